"""Reading images and meshes, and meshing a polygon."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import meshio
import numpy as np
import pytest
import tifffile

import fedic
from fedic.io.images import copy_if_writable, release_pages

RNG = np.random.default_rng(0)
GREY8 = RNG.integers(0, 256, (40, 50), dtype=np.uint8)
GREY16 = RNG.integers(0, 65536, (40, 50), dtype=np.uint16)
COLOUR = RNG.integers(0, 256, (40, 50, 3), dtype=np.uint8)


@pytest.mark.parametrize("suffix", [".png", ".tif"])
@pytest.mark.parametrize("image", [GREY8, GREY16], ids=["8bit", "16bit"])
def test_grey_levels_are_kept_as_stored(tmp_path: Path, suffix: str, image: np.ndarray) -> None:
    path = tmp_path / f"image{suffix}"
    assert cv2.imwrite(str(path), image)
    read = fedic.read_image(path)
    assert read.dtype == image.dtype
    np.testing.assert_array_equal(read, image)


def test_bmp_is_read(tmp_path: Path) -> None:
    assert cv2.imwrite(str(tmp_path / "image.bmp"), GREY8)
    np.testing.assert_array_equal(fedic.read_image(tmp_path / "image.bmp"), GREY8)


def test_float_and_big_endian_tiff_are_read(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "float.tif", GREY8.astype(np.float32) / 3)
    assert fedic.read_image(tmp_path / "float.tif").dtype == np.float32
    tifffile.imwrite(tmp_path / "big.tif", GREY16, byteorder=">")
    big = fedic.read_image(tmp_path / "big.tif")
    assert big.dtype.isnative
    np.testing.assert_array_equal(big, GREY16)


def test_a_mapped_tiff_gives_the_same_measurement(tmp_path: Path) -> None:
    """Images of 64 MB are mapped; the speckle fills a corner of them."""
    texture, frame = fedic.synthetic.Speckle(5.0, seed=1), fedic.ImageFrame()
    images = []
    for name, shift in (("reference", 0.0), ("deformed", 0.4)):
        image = np.zeros((128, 1 << 17), dtype=np.float32)
        image[:, :140] = fedic.synthetic.render(texture, frame, (128, 140), displacement=(shift, shift))
        tifffile.imwrite(tmp_path / f"{name}.tif", image)
        images.append(image)
    mapped = [fedic.read_image(tmp_path / f"{name}.tif", mapped=True) for name in ("reference", "deformed")]
    mesh = fedic.rectangle_mesh((20, 20, 120, 100), 20)
    for image, stored in zip(mapped, images, strict=True):
        assert isinstance(image.base, np.memmap)
        assert not image.flags.writeable
        np.testing.assert_array_equal(image, stored)
    results = [fedic.correlate(*pair, mesh, initial="pyramid") for pair in (mapped, images)]
    np.testing.assert_array_equal(results[0].displacement, results[1].displacement)
    # Pages that the operating system dropped meanwhile are read again.
    np.testing.assert_array_equal(mapped[0], images[0])


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".jpg", ".tif", ".lzw.tif", ".big.tif"])
def test_read_images_are_writeable_and_mapped_images_are_read_only(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"grey{suffix}"
    if suffix == ".big.tif":
        tifffile.imwrite(path, GREY16, byteorder=">")
    else:
        assert cv2.imwrite(str(path), GREY8, [cv2.IMWRITE_TIFF_COMPRESSION, 5 if suffix == ".lzw.tif" else 1])
    read, fixed = fedic.read_image(path), fedic.read_image(path, mapped=True)
    np.testing.assert_array_equal(read, fixed)
    assert read.flags.writeable
    assert not fixed.flags.writeable
    # Only writeable images are copied.
    assert copy_if_writable(fixed, "reference") is fixed
    assert not np.shares_memory(copy_if_writable(read, "reference"), read)
    # The image that was read does not depend on the file.
    stored = read.copy()
    del fixed
    path.write_bytes(b"")
    np.testing.assert_array_equal(read, stored)


def test_writeable_images_are_copied(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "grey.tif", GREY8)
    frozen = GREY8.view()
    frozen.flags.writeable = False
    buffer = bytearray(GREY8.tobytes())
    for image in (
        GREY8,
        GREY8[::2],
        frozen,
        np.frombuffer(memoryview(buffer).toreadonly(), np.uint8).reshape(GREY8.shape),
        tifffile.memmap(tmp_path / "grey.tif", mode="r+"),
    ):
        kept = copy_if_writable(image, "reference")
        np.testing.assert_array_equal(kept, image)
        assert not np.shares_memory(kept, image)
    for image in (
        np.frombuffer(bytes(buffer), np.uint8).reshape(GREY8.shape),
        tifffile.memmap(tmp_path / "grey.tif", mode="r"),
    ):
        assert np.shares_memory(copy_if_writable(image, "reference"), image)


def test_releasing_the_memory_of_an_image_keeps_its_values(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "grey.tif", GREY8)
    private = tifffile.memmap(tmp_path / "grey.tif", mode="c")
    private += 1
    for image in (private, GREY8.copy()):
        kept = np.array(image)
        release_pages(image)
        np.testing.assert_array_equal(image, kept)


def test_lzw_tiff_is_read(shared_data: Callable[[str], Path]) -> None:
    assert fedic.read_image(shared_data("chessboard/image_00.tif")).shape == (513, 613)


@pytest.mark.parametrize("depth", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_colour_is_reduced_to_luminance(tmp_path: Path, depth: type, channels: int, suffix: str) -> None:
    scale = 257 if depth is np.uint16 else 1
    rgb = COLOUR.astype(depth) * depth(scale)
    alpha = np.full((40, 50, 1), 200 * scale, dtype=depth)
    stored = rgb if channels == 3 else np.concatenate([rgb, alpha], axis=2)
    path = tmp_path / f"colour{suffix}"
    if suffix == ".tif":
        tifffile.imwrite(path, stored, photometric="rgb", extrasamples=["unassalpha"] * (channels - 3) or None)
    else:
        bgr = np.concatenate([stored[:, :, 2::-1], stored[:, :, 3:]], axis=2)
        assert cv2.imwrite(str(path), bgr)
    expected = rgb.astype(float) @ (0.299, 0.587, 0.114)
    read = fedic.read_image(path)
    assert read.dtype == depth
    np.testing.assert_allclose(read, expected, atol=2.0)


@pytest.mark.parametrize("planarconfig", ["contig", "separate"])
def test_contiguous_and_planar_colour_tiffs_are_read(tmp_path: Path, planarconfig: str) -> None:
    stored = COLOUR if planarconfig == "contig" else np.ascontiguousarray(np.moveaxis(COLOUR, -1, 0))
    tifffile.imwrite(tmp_path / "c.tif", stored, photometric="rgb", planarconfig=planarconfig)
    np.testing.assert_allclose(
        fedic.read_image(tmp_path / "c.tif"), COLOUR.astype(float) @ (0.299, 0.587, 0.114), atol=1.01
    )


def test_missing_empty_and_unknown_image_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(fedic.ImageError, match=r"nothing\.tif: there is no such image file"):
        fedic.read_image(tmp_path / "nothing.tif")
    (tmp_path / "empty.png").touch()
    with pytest.raises(fedic.ImageError, match=r"empty\.png: the image file is empty"):
        fedic.read_image(tmp_path / "empty.png")
    (tmp_path / "notes.png").write_text("not an image")
    with pytest.raises(fedic.ImageError, match=r"notes\.png: the image format is not supported"):
        fedic.read_image(tmp_path / "notes.png")


@pytest.mark.parametrize("suffix", [".png", ".tif", ".jpg", ".bmp"])
@pytest.mark.parametrize("kept", [0.3, 0.9, 0.99])
def test_truncated_images_are_refused(tmp_path: Path, suffix: str, kept: float) -> None:
    path = tmp_path / f"image{suffix}"
    assert cv2.imwrite(str(path), GREY8)
    fedic.read_image(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(kept * len(data))])
    with pytest.raises(fedic.ImageError, match="truncated or damaged"):
        fedic.read_image(path)


def test_png_with_a_flipped_bit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "image.png"
    assert cv2.imwrite(str(path), GREY8)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(fedic.ImageError, match="truncated or damaged"):
        fedic.read_image(path)


def test_tiff_of_several_pages_is_refused(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "stack.tif", np.stack([GREY8] * 3), photometric="minisblack")
    with pytest.raises(fedic.ImageError, match="holds 3 pages"):
        fedic.read_image(tmp_path / "stack.tif")


POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [9, 9, 0]], dtype=float)


@pytest.mark.parametrize(("suffix", "file_format"), [(".msh", "gmsh22"), (".vtu", "vtu"), (".vtk", "vtk")])
def test_surface_cells_and_all_nodes_are_read(tmp_path: Path, suffix: str, file_format: str) -> None:
    path = tmp_path / f"mesh{suffix}"
    cells = [("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]])]
    content = meshio.Mesh(POINTS, cells)
    if suffix == ".msh":
        content.cell_data = {key: [np.ones(1, dtype=int)] * 3 for key in ("gmsh:physical", "gmsh:geometrical")}
    meshio.write(path, content, file_format=file_format)
    mesh = fedic.read_mesh(path)
    np.testing.assert_array_equal(mesh.points, POINTS[:, :2])
    assert {name: nodes.tolist() for name, nodes in mesh.cells.items()} == {
        "quad": [[0, 1, 2, 3]],
        "triangle": [[1, 4, 2]],
    }
    np.testing.assert_array_equal(mesh.used_nodes, [True] * 5 + [False])


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_gmsh_files_are_read(tmp_path: Path, gmsh: Any, version: float, binary: int) -> None:
    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        for name, value in (("General.Terminal", 0), ("Mesh.MshFileVersion", version), ("Mesh.Binary", binary)):
            gmsh.option.setNumber(name, value)
        gmsh.model.occ.addRectangle(0, 0, 0, 3, 2)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(tmp_path / "mesh.msh"))
        triangles = len(gmsh.model.mesh.getElementsByType(9)[0])
    finally:
        gmsh.finalize()
    mesh = fedic.read_mesh(tmp_path / "mesh.msh")
    assert {name: len(nodes) for name, nodes in mesh.cells.items()} == {"triangle6": triangles}
    assert mesh.areas().sum() == pytest.approx(6.0)


def test_surface_meshes_in_space_keep_their_z_coordinates(tmp_path: Path) -> None:
    points = POINTS.copy()
    points[2, 2] = 0.5
    meshio.write(tmp_path / "mesh.vtu", meshio.Mesh(points, [("quad", [[0, 1, 2, 3]])]))
    np.testing.assert_array_equal(fedic.read_mesh(tmp_path / "mesh.vtu").points, points)


def test_volume_missing_and_broken_mesh_files_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    meshio.write(tmp_path / "solid.vtu", meshio.Mesh(points, [("tetra", [[0, 1, 2, 3]])]))
    with pytest.raises(fedic.MeshError, match=r"solid\.vtu: no surface cell .*cells found: tetra"):
        fedic.read_mesh(tmp_path / "solid.vtu")
    with pytest.raises(fedic.MeshError, match=r"none\.msh: there is no such mesh file"):
        fedic.read_mesh(tmp_path / "none.msh")
    for name in ("broken.msh", "broken.vtu", "broken.vtk", "broken.xyz"):
        (tmp_path / name).write_text("not a mesh\n")
        with pytest.raises(fedic.MeshError, match=f"{name}: the mesh file cannot be read"):
            fedic.read_mesh(tmp_path / name)
    assert capfd.readouterr() == ("", "")


CAE_FILE = """\
*Heading
** Job name: plate
*Part, name=Plate
*Node
      10,   0.,   0.
      20,   1.,   0.
      30,   1.,   1.
      40,   0.,   1.
*Node
      50,   2.,   0.
*Element, type={quad}, elset=all
1, 10, 20,
30, 40
*Element, type=CPE3
2, 20, 50, 30
*Element, type=SPRINGA
3, 10, 20
*Nset, nset=left
10, 40
*End Part
*Assembly, name=Assembly
*Instance, name=Plate-1, part=Plate
*End Instance
*Node
      1,   7.,   7.,   0.
*End Assembly
*Node Output
U,
"""


@pytest.mark.parametrize("quad", ["CPS4", "cpe4r", "CAX4P", "S4R5", "M3D4", "R3D4"])
def test_an_abaqus_part_is_read_regardless_of_the_assembly(tmp_path: Path, quad: str) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(CAE_FILE.format(quad=quad))
    mesh = fedic.read_mesh(path)
    np.testing.assert_array_equal(mesh.points, [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0]])
    assert {name: nodes.tolist() for name, nodes in mesh.cells.items()} == {
        "quad": [[0, 1, 2, 3]],
        "triangle": [[1, 4, 2]],
    }


@pytest.mark.parametrize(
    ("element", "cell", "nodes"),
    [("CPS6M", "triangle6", 6), ("STRI65", "triangle6", 6), ("CPE8R", "quad8", 8), ("S9R5", "quad9", 9)],
)
def test_abaqus_quadratic_elements_are_read(tmp_path: Path, element: str, cell: str, nodes: int) -> None:
    corners = [(0, 0), (2, 0), (0, 2), (1, 0), (1, 1), (0, 1)]
    if nodes > 6:
        corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)][:nodes]
    lines = ["*NODE", *(f"{i}, {x}, {y}, 0" for i, (x, y) in enumerate(corners, 1)), f"*ELEMENT, TYPE={element}"]
    lines.append("1, " + ", ".join(str(i + 1) for i in range(nodes)))
    (tmp_path / "one.inp").write_text("\n".join(lines))
    assert fedic.read_mesh(tmp_path / "one.inp").cells[cell].tolist() == [list(range(nodes))]


def test_abaqus_include_is_followed(tmp_path: Path) -> None:
    (tmp_path / "nodes.txt").write_text("*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n")
    (tmp_path / "main.inp").write_text("*INCLUDE, INPUT=nodes.txt\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n")
    assert fedic.read_mesh(tmp_path / "main.inp").num_nodes == 3


def test_abaqus_include_of_itself_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.inp").write_text("*INCLUDE, INPUT=b.inp\n")
    (tmp_path / "b.inp").write_text("*INCLUDE, INPUT=./a.inp\n")
    with pytest.raises(fedic.MeshError, match=r"a\.inp: the file includes itself"):
        fedic.read_mesh(tmp_path / "a.inp")


def test_errors_in_abaqus_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.inp"
    path.write_text("*NODE\n1, 0, 0\n2, 1, zero\n")
    with pytest.raises(fedic.MeshError, match=r"bad\.inp, line 3: not a valid line of \*NODE"):
        fedic.read_mesh(path)
    path.write_text("*NODE\n1, 0, 0\n2, 1, 0\n*ELEMENT, TYPE=S3\n7, 1, 2, 99\n")
    with pytest.raises(fedic.MeshError, match="element 7 refers to node 99"):
        fedic.read_mesh(path)
    path.write_text("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1, 1\n")
    with pytest.raises(fedic.MeshError, match="cells found: tetra"):
        fedic.read_mesh(path)


def test_the_meshes_of_the_open_hole_are_read(shared_data: Callable[[str], Path]) -> None:
    abaqus = fedic.read_mesh(shared_data("openhole/abaqus_q4_m.inp"))
    assert (abaqus.points.shape, abaqus.cells["quad"].shape) == ((1500, 2), (1404, 4))
    gmsh = fedic.read_mesh(shared_data("openhole/gmsh_t3_mm.msh"))
    assert (gmsh.points.shape, gmsh.cells["triangle"].shape) == ((1836, 2), (3478, 3))


SQUARE = [(0.0, 0.0), (100.0, 0.0), (100.0, 80.0), (0.0, 80.0)]
ANGLES = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
HOLE = np.column_stack([50.0 + 20.0 * np.cos(ANGLES), 40.0 + 20.0 * np.sin(ANGLES)])


@pytest.mark.parametrize("cell", ["triangle", "triangle6", "quad", "quad8", "quad9"])
@pytest.mark.parametrize("hole", [HOLE, HOLE[:-1]], ids=["even", "odd"])
@pytest.mark.usefixtures("gmsh")
def test_unstructured_mesh_covers_the_polygon(cell: str, hole: np.ndarray) -> None:
    mesh = fedic.unstructured_mesh(SQUARE, 8.3, cell, [hole])  # type: ignore[arg-type]
    assert list(mesh.cells) == [cell]
    assert mesh.used_nodes.all()
    x, y = hole.T
    hole_area = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0
    assert mesh.areas().sum() == pytest.approx(8000.0 - hole_area)
    again = fedic.unstructured_mesh(SQUARE, 8.3, cell, [hole])  # type: ignore[arg-type]
    np.testing.assert_array_equal(again.points, mesh.points)


def test_unstructured_mesh_restores_the_state_of_gmsh(gmsh: Any, capfd: pytest.CaptureFixture[str]) -> None:
    fedic.unstructured_mesh(SQUARE, 20.0)
    assert not gmsh.isInitialized()
    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("mine")
        fedic.unstructured_mesh(SQUARE, 20.0, "quad9")
        assert gmsh.model.getCurrent() == "mine"
        assert gmsh.option.getNumber("Mesh.ElementOrder") == 1
    finally:
        gmsh.finalize()
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("outline", "holes", "message"),
    [
        ([(0, 0), (100, 80), (100, 0), (0, 70)], [], "cross or touch"),
        (SQUARE, [HOLE + np.array([40.0, 0.0])], "cross or touch"),
        (SQUARE, [HOLE + 500.0], "inside the outline"),
    ],
)
@pytest.mark.usefixtures("gmsh")
def test_unstructured_mesh_refuses_bad_polygons(outline: list, holes: list, message: str) -> None:
    with pytest.raises(fedic.MeshError, match=message):
        fedic.unstructured_mesh(outline, 10.0, "triangle", holes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"outline": SQUARE[:2]}, "outline has no area"),
        ({"holes": [[(1, 2, 3)]]}, r"holes\[0\] has shape"),
        ({"outline": "square"}, "outline is not an array"),
        ({"cell": "hexahedron"}, "cell must be one of"),
        ({"size": 0.0}, "size is 0.0; give a positive length"),
        ({"size": 1e-3}, r"about 2e\+10 cells of these polygons, over the limit of 5e\+06; give a larger size"),
        ({"size": 1e-300}, "about inf cells"),
        ({"outline": [*SQUARE[:3], (-2e9, 40.0)]}, "cells of these polygons"),
        ({"outline": [(0.0, 0.0), (1e8, 1e-3), (1e8, 2e-3)]}, "cells of these polygons"),
        ({"outline": np.random.default_rng(0).random((5000, 2))}, "have 5000 corners, over the limit of 4000"),
    ],
)
def test_unstructured_mesh_refuses_malformed_arguments(arguments: dict, message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        fedic.unstructured_mesh(**{"outline": SQUARE, "size": 10.0, **arguments})


def test_unstructured_mesh_without_gmsh_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gmsh", None)
    with pytest.raises(fedic.MeshError, match=r"pip install fedic\[gmsh\]"):
        fedic.unstructured_mesh(SQUARE, 10.0)
