"""Starts of large motions, against motions known exactly: rendered images, and real images turned by quarter turns."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.candidate import Estimator
from fedic.starts.estimators import ESTIMATORS, candidates
from fedic.starts.features import matched_features
from fedic.starts.fft import translations
from fedic.starts.flow import dense_flow
from fedic.starts.images import StartImages
from fedic.starts.log_polar import turned
from fedic.starts.motion import moved
from scenes.moved_plate import motion, pair
from scenes.open_hole import open_hole_camera

SIDE = 360
MESH = fedic.rectangle_mesh((100, 100, 260, 260), size=20)
CAMERA = fedic.ImageFrame()


def error(estimator: Estimator, matrix: NDArray[np.float64], **options: float) -> float:
    """Return the largest error of the best candidate at the nodes, in pixels; infinite if there is none."""
    images = StartImages.of(*pair(matrix, side=SIDE, **options), MESH, CAMERA)  # type: ignore[arg-type]
    found = estimator(images)
    if not found:
        return np.inf
    expected = moved(matrix, MESH.points) - MESH.points
    return float(np.linalg.norm(found[0].displacement - expected, axis=1).max())


@pytest.mark.parametrize("angle", range(0, 360, 30))
def test_features_find_any_rotation(angle: int) -> None:
    assert error(matched_features, motion(angle, shift=(20, -30), side=SIDE)) < 0.1


@pytest.mark.parametrize("angle", range(0, 360, 60))
def test_log_polar_spectra_find_rotations_about_the_mesh(angle: int) -> None:
    assert error(turned, motion(angle, side=SIDE)) < 0.1


@pytest.mark.parametrize("scale", [0.6, 0.8, 1.25, 1.8])
def test_features_find_a_scale(scale: float) -> None:
    assert error(matched_features, motion(stretch=(scale, scale), side=SIDE)) < 0.2


@pytest.mark.parametrize("scale", [0.7, 1.25])
def test_log_polar_spectra_find_a_scale(scale: float) -> None:
    assert error(turned, motion(stretch=(scale, scale), side=SIDE)) < 0.1


@pytest.mark.parametrize(("stretch", "angle"), [(0.6, 0), (0.6, 50), (1.5, 0), (1.5, 50)])
def test_features_find_a_stretch_along_one_axis(stretch: float, angle: float) -> None:
    assert error(matched_features, motion(angle, (stretch, 1.0), side=SIDE)) < 0.2


@pytest.mark.parametrize("stretch", [0.8, 1.2])
def test_flow_finds_a_stretch(stretch: float) -> None:
    assert error(dense_flow, motion(stretch=(stretch, 1.0), side=SIDE)) < 0.5


@pytest.mark.parametrize("shift", [(60, -20), (-90, 90)])
def test_fft_finds_a_translation(shift: tuple[float, float]) -> None:
    assert error(translations, motion(shift=shift, side=SIDE)) < 0.05


@pytest.mark.parametrize("contrast", [0.2, 0.05])
@pytest.mark.parametrize("estimator", [translations, turned, matched_features], ids=["fft", "log-polar", "features"])
def test_a_loss_of_contrast_is_no_obstacle(estimator: Estimator, contrast: float) -> None:
    angle = 0.0 if estimator is translations else 50.0
    assert error(estimator, motion(angle, shift=(15, 0), side=SIDE), noise=2.0, contrast=contrast) < 0.3


@pytest.mark.parametrize("angle", [10, 15, 25, 90, 170])
def test_some_estimator_finds_the_rotation_of_a_mesh_in_a_wide_image(angle: int) -> None:
    matrix = motion(angle, shift=(35, 20), side=SIDE)
    best = max(
        candidates(StartImages.of(*pair(matrix, side=SIDE), MESH, CAMERA)), key=lambda each: each.score * each.overlap
    )
    expected = moved(matrix, MESH.points) - MESH.points
    assert np.linalg.norm(best.displacement - expected, axis=1).max() < 0.5


def quarter_turns(image: NDArray[np.uint8], points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the places of points of an image after `np.rot90(image, count)`."""
    height, width = image.shape
    for _ in range(count):
        points = np.column_stack([points[:, 1], width - 1 - points[:, 0]])
        height, width = width, height
    return points


@pytest.mark.parametrize(("frame", "largest", "turns"), [("0054", 0.5, (1,)), ("0070", 1.6, (2, 3))])
def test_real_images_turned_by_quarter_turns_get_the_start_of_the_unturned_ones(
    shared_data: Callable[[str], Path], frame: str, largest: float, turns: tuple[int, ...]
) -> None:
    camera = open_hole_camera()
    mesh = fedic.read_mesh(shared_data("openhole/abaqus_q4_m.inp"))
    reference, deformed = (
        np.asarray(fedic.read_image(shared_data(f"openhole/zoom-{name}_1.tif"))) for name in ("0053", frame)
    )
    rows = reference.shape[1] - reference.shape[0]
    reference, deformed = (np.pad(image, ((0, rows), (0, 0)), mode="edge") for image in (reference, deformed))
    measured = fedic.correlate(reference, deformed, mesh, camera, initial="pyramid")
    assert measured.converged
    here = camera.project(mesh.points)
    there = here + measured.pixel_displacement
    for count in turns:
        expected = quarter_turns(deformed, there, count) - here
        images = StartImages.of(reference, np.rot90(deformed, count), mesh, camera)  # type: ignore[arg-type]
        (feature,), (spectrum,) = matched_features(images), turned(images)
        (flow,) = dense_flow(images, feature.motion)
        errors = [np.linalg.norm(each.displacement - expected, axis=1) for each in (feature, spectrum, flow)]
        assert max(each.max() for each in errors) < largest
        assert np.sqrt((errors[2] ** 2).mean()) < 0.2
        assert flow.score > 0.99


def test_the_estimators_find_nothing_where_nothing_is() -> None:
    reference, _ = pair(motion(side=SIDE), side=SIDE)
    unrelated = fedic.synthetic.render(fedic.synthetic.Speckle(5.0, seed=8), CAMERA, (SIDE, SIDE))
    others = [unrelated, np.ascontiguousarray(reference[:, ::-1]), np.full_like(reference, 90)]
    for other in others:
        assert list(candidates(StartImages.of(reference, other, MESH, CAMERA))) == []
        assert list(candidates(StartImages.of(np.full_like(reference, 7), other, MESH, CAMERA))) == []


@pytest.mark.parametrize("name", [*ESTIMATORS, "flow"])
def test_an_estimator_returns_the_same_each_time(name: str) -> None:
    images = pair(motion(4.0, shift=(6, 2), side=SIDE), side=SIDE)
    estimator = ESTIMATORS.get(name, dense_flow)
    first, second = (estimator(StartImages.of(*images, MESH, CAMERA)) for _ in range(2))
    assert len(first) == len(second) == 1
    assert first[0].name == name
    np.testing.assert_array_equal(first[0].displacement, second[0].displacement)
