"""Progress on the terminal, for operations that last."""

import time
from types import TracebackType
from typing import Any

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
        self._started = time.monotonic()
        self._status: Any = None

    def __enter__(self) -> "TerminalProgress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._status is not None:
            self._status.stop()

    def iteration(self, stage: str, level: int, iteration: int, correction_px: float, residual_std: float) -> None:
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
        residual_std : float
            Standard deviation of the residual, in grey levels.
        """
        where = f", level {level}" if level else ""
        self._show(
            f"{stage}{where}, iteration {iteration}: correction {correction_px:.2g} px, residual {residual_std:.3g}"
        )

    def fraction(self, done: float) -> None:
        """Show how much is done.

        Parameters
        ----------
        done : float
            From 0 to 1.
        """
        self._show(f"{done:.0%}")

    def _show(self, text: str) -> None:
        if time.monotonic() - self._started < _PATIENCE_SECONDS:
            return
        from rich.console import Console
        from rich.text import Text

        line = Text(f"{self._title}: {text}")
        if self._status is None:
            self._status = Console(stderr=True).status(line)
            self._status.start()
        else:
            self._status.update(line)
