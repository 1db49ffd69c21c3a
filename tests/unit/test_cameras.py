"""Cameras against OpenCV, finite differences and their own inverse."""

import pickle

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fedic

small = st.floats(-0.3, 0.3)
coefficients = st.tuples(*[st.floats(-0.2, 0.2)] * 3), st.tuples(*[st.floats(-0.05, 0.05)] * 2)


@st.composite
def posed_pinholes(draw: st.DrawFn) -> tuple[fedic.Pinhole, np.ndarray]:
    """Cameras with all seven coefficients that look at the plane Z = 0 from about 2 units away; rotation vectors."""
    vector = np.array([np.pi + draw(small), draw(small), draw(small)])
    radial, decentering = draw(coefficients[0]), draw(coefficients[1])
    lens = fedic.BrownDistortion(radial, decentering, draw(coefficients[1]))
    camera = fedic.Pinhole(
        focal=(draw(st.floats(800, 9000)), draw(st.floats(800, 9000))),
        principal_point=(draw(st.floats(300, 900)), draw(st.floats(300, 900))),
        rotation=vector,
        translation=(draw(small), draw(small), draw(st.floats(1.5, 3.0))),
        distortion=lens,
    )
    return camera, vector


def pinholes() -> st.SearchStrategy[fedic.Pinhole]:
    return posed_pinholes().map(lambda posed: posed[0])


def plane_points() -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.4, 0.4, 9))
    return np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(7 * x.ravel())])


@given(posed_pinholes())
def test_projection_agrees_with_opencv(posed: tuple[fedic.Pinhole, np.ndarray]) -> None:
    camera, vector = posed
    lens = camera.distortion
    assert lens is not None
    (k1, k2, k3), (d1, d2), (p1, p2) = lens.radial, lens.decentering, lens.prism
    matrix = np.array(
        [[camera.focal[0], 0, camera.principal_point[0]], [0, camera.focal[1], camera.principal_point[1]], [0, 0, 1]]
    )
    # OpenCV's order: k1 k2 p1 p2 k3, k4 k5 k6, s1 s2 s3 s4.
    coefficients = np.array([k1, k2, d1, d2, k3, 0, 0, 0, p1, 0, p2, 0])
    expected, _ = cv2.projectPoints(plane_points(), vector, np.array(camera.translation), matrix, coefficients)
    np.testing.assert_allclose(camera.project(plane_points()), expected[:, 0], rtol=0, atol=1e-9)


@given(pinholes(), st.floats(1.3, 1.8))
def test_jacobian_is_the_derivative_of_the_projection(camera: fedic.Pinhole, angle: float) -> None:
    camera = fedic.Pinhole(
        camera.focal, camera.principal_point, camera.rotation, camera.translation, angle, camera.distortion
    )
    step = 1e-6
    for axis in range(3):
        offset = step * np.eye(3)[axis]
        slope = (camera.project(plane_points() + offset) - camera.project(plane_points() - offset)) / (2 * step)
        np.testing.assert_allclose(camera.jacobian(plane_points())[:, :, axis], slope, rtol=1e-6, atol=1e-4)


@given(pinholes(), st.floats(-0.1, 0.1))
def test_unproject_inverts_project(camera: fedic.Pinhole, z: float) -> None:
    points = plane_points()
    points[:, 2] = z
    pixels = camera.project(points)
    again = camera.unproject(pixels, z)
    np.testing.assert_array_equal(again[:, 2], z)
    np.testing.assert_allclose(camera.project(again), pixels, rtol=0, atol=1e-9)
    np.testing.assert_allclose(again, points, rtol=0, atol=1e-10)


def test_the_skew_angle_enters_the_intrinsic_matrix() -> None:
    theta = 1.4
    camera = fedic.Pinhole((1000, 900), (50, 60), translation=(0, 0, 1), skew_angle=theta)
    x, y = 0.3, -0.2
    expected = [1000 * x + 1000 / np.tan(theta) * y + 50, 900 / np.sin(theta) * y + 60]
    np.testing.assert_allclose(camera.project([[x, y, 0]])[0], expected, rtol=1e-14)


def test_image_frame_and_front_parallel_project_exactly() -> None:
    points = np.array([[3.0, 4.0], [-1.0, 0.5]])
    np.testing.assert_array_equal(fedic.ImageFrame().project(points), points)
    camera = fedic.FrontParallel(10.0, origin=(100.0, 200.0))
    np.testing.assert_array_equal(camera.project(points), [[130, 160], [90, 195]])
    np.testing.assert_array_equal(camera.jacobian(points)[0], [[10, 0, 0], [0, -10, 0]])
    np.testing.assert_allclose(camera.unproject(camera.project(points), z=2.0), np.c_[points, [2.0, 2.0]], atol=1e-14)
    turned = fedic.FrontParallel(10.0, (100.0, 200.0), angle=np.pi / 2)
    np.testing.assert_allclose(turned.project(points), [[60, 170], [95, 210]], atol=1e-12)
    np.testing.assert_allclose(turned.jacobian(points)[0], [[0, -10, 0], [-10, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(turned.unproject(turned.project(points), z=2.0), np.c_[points, [2.0, 2.0]], atol=1e-14)
    assert (camera.angle, turned.angle) == (0.0, np.pi / 2)
    assert repr(turned) == "FrontParallel(scale=10, origin=(100.0, 200.0), angle=1.5707963267948966)"


def test_rotation_vector_and_matrix_give_equal_cameras() -> None:
    vector = np.array([0.1, -0.2, 0.3])
    by_vector = fedic.Pinhole((1, 1), (0, 0), rotation=vector)
    by_matrix = fedic.Pinhole((1, 1), (0, 0), rotation=cv2.Rodrigues(vector)[0])
    np.testing.assert_allclose(by_vector.rotation, by_matrix.rotation, atol=1e-15)


@pytest.mark.parametrize(
    "camera",
    [
        fedic.ImageFrame(),
        fedic.FrontParallel(2.5, (1.0, 2.0)),
        fedic.FrontParallel(2.5, (1.0, 2.0), 0.3),
        fedic.Pinhole(
            (9, 8), (7, 6), [0.1, 0.2, 0.3], (1, 2, 3), 1.5, fedic.BrownDistortion((1, 2, 3), (4, 5), (6, 7))
        ),
    ],
)
def test_cameras_can_be_pickled(camera: object) -> None:
    assert pickle.loads(pickle.dumps(camera)) == camera


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fedic.FrontParallel(0.0), "scale .* must be positive, got 0"),
        (lambda: fedic.FrontParallel(float("nan")), "scale is not finite"),
        (lambda: fedic.FrontParallel(1.0, angle=float("inf")), "angle is not finite"),
        (lambda: fedic.Pinhole((1000, -1), (0, 0)), "focal length .* must be positive, got -1"),
        (lambda: fedic.Pinhole((1000, 1), (float("nan"), 0)), "principal_point is not finite"),
        (lambda: fedic.Pinhole((1, 1), (0, 0), translation=(0, 0, float("inf"))), "translation is not finite"),
        (lambda: fedic.Pinhole((1, 1), (0, 0), rotation=[float("nan"), 0, 0]), "rotation is not finite"),
        (lambda: fedic.Pinhole((1, 1), (0, 0), rotation=np.diag([1, 1, -1])), "is not a rotation"),
        (
            lambda: fedic.Pinhole((1, 1), (0, 0), rotation=np.eye(4)),
            r"vector \(3,\) or a matrix \(3, 3\), got .*\[4, 4\]",
        ),
        (lambda: fedic.Pinhole((1, 1), (0, 0), skew_angle=0.0), "between 0 and pi; got 0"),
        (lambda: fedic.BrownDistortion((float("nan"), 0, 0)), "k1 is not finite"),
        (lambda: fedic.ImageFrame().project([[1.0, 2.0, 3.0, 4.0]]), r"points must have shape \(n, 2\) or \(n, 3\)"),
        (lambda: fedic.ImageFrame().project(["a"]), "points must be a 2-dimensional array of real numbers"),
    ],
)
def test_bad_camera_parameters_are_refused(make: object, message: str) -> None:
    with pytest.raises((fedic.CameraError, fedic.OptionError), match=message):
        make()  # type: ignore[operator]


def test_pixels_that_cannot_be_unprojected_are_counted() -> None:
    grazing = fedic.Pinhole((1000, 1000), (500, 500), rotation=[np.pi / 2, 0, 0], translation=(0, 0, 2))
    message = r"1 of 2 pixels see no point of the plane Z = 1, the first of them number 1 at \(500, 700\)"
    with pytest.raises(fedic.CameraError, match=message):
        grazing.unproject([[500.0, 300.0], [500.0, 700.0]], z=1.0)


def test_points_behind_the_camera_project_to_nan() -> None:
    camera = fedic.Pinhole((1000, 1000), (0, 0), translation=(0, 0, 1))
    assert np.isnan(camera.project([[0.0, 0.0, -2.0]])).all()
