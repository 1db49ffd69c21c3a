"""Mesh files on HDF5 and netCDF: MED, XDMF and Exodus."""

from fedic.io.mesh_formats.hdf._exodus import read_exodus
from fedic.io.mesh_formats.hdf._med import read_med
from fedic.io.mesh_formats.hdf._xdmf import read_xdmf

__all__ = ["read_exodus", "read_med", "read_xdmf"]
