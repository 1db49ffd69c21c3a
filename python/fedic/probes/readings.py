"""Means over a place, and their covariance from that of the displacement."""

from collections.abc import Iterable

import numpy as np

from fedic._internal.types import Floats
from fedic.probes.cell_points import StrainOptions
from fedic.probes.places import NodeMean, Place
from fedic.probes.quantities import QUANTITIES
from fedic.results.covariance import Covariance
from fedic.results.result import Result

__all__ = ["has_source", "read"]

_MEASURED = 0.5
"""Smallest share of a place that must be measured."""


def has_source(place: Place, source: str) -> bool:
    """Return whether a place has the fields of a source.

    Parameters
    ----------
    place : Place
        The place.
    source : str
        The source of a `Quantity`.

    Returns
    -------
    bool
        An extensometer has its own fields and the quality, other places have all but those; a set without cells has the
        displacement only.
    """
    if source in ("strain", "quality") and place.cells is None:
        return False
    return source == "quality" or (source == "ends") == (place.ends is not None)


def read(
    place: Place, result: Result, covariance: Covariance | None, fields: Iterable[str], options: StrainOptions
) -> dict[str, tuple[float, float]]:
    """Read fields at a place.

    Parameters
    ----------
    place : Place
        The place.
    result : Result
        The result.
    covariance : Covariance or None
        The covariance of its displacement.
    fields : iterable of str
        Names of fields that the place has.
    options : StrainOptions
        Measure and axes of the strains.

    Returns
    -------
    dict
        Value and standard deviation, to first order in the noise, by field; NaN where not known.
    """
    names = list(fields)
    line = np.zeros(2) if place.ends is None else place.ends[1] - place.ends[0]
    found = {}
    for source in dict.fromkeys(QUANTITIES[name].source for name in names):
        means, spread = _means(source, place, result, covariance, options)
        for name in names:
            if QUANTITIES[name].source == source:
                with np.errstate(invalid="ignore", divide="ignore"):
                    value, slope = QUANTITIES[name].rule(means, line)
                    found[name] = value, float(np.sqrt(slope @ spread @ slope))
    return found


def _means(
    source: str, place: Place, result: Result, covariance: Covariance | None, options: StrainOptions
) -> tuple[Floats, Floats]:
    """Return the means that fields follow from, and their covariance."""
    if source == "quality":
        return _quality(place, result), np.full((3, 3), np.nan)
    if source == "strain":
        return _mean_strain(place, result, covariance, options)
    nodal = place.nodal
    if source == "ends":
        parts = [NodeMean(nodal.nodes[[end]], nodal.shapes[[end]], np.ones(1)) for end in range(2)]
    else:
        parts = [nodal]
    field = result.pixel_displacement if source == "pixels" else result.displacement
    weights = [_node_weights(part, field) for part in parts]
    if any(each is None for each in weights):
        return np.full(2 * len(parts), np.nan), np.full((2 * len(parts), 2 * len(parts)), np.nan)
    known = [each for each in weights if each is not None]
    means = np.concatenate([each @ np.nan_to_num(field) for each in known])
    functions = np.zeros((2 * len(known), len(field), 2))
    for part, each in enumerate(known):
        if source == "pixels":
            used = np.flatnonzero(each)
            moved = result.mesh.points[used].copy()
            moved[:, :2] += result.displacement[used]
            slopes = result.camera.jacobian(moved)[:, :, :2]
            functions[:, used] = np.swapaxes(each[used, np.newaxis, np.newaxis] * slopes, 0, 1)
        else:
            functions[2 * part, :, 0] = functions[2 * part + 1, :, 1] = each
    return means, _spread(covariance, functions)


def _node_weights(mean: NodeMean, field: Floats) -> Floats | None:
    """Return the weight of each node in the mean over the part that is measured; None if that is too small."""
    known = (np.isfinite(field[mean.nodes]).all(axis=2) | (mean.shapes == 0.0)).all(axis=1)
    share = mean.weights[known].sum()
    if not share >= _MEASURED - 1e-9:
        return None
    weights = np.zeros(len(field))
    np.add.at(weights, mean.nodes[known], mean.shapes[known] * mean.weights[known, np.newaxis] / share)
    return weights


def _mean_strain(
    place: Place, result: Result, covariance: Covariance | None, options: StrainOptions
) -> tuple[Floats, Floats]:
    cells = place.cells
    assert cells is not None
    strains = cells.strains(result.displacement, result.valid_cells, options)
    known = np.isfinite(strains).all(axis=1)
    share = place.weights[known].sum()
    if not share >= _MEASURED - 1e-9:
        return np.full(3, np.nan), np.full((3, 3), np.nan)
    weights = np.where(known, place.weights, 0.0) / share
    means = weights[known] @ strains[known]
    if covariance is None:
        return means, np.full((3, 3), np.nan)
    slopes = cells.strain_slopes(result.displacement, options)
    functions = np.zeros((3, result.mesh.num_nodes, 2))
    for component in range(3):
        parts = weights[known, np.newaxis, np.newaxis] * slopes[known, component]
        np.add.at(functions[component], cells.nodes[known], parts)
    return means, _spread(covariance, functions)


def _quality(place: Place, result: Result) -> Floats:
    """Return the root mean square of the residual, the mean correlation and the share that is measured."""
    cells = place.cells
    assert cells is not None
    values = np.column_stack([result.cell_residuals**2, result.quality.correlation])[cells.cells]
    known = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        means = (place.weights[:, np.newaxis] * np.where(known, values, 0.0)).sum(axis=0) / (
            place.weights[:, np.newaxis] * known
        ).sum(axis=0)
    measured = place.weights[result.valid_cells[cells.cells]].sum()
    return np.array([np.sqrt(means[0]), means[1], measured])


def _spread(covariance: Covariance | None, functions: Floats) -> Floats:
    if covariance is None:
        return np.full((len(functions), len(functions)), np.nan)
    return covariance.of(functions)
