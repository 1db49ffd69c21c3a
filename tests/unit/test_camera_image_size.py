"""The size of the images of a camera; cameras of regions and of binned images."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fedic
from fedic.campaign.config.camera_section import CameraFileSection

VECTOR = np.array([3.0, 0.2, -0.1])
BROWN = fedic.BrownDistortion((-0.1, 0.2, 0.05), (1e-3, -5e-4), (8e-4, -6e-4))
DOMAIN = (-0.4, -0.3, 0.4, 0.3)
LENSES = {
    "none": None,
    "brown": BROWN,
    "spline": fedic.SplineDistortion.from_lens(BROWN, DOMAIN, 1e-4),
    "inverse-spline": fedic.InverseSplineDistortion.from_lens(BROWN, DOMAIN, 1e-4),
}
SIZE = (641, 482)
CAMERAS: dict[str, Any] = {
    "image-frame": fedic.ImageFrame((3.0, -4.0), 0.75, SIZE),
    "front-parallel": fedic.FrontParallel(12.5, (30.0, 400.0), -0.7, SIZE),
    **{
        lens: fedic.Pinhole((900, 905), (325, 236), VECTOR, (1, 2, 100), 1.5, model, SIZE)
        for lens, model in LENSES.items()
    },
}
POINTS = np.array([[0.0, 0.0, 0.0], [20.0, 5.0, 0.0], [-10.0, 15.0, 3.0], [25.0, -20.0, 1.0]])


@pytest.mark.parametrize("name", CAMERAS)
def test_a_camera_keeps_the_size_of_its_images(name: str) -> None:
    camera = CAMERAS[name]
    assert camera.image_size == SIZE
    assert "image_size=(641, 482)" in repr(camera)
    assert pickle.loads(pickle.dumps(camera)) == camera
    other = type(camera)(*camera.__getnewargs__()[:-1])
    assert other.image_size is None
    assert "image_size" not in repr(other)
    assert other != camera
    assert other.cropped(0, 0, *SIZE) == camera


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(sorted(CAMERAS)), st.integers(0, 300), st.integers(0, 200), st.integers(1, 300), st.integers(1, 9)
)
@pytest.mark.filterwarnings("ignore::fedic.CalibrationWarning")
def test_regions_and_binned_images_show_the_same_points(name: str, left: int, top: int, side: int, n: int) -> None:
    camera = CAMERAS[name]
    pixels = camera.project(POINTS)
    region = camera.cropped(left, top, side, side // 2 + 1)
    assert region.image_size == (side, side // 2 + 1)
    np.testing.assert_allclose(region.project(POINTS), pixels - (left, top), rtol=0, atol=1e-9)
    binned = camera.binned(n)
    assert binned.image_size == (641 // n, 482 // n)
    np.testing.assert_allclose(binned.project(POINTS), (pixels + 0.5) / n - 0.5, rtol=0, atol=1e-9)
    np.testing.assert_allclose(binned.unproject(binned.project(POINTS[:2])), camera.unproject(pixels[:2]), atol=1e-7)
    np.testing.assert_array_equal(binned.covers(POINTS), camera.covers(POINTS))


def test_a_binned_image_is_the_mean_of_its_pixels() -> None:
    texture, camera = fedic.synthetic.Speckle(6.0, seed=3), fedic.FrontParallel(1.0, (20.0, 70.0), 0.2)
    full = fedic.synthetic.render(texture, camera, (96, 128), supersampling=4, bits=16).astype(float)
    small = fedic.synthetic.render(texture, camera.binned(2), (48, 64), supersampling=8, bits=16).astype(float)
    means = full.reshape(48, 2, 64, 2).mean(axis=(1, 3))
    assert np.abs(small - means).max() < 3e-3 * np.ptp(full)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda c: c.cropped(600, 0, 100, 10), fedic.CameraError, r"\(600, 0\) is not inside the image, .* 641 x 482"),
        (lambda c: c.cropped(0, 0, 0, 10), fedic.CameraError, "0 x 10 px has no pixel"),
        (lambda c: c.cropped(-1, 0, 5, 5), fedic.OptionError, "left must be a whole number of pixels, .* got -1"),
        (lambda c: c.cropped(0, 0, 5.5, 5), fedic.OptionError, "width must be a whole number of pixels"),
        (lambda c: c.cropped(0, 0, 10**30, 5), fedic.OptionError, "width must be a whole number of pixels"),
        (lambda c: c.binned(0), fedic.CameraError, "binning must be positive"),
        (lambda c: c.binned(500), fedic.CameraError, "1 x 0 px has no pixel"),
        (lambda c: c.binned("2"), fedic.OptionError, "n must be a whole number"),
        (lambda c: fedic.ImageFrame(image_size=(3, 0)), fedic.CameraError, "3 x 0 px has no pixel"),
        (lambda c: fedic.ImageFrame(image_size=(3,)), fedic.OptionError, r"image_size must be \(width, height\)"),  # type: ignore[arg-type]
        (lambda c: fedic.ImageFrame(scale=0.0), fedic.CameraError, "scale must be positive"),
    ],
)
def test_impossible_sizes_and_regions_are_refused(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        call(CAMERAS["image-frame"])


@pytest.fixture(scope="module")
def speckle() -> Any:
    return fedic.synthetic.render(fedic.synthetic.Speckle(4.0, seed=1), fedic.ImageFrame(), (120, 160))


REFUSED = (
    r"image has 160 x 120 px, but the camera is that of images of 320 x 240 px.*"
    r"camera\.cropped\(left, top, 160, 120\).*camera\.binned\(n\)"
)


def test_an_image_of_another_size_is_refused_everywhere(speckle: Any) -> None:
    mesh = fedic.rectangle_mesh((40, 40, 100, 80), size=20)
    camera = fedic.ImageFrame(image_size=(320, 240))
    with pytest.raises(fedic.CameraError, match="The reference " + REFUSED):
        fedic.correlate(speckle, speckle, mesh, camera)
    for fitting in (camera.cropped(0, 0, 160, 120), camera.cropped(30, 10, 320 - 160, 120), fedic.ImageFrame()):
        assert fedic.Correlator(speckle, mesh, fitting).num_points > 0
    with pytest.raises(fedic.CameraError, match="The given " + REFUSED):
        fedic.register(
            mesh,
            speckle,
            fedic.FrontParallel(1.0, (0.0, 120.0), image_size=(320, 240)),
            points=([[0, 0], [50, 0], [0, 50]], [[10, 100], [60, 100], [10, 50]]),
        )
    pinhole = fedic.Pinhole((500, 500), (80, 60), [np.pi, 0, 0], (0, 0, 500), image_size=(320, 240))
    with pytest.raises(fedic.CameraError, match="The reference " + REFUSED):
        fedic.calibrate_on_specimen(speckle, [speckle], mesh, pinhole)


def test_the_camera_of_the_region_measures_what_the_camera_of_the_frame_does() -> None:
    texture = fedic.synthetic.Speckle(4.0, seed=1)
    camera = fedic.FrontParallel(2.0, (120.0, 130.0), image_size=(240, 200))
    images = [
        fedic.synthetic.render(texture, camera, (200, 240), displacement=move, bits=16)
        for move in ((0.0, 0.0), (0.31, -0.2))
    ]
    mesh = fedic.rectangle_mesh((-20, -20, 20, 20), size=10)
    whole = fedic.correlate(*images, mesh, camera).displacement
    cut = fedic.correlate(*(image[40:, 30:230].copy() for image in images), mesh, camera.cropped(30, 40, 200, 160))
    np.testing.assert_allclose(cut.displacement, whole, rtol=0, atol=2e-4)
    halves = [image.reshape(100, 2, 120, 2).mean(axis=(1, 3)).astype(np.float32) for image in images]
    np.testing.assert_allclose(fedic.correlate(*halves, mesh, camera.binned(2)).displacement, whole, rtol=0, atol=5e-3)


@pytest.mark.parametrize("name", CAMERAS)
def test_camera_toml_keeps_the_size(name: str, tmp_path: Path) -> None:
    path = fedic.write_camera(CAMERAS[name], tmp_path / "camera.toml")
    assert fedic.read_camera(path) == CAMERAS[name]


@pytest.mark.parametrize("suffix", [".yml", ".xml"])
def test_opencv_files_keep_the_size(suffix: str, tmp_path: Path) -> None:
    camera = fedic.Pinhole((900, 905), (325, 236), VECTOR, (1, 2, 100), distortion=BROWN, image_size=SIZE)
    assert fedic.read_camera(fedic.write_camera(camera, tmp_path / f"camera{suffix}")).image_size == SIZE


def test_calibration_tells_the_camera_the_size(tmp_path: Path) -> None:
    grid = np.array([[8.0 * i, 8.0 * j, 0.0] for j in range(7) for i in range(9)])
    views = [
        fedic.Pinhole((2000, 2000), (645, 470), [np.pi + 0.5 * np.cos(i), 0.5 * np.sin(i), 0.1 * i], (-30, 20, 520))
        for i in range(8)
    ]
    found = fedic.calibration.calibrate_points(
        [grid[:, :2]] * 8, [view.project(grid) for view in views], (1280, 960), "radial1"
    )
    assert found.camera.image_size == (1280, 960)
    assert fedic.read_camera(found.write(tmp_path / "camera.toml")).image_size == (1280, 960)


def test_a_configuration_crops_then_bins_the_camera_of_a_file(tmp_path: Path) -> None:
    camera = CAMERAS["brown"]
    path = fedic.write_camera(camera, tmp_path / "camera.toml")
    section = CameraFileSection(file=path, crop=(40, 20, 400, 300), binning=2)
    found, expected = section.build(), camera.cropped(40, 20, 400, 300).binned(2)
    assert found.image_size == (200, 150)
    np.testing.assert_allclose(found.project(POINTS), expected.project(POINTS), rtol=0, atol=1e-9)
    with pytest.raises(fedic.CameraError, match=r"crop and binning in \[camera\]: the region of 700 x 300 px"):
        CameraFileSection(file=path, crop=(40, 20, 700, 300)).build()
