"""The covariance of a displacement due to the noise of the images, and of what is derived from it."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fedic import _core
from fedic._core import STRAIN_MEASURES, Mesh
from fedic._internal.choices import check_choice
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.results.strains import StrainMeasure

__all__ = ["Covariance"]


@dataclass(frozen=True, eq=False, repr=False)
class Covariance:
    """Covariance of the displacement of the nodes, predicted from the noise of the images.

    ``C = 2 noise^2 A^-1 B A^-1``; see `Correlator.standard_deviations`. Neighbouring nodes are correlated: the standard
    deviation of a strain, a gauge or a point between nodes does not follow from those of the nodes alone.

    The correlator prepares it once for the reference image and the points used, for about six factorisations of the
    system, and carries it to the displacement and noise of each frame in milliseconds.

    Attributes
    ----------
    mesh : Mesh
        The mesh.
    noise : float
        Standard deviation of the noise of one image, in grey levels.
    valid_nodes, valid_cells : ndarray of bool, shapes (n,) and (num_cells,)
        Nodes and cells that were measured.
    """

    mesh: Mesh
    noise: float
    valid_nodes: NDArray[np.bool_]
    valid_cells: NDArray[np.bool_]
    _prediction: "_core.Covariance" = field(repr=False)

    def __repr__(self) -> str:
        deviations = self.standard_deviations
        known = deviations[np.isfinite(deviations)]
        median = float(np.median(known)) if known.size else float("nan")
        return f"Covariance({self.mesh.num_nodes} nodes, noise={self.noise:.3g}, median deviation {median:.3g})"

    @property
    def nodes(self) -> Floats:
        """Covariance of the displacement of each node, (n, 2, 2), in the square of the mesh's unit.

        NaN at nodes that were not measured.
        """
        blocks = self._prediction.nodes()
        blocks[~self.valid_nodes] = np.nan
        return blocks

    @property
    def standard_deviations(self) -> Floats:
        """Standard deviation of the displacement of each node, (n, 2), in the mesh's unit; NaN where not measured."""
        return np.sqrt(np.diagonal(self.nodes, axis1=1, axis2=2))

    def at(self, points: ArrayLike) -> Floats:
        """Return the covariance of the displacement at points.

        Parameters
        ----------
        points : array_like, shape (m, 2)
            Points of the ``(x, y)`` plane, in the mesh's unit.

        Returns
        -------
        ndarray of float, shape (m, 2, 2)
            In the square of the mesh's unit; NaN outside the mesh.
        """
        return self._prediction.at_points(points)

    def strains(self, measure: StrainMeasure = "green-lagrange") -> Floats:
        """Return the covariance of the strain at the centre of each cell.

        Parameters
        ----------
        measure : {"green-lagrange", "hencky", "small"}
            Strain measure.

        Returns
        -------
        ndarray of float, shape (num_cells, 3, 3)
            Of ``exx, eyy, exy`` along the axes of `Mesh.strains`, to first order in the noise; NaN in cells that are
            not valid.

        Raises
        ------
        OptionError
            If the measure is unknown.
        """
        check_choice("measure", measure, STRAIN_MEASURES)
        covariance = self._prediction.cell_strains(measure)
        covariance[~self.valid_cells] = np.nan
        return covariance

    def strain_deviations(self, measure: StrainMeasure = "green-lagrange") -> Floats:
        """Return the standard deviation of the strain at the centre of each cell.

        Parameters
        ----------
        measure : {"green-lagrange", "hencky", "small"}
            Strain measure.

        Returns
        -------
        ndarray of float, shape (num_cells, 3)
            Of ``exx, eyy, exy``; NaN in cells that are not valid.

        Raises
        ------
        OptionError
            If the measure is unknown.
        """
        return np.sqrt(np.diagonal(self.strains(measure), axis1=1, axis2=2))

    def gauge(self, points: ArrayLike, measure: StrainMeasure = "green-lagrange") -> Floats:
        """Return the covariance of the strain of a gauge: that of the mean strain over points, to first order.

        Parameters
        ----------
        points : array_like, shape (m, 2)
            Points spread over the gauge, such as those of a grid, in the mesh's unit.
        measure : {"green-lagrange", "hencky", "small"}
            Strain measure.

        Returns
        -------
        ndarray of float, shape (3, 3)
            Of ``exx, eyy, exy``; NaN if a point lies outside the mesh. The cost is three solutions of the system.

        Raises
        ------
        OptionError
            If the measure is unknown.
        """
        check_choice("measure", measure, STRAIN_MEASURES)
        return self._prediction.mean_strain(points, measure)

    def of(self, weights: ArrayLike) -> Floats:
        """Return the covariance of linear functions of the displacement.

        Parameters
        ----------
        weights : array_like, shape (k, n, 2)
            Weight of every component of every node in each function: the elongation between nodes ``a`` and ``b`` along
            ``x`` has -1 at ``[a, 0]`` and 1 at ``[b, 0]``.

        Returns
        -------
        ndarray of float, shape (k, k)
            NaN where a function has a node that was not measured. The cost is one solution of the system a function,
            or none if all nodes share cells with one another.

        Raises
        ------
        OptionError
            If the weights have another shape.
        """
        given = np.asarray(weights, dtype=np.float64)
        if given.ndim != 3 or given.shape[1:] != (self.mesh.num_nodes, 2):
            raise OptionError(
                f"weights has shape {given.shape}; give the weight of every component of every node for each function, "
                f"shape (k, {self.mesh.num_nodes}, 2)",
                "weights",
            )
        covariance = self._prediction.of_functions(given.reshape(-1, 2), len(given))
        unknown = (given[:, ~self.valid_nodes] != 0).any(axis=(1, 2))
        covariance[unknown] = covariance[:, unknown] = np.nan
        return covariance

    def of_total(self, mesh: Mesh, displacement: ArrayLike) -> "Covariance":
        """Return the same covariance of the nodes, for strains, gauges and points of another configuration.

        A series may be measured from an intermediate image, on the mesh moved there, while its strains refer to the
        first mesh. The noise is that of the last step alone: of the intermediate and the deformed image.

        Parameters
        ----------
        mesh : Mesh
            The same cells on other points, to which the strains refer: the first mesh.
        displacement : array_like, shape (n, 2)
            Total displacement from that mesh, in its unit. Nodes that were not measured may be NaN.

        Returns
        -------
        Covariance
            Of the same nodes; `strains` and `gauge` are those of the total displacement, and `at` and `gauge` take
            points of that mesh.

        Raises
        ------
        OptionError
            If the mesh has other cells, or the displacement another shape or a node that was measured is not finite.
        """
        total = np.array(displacement, dtype=np.float64)
        if total.shape != (self.mesh.num_nodes, 2) or not np.isfinite(total[self.valid_nodes]).all():
            raise OptionError(
                f"displacement must have one finite value per component and node that was measured, shape "
                f"({self.mesh.num_nodes}, 2), got shape {total.shape}",
                "displacement",
            )
        total[~np.isfinite(total)] = 0.0
        return replace(self, mesh=mesh, _prediction=self._prediction.of_total(mesh, total))
