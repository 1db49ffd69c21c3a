"""Files of all frames of a series: long tables, arrays, and series of ParaView."""

from fedic.io.exports.export import export

__all__ = ["export"]
