"""Spline lenses: evaluation, files, calibration and measurement."""

import pickle
import warnings
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import fedic
from fedic._core import spline_basis
from fedic.calibration import calibrate_points
from fedic.demo.scene import FOCAL, HEIGHT, WIDTH, Scene
from fedic.experiments import splines as experiment

DOMAIN = (-0.2, -0.15, 0.2, 0.15)
BROWN = fedic.BrownDistortion((-0.2, 0.05, 0.0), (1e-3, -2e-3), (5e-4, 0.0))


def grid(count: int = 41, factor: float = 0.98) -> NDArray[np.float64]:
    x, y = np.meshgrid(np.linspace(DOMAIN[0], DOMAIN[2], count), np.linspace(DOMAIN[1], DOMAIN[3], count))
    return factor * np.column_stack([x.ravel(), y.ravel()])


@pytest.fixture(scope="module")
def direct() -> fedic.SplineDistortion:
    return fedic.SplineDistortion.from_lens(BROWN, DOMAIN)


@pytest.fixture(scope="module")
def inverse(direct: fedic.SplineDistortion) -> fedic.InverseSplineDistortion:
    return fedic.InverseSplineDistortion.from_lens(direct)


def camera(lens: fedic.SplineDistortion | fedic.InverseSplineDistortion | fedic.BrownDistortion) -> fedic.Pinhole:
    return fedic.Pinhole((900.0, 905.0), (320.0, 240.0), np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 900.0), distortion=lens)


def test_spline_lenses_agree_with_the_lens_they_approximate(
    direct: fedic.SplineDistortion, inverse: fedic.InverseSplineDistortion
) -> None:
    seen = BROWN.distort(grid())
    np.testing.assert_allclose(direct.distort(grid()), seen, rtol=0, atol=1e-8)
    np.testing.assert_allclose(inverse.distort(grid()), seen, rtol=0, atol=2e-8)
    for lens in (BROWN, direct, inverse):
        np.testing.assert_allclose(lens.undistort(seen), grid(), rtol=0, atol=2e-8)
    again = fedic.SplineDistortion.from_lens(inverse)
    np.testing.assert_allclose(again.distort(grid()), seen, rtol=0, atol=4e-8)
    # The domain of the inverse lens is the distorted domain of the direct one.
    corners = BROWN.distort([[DOMAIN[0], DOMAIN[1]], [DOMAIN[2], DOMAIN[3]]])
    assert (inverse.domain[:2] <= corners[0] + 1e-8).all()
    assert (inverse.domain[2:] >= corners[1] - 1e-8).all()


def test_distortion_is_the_sum_of_basis_functions_times_coefficients(direct: fedic.SplineDistortion) -> None:
    height, width, _ = direct.coefficients.shape
    basis, by_x, by_y = spline_basis(direct.domain, (width - 3, height - 3), grid())
    np.testing.assert_allclose(basis.sum(axis=1), 1.0, rtol=0, atol=1e-14)
    np.testing.assert_allclose([by_x.sum(axis=1), by_y.sum(axis=1)], 0.0, rtol=0, atol=1e-11)
    field = basis @ direct.coefficients.reshape(-1, 2)
    np.testing.assert_allclose(direct.distort(grid()), grid() + field, rtol=0, atol=1e-15)
    again = fedic.SplineDistortion(direct.domain, direct.coefficients)
    assert again == direct == pickle.loads(pickle.dumps(direct))
    assert "coefficients=<" in repr(camera(direct))


@given(st.floats(-0.18, 0.18), st.floats(-0.13, 0.13), st.booleans())
def test_unproject_inverts_project_with_spline_lenses(x: float, y: float, straight: bool) -> None:
    lens = fedic.SplineDistortion.from_lens(BROWN, DOMAIN, 1e-5)
    view = camera(lens if straight else fedic.InverseSplineDistortion.from_lens(lens, tolerance=1e-5))
    pixels = view.project([[900.0 * x, 900.0 * y]])
    np.testing.assert_allclose(view.project(view.unproject(pixels)), pixels, rtol=0, atol=1e-9)


def test_unprojection_agrees_with_opencv(
    direct: fedic.SplineDistortion, inverse: fedic.InverseSplineDistortion
) -> None:
    (k1, k2, k3), (d1, d2), (p1, p2) = BROWN.radial, BROWN.decentering, BROWN.prism
    coefficients = np.array([k1, k2, d1, d2, k3, 0.0, 0.0, 0.0, p1, 0.0, p2, 0.0])
    matrix = np.array([[900.0, 0.0, 320.0], [0.0, 905.0, 240.0], [0.0, 0.0, 1.0]])
    pixels = camera(BROWN).project(900.0 * grid())
    closely = (cv2.TERM_CRITERIA_MAX_ITER | cv2.TERM_CRITERIA_EPS, 200, 1e-14)
    if hasattr(cv2, "undistortPointsIter"):  # until OpenCV 5
        straight = cv2.undistortPointsIter(pixels[:, None], matrix, coefficients, None, None, closely)
    else:
        straight = cv2.undistortPoints(pixels[:, None], matrix, coefficients, None, None, None, closely)
    wanted = straight[:, 0] * (900.0, -900.0)
    for lens, atol in ((BROWN, 1e-6), (direct, 2e-5), (inverse, 4e-5)):  # in pixels; the splines are 1e-8 of 900 off
        np.testing.assert_allclose(camera(lens).unproject(pixels)[:, :2], wanted, rtol=0, atol=atol)


def test_displacement_with_a_spline_lens_agrees_with_the_approximated_lens(
    direct: fedic.SplineDistortion,
    inverse: fedic.InverseSplineDistortion,
) -> None:
    texture = fedic.synthetic.Speckle(4.0, seed=3)
    shape, motion = (480, 640), (30.0, -20.0)
    images = [fedic.synthetic.render(texture, camera(BROWN), shape, displacement=move) for move in (None, motion)]
    mesh = fedic.rectangle_mesh((-120.0, -90.0, 90.0, 110.0), 20.0)
    expected = fedic.correlate(*images, mesh, camera(BROWN), initial="fft")
    assert np.abs(expected.displacement.mean(axis=0) - motion).max() < 2e-3
    for lens in (direct, inverse):
        result = fedic.correlate(*images, mesh, camera(lens), initial="fft")
        np.testing.assert_allclose(result.displacement, expected.displacement, rtol=0, atol=2e-5)
        alone = fedic.correlate(*images, mesh, camera(lens), initial="fft", num_threads=1)
        np.testing.assert_array_equal(alone.displacement, result.displacement)


def test_extrapolation_beyond_the_domain_warns(direct: fedic.SplineDistortion, speckle_pair: tuple) -> None:
    points = np.array([[0.0, 0.0], [179.0, 0.0], [181.0, 0.0]])
    assert camera(direct).covers(points).tolist() == [True, True, False]
    assert camera(BROWN).covers(points).all()
    assert fedic.ImageFrame().covers(points).all()
    for call in (camera(direct).project, camera(direct).jacobian):
        call(points[:2])
        with pytest.warns(
            fedic.CalibrationWarning, match=r"outside the domain in which the lens is calibrated.*covers"
        ):
            call(points)
    with warnings.catch_warnings():  # points behind the camera are not extrapolated
        warnings.simplefilter("error")
        assert np.isnan(camera(direct).project([[0.0, 0.0, 1000.0]])).all()
    near = fedic.SplineDistortion.from_lens(fedic.BrownDistortion((-0.1, 0.0, 0.0)), (-0.08, -0.08, 0.08, 0.08))
    view = fedic.Pinhole((900.0, 900.0), (100.0, 80.0), np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 900.0), distortion=near)
    with pytest.warns(fedic.CalibrationWarning, match=r"5 of 35 nodes of the mesh lie outside .* first being node 6"):
        fedic.Correlator(speckle_pair[0], fedic.rectangle_mesh((-60.0, -40.0, 75.0, 40.0), 22.0), view)
    with pytest.warns(fedic.CalibrationWarning) as told:
        fedic.correlate(*speckle_pair, fedic.rectangle_mesh((-60.0, -40.0, 75.0, 40.0), 22.0), view)
    assert {each.filename for each in told} == {__file__}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fedic.SplineDistortion((0, 0, 0, 1), np.zeros((5, 5, 2))), "x0 < x1"),
        (lambda: fedic.SplineDistortion(DOMAIN, np.zeros((3, 5, 2))), r"\(ny \+ 3, nx \+ 3, 2\).* shape \[3, 5, 2\]"),
        (lambda: fedic.SplineDistortion(DOMAIN, np.zeros((5, 5))), r"\(ny \+ 3, nx \+ 3, 2\)"),
        (lambda: fedic.InverseSplineDistortion(DOMAIN, np.full((5, 5, 2), np.nan)), "not finite"),
        (lambda: fedic.SplineDistortion.from_lens(BROWN), 'brown" is not limited to a domain'),
        (lambda: fedic.SplineDistortion.from_lens("brown", DOMAIN), "lens must be a Distortion"),  # type: ignore[arg-type]
        (lambda: fedic.SplineDistortion.from_lens(fedic.BrownDistortion((-30, 0, 0)), DOMAIN), "does not reach"),
        (lambda: fedic.InverseSplineDistortion.from_lens(fedic.BrownDistortion((-30, 0, 0)), DOMAIN), "does not reach"),
        (lambda: fedic.SplineDistortion.from_lens(BROWN, DOMAIN, 1e-20), "no spline approximates the lens"),
        (lambda: fedic.SplineDistortion.from_lens(BROWN, DOMAIN, float("nan")), "tolerance .* must be positive"),
        (lambda: fedic.SplineDistortion((0, 0, 1e-320, 1), np.zeros((5, 5, 2))), "x0 < x1"),
        (lambda: camera(BROWN).covers("here"), "points must be"),
    ],
)
def test_bad_spline_lenses_are_refused(make, message: str) -> None:
    with pytest.raises((fedic.CameraError, fedic.OptionError), match=message):
        make()


def test_toml_files_preserve_spline_lenses(
    direct: fedic.SplineDistortion, inverse: fedic.InverseSplineDistortion, tmp_path: Path
) -> None:
    for lens in (direct, inverse):
        path = fedic.write_camera(camera(lens), tmp_path / f"{type(lens).__name__}.toml")
        assert fedic.read_camera(path) == camera(lens)
    with pytest.raises(fedic.CameraError, match="can hold a BrownDistortion only, not a SplineDistortion"):
        fedic.write_camera(camera(direct), tmp_path / "camera.yml")
    text = path.read_text()
    for right, wrong, message in (
        (
            '"inverse-spline"',
            '"splin"',
            r"distortion\.model = 'splin' is unknown; choose one of brown, spline, inverse",
        ),
        ("domain = [-", "domain = [1", r"InverseSplineDistortion\.toml: the domain of a spline is"),
        ("[[[", "[[[0.0, ", r"distortion\.coefficients\[0\]\[0\]"),
        ("[[[", "[[[0.0, 0.0]], [[", r"distortion\.coefficients = .* should have rows of equal length"),
        ("domain = ", "domains = ", r'distortion\.domains is not a known key; did you mean "domain"'),
    ):
        path.write_text(text.replace(right, wrong, 1))
        with pytest.raises(fedic.CameraError, match=message):
            fedic.read_camera(path)


@pytest.fixture(scope="module")
def wavy() -> tuple[Scene, list[NDArray[np.float64]], list[NDArray[np.float64]]]:
    scene = Scene(experiment._wavy_lens())
    views = experiment._views(scene, np.random.default_rng(0))
    return scene, views.points, views.pixels


def test_calibration_finds_a_lens_outside_the_brown_model(wavy: tuple) -> None:
    _, points, pixels = wavy
    found = calibrate_points(points, pixels, (WIDTH, HEIGHT), "spline")
    assert isinstance(found.camera.distortion, fedic.SplineDistortion)
    # 12000 coordinates with a noise of 0.02 px each, less the degrees of freedom of the field and the poses.
    assert 0.026 < found.reprojection_error < 0.0283
    assert list(found.parameters) == ["fx", "fy", "cx", "cy"]
    assert all(np.isfinite(value) for value in found.standard_deviations.values())
    assert abs(found.parameters["fx"] - FOCAL) < 5.0 * found.standard_deviations["fx"]
    # The difference from the radial lens of a first fit contains no rigid motion and no change of the intrinsics.
    lens = found.camera.distortion
    radial = calibrate_points(points, pixels, (WIDTH, HEIGHT), "radial1").camera.distortion
    assert isinstance(radial, fedic.BrownDistortion)
    x0, y0, x1, y1 = lens.domain
    places = np.stack(np.meshgrid(np.linspace(x0, x1, 60), np.linspace(y0, y1, 60)), axis=-1).reshape(-1, 2)
    field = FOCAL * (lens.distort(places) - radial.distort(places))
    x, y = places.T
    for along, across in ((1, 0), (0, 1), (x, 0), (0, y), (-y, x), (1 + x * x, x * y), (x * y, 1 + y * y)):
        rigid = np.column_stack([along + 0 * x, across + 0 * x])
        part = (field * rigid).sum() / np.linalg.norm(rigid) / np.sqrt(len(places))
        assert abs(part) < 1e-3, "root mean square of this rigid part of the field, in pixels"


def test_spline_calibration_rejects_outliers(wavy: tuple) -> None:
    _, points, pixels = wavy
    spoilt = [each.copy() for each in pixels]
    spoilt[3][17] += 5.0
    spoilt[8] += np.random.default_rng(1).normal(0.0, 3.0, spoilt[8].shape)
    found = calibrate_points(points, spoilt, (WIDTH, HEIGHT), "spline")
    assert [index for index, view in enumerate(found.views) if not view.accepted] == [8]
    assert np.flatnonzero(~found.views[3].used).tolist() == [17]
    assert found.reprojection_error < 0.0283


def test_calibration_finds_a_strong_lens(wavy: tuple) -> None:
    lens = fedic.BrownDistortion((-0.3, 0.1, 0.0))
    scene = Scene(lens, focal=1600.0)
    views = experiment._views(scene, np.random.default_rng(2))
    found = calibrate_points(views.points, views.pixels, (WIDTH, HEIGHT), "inverse-spline")
    assert isinstance(found.camera.distortion, fedic.InverseSplineDistortion)
    assert found.reprojection_error < 0.0283
    # Equal rays up to a rotation of the camera, which the poses compensate.
    u, v = np.meshgrid(np.linspace(40.0, WIDTH - 41.0, 12), np.linspace(40.0, HEIGHT - 41.0, 9))
    seen = np.column_stack([u.ravel(), v.ravel()])
    rays = found.camera.distortion.undistort((seen - found.camera.principal_point) / found.camera.focal)
    true = lens.undistort((seen - scene.camera.principal_point) / scene.camera.focal)
    turned = cv2.perspectiveTransform(rays[:, None], cv2.findHomography(rays, true)[0])[:, 0]
    assert 1600.0 * np.abs(turned - true).max() < 0.03


def test_real_chessboard_images(shared_data: Callable[[str], Path]) -> None:
    found = fedic.calibrate(f"{shared_data('chessboard')}/*.tif", "chessboard:11x7:8", "spline")
    assert all(view.accepted for view in found.views)
    assert found.reprojection_error < 0.0385  # 0.0377, where radial1 leaves 0.053 and brown 0.043


def test_a_spline_with_too_few_points_is_refused(wavy: tuple) -> None:
    _, points, pixels = wavy
    few = slice(None, None, 40)
    with pytest.raises(fedic.CameraError, match=r"needs at least 200, .* the views have 150\. Take more views"):
        calibrate_points([each[few] for each in points], [each[few] for each in pixels], (WIDTH, HEIGHT), "spline")
    with pytest.raises(fedic.OptionError, match="a spline has any shape; leave out the other models"):
        calibrate_points(points, pixels, (WIDTH, HEIGHT), "radial1+spline")


def test_specimen_calibration_refuses_brown_coefficients_of_a_spline_lens(
    direct: fedic.SplineDistortion, speckle_pair: tuple
) -> None:
    mesh = fedic.rectangle_mesh((-60.0, -40.0, 60.0, 40.0), 20.0)
    view = fedic.Pinhole(
        (900.0, 900.0), (100.0, 80.0), np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 900.0), distortion=direct
    )
    with pytest.raises(fedic.OptionError, match='the camera has no parameter "k1": its parameters are fx'):
        fedic.calibrate_on_specimen(speckle_pair[0], speckle_pair[1:], mesh, view, ["k1"])


def test_quick_experiment_holds_its_claims() -> None:
    outcome = experiment.run(fedic.experiments.Request(quick=True))
    assert [claim.text for claim in outcome.claims if not claim.holds] == []
    assert {row["model"] for row in outcome.rows} == set(experiment.MODELS)
    assert outcome.figures[""].axes


def test_the_command_line_refuses_an_output_format_before_calibrating(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from fedic.cli import app

    views, output = str(tmp_path / "view.png"), str(tmp_path / "camera.yml")
    options = ["--target", "chessboard:5x4:8", "--distortion", "spline", "--output", output]
    found = CliRunner().invoke(app, ["calibrate", views, *options])
    assert found.exit_code == 2
    assert "only a .toml file can hold a spline lens; give --output camera.toml" in found.output
