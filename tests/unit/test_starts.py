"""Parts of the starts: preparation of the images, refinement, periodic textures, conversion of units."""

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.candidate import nodal_displacement
from fedic.starts.fft import translations
from fedic.starts.images import StartImages
from fedic.starts.motion import is_plausible, moved, translation
from fedic.starts.periodicity import other_maxima, repeats
from fedic.starts.refinement import refined
from fedic.starts.window import Window
from scenes.moved_plate import motion, pair

SIDE = 300
MESH = fedic.rectangle_mesh((70, 70, 230, 230), size=20)
CAMERA = fedic.ImageFrame()


def printed_grid(shift: float, period: float = 12.0) -> NDArray[np.uint8]:
    v, u = np.mgrid[0:300, 0:400]
    waves = np.cos(2 * np.pi * (u - shift) / period) + np.cos(2 * np.pi * v / period)
    return np.round(128 + 45 * waves).astype(np.uint8)


@pytest.mark.parametrize(("distance", "angle"), [(2, 0), (20, 0), (0, 6), (12, 4)])
def test_refinement_reaches_the_motion_from_far_off(distance: float, angle: float) -> None:
    truth = motion(30.0, (1.05, 0.97), (8, -5), side=SIDE)
    images = StartImages.of(*pair(truth, side=SIDE), MESH, CAMERA)
    start = motion(30.0 + angle, shift=(8 + 0.8 * distance, -5 - 0.6 * distance), side=SIDE)
    found = refined(images, start)
    assert found is not None
    np.testing.assert_allclose(moved(found.motion, MESH.points), moved(truth, MESH.points), atol=0.05)
    assert found.match.score > 0.98
    assert found.match.overlap == 1.0


def test_refinement_follows_a_homography() -> None:
    truth = motion(5.0, side=SIDE)
    truth[2, :2] = 2e-4, -1e-4
    images = StartImages.of(*pair(truth, side=SIDE), MESH, CAMERA)
    found = refined(images, translation(np.array([1.5, -1.0])) @ truth)
    assert found is not None
    np.testing.assert_allclose(moved(found.motion, MESH.points), moved(truth, MESH.points), atol=0.1)


def test_refinement_ignores_a_gradient_of_light() -> None:
    truth = motion(3.0, shift=(4, 2), side=SIDE)
    reference, deformed = pair(truth, side=SIDE)
    light = np.linspace(0.5, 1.0, SIDE)
    found = refined(StartImages.of(reference, (deformed * light).astype(np.uint8), MESH, CAMERA), np.eye(3))
    assert found is not None
    np.testing.assert_allclose(moved(found.motion, MESH.points), moved(truth, MESH.points), atol=0.1)


def test_refinement_gives_up_where_the_mesh_leaves_the_view() -> None:
    reference, deformed = pair(motion(side=SIDE), side=SIDE)
    images = StartImages.of(reference, deformed, MESH, CAMERA)
    assert refined(images, translation(np.array([1e4, 0.0]))) is None
    assert refined(images, np.full((3, 3), np.nan)) is None


def test_a_specimen_on_black_is_followed_without_the_background() -> None:
    truth = motion(20.0, shift=(5, 3), side=SIDE)
    reference, deformed = (image.copy() for image in pair(truth, side=SIDE))
    v, u = np.mgrid[0:SIDE, 0:SIDE]
    pixels = np.stack([u.ravel(), v.ravel()], axis=-1).astype(np.float64)
    for image, places in ((reference, pixels), (deformed, moved(np.linalg.inv(truth), pixels))):
        image[(np.abs(places - 150).max(axis=1) > 81).reshape(image.shape)] = 0
    found = refined(StartImages.of(reference, deformed, MESH, CAMERA), motion(17.0, side=SIDE))
    assert found is not None
    np.testing.assert_allclose(moved(found.motion, MESH.points), moved(truth, MESH.points), atol=0.05)


@pytest.mark.parametrize(
    "convert",
    [
        lambda image: image.astype(np.uint16) * 16,
        lambda image: image.astype(np.float32) * 1e-3 - 5.0,
        lambda image: image.astype(np.float64) * 1e30,
    ],
    ids=["uint16", "small float32", "large float64"],
)
def test_the_scale_of_the_grey_levels_does_not_matter(convert: object) -> None:
    truth = motion(shift=(17, -9), side=SIDE)
    first, second = pair(truth, side=SIDE)
    (expected,) = translations(StartImages.of(first, second, MESH, CAMERA))
    (found,) = translations(StartImages.of(convert(first), convert(second), MESH, CAMERA))  # type: ignore[operator]
    np.testing.assert_allclose(found.displacement, expected.displacement, atol=1e-3)


def test_grey_levels_that_are_not_finite_are_replaced() -> None:
    first, second = (image.astype(np.float32) for image in pair(motion(shift=(17, -9), side=SIDE), side=SIDE))
    first[100:110, 100:110], second[0, 0], second[5, 5] = np.nan, np.inf, -np.inf
    images = StartImages.of(first, second, MESH, CAMERA)
    assert np.isfinite(images.reference).all()
    assert np.isfinite(images.deformed).all()
    (found,) = translations(images)
    np.testing.assert_allclose(found.displacement, np.tile((17.0, -9.0), (MESH.num_nodes, 1)), atol=0.05)


@pytest.mark.parametrize("fill", [np.nan, 3.0])
def test_images_without_texture_have_no_candidate(fill: float) -> None:
    flat = np.full((200, 200), fill, dtype=np.float32)
    images = StartImages.of(flat, flat, fedic.rectangle_mesh((20, 20, 120, 120), 20), CAMERA)
    assert not images.has_texture()
    assert translations(images) == []


def test_a_mesh_outside_the_image_has_no_candidate() -> None:
    first, second = pair(motion(side=SIDE), side=SIDE)
    images = StartImages.of(first, second, fedic.rectangle_mesh((1000, 1000, 1100, 1100), 20), CAMERA)
    assert not images.region.any()
    assert translations(images) == []


def test_the_region_has_the_holes_of_the_mesh() -> None:
    grid = fedic.rectangle_mesh((20, 20, 80, 80), 20)
    mesh = fedic.Mesh(grid.points, {"quad": np.delete(grid.cells["quad"], 4, axis=0)})
    image = np.zeros((100, 100), dtype=np.uint8)
    region = StartImages.of(image, image, mesh, CAMERA).region
    assert not region[45:56, 45:56].any()
    assert region[22:38, 22:78].all()
    assert not region[:18].any()


def test_nodes_of_no_cell_have_no_displacement() -> None:
    far = fedic.Mesh(np.vstack([MESH.points, [[5.0, 5.0]]]), MESH.cells)
    images = StartImages.of(*pair(motion(shift=(6, 2), side=SIDE), side=SIDE), far, CAMERA)
    (found,) = translations(images)
    np.testing.assert_array_equal(found.displacement[-1], 0.0)
    np.testing.assert_allclose(found.displacement[:-1], np.tile((6.0, 2.0), (MESH.num_nodes, 1)), atol=0.05)


def test_motions_that_mirror_or_stretch_too_much_are_implausible() -> None:
    corners = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
    assert is_plausible(motion(170.0, (2.0, 0.5), side=100), corners)
    assert not is_plausible(motion(stretch=(-1.0, 1.0), side=100), corners)
    assert not is_plausible(motion(stretch=(5.0, 1.0), side=100), corners)
    assert not is_plausible(np.array([[1.0, 0, 0], [0, 1, 0], [-0.02, 0, 1]]), corners)


@pytest.mark.parametrize("shift", [2.0, 5.0, 7.0])
def test_the_other_shifts_of_a_printed_grid_are_named(shift: float) -> None:
    images = StartImages.of(
        printed_grid(0.0), printed_grid(shift), fedic.rectangle_mesh((100, 80, 300, 220), 20), CAMERA
    )
    (found,) = translations(images)
    assert np.hypot(*(found.displacement[0] - (shift, 0.0))) < 0.1
    shifts = {tuple(each) for each in found.alternatives}
    assert {(shift - 12, 0), (shift + 12, 0), (shift, 12), (shift, -12)} <= shifts
    assert {tuple(each) for each in repeats(images)[:4]} == {(12.0, 0.0), (-12.0, 0.0), (0.0, 12.0), (0.0, -12.0)}


def test_a_speckle_has_no_other_shift() -> None:
    images = StartImages.of(*pair(motion(shift=(6, 2), side=SIDE), side=SIDE), MESH, CAMERA)
    (found,) = translations(images)
    assert len(found.alternatives) == len(repeats(images)) == 0


def test_one_broad_maximum_has_no_others() -> None:
    v, u = np.mgrid[0:50, 0:60]
    peak = np.exp(-((u - 20) ** 2 + (v - 30) ** 2) / 200.0)
    rough = (peak + 0.02 * np.random.default_rng(0).standard_normal(peak.shape)).astype(np.float32)
    assert len(other_maxima(rough)) == 0
    double = peak + 0.95 * np.exp(-((u - 50) ** 2 + (v - 30) ** 2) / 50.0)
    np.testing.assert_allclose(other_maxima(double.astype(np.float32)), [[30.0, 0.0]], atol=1.0)
    assert len(other_maxima(np.full((5, 5), -1.0, dtype=np.float32))) == 0


def test_displacements_are_converted_to_the_unit_of_the_mesh() -> None:
    camera = fedic.FrontParallel(10.0, (0.0, 160.0))
    mesh = fedic.rectangle_mesh((3, 3, 17, 13), size=2)
    pixels = np.tile((2.0, -5.0), (mesh.num_nodes, 1))
    np.testing.assert_allclose(nodal_displacement(pixels, mesh, camera), np.tile((0.2, 0.5), (mesh.num_nodes, 1)))


def test_large_images_are_reduced_to_the_size_of_the_mesh() -> None:
    image = np.random.default_rng(0).integers(0, 255, (1500, 2000)).astype(np.uint8)
    large = StartImages.of(image, image, fedic.rectangle_mesh((100, 100, 1600, 1400), 50), CAMERA)
    small = StartImages.of(image, image, fedic.rectangle_mesh((100, 100, 300, 300), 50), CAMERA)
    assert max(Window(large).region.shape) == pytest.approx(500, abs=2)
    assert max(Window(small).region.shape) == pytest.approx(201, abs=2)
    matrix = motion(10.0, shift=(3, 4), side=1000)
    level = Window(large).level
    np.testing.assert_allclose(level.enlarged(level.reduced(matrix)), matrix, atol=1e-9)
