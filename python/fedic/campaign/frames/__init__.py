"""The frames of a series: files, arrays, videos, means of several images, and their times."""

from fedic.campaign.frames.entry import FrameEntry, load_entry
from fedic.campaign.frames.read_ahead import LoadedFrame, read_ahead
from fedic.campaign.frames.series import FrameSeries
from fedic.campaign.frames.times import Times

__all__ = ["FrameEntry", "FrameSeries", "LoadedFrame", "Times", "load_entry", "read_ahead"]
