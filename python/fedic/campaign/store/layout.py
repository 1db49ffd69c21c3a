"""Layout of the file of a campaign: groups, names, types and shapes.

The group ``VTKHDF`` is that of VTK's format for an unstructured grid with steps: the mesh once, the fields of all
frames one after the other. The group ``fedic`` beside it holds what VTK has no place for. docs/campaign-files.md
describes both.
"""

from dataclasses import dataclass
from typing import Literal

from fedic._core import Mesh
from fedic.results.strains import StrainMeasure, strain_fields

__all__ = [
    "COLUMNS",
    "FORMAT",
    "HISTORY_ROWS",
    "INFORMATION",
    "REPEATS",
    "UNCHECKED",
    "VTK_VERSION",
    "Column",
    "Field",
    "fields",
]

FORMAT = 1
"""Version of the group ``fedic``; files of another one are refused."""
VTK_VERSION = (2, 1)
HISTORY_ROWS = 128
"""Iterations that are kept of a frame: the last ones."""
REPEATS = 4
"""Translations of a periodic texture that are kept."""
UNCHECKED = "unchecked_displacement"
"""Dataset of the displacements as the iterations left them, (frames * n, 2)."""
INFORMATION = "information"
"""Dataset of the factors of the cells on the Hessian and on the noise, (frames * m, 2); see `Result.information`."""


@dataclass(frozen=True)
class Field:
    """A field of every frame, stored for all frames one after the other.

    Attributes
    ----------
    group : {"PointData", "CellData"}
        On the nodes or on the cells.
    name : str
        Its name.
    components : int
        Number of components; 1 for an array of one dimension.
    dtype : str
        Its type.
    """

    group: Literal["PointData", "CellData"]
    name: str
    components: int
    dtype: str

    def rows(self, mesh: Mesh) -> int:
        """Return the number of rows of one frame."""
        return mesh.num_nodes if self.group == "PointData" else mesh.num_cells


@dataclass(frozen=True)
class Column:
    """A value of every frame, a row of a dataset of the group ``fedic/frames``."""

    name: str
    dtype: str
    shape: tuple[int, ...] = ()


def fields(measure: StrainMeasure, *, drift: bool) -> list[Field]:
    """Return the fields of a file.

    Parameters
    ----------
    measure : {"green-lagrange", "hencky", "small"}
        Measure of the strains.
    drift : bool
        Whether the reference image may be updated.

    Returns
    -------
    list of Field
        Those of the nodes first.
    """
    nodal = [
        Field("PointData", "displacement", 3, "f8"),
        Field("PointData", "displacement_px", 3, "f4"),
        Field("PointData", "standard_deviation", 3, "f4"),
        Field("PointData", "standard_deviation_px", 1, "f4"),
        Field("PointData", "conditioning", 1, "f4"),
        Field("PointData", "flags", 1, "u1"),
    ]
    if drift:
        nodal.append(Field("PointData", "drift", 3, "f4"))
    cells = [
        Field("CellData", name, 1, "f4")
        for deviation in (False, True)
        for name in strain_fields(measure, deviation=deviation)
    ]
    evidence = ("residual", "correlation", "used_share", "kept_share", "normalized_residual", "misfit")
    cells += [Field("CellData", name, 1, "f4") for name in evidence]
    cells += [Field("CellData", name, 1, "u1") for name in ("outside", "flags")]
    return nodal + cells


COLUMNS = (
    Column("name", "S256"),
    Column("image", "S2048"),
    Column("time", "f8"),
    Column("error", "S1024"),
    Column("converged", "u1"),
    Column("good", "u1"),
    Column("residual_rms", "f8"),
    Column("error_left", "f8"),
    Column("noise", "f8"),
    Column("iterations", "i4"),
    Column("num_points", "i8"),
    Column("reference", "i4"),
    Column("start", "S32"),
    Column("has_information", "u1"),
    Column("has_weights", "u1"),
    Column("saturated_share", "f8", (2,)),
    Column("repeats", "f8", (REPEATS, 2)),
    Column("attempts", "S4096"),
    Column("history", "f8", (HISTORY_ROWS, 4)),
    Column("checksum", "i8"),
    Column("seconds", "f8"),
)
"""Values of the frames; ``seconds`` is a clock reading, the others are the same in every run."""
