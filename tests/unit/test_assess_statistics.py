"""Statistics of an assessment on fields whose deviations are known exactly."""

import numpy as np
import pytest

import fedic
from fedic.assess.squares import square_samples
from fedic.assess.statistics import deviations, pixel_size, zero_displacement_deviation, zero_strain_deviation
from fedic.results.rigid import fit_rigid_motion

CORNERS = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])


def moved_rigidly(points: np.ndarray, degrees: float, translation: tuple[float, float]) -> np.ndarray:
    """Return the displacement of points turned about the origin and translated."""
    angle = np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(points @ turn.T + translation - points)


@pytest.mark.parametrize("degrees", [0.0, 0.01, 30.0, -90.0, 179.0])
def test_a_rigid_motion_is_found_exactly(degrees: float) -> None:
    motion = fit_rigid_motion(CORNERS, moved_rigidly(CORNERS, degrees, (3.0, -2.0)))
    assert np.rad2deg(motion.rotation) == pytest.approx(degrees, abs=1e-9)
    np.testing.assert_allclose(motion.residual, 0.0, atol=1e-12)
    centre = np.array([[5.0, 5.0]])
    np.testing.assert_allclose(motion.translation, moved_rigidly(centre, degrees, (3.0, -2.0))[0], atol=1e-12)


def test_zd_is_zero_for_rigid_motions_of_any_pose() -> None:
    fields = [(CORNERS, moved_rigidly(CORNERS, degrees, (degrees, 1.0))) for degrees in (0.0, 10.0, -50.0)]
    np.testing.assert_allclose(zero_displacement_deviation(fields), 0.0, atol=1e-12)


def test_zd_of_a_saddle_is_its_root_mean_square() -> None:
    # At the corners of a square this field has no translation and no rotation in it.
    saddle = 0.003 * np.array([[1.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [-1.0, 0.0]])
    found = zero_displacement_deviation([(CORNERS, saddle + np.array([0.5, 0.0])), (CORNERS, saddle)])
    np.testing.assert_allclose(found, [0.003, 0.003, 0.0], atol=1e-12)
    # Poses of unlike quality: the mean of the squares over both.
    found = zero_displacement_deviation([(CORNERS, saddle), (CORNERS, np.zeros((4, 2)))])
    np.testing.assert_allclose(found, np.array([0.003, 0.003, 0.0]) / np.sqrt(2.0), atol=1e-12)


def test_a_stretch_is_left_as_deviation() -> None:
    stretch = 1e-3 * (CORNERS - 5.0)
    np.testing.assert_allclose(
        zero_displacement_deviation([(CORNERS, stretch)]), 5e-3 * np.array([np.sqrt(2.0), 1.0, 1.0]), rtol=1e-12
    )


def test_zs_is_the_root_mean_square_of_the_three_strains() -> None:
    strains = [np.array([[3e-4, 0.0, 0.0], [-3e-4, 0.0, 0.0]]), np.array([[0.0, 4e-4, 1e-4]])]
    found = zero_strain_deviation(strains)
    expected = np.sqrt(np.array([18e-8, 16e-8, 1e-8]) / 3.0)
    np.testing.assert_allclose(found[1:], expected, rtol=1e-12)
    assert found[0] == pytest.approx(np.sqrt(35e-8 / 9.0), rel=1e-12)


def test_nothing_measured_is_nan() -> None:
    empty = np.empty((0, 2))
    assert np.isnan(zero_displacement_deviation([(empty, empty)])).all()
    assert np.isnan(zero_strain_deviation([])).all()
    assert np.isnan(deviations(np.empty(0), np.empty(0))[1:]).all()
    assert np.isnan(pixel_size(np.empty((0, 2)), np.empty((0, 2)))).all()


def test_deviations_have_mean_standard_deviation_and_largest() -> None:
    found = deviations(np.array([1.1, 1.9, 3.2]), np.array([1.0, 2.0, 3.0]))
    assert found.num_readings == 3
    assert found.mean == pytest.approx(0.2 / 3.0)
    assert found.standard_deviation == pytest.approx(np.std([0.1, -0.1, 0.2], ddof=1))
    assert found.largest == pytest.approx(0.2)
    assert np.isnan(deviations(np.array([1.0]), np.array([1.0])).standard_deviation)
    assert np.isnan(deviations(np.array([np.nan, 1.0]), np.array([1.0, 1.0])).largest)


def test_the_pixel_size_is_the_ratio_of_set_and_read_lengths() -> None:
    given = np.array([[1.0, 0.0], [0.0, 2.0], [-3.0, 4.0]])
    exact = pixel_size(20.0 * given[:, ::-1], given)
    assert exact.size == pytest.approx(0.05)
    assert exact.uncertainty == pytest.approx(0.0, abs=1e-12)
    # With an uncertainty u of every set length: u times the size over the root of the sum of their squares.
    assert pixel_size(20.0 * given, given, 0.01).uncertainty == pytest.approx(0.05 * 0.01 / np.sqrt(30.0))
    assert np.isnan(pixel_size(20.0 * given[:1], given[:1]).uncertainty)


def test_squares_fill_the_box_around_the_mesh() -> None:
    mesh = fedic.rectangle_mesh((0.0, 0.0, 50.0, 30.0), 5.0)
    samples = square_samples(mesh, 12.0)
    assert samples.shape == (4 * 2, 100, 2)
    np.testing.assert_allclose(samples.mean(axis=1)[0], [1.0 + 6.0, 3.0 + 6.0])
    np.testing.assert_allclose(np.ptp(samples[0], axis=0), 12.0 * 0.9)
    assert square_samples(mesh, 10.0).shape[0] == 15
    whole = fedic.rectangle_mesh((0.0, 0.0, 30.0, 30.0), 10.0)
    holed = fedic.Mesh(whole.points, {"quad": np.delete(whole.cells["quad"], 4, axis=0)})
    assert len(square_samples(holed, 10.0)) == 8


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf, 40.0])
def test_squares_that_do_not_fit_are_refused(size: float) -> None:
    with pytest.raises(fedic.OptionError, match="square="):
        square_samples(fedic.rectangle_mesh((0.0, 0.0, 50.0, 30.0), 5.0), size)
