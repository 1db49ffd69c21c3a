"""Results and series of results that hold given displacements, without images."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

import fedic
from fedic._core import CELL_FLAGS, NODE_FLAGS
from fedic.results.pixels import pixel_displacement

Floats = NDArray[np.float64]


def result_of(
    mesh: fedic.Mesh, displacement: ArrayLike, *, damaged: Sequence[int] = (), camera: object = None, unit: str = "mm"
) -> fedic.Result:
    """Return a result with a displacement; the damaged cells are not valid, and nodes of no other cell are NaN."""
    unchecked = np.array(displacement, dtype=float)
    cell_flags, node_flags = (np.zeros(count, dtype=np.uint8) for count in (mesh.num_cells, mesh.num_nodes))
    cell_flags[list(damaged)] = 1 << list(CELL_FLAGS).index("damaged")
    connectivity = [nodes for block in mesh.cells.values() for nodes in block]
    valid = np.zeros(mesh.num_nodes, dtype=bool)
    for cell, nodes in enumerate(connectivity):
        valid[nodes] |= not cell_flags[cell]
    node_flags[~valid] = 1 << list(NODE_FLAGS).index("not-measured")
    cells, nodes = np.full(mesh.num_cells, 0.9), np.full(mesh.num_nodes, 0.01)
    quality = fedic.Quality(
        2.0, cells, cells, cells, cells, cells, nodes, nodes, np.empty((0, 2)), (0.0, 0.0), True, cell_flags, node_flags
    )
    camera = camera or fedic.FrontParallel(10.0, (0.0, 1000.0))
    measured = np.where(valid[:, np.newaxis], unchecked, np.nan)
    return fedic.Result(
        mesh=mesh,
        camera=camera,  # type: ignore[arg-type]
        displacement=measured,
        pixel_displacement=pixel_displacement(camera, mesh.points, measured),  # type: ignore[arg-type]
        converged=True,
        error_left=1e-4,
        iterations=3,
        history=[],
        num_points=100,
        residual_rms=2.5,
        cell_residuals=np.arange(mesh.num_cells, dtype=float),
        outside_cells=np.empty(0, dtype=np.int64),
        unchecked_displacement=unchecked,
        quality=quality,
        start="zero",
        unit=unit,
    )


@dataclass
class Frame:
    """A frame of a series."""

    index: int
    name: str
    time: float = float("nan")
    error: str = ""
    residual_rms: float = 2.5
    converged: bool = True
    good: bool = True


@dataclass
class Fields:
    """A series of results in memory; None is a frame that failed."""

    mesh: fedic.Mesh
    results: Sequence[fedic.Result | None]
    times: Sequence[float] | None = None
    unit: str = "mm"
    read: list[int] = field(default_factory=list)

    @property
    def frames(self) -> list[Frame]:
        times = self.times or [float(index) for index in range(len(self.results))]
        return [
            Frame(index, f"image_{index}.tif", times[index])
            if result is not None
            else Frame(index, f"image_{index}.tif", times[index], "no texture", float("nan"), False, False)
            for index, result in enumerate(self.results)
        ]

    def result(self, index: int) -> fedic.Result:
        self.read.append(index)
        found = self.results[index]
        assert found is not None
        return found

    def covariance(self, index: int) -> fedic.Covariance | None:
        try:
            return self.result(index).covariance()
        except fedic.FedicError:
            return None
