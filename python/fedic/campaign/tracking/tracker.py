"""The frames of a series, each measured from what earlier ones tell."""

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

from fedic._core import Mesh
from fedic._internal.types import Floats, Image
from fedic.campaign.tracking.prediction import KnownFrame, extrapolated, filled
from fedic.campaign.tracking.reference import Reference
from fedic.correlation import Correlator
from fedic.errors import CalibrationWarning, ConvergenceWarning, FedicError, QualityWarning
from fedic.results import Result

__all__ = ["ReferenceUpdate", "Starts", "Tracked", "Tracker", "is_known"]

Starts: TypeAlias = Literal["extrapolated", "previous", "independent"]
ReferenceUpdate: TypeAlias = Literal["first", "previous", "auto"]

_FLAGGED_RISE = 0.05
"""Share of flagged cells beyond that of the last two frames from which on other starts are tried."""
_RESIDUAL_RISE = 1.5
"""Residual relative to that of the last two frames from which on other starts are tried."""
_UNKNOWN_SHARE = 0.5
"""Share of flagged cells from which on a frame tells nothing of later ones."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """What was measured of a frame.

    Attributes
    ----------
    index : int
        Number of the frame.
    image : ndarray, shape (height, width)
        Its image.
    result : Result
        The result, its displacement counted from the first mesh.
    reference : int
        Number of the frame that was the reference image; -1 for the first reference image.
    drift : ndarray of float64, shape (n, 2), or None
        Displacement through later reference images minus the direct one, where both were measured.
    """

    index: int
    image: Image
    result: Result
    reference: int = -1
    drift: Floats | None = None


class Tracker:
    """Measures the frames of a series in their order.

    Parameters
    ----------
    correlator : Correlator
        The first reference image, prepared.
    mesh : Mesh
        The mesh.
    mask : ndarray of bool, shape (height, width), or None
        Pixels of the first reference image that are left out.
    prepare : callable
        Returns the correlator of an image, a mesh and a mask.
    starts : {"extrapolated", "previous", "independent"}
        Where a frame starts from.
    reference_update : {"first", "previous", "auto"}
        When a later frame becomes the reference.
    """

    def __init__(
        self,
        correlator: Correlator,
        mesh: Mesh,
        mask: Any,
        prepare: Callable[[Image, Mesh, Any], Correlator],
        starts: Starts,
        reference_update: ReferenceUpdate,
    ) -> None:
        self._mesh, self._mask, self._prepare = mesh, mask, prepare
        self._starts, self._update = starts, reference_update
        self._first = Reference.first(correlator, mesh)
        self._current = self._first
        self._known: list[KnownFrame] = []
        self._last: Tracked | None = None

    def measure(self, index: int, image: Image) -> Tracked:
        """Measure a frame.

        Parameters
        ----------
        index : int
            Its number.
        image : ndarray, shape (height, width)
            Its image.

        Returns
        -------
        Tracked
            What was measured.

        Raises
        ------
        FedicError
            If it cannot be measured.
        """
        with warnings.catch_warnings():
            # The verdict is part of the result, and a lens is the same in all frames.
            for kind in (ConvergenceWarning, QualityWarning, CalibrationWarning):
                warnings.simplefilter("ignore", kind)
            tracked = self._measured(index, image)
        self._remember(tracked)
        return tracked

    def restore(self, frames: Sequence[Tracked], reference: Tracked | None) -> None:
        """Go on from frames measured before.

        Parameters
        ----------
        frames : sequence of Tracked
            The last two frames for which `is_known` is true, in their order, or fewer if there are no more.
        reference : Tracked or None
            The frame that was the reference image of the last measured one; None for the first reference image.
        """
        if reference is not None:
            self._current = self._as_reference(reference)
        for tracked in frames:
            self._remember(tracked)

    def _remember(self, tracked: Tracked) -> None:
        if is_known(tracked.result):
            flagged = tracked.result.quality.flagged_share
            displacement = filled(self._mesh, tracked.result.displacement)
            known = KnownFrame(tracked.index, displacement, tracked.result.residual_rms, flagged)
            self._known = [*self._known[-1:], known]
            self._last = tracked if self._update != "first" else None

    def _measured(self, index: int, image: Image) -> Tracked:
        if self._update == "previous" and self._last is not None:
            self._current = self._as_reference(self._last)
            return self._with_drift(self._attempt(self._current, index, image))
        if self._current is not self._first:
            return self._direct_if_possible(self._through_later_reference(index, image))
        direct: Tracked | FedicError
        try:
            direct = self._attempt(self._first, index, image)
        except FedicError as error:
            direct = error
        if self._update == "auto" and self._last is not None and not self._is_measured(direct):
            direct = self._better(direct, index, image)
        if isinstance(direct, FedicError):
            raise direct
        return direct

    def _better(self, direct: Tracked | FedicError, index: int, image: Image) -> Tracked | FedicError:
        """Measure a frame from the last known one; return that if it is better than the direct measurement."""
        assert self._last is not None, "called with an earlier frame"
        try:
            reference = self._as_reference(self._last)
            chained = self._attempt(reference, index, image)
        except FedicError:
            return direct
        if isinstance(direct, Tracked) and not _is_better(chained.result, direct.result):
            return direct
        self._current = reference
        return chained

    def _through_later_reference(self, index: int, image: Image) -> Tracked:
        """Measure a frame from the present reference image, or from the last known frame if that fails."""
        found: Tracked | FedicError
        try:
            found = self._attempt(self._current, index, image)
        except FedicError as error:
            found = error
        if not self._is_measured(found) and self._last is not None and self._last.index != self._current.index:
            found = self._better(found, index, image)
        if isinstance(found, FedicError):
            raise found
        return found

    def _direct_if_possible(self, chained: Tracked) -> Tracked:
        """Return the direct measurement if it is possible from the displacement that was found, else that one."""
        direct = self._direct(chained)
        if direct is None:
            return chained
        self._current = self._first
        return replace(chained, result=direct, reference=-1, drift=_drift(chained.result, direct))

    def _with_drift(self, chained: Tracked) -> Tracked:
        direct = self._direct(chained)
        return chained if direct is None else replace(chained, drift=_drift(chained.result, direct))

    def _direct(self, chained: Tracked) -> Result | None:
        """Measure a frame from the first reference image, starting from what was found; None if that fails."""
        start = filled(self._mesh, chained.result.displacement)
        try:
            direct = self._first.measure(chained.image, start)
        except FedicError:
            return None
        return direct if self._has_converged(direct) else None

    def _attempt(self, reference: Reference, index: int, image: Image) -> Tracked:
        """Measure a frame from one start after the other until the result is as expected; else return the best."""
        found: list[Tracked] = []
        fault: FedicError | None = None
        for total, pyramid in self._initial_displacements(index):
            try:
                result = reference.measure(image, total, pyramid=pyramid)
            except FedicError as error:
                fault = error
                continue
            found.append(Tracked(index, image, result, reference.index))
            if self._is_expected(result):
                return found[-1]
        if not found:
            assert fault is not None, "there is at least one start"
            raise fault
        best = found[0]
        for each in found[1:]:
            best = each if _is_better(each.result, best.result) else best
        return best

    def _initial_displacements(self, index: int) -> Iterator[tuple[Floats | None, bool]]:
        if self._known and self._starts != "independent":
            known = self._known[-1:] if self._starts == "previous" else self._known
            prediction = extrapolated(known, index)
            yield prediction, False
            yield prediction, True
        yield None, False

    def _is_measured(self, found: Tracked | FedicError) -> bool:
        return isinstance(found, Tracked) and self._has_converged(found.result)

    def _has_converged(self, result: Result) -> bool:
        """Tell whether a result has converged with about as few flagged cells as the last two known frames."""
        flagged = _FLAGGED_RISE + max((frame.flagged_share for frame in self._known), default=0.0)
        return result.converged and result.quality.flagged_share <= flagged

    def _is_expected(self, result: Result) -> bool:
        """Tell whether a result has converged with about the residual of the last two known frames."""
        residual = _RESIDUAL_RISE * max((frame.residual_rms for frame in self._known), default=math.inf)
        return self._has_converged(result) and result.residual_rms <= residual

    def _as_reference(self, frame: Tracked) -> Reference:
        if frame.index == self._current.index:
            return self._current
        return Reference.of_frame(frame.index, frame.image, frame.result, self._prepare, self._mask)


def is_known(result: Result) -> bool:
    """Tell whether later frames may start from a result.

    Parameters
    ----------
    result : Result
        The result.

    Returns
    -------
    bool
        True if it has converged and at most half of its cells are flagged.
    """
    return result.converged and result.quality.flagged_share <= _UNKNOWN_SHARE


def _drift(chained: Result, direct: Result) -> Floats:
    return chained.displacement - direct.displacement


def _is_better(first: Result, second: Result) -> bool:
    return _rank(first) < _rank(second)


def _rank(result: Result) -> tuple[float, bool, float]:
    return result.quality.flagged_share, not result.converged, result.residual_rms
