"""What the probes need of a series of frames measured on one mesh."""

from collections.abc import Sequence
from typing import Protocol

from fedic._core import Mesh
from fedic.results.covariance import Covariance
from fedic.results.result import Result

__all__ = ["FrameInfo", "Series"]


class FrameInfo(Protocol):
    """A frame that was measured, or that failed."""

    @property
    def index(self) -> int:
        """Index of the frame in the series."""

    @property
    def name(self) -> str:
        """Name of the frame, such as that of its image."""

    @property
    def time(self) -> float:
        """Time of the frame in seconds; NaN if it is not known."""

    @property
    def error(self) -> str:
        """Why the frame failed; empty if it was measured."""

    @property
    def residual_rms(self) -> float:
        """Root mean square of the residual in grey levels; NaN if the frame failed."""

    @property
    def converged(self) -> bool:
        """Whether the iterations converged."""

    @property
    def good(self) -> bool:
        """Whether the verdict finds nothing doubtful."""


class Series(Protocol):
    """Frames measured on one mesh."""

    @property
    def mesh(self) -> Mesh:
        """The mesh."""

    @property
    def unit(self) -> str:
        """Unit of length of the mesh; empty if it was not given."""

    @property
    def frames(self) -> Sequence[FrameInfo]:
        """All frames that are finished, those that failed too."""

    def result(self, index: int) -> Result:
        """Return the result of a frame without error.

        Parameters
        ----------
        index : int
            Index of the frame.

        Returns
        -------
        Result
            Its result.
        """

    def covariance(self, index: int) -> Covariance | None:
        """Return the covariance of the displacement of a frame without error.

        Parameters
        ----------
        index : int
            Index of the frame.

        Returns
        -------
        Covariance or None
            None if the noise or the reference image is not known.
        """
