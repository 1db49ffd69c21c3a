"""The mesh of a plate of 3 x 2 in the variants of each format."""

from scenes.meshes import gmsh_files, hdf_files, meshio_files, vtk_files
from scenes.meshes.variant import Variant

__all__ = ["VARIANTS"]

QUADS = {"quad": 6}


def _gmsh() -> list[Variant]:
    found = []
    for version, binary in ((2.2, False), (2.2, True), (4.0, False), (4.1, False), (4.1, True)):
        form = f"{version}, {'binary' if binary else 'text'}"
        for name, options in gmsh_files.OPTIONS.items():
            lost = version == 2.2 and options.get("SaveAll", 0)
            found.append(
                Variant(
                    "Gmsh .msh",
                    f"{form}, {name}",
                    "plate.msh",
                    lambda path, v=version, b=binary, o=options: gmsh_files.write_plate(path, v, b, o),  # type: ignore[misc]
                    QUADS,
                    () if lost else ("also", "bottom", "plate"),
                )
            )
    solid = "4.1, faces of a solid, chosen by"
    return [
        *found,
        Variant("Gmsh .msh", "2.2, second order", "p.msh", gmsh_files.write_second_order, {"quad9": 6}, ("plate",)),
        Variant("Gmsh .msh", f"{solid} physical name", "s.msh", gmsh_files.write_solid, QUADS, ("TOP", "solid"), "TOP"),
        Variant("Gmsh .msh", f"{solid} physical number", "s.msh", gmsh_files.write_solid, QUADS, ("TOP", "solid"), "5"),
        Variant("Gmsh .msh", "1", "p.msh", gmsh_files.write_version_1, refusal="version 1 of Gmsh's format"),
        Variant("Gmsh .msh", "third order", "p.msh", gmsh_files.write_third_order, refusal="type quad16 are not"),
    ]


def _vtk() -> list[Variant]:
    found = []
    for array_format in ("ascii", "binary", "appended raw", "appended base64"):
        for compressor in ("", "ZLib", "LZMA", "LZ4"):
            if array_format == "ascii" and compressor:
                continue
            found.append(
                Variant(
                    "VTK .vtu",
                    ", ".join(filter(None, [array_format, compressor])),
                    "plate.vtu",
                    lambda path, f=array_format, c=compressor: vtk_files.write_vtu(path, f, c),  # type: ignore[misc]
                    QUADS,
                    ("left",),
                )
            )
    for name, order, header in (("big-endian", ">", "UInt32"), ("headers of 64 bits", "<", "UInt64")):
        found.append(
            Variant(
                "VTK .vtu",
                name,
                "plate.vtu",
                lambda path, o=order, h=header: vtk_files.write_vtu(path, "appended raw", "ZLib", o, h),  # type: ignore[misc]
                QUADS,
                ("left",),
            )
        )
    for name, (cells, counts) in vtk_files.CELLS.items():
        found.append(
            Variant(
                "VTK .vtu",
                name,
                "plate.vtu",
                lambda path, c=cells: vtk_files.write_cells(path, c),  # type: ignore[misc]
                counts,
                refusal="" if counts else "not measured",
            )
        )
    for version, binary in ((4.2, False), (4.2, True), (5.1, False), (5.1, True)):
        form = f"{version}, {'binary' if binary else 'text'}"
        found += [
            Variant(
                "VTK .vtk",
                f"{form}, grid with texts and a poly-line",
                "plate.vtk",
                lambda path, v=version, b=binary: vtk_files.write_legacy(path, v, b),  # type: ignore[misc]
                QUADS,
                ("left",),
            ),
            Variant(
                "VTK .vtk",
                f"{form}, polygons",
                "plate.vtk",
                lambda path, v=version, b=binary: vtk_files.write_legacy_polygons(path, v, b),  # type: ignore[misc]
                {"quad": 4, "triangle": 4},
            ),
        ]
    return [
        *found,
        Variant("VTK .vtu", "array of texts", "plate.vtu", vtk_files.write_with_text, QUADS),
        Variant("VTK .vtu", "two pieces", "plate.vtu", vtk_files.write_pieces, QUADS),
        Variant("VTK .vtp", "polygons and strips", "plate.vtp", vtk_files.write_vtp, {"quad": 2, "triangle": 8}),
        Variant("VTK .vtu", "image data", "plate.vtu", vtk_files.write_image, refusal="data set of type 'ImageData'"),
        Variant("VTK .vtk", "structured points", "p.vtk", vtk_files.write_legacy_image, refusal="STRUCTURED_POINTS"),
    ]


def _hdf() -> list[Variant]:
    h5py, netcdf4 = "h5py", "netCDF4"
    found = [
        Variant("MED .med", "groups", "plate.med", hdf_files.write_med, QUADS, ("LEFT", "PLATE", "TWO"), reader=h5py),
        Variant(
            "MED .med",
            "group chosen",
            "p.med",
            hdf_files.write_med,
            {"quad": 2},
            ("LEFT", "PLATE", "TWO"),
            "TWO",
            reader=h5py,
        ),
        Variant("MED .med", "two meshes", "p.med", hdf_files.write_two_med, refusal="2 meshes", reader=h5py),
        Variant(
            "XDMF .xdmf", "mixed, HDF5", "p.xdmf", hdf_files.write_xdmf_mixed, {"quad": 4, "triangle": 4}, reader=h5py
        ),
        Variant("XDMF .xdmf", "version 2, in time, XML", "p.xdmf", hdf_files.write_xdmf_2, QUADS, ("left", "two")),
        Variant("XDMF .xdmf", "structured", "p.xdmf", hdf_files.write_xdmf_structured, refusal="topology '2dsmesh'"),
    ]
    for form, reader in (("XML", "fedic"), ("Binary", "fedic"), ("HDF", h5py)):
        found.append(
            Variant(
                "XDMF .xdmf",
                f"version 3, {form}",
                "plate.xdmf",
                lambda path, f=form: hdf_files.write_xdmf(path, f),  # type: ignore[misc]
                QUADS,
                ("left",),
                reader=reader,
            )
        )
    for form in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF4"):
        found.append(
            Variant(
                "Exodus .e",
                f"{form}, blocks and node set",
                "plate.e",
                lambda path, f=form: hdf_files.write_exodus(path, f),  # type: ignore[misc]
                {"quad": 4, "triangle": 4},
                ("LEFT", "PLATE"),
                reader=netcdf4,
            )
        )
    solid = "solids of 20 nodes, faces chosen by"
    return [
        *found,
        Variant(
            "Exodus .e",
            f"{solid} side set",
            "s.e",
            hdf_files.write_exodus_solid,
            {"quad8": 6},
            (),
            "TOP",
            reader=netcdf4,
        ),
        Variant(
            "Exodus .e",
            f"{solid} z-max",
            "s.e",
            hdf_files.write_exodus_solid,
            {"quad8": 6},
            (),
            "z-max",
            reader=netcdf4,
        ),
    ]


def _meshio() -> list[Variant]:
    return [
        Variant(name, "", f"plate{suffix}", write, cells, reader="meshio")
        for name, suffix, write, cells in meshio_files.FILES
    ] + [
        Variant("Tecplot .tec", "two zones", "p.tec", meshio_files.write_two_zones, refusal="zones", reader="meshio"),
        *(
            Variant(f"{suffix}", "", f"plate{suffix}", lambda path: path.write_bytes(b"\0"), refusal="names no format")  # type: ignore[misc, arg-type, func-returns-value, return-value]
            for suffix in (".cgns", ".wkt", ".node")
        ),
    ]


VARIANTS = [*_gmsh(), *_vtk(), *_hdf(), *_meshio()]
