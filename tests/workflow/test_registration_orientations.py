"""Registration of meshes that lie the wrong way round, are mirrored, or differ from the specimen."""

import warnings
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
import scenes.plate
from fedic.cli import app
from fedic.registration._mirrored import mirrored_feature, mirrored_mesh, turned_camera
from scenes.placed_plate import BOUNDARY, CAMERAS, FRONT, MESH, PINHOLE, POINTS, off, plate
from scenes.plate import CENTRE, LENGTH, WIDTH, plate_mesh, wrong

SIDES = ["left", "right", "bottom", "top"]
OFF = (1, -1, 1, -1)


@pytest.fixture(scope="module", params=CAMERAS)
def scene(request: pytest.FixtureRequest) -> tuple[Any, NDArray[np.uint8]]:
    camera = CAMERAS[request.param]
    return camera, plate(camera, 0.02)


def mirrored(mesh: fedic.Mesh) -> fedic.Mesh:
    return fedic.Mesh(mesh.points * [-1.0, 1.0] + [LENGTH, 0.0], mesh.cells)


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_the_turned_camera_sees_each_point_where_its_opposite_was(camera: Any) -> None:
    opposite = np.array([LENGTH, WIDTH]) - MESH.points
    np.testing.assert_allclose(turned_camera(camera, MESH).project(MESH.points), camera.project(opposite), atol=1e-9)
    np.testing.assert_allclose(off(turned_camera(turned_camera(camera, MESH), MESH), camera), 0.0, atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1])
def test_features_of_the_mirrored_mesh_have_the_material_on_the_left(axis: int) -> None:
    image = mirrored_mesh(MESH, axis)
    theirs = {frozenset(each.nodes.tolist()): each for each in fedic.boundary_features(image)}
    for feature in fedic.boundary_features(MESH):
        ours = mirrored_feature(feature, MESH, axis)
        other = theirs[frozenset(ours.nodes.tolist())]
        assert {tuple(segment) for piece in ours.pieces for segment in piece.segments} == {
            tuple(segment) for piece in other.pieces for segment in piece.segments
        }
        for piece, same in zip(ours.pieces, other.pieces, strict=False):
            if piece.circle is not None and same.circle is not None:
                np.testing.assert_allclose(piece.circle.centre, same.circle.centre, atol=1e-9)


@pytest.mark.parametrize("features", [BOUNDARY, SIDES, ["hole 0", "top", "left"], ["hole 0", "bottom"]], ids=len)
def test_a_mesh_turned_by_half_a_turn_is_found_and_named(
    scene: tuple[Any, NDArray[np.uint8]], features: list[str]
) -> None:
    camera, image = scene
    free = None if camera is FRONT else ["rz", "tx", "ty", "tz"]
    start = turned_camera(camera if free else wrong(camera, OFF), MESH)
    with pytest.warns(fedic.QualityWarning, match="with the mesh turned by 180 degrees"):
        found = fedic.register(MESH, image, start, features=features, free=free)
    assert off(found.camera, camera).max() < 1.5
    assert "turned by 180 degrees" in found.doubts[0]


def test_a_right_start_raises_no_doubts(scene: tuple[Any, NDArray[np.uint8]]) -> None:
    camera, image = scene
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for features in (BOUNDARY, SIDES):
            found = fedic.register(MESH, image, wrong(camera, OFF), features=features)
            assert found.doubts == ()
            assert off(found.camera, camera).max() < 1.0


def test_points_say_which_way_round_the_mesh_lies(scene: tuple[Any, NDArray[np.uint8]]) -> None:
    camera, image = scene
    points = POINTS[[0, 2, 9, 11]], camera.project(POINTS[[0, 2, 9, 11]])
    found = fedic.register(MESH, image, turned_camera(camera, MESH), features=BOUNDARY, points=points)
    assert found.doubts == ()
    assert off(found.camera, camera).max() < 1.0


def test_a_held_angle_is_not_turned() -> None:
    image, start = plate(FRONT, 0.02), turned_camera(FRONT, MESH)
    with pytest.raises(fedic.ImageError, match="is not found in the image"):
        fedic.register(MESH, image, start, features=["hole 0", "left", "right"], free=["u0", "v0"])


def test_a_mirrored_mesh_is_named() -> None:
    image = plate(FRONT, 0.02)
    with pytest.raises(fedic.ImageError, match=r"is not found .*fit better with the mesh mirrored"):
        fedic.register(mirrored(MESH), image, FRONT, features=BOUNDARY)


def test_a_mirrored_mesh_whose_hole_is_nearly_in_the_middle_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The hole is 2.4 px beside its place in the mirrored mesh, and so the fit is accepted."""
    monkeypatch.setattr(scenes.plate, "CENTRE", (LENGTH / 2 + 0.15, CENTRE[1]))
    with pytest.warns(fedic.QualityWarning, match="mesh mirrored"):
        found = fedic.register(mirrored(plate_mesh()), plate(FRONT, 0.02), FRONT, features=["hole 0", *SIDES])
    assert "mirrored" in found.doubts[0]


@pytest.mark.parametrize(("factor", "side"), [(0.97, "inside"), (1.03, "out of")])
def test_a_hole_of_another_size_is_named(factor: float, side: str) -> None:
    """A hole of 40 px whose radius is 1.2 px smaller or larger in the mesh."""
    mesh = plate_mesh("triangle", 24)
    near = np.hypot(*(mesh.points - CENTRE).T) < 5.01
    points = mesh.points.copy()
    points[near] = CENTRE + factor * (points[near] - CENTRE)
    changed = fedic.Mesh(points, mesh.cells)
    with pytest.warns(fedic.QualityWarning, match=f"feature 'hole 0' in the image lies {side} the material"):
        found = fedic.register(changed, plate(FRONT, 0.02), wrong(FRONT, OFF), features=BOUNDARY)
    assert off(found.camera, FRONT, mesh).max() < 1.0
    assert len(found.doubts) == 1


def test_mirrored_points_are_refused() -> None:
    pixels = FRONT.project(POINTS)
    downwards = np.array([0.0, WIDTH]) - POINTS * [-1.0, 1.0]
    for some in (range(len(POINTS)), [0, 2, 9]):
        with pytest.raises(fedic.OptionError, match=r"mirror image of the points\. Y points up"):
            fedic.register(MESH, plate(FRONT, 0.02), FRONT, points=(downwards[some], pixels[some]))
    with pytest.raises(fedic.OptionError, match="exchange u and v"):
        fedic.register(MESH, np.zeros((600, 600), np.uint8), FRONT, points=(POINTS, pixels[:, ::-1]))
    fedic.register(MESH, plate(PINHOLE, 0.02), PINHOLE, points=(POINTS, PINHOLE.project(POINTS)))


def test_the_command_ends_with_status_3_and_says_why(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "plate.png"), plate(FRONT, 0.02))
    fedic.write_camera(turned_camera(FRONT, MESH), tmp_path / "rough.toml")
    images = [plate(FRONT, 0.02)] * 2
    fedic.correlate(*images, MESH, FRONT).write(tmp_path / "plate.vtu")
    files = [str(tmp_path / name) for name in ("plate.vtu", "plate.png", "rough.toml")]
    features = [word for name in BOUNDARY for word in ("--feature", name)]
    written = ["--output", str(tmp_path / "camera.toml"), "--picture", str(tmp_path / "placed.png")]
    outcome = CliRunner().invoke(app, ["register", *files, *features, *written])
    assert outcome.exit_code == 3, outcome.output
    assert "Doubtful: The features fit better with the mesh turned by 180 degrees" in outcome.stderr
    assert off(fedic.read_camera(tmp_path / "camera.toml"), FRONT).max() < 1.0
    assert 'doubts = ["The features fit better' in (tmp_path / "camera.toml").read_text()
