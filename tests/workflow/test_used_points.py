"""Points without weight: outside the deformed image, masked, or saturated."""

import warnings

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.motion import moved
from scenes.moved_plate import motion, pair

Grey = NDArray[np.uint8]

SIDE = 300


def measured(reference: Grey, deformed: Grey, mesh: fedic.Mesh) -> tuple[fedic.Result, str]:
    """Return the result and the texts of its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = fedic.correlate(reference, deformed, mesh)
    return result, "\n".join(str(warning.message) for warning in caught)


def far() -> tuple[Grey, Grey, NDArray[np.float64]]:
    matrix = motion(shift=(60.0, 0.0), side=SIDE)
    return *pair(matrix, side=SIDE), matrix


@pytest.mark.parametrize("cell", ["quad", "triangle", "quad9"])
@pytest.mark.parametrize("hessian", ["initial", "updated"])
@pytest.mark.parametrize("start", ["auto", "pyramid", "fft"])
def test_what_leaves_the_view_is_nan_and_the_rest_converges(start: str, hessian: str, cell: str) -> None:
    reference, deformed, matrix = far()
    mesh = fedic.rectangle_mesh((20, 20, 280, 280), size=20 if cell != "quad9" else 40, cell=cell)  # type: ignore[arg-type]
    with pytest.warns(fedic.QualityWarning, match="few-points"):
        result = fedic.correlate(reference, deformed, mesh, initial=start, hessian=hessian)  # type: ignore[arg-type]
    assert result.converged
    truth = moved(matrix, mesh.points) - mesh.points
    error = np.linalg.norm(result.displacement - truth, axis=1)
    size = 20 if cell != "quad9" else 40
    assert np.isnan(error[mesh.points[:, 0] + 60 > SIDE + size]).all()
    inside = mesh.points[:, 0] + 60 < SIDE - 3
    assert np.isfinite(error[inside]).all()
    trusted = result.quality.node_flags == 0
    assert error[trusted].max() < 0.1
    assert error[inside & (mesh.points[:, 0] + 60 < SIDE - size)].max() < 0.1


def test_meshes_partly_out_of_the_view_do_not_cycle() -> None:
    matrix = motion(0.3, (1.004, 1.0), (0.0, -9.3), side=SIDE)
    reference, deformed = pair(matrix, side=SIDE)
    for top in (7.0, 8.0, 9.0, 9.5, 10.0):
        mesh = fedic.rectangle_mesh((40, top, 240, 220), size=20)
        result, _ = measured(reference, deformed, mesh)
        assert result.converged
        error = np.linalg.norm(result.displacement - (moved(matrix, mesh.points) - mesh.points), axis=1)
        assert np.nanmax(error[result.quality.node_flags == 0]) < 0.15


MATRIX = motion(1.0, (1.01, 1.0), (1.7, -0.8), side=SIDE)
MESH = fedic.rectangle_mesh((50, 50, 250, 250), size=20)


@pytest.mark.parametrize("form", ["image", "polygon"])
def test_masked_pixels_carry_no_weight(form: str) -> None:
    reference, deformed = pair(MATRIX, side=SIDE)
    box = (100, 120, 170, 190)
    spoilt = deformed.copy()
    spoilt[118:194, 98:176] = 30
    mask = np.zeros((SIDE, SIDE), dtype=bool)
    left, top, right, bottom = box[0] - 10, box[1] - 10, box[2] + 15, box[3] + 15
    mask[top : bottom + 1, left : right + 1] = True
    polygon = [(left, top), (right, top), (right, bottom), (left, bottom)]
    given = mask if form == "image" else [polygon]
    with pytest.warns(fedic.QualityWarning, match="few-points"):
        result = fedic.correlate(reference, spoilt, MESH, mask=given)
    assert result.converged
    with pytest.warns(fedic.QualityWarning):
        without = fedic.correlate(reference, deformed, MESH, mask=given)
    np.testing.assert_array_equal(result.valid_nodes, without.valid_nodes)
    valid = result.valid_nodes
    np.testing.assert_allclose(result.displacement[valid], without.displacement[valid], atol=2e-3)
    error = np.linalg.norm(result.displacement - (moved(MATRIX, MESH.points) - MESH.points), axis=1)
    assert np.nanmax(error[result.quality.node_flags == 0]) < 0.1
    assert 4 <= (~valid).sum() <= 16
    assert result.quality.used_share.min() == 0.0
    residual = result.residual_map()
    assert np.isnan(residual[150, 140])
    assert np.isfinite(residual[80, 80])
    deviations = result.standard_deviations(1.0)
    np.testing.assert_array_equal(np.isnan(deviations).any(axis=1), ~valid)


def test_a_mask_works_with_every_hessian_regularization_and_the_pyramid() -> None:
    reference, deformed = pair(motion(0.5, shift=(9.0, -4.0), side=SIDE), side=SIDE)
    mask = np.zeros((SIDE, SIDE), dtype=np.uint8)
    mask[90:180, 90:180] = 1
    for options in ({"hessian": "updated"}, {"regularization_length": 120.0}, {"smoothing": 0.0}):
        with pytest.warns(fedic.QualityWarning):
            result = fedic.correlate(reference, deformed, MESH, mask=mask, initial="pyramid", **options)  # type: ignore[arg-type]
        assert result.converged
        truth = moved(motion(0.5, shift=(9.0, -4.0), side=SIDE), MESH.points) - MESH.points
        error = np.linalg.norm(result.displacement - truth, axis=1)
        assert np.nanmax(error[result.quality.node_flags == 0]) < 0.1


def test_bad_masks_are_refused() -> None:
    reference, deformed = pair(MATRIX, side=SIDE)
    for mask, message in (
        (np.zeros((10, 12), dtype=bool), "mask has shape"),
        ([[(0, 0), (1, 1)]], "three finite corners"),
        ([[(0, 0), (1, np.nan), (3, 3)]], "three finite corners"),
        ("hole", "mask must be"),
        (7, "mask must be"),
        (np.ones((SIDE, SIDE), dtype=bool), "no cell of the mesh"),
    ):
        with pytest.raises(fedic.OptionError, match=message):
            fedic.correlate(reference, deformed, MESH, mask=mask)


def test_saturated_points_carry_no_weight_and_are_said() -> None:
    reference, deformed = pair(MATRIX, side=SIDE)
    spoilt = deformed.copy()
    spoilt[110:171, 100:161] = 255
    result, warned = measured(reference, spoilt, MESH)
    assert "of the deformed image around the mesh are saturated" in warned
    share = result.quality.saturated_share
    assert share[0] == 0.0
    assert share[1] == pytest.approx(61 * 61 / 202**2, rel=0.1)
    assert result.quality.cells("few-points").size >= 1
    error = np.linalg.norm(result.displacement - (moved(MATRIX, MESH.points) - MESH.points), axis=1)
    assert not (error[result.quality.node_flags == 0] > 0.3).any()


def test_textures_that_touch_the_full_scale_are_measured() -> None:
    reference, deformed = (
        np.minimum(1.3 * image, 255).astype(np.uint8) for image in pair(MATRIX, side=SIDE, noise=0.5)
    )
    result, warned = measured(reference, deformed, MESH)
    assert "are saturated" in warned
    assert result.converged
    error = np.linalg.norm(result.displacement - (moved(MATRIX, MESH.points) - MESH.points), axis=1)
    assert np.nanmax(error) < 0.2
    assert np.isfinite(error).mean() > 0.98
