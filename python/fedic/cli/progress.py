"""Progress of long operations on the terminal."""

import threading
from types import TracebackType
from typing import TYPE_CHECKING, Any

from fedic.cli.terminal import shown
from fedic.progress import Progress

if TYPE_CHECKING:
    from rich.text import Text

__all__ = ["TerminalProgress"]

_DELAY_SECONDS = 2.0


class TerminalProgress:
    """A progress callback that shows one line on stderr.

    The line appears when the operation lasts over two seconds and is removed at the end. Nothing is written if stderr
    is not a terminal.

    Parameters
    ----------
    title : str
        Name of the operation, such as the name of the image.
    """

    def __init__(self, title: str) -> None:
        self._title = title
        self._text = ""
        self._status: Any = None
        self._finished = False
        self._lock = threading.Lock()
        self._timer = threading.Timer(_DELAY_SECONDS, self._appear)
        self._timer.daemon = True

    def __enter__(self) -> "TerminalProgress":
        self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.cancel()
        with self._lock:
            self._finished = True
            if self._status is not None:
                self._status.stop()

    def __call__(self, progress: Progress) -> None:
        """Show a state.

        Parameters
        ----------
        progress : Progress
            The state.
        """
        with self._lock:
            self._text = _describe(progress)
            if self._status is not None:
                self._status.update(self._line())

    def _appear(self) -> None:
        from rich.console import Console

        with self._lock:
            if not self._finished:
                self._status = Console(stderr=True).status(self._line())
                self._status.start()

    def _line(self) -> "Text":
        from rich.text import Text

        return Text(f"{shown(self._title)}: {self._text or 'preparing'}")


def _describe(progress: Progress) -> str:
    if progress.fraction is not None:
        return f"{progress.stage} {progress.fraction:.0%}"
    if progress.iteration == 0:
        return progress.stage
    level = f", level {progress.level}" if progress.level else ""
    return (
        f"{progress.stage}{level}, iteration {progress.iteration}: correction {progress.correction:.2g} px, "
        f"residual {progress.residual_rms:.3g}"
    )
