"""Parts of mesh files: choice by name, faces of solids, and cells given twice."""

from fedic.io.mesh_parts._choice import check_whole, chosen
from fedic.io.mesh_parts._faces import SOLIDS, boundary_faces, faces_of
from fedic.io.mesh_parts._repeated import without_repeated_cells

__all__ = ["SOLIDS", "boundary_faces", "check_whole", "chosen", "faces_of", "without_repeated_cells"]
