"""A thread that completes and writes frames while the next one is measured."""

import queue
import threading
from collections.abc import Callable

from fedic.campaign.store.campaign_file import CampaignFile
from fedic.campaign.store.frame_data import FrameData

__all__ = ["WriteBehind"]

_WAITING = 2
"""Frames that may wait to be written."""


class WriteBehind:
    """Adds frames to the file of a campaign, in their order, in a thread of its own.

    Parameters
    ----------
    file : CampaignFile
        The file, open for writing.
    """

    def __init__(self, file: CampaignFile) -> None:
        self._file = file
        self._waiting: queue.Queue[tuple[Callable[[], FrameData], float] | None] = queue.Queue(_WAITING)
        self._fault: BaseException | None = None
        self._thread = threading.Thread(target=self._write, name="fedic-write-behind", daemon=True)
        self._thread.start()

    def put(self, data: Callable[[], FrameData], seconds: float) -> None:
        """Hand over a frame; its data are made by the thread.

        Raises
        ------
        FedicError
            If an earlier frame could not be written.
        """
        self._raise_fault()
        self._waiting.put((data, seconds))

    def close(self) -> None:
        """Wait until all frames are written.

        Raises
        ------
        FedicError
            If one could not be written.
        """
        self._waiting.put(None)
        self._thread.join()
        self._raise_fault()

    def _write(self) -> None:
        while (item := self._waiting.get()) is not None:
            if self._fault is None:
                data, seconds = item
                try:
                    self._file.add(data(), seconds)
                except BaseException as error:  # raised where the frames come from
                    self._fault = error

    def _raise_fault(self) -> None:
        if self._fault is not None:
            raise self._fault
