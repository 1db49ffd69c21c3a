"""Dots with three rings: numbered from the rings, also where a part of the target is in view."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.calibration import NotFoundError, find_target, parse_target
from fedic.calibration.detection import WrongCountError
from scenes.targets import SHAPE, Texture, poses

SPECIFICATION = "ring-dots:12x9:7:3x2:6x5"
TARGET = parse_target(SPECIFICATION)
LENS = fedic.BrownDistortion((-0.15, 0.0, 0.0))
NEAR = 0.72
"""Factor of the distance at which the target is larger than the image."""


def near_view(camera: fedic.Pinhole) -> fedic.Pinhole:
    """Return a camera so near that a part of the target is in view, the rings in the middle."""
    middle = np.array([3.0 * 7.0, 2.5 * 7.0, 0.0])
    centre = camera.rotation @ middle + camera.translation
    shift = np.array([0.0, 0.0, NEAR * centre[2]]) - camera.rotation @ middle
    return fedic.Pinhole(camera.focal, camera.principal_point, camera.rotation, tuple(shift), distortion=LENS)


def rendered(camera: fedic.Pinhole, seed: int = 0) -> NDArray[np.uint8]:
    return fedic.synthetic.render(Texture(TARGET), camera, SHAPE, noise=2.55, seed=seed, supersampling=1)  # type: ignore[arg-type]


CAMERAS = [near_view(camera) for camera in poses(TARGET, 4, LENS)]


@pytest.fixture(scope="module")
def images() -> list[NDArray[np.uint8]]:
    return [rendered(camera, seed) for seed, camera in enumerate(CAMERAS)]


def test_dots_in_view_are_numbered_from_the_rings(images: list[NDArray[np.uint8]]) -> None:
    for camera, image in zip(CAMERAS, images, strict=True):
        seen = find_target(image, TARGET)
        truth = camera.project(seen.points)
        assert np.linalg.norm(truth - seen.pixels, axis=1).max() < 1.0
        every = camera.project(TARGET.points)
        inside = ((every > 25.0) & (every < np.array(SHAPE[::-1]) - 26.0)).all(axis=1)
        assert 50 < inside.sum() < 108
        assert len(seen.points) >= 0.97 * inside.sum()


def test_the_camera_is_found_from_parts_of_the_target(images: list[NDArray[np.uint8]]) -> None:
    calibration = fedic.calibrate(images, SPECIFICATION, "radial1")
    assert all(view.accepted for view in calibration.views)
    assert calibration.reprojection_error < 0.05
    for camera, view in zip(CAMERAS, calibration.views, strict=True):
        focal, centre = calibration.camera.focal, calibration.camera.principal_point
        lens = calibration.camera.distortion
        found = fedic.Pinhole(focal, centre, view.rotation, tuple(view.translation), distortion=lens)
        assert np.linalg.norm(found.project(view.points) - camera.project(view.points), axis=1).max() < 0.05


@pytest.mark.parametrize("quarter", [1, 2, 3])
def test_a_turned_image_is_read_the_same(images: list[NDArray[np.uint8]], quarter: int) -> None:
    expected = {tuple(point) for point in np.round(find_target(images[0], TARGET).points, 6).tolist()}
    turned = np.ascontiguousarray(np.rot90(images[0], quarter))
    found = {tuple(point) for point in np.round(find_target(turned, TARGET).points, 6).tolist()}
    assert found == expected


def test_light_dots_on_a_dark_ground_are_found(images: list[NDArray[np.uint8]]) -> None:
    assert len(find_target(255 - images[0], TARGET).points) == len(find_target(images[0], TARGET).points)


def test_a_mirrored_image_is_refused(images: list[NDArray[np.uint8]]) -> None:
    with pytest.raises(NotFoundError, match="not found 6 steps apart along X and 5 along Y; 3 rings are seen"):
        find_target(np.ascontiguousarray(images[0][:, ::-1]), TARGET)


def test_a_hidden_ring_is_said(images: list[NDArray[np.uint8]]) -> None:
    image = images[0].copy()
    spot = tuple(int(value) for value in CAMERAS[0].project([[0.0, 0.0, 0.0]])[0])
    cv2.circle(image, spot, 25, 230, -1)
    with pytest.raises(NotFoundError, match="2 rings are seen"):
        find_target(image, TARGET)


@pytest.mark.parametrize("text", ["ring-dots:12x9:7:3x2:5x5", "ring-dots:12x9:7:3x2:6x6"])
def test_rings_at_other_places_are_refused(images: list[NDArray[np.uint8]], text: str) -> None:
    with pytest.raises(NotFoundError, match="rings of the target are not found"):
        find_target(images[0], parse_target(text))


@pytest.mark.parametrize("text", ["ring-dots:10x9:7:1x2:6x5", "ring-dots:12x8:7:3x2:6x5"])
def test_dots_beyond_the_border_are_refused(text: str) -> None:
    image = rendered(poses(TARGET, 1, LENS)[0])
    with pytest.raises(WrongCountError, match=r"the dots go on beyond the (first column|last row)"):
        find_target(image, parse_target(text))


def test_specifications_are_read_and_written() -> None:
    assert (TARGET.origin, TARGET.axes, str(TARGET)) == ((3, 2), (6, 5), SPECIFICATION)
    assert [0.0, 0.0, 0.0] in TARGET.points.tolist()
    np.testing.assert_allclose(TARGET.points.min(axis=0), [-21.0, -14.0, 0.0])
    for text, message in (
        ("ring-dots:12x9:7", "should be written ring-dots:COLUMNSxROWS:PITCH:LEFTxBELOW:ALONGxUP"),
        ("ring-dots:12x9:7:3x2:9x5", "the rings must be dots of the target"),
        ("ring-dots:12x9:7:3x2:0x5", "the rings must be dots of the target"),
        ("ring-dots:12x9:7:3:6x5", "should be written"),
    ):
        with pytest.raises(fedic.OptionError, match=message):
            parse_target(text)
