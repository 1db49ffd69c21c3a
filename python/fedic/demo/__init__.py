"""The lens-distortion demonstration: a large shift measured with and without the model of the lens."""

from fedic.demo._demo import Demo, measure, write_demo

__all__ = ["Demo", "measure", "write_demo"]
