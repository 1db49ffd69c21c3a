"""Universal files of I-deas and Salome."""

from fedic.io.unv.reader import read_unv

__all__ = ["read_unv"]
