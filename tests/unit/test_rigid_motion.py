"""The rigid motion of a result, and results without it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import fedic
from scenes.fields import result_of

MESH = fedic.rectangle_mesh((0, 0, 40, 30), 10, "triangle6")
CAMERA = fedic.FrontParallel(10.0, (50.0, 600.0), angle=0.3)
angles = st.floats(-np.pi + 1e-3, np.pi - 1e-3)
translations = st.tuples(st.floats(-100, 100), st.floats(-100, 100))
gradients = st.lists(st.floats(-0.3, 0.3), min_size=4, max_size=4)


def moved(points: NDArray[np.float64], angle: float, translation: tuple[float, float]) -> NDArray[np.float64]:
    """Return the positions of points turned about the origin and translated."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(points @ turn.T + translation)


@settings(max_examples=50, deadline=None)
@given(angle=angles, translation=translations)
def test_a_rigid_motion_leaves_nothing(angle: float, translation: tuple[float, float]) -> None:
    result = result_of(MESH, moved(MESH.points, angle, translation) - MESH.points, camera=CAMERA)
    motion = result.rigid_motion()
    assert motion.rotation == pytest.approx(angle, abs=1e-9)
    centre = MESH.points.mean(axis=0)
    np.testing.assert_allclose(motion.translation, moved(centre, angle, translation) - centre, atol=1e-9)
    still = result.without_rigid_motion()
    np.testing.assert_allclose(still.displacement, 0.0, atol=1e-10)
    np.testing.assert_allclose(still.unchecked_displacement, 0.0, atol=1e-10)
    np.testing.assert_allclose(still.pixel_displacement, 0.0, atol=1e-9)


@settings(max_examples=50, deadline=None)
@given(angle=angles, translation=translations, gradient=gradients, damaged=st.sets(st.integers(0, 5)))
def test_strains_do_not_change_and_no_rigid_motion_is_left(
    angle: float, translation: tuple[float, float], gradient: list[float], damaged: set[int]
) -> None:
    waves = 0.5 * np.sin(MESH.points / 9.0)
    strained = MESH.points @ (np.eye(2) + np.reshape(gradient, (2, 2))) + waves
    result = result_of(MESH, moved(strained, angle, translation) - MESH.points, damaged=sorted(damaged))
    still = result.without_rigid_motion()
    np.testing.assert_array_equal(still.valid_nodes, result.valid_nodes)
    np.testing.assert_array_equal(still.valid_cells, result.valid_cells)
    np.testing.assert_array_equal(np.isnan(still.displacement), np.isnan(result.displacement))
    for measure in ("green-lagrange", "hencky"):
        np.testing.assert_allclose(still.strains(measure), result.strains(measure), atol=1e-11)  # type: ignore[arg-type]
    left = still.rigid_motion()
    np.testing.assert_allclose(left.translation, 0.0, atol=1e-10)
    assert left.rotation == pytest.approx(0.0, abs=1e-10)
    known = result.valid_nodes
    np.testing.assert_allclose(still.unchecked_displacement[known], still.displacement[known], atol=1e-12)


def test_the_displacement_left_is_in_the_axes_of_the_mesh() -> None:
    stretched = MESH.points * [1.0, 1.1]
    result = result_of(MESH, moved(stretched, 0.5 * np.pi, (3.0, -8.0)) - MESH.points)
    left = result.without_rigid_motion().displacement
    np.testing.assert_allclose(left, 0.1 * (MESH.points - MESH.points.mean(axis=0)) * [0.0, 1.0], atol=1e-10)


def test_pixel_displacements_are_those_of_the_camera() -> None:
    result = result_of(MESH, moved(MESH.points * [1.0, 1.1], 0.2, (3.0, -8.0)) - MESH.points, camera=CAMERA)
    still = result.without_rigid_motion()
    expected = CAMERA.project(MESH.points + still.displacement) - CAMERA.project(MESH.points)
    np.testing.assert_allclose(still.pixel_displacement, expected, atol=1e-9)


def test_a_result_of_one_node_has_no_rigid_motion() -> None:
    result = result_of(MESH, np.zeros(MESH.points.shape), damaged=range(MESH.num_cells))
    assert np.isnan(result.rigid_motion().rotation)
    assert np.isnan(result.rigid_motion().translation).all()
    with pytest.raises(fedic.FedicError, match="fewer than two nodes of the result were measured"):
        result.without_rigid_motion()


def test_a_result_without_its_rigid_motion_no_longer_refers_to_the_images(
    speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]],
) -> None:
    result = fedic.correlate(*speckle_pair, fedic.rectangle_mesh((30, 30, 170, 130), size=20))
    still = result.without_rigid_motion()
    np.testing.assert_allclose(result.rigid_motion().translation, (1.3, -0.6), atol=0.02)
    assert np.abs(still.displacement).max() < 0.1
    with pytest.raises(fedic.ImageError, match="does not know its images"):
        still.residual_map()
