"""Results that hold a camera: they write it to a file and draw themselves."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from fedic._internal.types import Camera, StrPath
from fedic.cameras.files import write_camera

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["CameraResult"]


class CameraResult(ABC):
    """Base of the results of calibration and registration."""

    if TYPE_CHECKING:

        @property
        def camera(self) -> Camera:
            """The camera that was found; an attribute of each subclass."""

    def plot(self, path: StrPath) -> None:
        """Draw the residuals over the image.

        Parameters
        ----------
        path : str or path
            The ``.png`` file; replaced if it exists.

        Raises
        ------
        FedicError
            If the suffix is another, or the file cannot be written.
        """
        from fedic.plotting.png_files import save_figure

        save_figure(self._figure(), Path(path))

    def write(self, path: StrPath, *, overwrite: bool = False) -> Path:
        """Write the camera, see `fedic.write_camera`; a ``.toml`` file also holds the standard deviations.

        Parameters
        ----------
        path : str or path
            Ends in ``.toml``, ``.yml``, ``.yaml`` or ``.xml``.
        overwrite : bool
            If true, an existing file is replaced.

        Returns
        -------
        Path
            The file written.

        Raises
        ------
        CameraError
            If the file exists and `overwrite` is false, or the format cannot hold the camera.
        FedicError
            If the file cannot be written.
        """
        return write_camera(self.camera, path, overwrite=overwrite, notes=self._notes())

    @abstractmethod
    def _figure(self) -> "Figure":
        """Draw the residuals."""

    @abstractmethod
    def _notes(self) -> dict[str, object]:
        """Return numbers and texts for the section ``[calibration]`` of a camera file."""
