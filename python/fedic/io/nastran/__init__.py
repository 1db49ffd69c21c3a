"""Mesh files of Nastran and OptiStruct."""

from fedic.io.nastran.reader import read_nastran

__all__ = ["read_nastran"]
