"""Universal files of I-deas and Salome."""

from fedic.io.mesh_formats.unv.reader import read_unv

__all__ = ["read_unv"]
