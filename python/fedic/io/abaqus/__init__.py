"""Mesh files of Abaqus."""

from fedic.io.abaqus.reader import read_abaqus

__all__ = ["read_abaqus"]
