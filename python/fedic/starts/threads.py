"""Number of threads of OpenCV, which has one for the whole process."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["opencv_threads"]

_lock = threading.Lock()
_wanted: list[int] = []
_before = 0


@contextmanager
def opencv_threads(count: int | None) -> Iterator[None]:
    """Let OpenCV use no more than some threads in a block; of several such blocks at once, the fewest.

    Parameters
    ----------
    count : int, optional
        The number of threads; no limit by default.
    """
    if count is None:
        yield
        return
    _change(_wanted.append, count)
    try:
        yield
    finally:
        _change(_wanted.remove, count)


def _change(how: Callable[[int], None], count: int) -> None:
    import cv2

    global _before
    with _lock:
        if not _wanted:
            _before = cv2.getNumThreads()
        how(count)
        cv2.setNumThreads(min(_wanted, default=_before))
