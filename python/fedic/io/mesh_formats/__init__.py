"""Formats of mesh files: a module or package each, which returns the contents as a `fedic.io._mesh_file.MeshFile`.

A format is added by its reader here and one line in the table of ``_readers.py``; a reader that calls a library which
may not end goes through ``_process.py``. A writer is added in ``_writers.py``. Its variants are tested and listed by
``tools/formats``.
"""

from fedic.io.mesh_formats._readers import mesh_reader
from fedic.io.mesh_formats._writers import mesh_writer

__all__ = ["mesh_reader", "mesh_writer"]
