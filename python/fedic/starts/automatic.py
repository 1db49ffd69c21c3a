"""The start ``"auto"``: starts of increasing cost until the verdict accepts the result of one."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from fedic import _core
from fedic._core import Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import CameraError, SolveError
from fedic.results.attempt import Attempt

__all__ = ["measure_from_any_start"]

_PYRAMID = "+pyramid"
_FLAGGED_SHARE = 0.05
"""Largest share of flagged cells of a result that is accepted without another start."""
_AGREEMENT_SHARE = 0.5
"""Largest share of flagged cells of two results that are compared."""
_AGREEMENT_PX = 0.05
"""Largest difference between two results that agree, at the nodes valid in both."""
_ITERATIONS = {"zero": 12, "pyramid": 20}
"""Iterations after which a start that need not be near the motion is given up."""
_ITERATIONS_FROM_MOTION = 6
"""Iterations after which the start from one motion of the whole mesh is refined by the image pyramid."""


def measure_from_any_start(
    correlator: "_core.Correlator", images: tuple[Image, Image], mesh: Mesh, camera: Camera, progress: Any
) -> tuple["_core.Solution", list[Attempt]]:
    """Measure a deformed image from the first start whose result is accepted.

    A result is accepted if the iterations converged and at most one cell in twenty is flagged, or if another start led
    to the same displacement at the nodes that are measured. If none is, that with the fewest flagged cells is returned.

    Parameters
    ----------
    correlator : _core.Correlator
        The prepared reference image.
    images : (ndarray, ndarray)
        The reference and the deformed image.
    mesh : Mesh
        The mesh.
    camera : camera
        The camera.
    progress : callable or None
        The progress callback of the core.

    Returns
    -------
    solution : _core.Solution
        The result.
    attempts : list of Attempt
        What each start led to; that of the result is the last.

    Raises
    ------
    SolveError
        If every start ends in an error. The message lists them.
    """
    found: list[tuple[Attempt, _core.Solution]] = []
    failed: list[Attempt] = []
    for name, arguments in _starts(images, mesh, camera):
        if _is_settled(found, name):
            continue
        try:
            solution = correlator.correlate(images[1], max_iterations=_limit(name), progress=progress, **arguments)
        except SolveError as error:
            failed.append(Attempt(name, False, 0, 1.0, float("nan"), str(error)))
            continue
        attempt = _attempt(name, solution)
        is_confirmed = any(_agree(solution, other) for _, other in found)
        found.append((attempt, solution))
        if is_confirmed or (attempt.converged and attempt.flagged_share <= _FLAGGED_SHARE):
            break
    if not found:
        tried = "; ".join(map(str, failed))
        raise SolveError(
            f"no start leads to a measurement. Tried: {tried}. Check that both images show the same specimen, or give "
            "an initial displacement per node."
        )
    attempt, solution = _best(found)
    if not attempt.converged and _limit(attempt.start) is not None:
        try:
            solution = correlator.correlate(
                images[1], initial=np.nan_to_num(solution.unchecked_displacement), progress=progress
            )
        except SolveError as error:
            failed.append(Attempt(attempt.start, False, 0, 1.0, float("nan"), str(error)))
        else:
            attempt = _attempt(attempt.start, solution)
    return _outcome(found, failed, (attempt, solution))


def _starts(images: tuple[Image, Image], mesh: Mesh, camera: Camera) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the names of the starts and the arguments of the core, cheapest first."""
    yield "zero", {}
    yield "pyramid", {"pyramid": True}
    # Importing OpenCV takes a third of the time of a measurement of five megapixels.
    from fedic.starts.candidate import nodal_displacement
    from fedic.starts.estimators import candidates
    from fedic.starts.images import StartImages

    for candidate in candidates(StartImages.of(*images, mesh, camera)):
        try:
            initial: Floats = nodal_displacement(candidate.displacement, mesh, camera)
        except CameraError:
            continue
        if np.isfinite(initial).all():
            yield candidate.name, {"initial": initial}
            yield candidate.name + _PYRAMID, {"initial": initial, "pyramid": True}


def _limit(name: str) -> int | None:
    """Return the largest number of iterations from a start; None for the option's."""
    return None if name.endswith(_PYRAMID) else _ITERATIONS.get(name, _ITERATIONS_FROM_MOTION)


def _is_settled(found: list[tuple[Attempt, "_core.Solution"]], name: str) -> bool:
    """Tell whether the start that this one refines has converged already."""
    first = name.removesuffix(_PYRAMID)
    return first != name and any(attempt.start == first and attempt.converged for attempt, _ in found)


def _attempt(name: str, solution: "_core.Solution") -> Attempt:
    flagged = float(np.mean(solution.cell_flags != 0)) if solution.cell_flags.size else 0.0
    return Attempt(name, solution.converged, solution.iterations, flagged, solution.residual_rms)


def _agree(first: "_core.Solution", second: "_core.Solution") -> bool:
    for solution in (first, second):
        if np.mean(solution.cell_flags != 0) > _AGREEMENT_SHARE:
            return False
    difference = np.abs(first.pixel_displacement - second.pixel_displacement).max(axis=1)
    known = difference[np.isfinite(difference)]
    return bool(known.size) and float(known.max()) <= _AGREEMENT_PX


def _best(found: list[tuple[Attempt, "_core.Solution"]]) -> tuple[Attempt, "_core.Solution"]:
    return min(found, key=lambda each: (each[0].flagged_share, not each[0].converged, each[0].residual_rms))


def _outcome(
    found: list[tuple[Attempt, "_core.Solution"]], failed: list[Attempt], winner: tuple[Attempt, "_core.Solution"]
) -> tuple["_core.Solution", list[Attempt]]:
    others = [attempt for attempt, solution in found if attempt.start != winner[0].start]
    return winner[1], [*failed, *others, winner[0]]
