"""A progress bar of a campaign, in a notebook or on a terminal."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from fedic.progress import Progress, ProgressCallback

__all__ = ["progress_bar"]


@contextmanager
def progress_bar(progress: ProgressCallback | bool | None, count: int | None) -> Iterator[ProgressCallback | None]:
    """Provide the callback of a campaign.

    Parameters
    ----------
    progress : callable or bool or None
        A callback, which is provided as it is; true for a bar, false for none; None for one where it can be seen.
    count : int or None
        Number of frames; None if it is not known.

    Yields
    ------
    callable or None
        Called with a `Progress`.
    """
    if callable(progress):
        yield progress
        return
    if progress is False or (progress is None and not _is_seen()):
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=Console(stderr=True), transient=progress is None) as bar:
        task = bar.add_task("preparing", total=count)

        def show(state: Progress) -> None:
            if state.frame == 0:
                return
            doubtful = f", {state.flagged_cells} doubtful cells" if state.flagged_cells else ""
            text = f"{state.stage}: residual {state.residual_rms:.3g} grey levels{doubtful}"
            bar.update(task, completed=state.frame, total=state.frames, description=text)

        yield show


def _is_seen() -> bool:
    return sys.stderr.isatty() or "ipykernel" in sys.modules
