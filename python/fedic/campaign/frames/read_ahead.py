"""Frames read ahead by a thread, so that the measurement does not wait for files."""

import queue
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from fedic._internal.types import Image
from fedic.campaign.frames.entry import load_entry
from fedic.campaign.frames.series import SeriesFrame
from fedic.errors import FedicError, ImageError

__all__ = ["LoadedFrame", "load", "read_ahead"]

_AHEAD = 2
"""Frames that are read before they are asked for."""
_PATIENCE = 5.0
"""Seconds that a stopped thread is waited for."""


@dataclass(frozen=True, eq=False)
class LoadedFrame:
    """A frame that was loaded, or could not be.

    Attributes
    ----------
    frame : SeriesFrame
        The frame.
    image : ndarray, shape (height, width), or None
        Its image.
    error : str
        Why there is none; empty if there is one.
    """

    frame: SeriesFrame
    image: Image | None
    error: str = ""


def load(frame: SeriesFrame) -> LoadedFrame:
    """Load a frame; a fault becomes the error of the frame."""
    try:
        return LoadedFrame(frame, load_entry(frame.entry, frame.name))
    except FedicError as error:
        return LoadedFrame(frame, None, str(error))
    except (OSError, MemoryError) as error:
        return LoadedFrame(frame, None, str(ImageError(f"{frame.name}: the image cannot be read ({error}).")))


def read_ahead(frames: Iterable[SeriesFrame]) -> Iterator[LoadedFrame]:
    """Yield frames in their order, each loaded by a thread before it is asked for.

    Parameters
    ----------
    frames : iterable of SeriesFrame
        The frames. An error of the iterable itself is raised when its place is reached.

    Yields
    ------
    LoadedFrame
        The frames.
    """
    loaded: queue.Queue[LoadedFrame | BaseException | None] = queue.Queue(_AHEAD)
    stopped = threading.Event()

    def put(item: LoadedFrame | BaseException | None) -> None:
        while not stopped.is_set():
            try:
                loaded.put(item, timeout=0.1)
                return
            except queue.Full:
                continue

    def read() -> None:
        try:
            for frame in frames:
                put(load(frame))
                if stopped.is_set():
                    return
            put(None)
        except BaseException as error:  # raised where the frames are used
            put(error)

    thread = threading.Thread(target=read, name="fedic-read-ahead", daemon=True)
    thread.start()
    try:
        while (item := loaded.get()) is not None:
            if isinstance(item, BaseException):
                raise item
            yield item
    finally:
        stopped.set()
        # A camera may not deliver another image.
        thread.join(_PATIENCE)
