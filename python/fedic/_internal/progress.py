"""Progress on the terminal, for operations that last."""

import threading
from types import TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.text import Text

__all__ = ["TerminalProgress"]

_PATIENCE_SECONDS = 2.0


class TerminalProgress:
    """One line on the terminal's stderr that appears when the work lasts over two seconds, and vanishes at the end.

    Nothing is written when stderr is not a terminal. Its methods `iteration` and `fraction` are the callbacks.

    Parameters
    ----------
    title : str
        What the work is, such as the name of the image.
    """

    def __init__(self, title: str) -> None:
        self._title = title
        self._text = ""
        self._status: Any = None
        self._over = False
        self._lock = threading.Lock()
        self._timer = threading.Timer(_PATIENCE_SECONDS, self._appear)
        self._timer.daemon = True

    def __enter__(self) -> "TerminalProgress":
        self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.cancel()
        with self._lock:
            self._over = True
            if self._status is not None:
                self._status.stop()

    def iteration(self, stage: str, level: int, iteration: int, correction_px: float, residual_rms: float) -> None:
        """Show where a correlation is.

        Parameters
        ----------
        stage : str
            What the core is doing.
        level : int
            Level of the pyramid; 0 is the full image.
        iteration : int
            Number of the iteration.
        correction_px : float
            Largest nodal correction, in pixels.
        residual_rms : float
            Standard deviation of the residual, in grey levels.
        """
        if stage == "prepare":
            self._show("reference prepared")
            return
        where = f", level {level}" if level else ""
        self._show(
            f"{stage}{where}, iteration {iteration}: correction {correction_px:.2g} px, residual {residual_rms:.3g}"
        )

    def fraction(self, done: float) -> None:
        """Show how much is done.

        Parameters
        ----------
        done : float
            From 0 to 1.
        """
        self._show(f"{done:.0%}")

    def _appear(self) -> None:
        from rich.console import Console

        with self._lock:
            if not self._over:
                self._status = Console(stderr=True).status(self._line())
                self._status.start()

    def _show(self, text: str) -> None:
        with self._lock:
            self._text = text
            if self._status is not None:
                self._status.update(self._line())

    def _line(self) -> "Text":
        from rich.text import Text

        return Text(f"{self._title}: {self._text or 'preparing'}")
