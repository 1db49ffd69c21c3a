"""Unstructured meshes of a polygon with holes, made by Gmsh."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic._core import CELL_TYPES, CellType, Mesh
from fedic._internal.types import CellName, Floats
from fedic.errors import MeshError

__all__ = ["unstructured_mesh"]

_MODEL = "fedic"
_FRONTAL_DELAUNAY, _FRONTAL_DELAUNAY_FOR_QUADS = 6, 8
_BLOSSOM = 1
_NO_SUBDIVISION, _ALL_QUADS = 0, 1
_AREA_TOLERANCE = 1e-6
_one_at_a_time = threading.Lock()


def unstructured_mesh(
    outline: ArrayLike, size: float, cell: CellName = "triangle", holes: Sequence[ArrayLike] = ()
) -> Mesh:
    """Mesh the inside of a polygon, without its holes.

    Needs the extra ``fedic[gmsh]``. The same arguments give the same mesh.

    Parameters
    ----------
    outline : array_like, shape (n, 2)
        The corners of the polygon in order, either way round, in the mesh's unit. Its edges stay straight.
    size : float
        Length of the cells' edges, in the mesh's unit.
    cell : str
        Type of the cells, a name of `CELL_TYPES`.
    holes : sequence of array_like, shape (k, 2)
        Polygons inside the outline, apart from each other. Give a round hole enough corners: each of its edges is an
        edge of one cell or more.

    Returns
    -------
    Mesh
        In the plane, ``points`` of shape (m, 2).

    Raises
    ------
    MeshError
        If Gmsh is not installed, an argument is out of its range, or the polygons cross.
    """
    names = [name for name, each in CELL_TYPES.items() if each.gmsh_order is not None]
    if cell not in names:
        raise MeshError(f"unstructured_mesh: cell is {cell!r}; choose one of {', '.join(names)}.")
    cell_type = CELL_TYPES[cell]
    if not (np.isfinite(size) and size > 0.0):
        raise MeshError(f"unstructured_mesh: size is {size!r}; give a positive length in the mesh's unit.")
    border = _polygon(outline, "outline")
    inner = [_polygon(hole, f"holes[{index}]") for index, hole in enumerate(holes)]
    _check_apart([border, *inner])
    gmsh = _import_gmsh()
    with _one_at_a_time, _session(gmsh, cell_type):
        try:
            tags, coordinates, connectivity = _generate(gmsh, [border, *inner], size, cell_type)
        except Exception as error:  # gmsh raises nothing more precise
            raise MeshError(f"unstructured_mesh: Gmsh could not mesh the polygon ({error}).") from error
    if len(connectivity) == 0:
        raise MeshError("unstructured_mesh: Gmsh made no cell; check the outline, the holes and the size.")

    used, cells = np.unique(connectivity, return_inverse=True)
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags, used, sorter=order)]
    points = np.ascontiguousarray(coordinates.reshape(-1, 3)[rows, :2])
    mesh = Mesh(points, {cell: cells.reshape(-1, cell_type.num_nodes)})

    expected = _area(border) - sum(_area(hole) for hole in inner)
    if abs(float(mesh.areas().sum()) - expected) > _AREA_TOLERANCE * _area(border):
        raise MeshError(
            "unstructured_mesh: the mesh does not cover the polygon; the holes must lie inside the outline, and none "
            "inside another."
        )
    return mesh


def _import_gmsh() -> ModuleType:
    try:
        import gmsh
    except ImportError as error:
        raise MeshError("unstructured_mesh needs Gmsh, which is not installed: pip install fedic[gmsh]") from error
    except OSError as error:
        raise MeshError(
            f"unstructured_mesh needs Gmsh (pip install fedic[gmsh]); it is installed but a system library it needs is "
            f"missing ({error})."
        ) from error
    module: ModuleType = gmsh
    return module


def _polygon(corners: ArrayLike, name: str) -> Floats:
    try:
        polygon = np.asarray(corners, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise MeshError(f"unstructured_mesh: {name} is not an array of numbers of shape (n, 2) ({error}).") from error
    if polygon.ndim != 2 or polygon.shape[1] != 2 or not np.isfinite(polygon).all():
        raise MeshError(f"unstructured_mesh: {name} has shape {polygon.shape}; give finite corners of shape (n, 2).")
    if len(polygon) > 1 and (polygon[0] == polygon[-1]).all():
        polygon = polygon[:-1]
    if len(polygon) < 3 or _area(polygon) == 0.0:
        raise MeshError(f"unstructured_mesh: {name} encloses no area; give at least three corners, not in a line.")
    return polygon


def _area(polygon: Floats) -> float:
    x, y = (polygon - polygon.mean(axis=0)).T
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2.0


def _check_apart(polygons: list[Floats]) -> None:
    """Refuse edges that cross or touch, on which Gmsh may never end."""
    start = np.concatenate(polygons)
    end = np.concatenate([np.roll(polygon, -1, axis=0) for polygon in polygons])
    low, high = np.minimum(start, end), np.maximum(start, end)

    def side(point: Floats) -> Floats:
        """Of which side of edge i (row) is each point (column)."""
        edge = (end - start)[:, np.newaxis]
        offset = point[np.newaxis] - start[:, np.newaxis]
        sign: Floats = np.sign(edge[..., 0] * offset[..., 1] - edge[..., 1] * offset[..., 0])
        return sign

    astride = side(start) * side(end) <= 0.0
    boxes_meet = ((low[:, np.newaxis] <= high) & (low <= high[:, np.newaxis])).all(axis=-1)
    number = np.concatenate([np.full(len(polygon), index) for index, polygon in enumerate(polygons)])
    following = np.concatenate([np.roll(np.arange(len(p)), -1) for p in polygons])
    position = np.concatenate([np.arange(len(p)) for p in polygons])
    same = number[:, np.newaxis] == number
    consecutive = same & (following[:, np.newaxis] == position)
    neighbours = consecutive | consecutive.T | np.eye(len(start), dtype=bool)
    meeting = np.argwhere(astride & astride.T & boxes_meet & ~neighbours)
    if len(meeting):
        x, y = start[meeting[0][0]]
        raise MeshError(
            f"unstructured_mesh: edges of the outline or of the holes cross or touch, one starting at ({x:g}, {y:g}); "
            "the polygons must not cross themselves nor each other."
        )


def _generate(
    gmsh: ModuleType, polygons: list[Floats], size: float, cell_type: CellType
) -> tuple[NDArray[np.int64], Floats, NDArray[np.int64]]:
    """Return the tags of the nodes, their coordinates and the nodes of the cells, all flat."""
    _fill(gmsh, polygons, size)

    def code(family: str) -> int:
        number: int = gmsh.model.mesh.getElementType(family, cell_type.gmsh_order, cell_type.gmsh_incomplete)
        return number

    if not cell_type.is_triangle and len(gmsh.model.mesh.getElementsByType(code("Triangle"))[0]):
        # An odd number of edges on the border leaves triangles: cut a mesh twice as coarse into quadrilaterals.
        gmsh.model.remove()
        gmsh.model.add(_MODEL)
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", _ALL_QUADS)
        _fill(gmsh, polygons, 2.0 * size)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, connectivity = gmsh.model.mesh.getElementsByType(code("Triangle" if cell_type.is_triangle else "Quadrangle"))
    return (
        np.asarray(tags, dtype=np.int64),
        np.asarray(coordinates, dtype=np.float64),
        np.asarray(connectivity, dtype=np.int64),
    )


def _fill(gmsh: ModuleType, polygons: list[Floats], size: float) -> None:
    geometry = gmsh.model.geo
    loops = []
    for polygon in polygons:
        corners = [geometry.addPoint(x, y, 0.0, size) for x, y in polygon]
        edges = [geometry.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        loops.append(geometry.addCurveLoop(edges))
    geometry.addPlaneSurface(loops)
    geometry.synchronize()
    gmsh.model.mesh.generate(2)


@contextmanager
def _session(gmsh: ModuleType, cell_type: CellType) -> Iterator[None]:
    """Run in a model of its own, and leave Gmsh as the caller had it."""
    quads = not cell_type.is_triangle
    options = {
        "General.Terminal": 0.0,
        "Mesh.Algorithm": float(_FRONTAL_DELAUNAY_FOR_QUADS if quads else _FRONTAL_DELAUNAY),
        "Mesh.RecombineAll": float(quads),
        "Mesh.RecombinationAlgorithm": float(_BLOSSOM),
        "Mesh.SubdivisionAlgorithm": float(_NO_SUBDIVISION),
        "Mesh.ElementOrder": float(cell_type.gmsh_order or 1),
        "Mesh.SecondOrderIncomplete": float(cell_type.gmsh_incomplete),
    }
    callers_session = bool(gmsh.isInitialized())
    if not callers_session:
        gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    callers_model = gmsh.model.getCurrent() if callers_session else ""
    callers_options = {name: gmsh.option.getNumber(name) for name in options}
    try:
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add(_MODEL)
        yield
    finally:
        if callers_session:
            gmsh.model.remove()
            gmsh.model.setCurrent(callers_model)
            for name, value in callers_options.items():
                gmsh.option.setNumber(name, value)
        else:
            gmsh.finalize()
