"""What is known of a frame besides its fields."""

from dataclasses import dataclass

__all__ = ["FrameRecord"]


@dataclass(frozen=True)
class FrameRecord:
    """What is known of a frame of a campaign besides its fields.

    Attributes
    ----------
    index : int
        Its number, from 0.
    name : str
        Name of its image, without folder and ending.
    time : float
        Its time in seconds; NaN if it is not known.
    error : str
        Why it could not be measured; empty if it was.
    converged : bool
        Whether the iterations converged.
    good : bool
        Whether the verdict finds nothing doubtful.
    residual_rms : float
        Root mean square of the residual, in grey levels.
    noise : float
        Standard deviation of the noise of one image, in grey levels; NaN if it is not known.
    iterations : int
        Iterations on the images at full resolution.
    start : str
        The start that led to the result; see `Result.start`.
    reference : int
        Number of the frame that was the reference image; -1 for the first reference image.
    seconds : float
        Time that the measurement took.
    """

    index: int
    name: str
    time: float
    error: str
    converged: bool
    good: bool
    residual_rms: float
    noise: float
    iterations: int
    start: str
    reference: int
    seconds: float

    @property
    def is_measured(self) -> bool:
        """Whether the frame has a result."""
        return not self.error
