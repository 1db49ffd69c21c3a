"""Progress of long operations, as callbacks receive it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

__all__ = ["Progress", "ProgressCallback", "core_callback", "fraction_callback"]


@dataclass(frozen=True)
class Progress:
    """State of a running operation.

    Attributes
    ----------
    stage : str
        Name of the stage, such as ``"prepare"``, ``"solve"`` or ``"render"``.
    fraction : float or None
        Completed part of the stage, from 0 to 1, where it is known in advance.
    level : int
        Level of the image pyramid; 0 is the full image.
    iteration : int
        Number of the iteration in this level, from 1; 0 for stages without iterations.
    correction : float
        Largest nodal correction of the iteration in pixels; 0 for stages without iterations.
    residual_rms : float
        Root mean square residual in grey levels; 0 for stages without iterations.
    frame : int
        Number of frames of a campaign that are finished; 0 for other operations.
    frames : int or None
        Number of frames of a campaign; None if it is not known.
    flagged_cells : int
        Doubtful cells of the last frame of a campaign.
    """

    stage: str
    fraction: float | None = None
    level: int = 0
    iteration: int = 0
    correction: float = 0.0
    residual_rms: float = 0.0
    frame: int = 0
    frames: int | None = None
    flagged_cells: int = 0


ProgressCallback: TypeAlias = Callable[[Progress], object]
"""Called from the thread that runs the operation; an exception it raises stops the operation."""


def core_callback(callback: ProgressCallback | None) -> Callable[[str, int, int, float, float], object] | None:
    """Adapt a callback to the positional arguments that the extension module passes."""
    if callback is None:
        return None

    def report(stage: str, level: int, iteration: int, correction: float, residual_rms: float) -> object:
        return callback(Progress(stage, None, level, iteration, correction, residual_rms))

    return report


def fraction_callback(callback: ProgressCallback | None, stage: str) -> Callable[[float], object]:
    """Adapt a callback to the completed fraction of a stage; does nothing without a callback."""
    if callback is None:
        return lambda _: None
    return lambda fraction: callback(Progress(stage, fraction))
