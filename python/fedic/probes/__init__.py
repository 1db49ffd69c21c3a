"""Readings of a series of frames: gauges, tables, and the data of the testing machine."""

from fedic.probes.gauge import Gauge
from fedic.probes.machine import join
from fedic.probes.places import At
from fedic.probes.series import FrameInfo, Series
from fedic.probes.tables import frame_table, table

__all__ = ["At", "FrameInfo", "Gauge", "Series", "frame_table", "join", "table"]
