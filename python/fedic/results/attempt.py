"""Attempts of a measurement from several starts."""

from typing import NamedTuple

__all__ = ["Attempt"]


class Attempt(NamedTuple):
    """What one start led to.

    Attributes
    ----------
    start : str
        Name of the start, such as ``"features"`` or ``"features+pyramid"``.
    converged : bool
        Whether the iterations converged.
    iterations : int
        Number of iterations on the images at full resolution.
    flagged_share : float
        Share of the cells that the verdict flags; 1 after an error.
    residual_rms : float
        Root mean square of the residual, in grey levels; NaN after an error.
    error : str
        Message of the error that ended it; empty if none.
    """

    start: str
    converged: bool
    iterations: int
    flagged_share: float
    residual_rms: float
    error: str = ""

    def __str__(self) -> str:
        if self.error:
            return f"{self.start}: {self.error}"
        state = "converged" if self.converged else "not converged"
        return f"{self.start}: {state}, {self.flagged_share:.0%} of the cells flagged"
