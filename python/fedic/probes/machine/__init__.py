"""Data of the testing machine: its files, its clock, and its channels at the times of the frames."""

from fedic.probes.machine.clock import ClockOffset, find_offset
from fedic.probes.machine.joining import join

__all__ = ["ClockOffset", "find_offset", "join"]
