"""Frames grouped into blocks, each of which is one task."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fedic.campaign.frames import FrameEntry
from fedic.campaign.frames.series import SeriesFrame
from fedic.campaign.tracking import Starts, Tracked

__all__ = ["Block", "blocks", "travelling"]

_CHAINED = 8
"""Frames of a block in which each frame starts from those before."""


@dataclass(frozen=True, eq=False)
class Block:
    """Frames that one worker measures one after the other.

    Attributes
    ----------
    frames : list of SeriesFrame
        The frames.
    known : list of Tracked
        Frames of the same block that were measured before, which the first one starts from.
    """

    frames: list[SeriesFrame]
    known: list[Tracked]

    @property
    def names(self) -> str:
        """The names of the frames for messages."""
        first, last = self.frames[0].name, self.frames[-1].name
        return first if len(self.frames) == 1 else f"{first} to {last}"


def blocks(frames: Iterable[SeriesFrame], starts: Starts, known: Sequence[Tracked]) -> Iterator[Block]:
    """Group frames into blocks.

    The bounds depend on the numbers of the frames alone, so that the results depend neither on the number of workers
    nor on where an earlier run was interrupted.

    Parameters
    ----------
    frames : iterable of SeriesFrame
        The frames; if it raises an error, those before are yielded first.
    starts : {"extrapolated", "previous", "independent"}
        Where a frame starts from.
    known : sequence of Tracked
        The last frames of an earlier run; it is read when the first frame is there.

    Yields
    ------
    Block
        The blocks in the order of their frames.
    """
    size = 1 if starts == "independent" else _CHAINED
    waiting: list[SeriesFrame] = []

    def block() -> Block:
        first = waiting[0].index - waiting[0].index % size
        return Block(list(waiting), [tracked for tracked in known if tracked.index >= first])

    try:
        for frame in frames:
            waiting.append(frame)
            if (frame.index + 1) % size == 0:
                yield block()
                waiting.clear()
    except Exception:
        if waiting:
            yield block()
        raise
    if waiting:
        yield block()


def travelling(block: Block) -> Block:
    """Return a block whose files have names that hold in every folder."""
    return replace(block, frames=[replace(frame, entry=_absolute(frame.entry)) for frame in block.frames])


def _absolute(entry: FrameEntry) -> FrameEntry:
    if isinstance(entry, (str, Path)):
        return Path(entry).absolute()
    if isinstance(entry, (list, tuple)):
        return [Path(part).absolute() if isinstance(part, (str, Path)) else part for part in entry]
    return entry
