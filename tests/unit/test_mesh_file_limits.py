"""Damaged and hostile mesh files: every one ends, soon, in a MeshError that says what is wrong."""

import os
import random
import zlib
from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.io import meshes
from fedic.io.mesh_formats._process import read_in_process
from scenes.meshes.gmsh_files import write_plate
from scenes.meshes.hdf_files import write_exodus, write_med, write_xdmf
from scenes.meshes.plate import POINTS
from scenes.meshes.vtk_files import write_legacy, write_vtp, write_vtu

HUGE = 10_000_000_000


def test_what_is_no_regular_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.msh").mkdir()
    os.mkfifo(tmp_path / "pipe.msh")
    for name, message in (
        ("folder.msh", "this is a folder"),
        ("pipe.msh", "this is a device or a pipe"),
        ("none.msh", "there is no such mesh file"),
        ("x" * 300 + ".msh", "the mesh file cannot be read .*too long"),
        ("a\0.msh", "the mesh file cannot be read .*null"),
    ):
        with pytest.raises(fedic.MeshError, match=message):
            fedic.read_mesh(tmp_path / name)


def test_a_file_that_is_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_vtu(tmp_path / "plate.vtu", "ascii")
    monkeypatch.setattr(meshes, "MAX_BYTES", 100)
    with pytest.raises(fedic.MeshError, match=r"the mesh file has .* bytes; one of this kind has at most 100"):
        fedic.read_mesh(tmp_path / "plate.vtu")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "a.msh",
            f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{HUGE}\n1 0 0 0\n$EndNodes\n$Elements\n0\n$EndElements",
        ),
        ("b.msh", f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {HUGE} 1 1\n2 1 0 {HUGE}\n1\n$EndNodes\n"),
        ("c.msh", f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n{HUGE} 0 0 0\n1 0 0 0 0\n$EndEntities\n"),
        ("d.vtk", f"# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS {HUGE} float\n0 0 0\n"),
        ("e.vtk", f"# vtk DataFile Version 3.0\n\nBINARY\nDATASET POLYDATA\nPOLYGONS {HUGE} {HUGE}\n\0\0\0"),
        (
            "f.vtu",
            '<VTKFile type="UnstructuredGrid"><UnstructuredGrid>'
            f'<Piece NumberOfPoints="{HUGE}" NumberOfCells="{HUGE}"><Points>'
            '<DataArray type="Float64" format="ascii">1 2 3</DataArray></Points></Piece></UnstructuredGrid></VTKFile>',
        ),
        (
            "g.xdmf",
            '<Xdmf><Domain><Grid><Geometry GeometryType="XYZ"><DataItem Format="XML" '
            f'Dimensions="{HUGE} 3">1 2 3</DataItem></Geometry><Topology/></Grid></Domain></Xdmf>',
        ),
        ("h.off", f"OFF\n{HUGE} {HUGE} 0\n0 0 0\n"),
    ],
)
def test_sizes_that_the_file_does_not_hold_are_refused(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(fedic.MeshError, match="the mesh file cannot be read") as error:
        fedic.read_mesh(tmp_path / name)
    assert "np." not in str(error.value)


@pytest.mark.parametrize(
    ("sizes", "message"),
    [((1, 2**62, 0), "bytes, more than the"), ((2**40, 8, 0), "it ends too early"), ((1, 80, 0), "the wrong size")],
)
def test_compressed_arrays_of_the_wrong_size_are_refused(
    tmp_path: Path, sizes: tuple[int, int, int], message: str
) -> None:
    packed = zlib.compress(b"\0" * 10_000)
    data = np.array([*sizes, len(packed)], dtype="<u8").tobytes() + packed
    (tmp_path / "a.vtu").write_bytes(
        b'<VTKFile type="UnstructuredGrid" header_type="UInt64" compressor="vtkZLibDataCompressor"><UnstructuredGrid>'
        b'<Piece NumberOfPoints="1" NumberOfCells="0"><Points><DataArray type="Float64" format="appended" offset="0"/>'
        b'</Points></Piece></UnstructuredGrid><AppendedData encoding="raw">_' + data + b"</AppendedData></VTKFile>"
    )
    with pytest.raises(fedic.MeshError, match=message):
        fedic.read_mesh(tmp_path / "a.vtu")


@pytest.mark.parametrize(("suffix", "root"), [("vtu", "VTKFile"), ("xdmf", "Xdmf")])
def test_entities_of_xml_are_refused(tmp_path: Path, suffix: str, root: str) -> None:
    path = tmp_path / f"a.{suffix}"
    path.write_text(f'<!DOCTYPE {root} [<!ENTITY a "b">]>\n<{root}>&a;</{root}>')
    with pytest.raises(fedic.MeshError, match="declares entities of XML"):
        fedic.read_mesh(path)


def test_links_to_other_hdf5_files_are_refused(tmp_path: Path) -> None:
    import h5py

    write_med(tmp_path / "plate.med")
    (tmp_path / "plate.med").rename(tmp_path / "other.med")
    with h5py.File(tmp_path / "link.med", "w") as file:
        file["ENS_MAA"] = h5py.ExternalLink("other.med", "/ENS_MAA")
    with pytest.raises(fedic.MeshError, match="'ENS_MAA' is a link to another file"):
        fedic.read_mesh(tmp_path / "link.med")
    write_xdmf(tmp_path / "plate.xdmf", "HDF")
    numbers = tmp_path / "numbers.bin"
    POINTS[:, :2].astype("f8").tofile(numbers)
    with h5py.File(tmp_path / "plate.h5", "a") as file:
        del file["data1"]
        file.create_dataset("data1", (12, 2), "f8", external=[(str(numbers), 0, h5py.h5f.UNLIMITED)])
    with pytest.raises(fedic.MeshError, match="lie in another file"):
        fedic.read_mesh(tmp_path / "plate.xdmf")


def test_the_extra_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    absent = tmp_path / "absent"
    absent.mkdir()
    (absent / "netCDF4.py").write_text("raise ImportError('absent')")
    path = tmp_path / "plate.e"
    write_exodus(path, "NETCDF3_CLASSIC")
    monkeypatch.syspath_prepend(absent)
    with pytest.raises(fedic.MeshError, match=r"plate\.e: the mesh file needs netCDF4.*fedic\[exodus\]"):
        fedic.read_mesh(path)


def test_a_library_that_does_not_end_is_ended(tmp_path: Path) -> None:
    path = tmp_path / "plate.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert fedic.read_mesh(path).num_cells == 1
    with pytest.raises(fedic.MeshError, match=r"plate\.off: .*did not read it within 0 s"):
        read_in_process("_meshio", "read_with_meshio", path, seconds=0.0)


def test_a_library_that_ends_the_process_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "plate.off"
    path.write_text("OFF\n")
    with pytest.raises(fedic.MeshError, match=r"plate\.off: .*the library ended with code 1"):
        read_in_process("hdf", "there is no such reader", path)


@pytest.mark.filterwarnings("default::fedic.QualityWarning")
@pytest.mark.parametrize("name", ["text.msh", "binary.msh", "raw.vtu", "text.vtu", "text.vtk", "binary.vtk", "a.vtp"])
def test_damaged_files_are_refused_or_read(tmp_path: Path, name: str) -> None:
    """Cut short, with bytes changed, put in or taken out: 200 files from one of each format."""
    path = tmp_path / name
    if path.suffix == ".msh":
        write_plate(path, 4.1, name == "binary.msh", {})
    elif path.suffix == ".vtu":
        write_vtu(path, "ascii" if name == "text.vtu" else "appended raw", "" if name == "text.vtu" else "ZLib")
    elif path.suffix == ".vtk":
        write_legacy(path, 5.1, name == "binary.vtk")
    else:
        write_vtp(path)
    content = path.read_bytes()
    chance = random.Random(1)
    messages = []
    for _ in range(200):
        damaged = bytearray(content)
        place = chance.randrange(len(content))
        kind = chance.randrange(4)
        if kind == 0:
            del damaged[place:]
        elif kind == 1:
            damaged[place] = chance.randrange(256)
        elif kind == 2:
            del damaged[place : place + chance.randrange(1, 20)]
        else:
            damaged[place:place] = chance.choice([b"9999999999", b"-1 ", b"nan ", b"\0" * 8, b"\xff" * 8])
        path.write_bytes(bytes(damaged))
        try:
            fedic.read_mesh(path)
        except fedic.MeshError as error:
            messages.append(str(error))
    assert len(messages) > 50
    assert [each for each in messages if not each.startswith(f"{path}") or "np." in each] == []
