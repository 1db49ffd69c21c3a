"""The verdict on a result: evidence of each cell and node, and flags with a reason."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import CELL_FLAGS, INVALID_CELL_FLAGS, NODE_FLAGS, QUALITY_THRESHOLDS, Mesh
from fedic._internal.choices import check_choice
from fedic._internal.types import Floats

__all__ = ["Quality"]

_UNCERTAIN_SHARE = 0.01
"""Largest share of uncertain nodes in a good result."""


@dataclass(frozen=True, eq=False, repr=False)
class Quality:
    """What the images tell of the error of a result.

    A cell with the flag ``"few-points"``, ``"uncorrelated"``, ``"weak-texture"``, ``"folded"`` or ``"damaged"`` is not
    valid; one with another flag is doubtful. A node without any valid cell is not measured: its displacement is NaN.
    Other nodes with a flag keep their displacement, which is doubtful. `flags` gives the reason for each flag,
    docs/verdict.md the rules.

    Attributes
    ----------
    noise : float
        Standard deviation of the noise of one image, in grey levels: the option ``noise``, or estimated from the
        residual; NaN if no cell of the images correlates.
    used_share : ndarray of float, shape (num_cells,)
        Share of the area of each cell that was used: inside both images, not masked, not saturated.
    kept_share : ndarray of float, shape (num_cells,)
        Share of the weight of each cell that robust weights keep; 1 in cells without outliers.
    correlation : ndarray of float, shape (num_cells,)
        Correlation coefficient of the two images in each cell; NaN without points.
    normalized_residual : ndarray of float, shape (num_cells,)
        Residual of each cell, without a gain and offset of its own, divided by that of the noise; NaN without points.
    misfit : ndarray of float, shape (num_cells,)
        Displacement in pixels, root mean square over the cell, that would explain the residual beyond the noise.
    standard_deviation : ndarray of float, shape (n,)
        Standard deviation of each node due to the noise, in pixels, in its worst direction. From the node's own block
        of the Hessian, as if its neighbours were known; without a regularization. Infinite without texture.
    conditioning : ndarray of float, shape (n,)
        Standard deviation of each node in its best direction divided by that in the worst: near zero where the texture
        has one direction only; NaN without points.
    repeats : ndarray of float, shape (k, 2)
        Translations in pixels at which the texture of the reference image resembles itself: every displacement may be
        wrong by one of them. Empty if the texture is not periodic.
    saturated_share : tuple of float
        Share of saturated pixels of the reference image near the mesh and of the deformed image.
    converged : bool
        Whether the iterations converged.
    cell_flags, node_flags : ndarray of uint8, shapes (num_cells,) and (n,)
        Bits of the flags, in the order of ``flags["cells"]`` and ``flags["nodes"]``.
    """

    noise: float
    used_share: Floats
    kept_share: Floats
    correlation: Floats
    normalized_residual: Floats
    misfit: Floats
    standard_deviation: Floats
    conditioning: Floats
    repeats: Floats
    saturated_share: tuple[float, float]
    converged: bool
    cell_flags: NDArray[np.uint8]
    node_flags: NDArray[np.uint8]

    @property
    def thresholds(self) -> dict[str, float]:
        """Thresholds of the flags, in pixels where they are displacements; see docs/verdict.md."""
        return dict(QUALITY_THRESHOLDS)

    @property
    def flags(self) -> dict[str, dict[str, str]]:
        """Names of the flags of ``"cells"`` and ``"nodes"`` in the order of their bits, with their reasons."""
        return {"cells": dict(CELL_FLAGS), "nodes": dict(NODE_FLAGS)}

    @property
    def valid_cells(self) -> NDArray[np.bool_]:
        """Cells whose texture was measured, shape (num_cells,): without a flag, or a doubtful one only."""
        valid = np.ones(self.cell_flags.shape, dtype=bool)
        for name in INVALID_CELL_FLAGS:
            valid &= ~self._has(name, self.cell_flags, CELL_FLAGS)
        return valid

    @property
    def valid_nodes(self) -> NDArray[np.bool_]:
        """Nodes with at least one valid cell, shape (n,)."""
        return ~self._has("not-measured", self.node_flags, NODE_FLAGS)

    @property
    def flagged_share(self) -> float:
        """Share of cells that are flagged, from 0 to 1."""
        return float(np.mean(self.cell_flags != 0)) if self.cell_flags.size else 0.0

    @property
    def is_good(self) -> bool:
        """Whether nothing is doubtful.

        The iterations converged, no cell is flagged, the texture is not periodic, and at most one measured node in a
        hundred is uncertain.
        """
        return (
            self.converged
            and not self.cell_flags.any()
            and not len(self.repeats)
            and self._measured_with("uncertain").sum() <= _UNCERTAIN_SHARE * self.valid_nodes.sum()
        )

    def cells(self, flag: str) -> NDArray[np.int64]:
        """Return the cells with a flag.

        Parameters
        ----------
        flag : str
            One of ``flags["cells"]``.

        Returns
        -------
        ndarray of int, shape (k,)
            Indices of the cells.

        Raises
        ------
        OptionError
            If there is no such flag.
        """
        check_choice("flag", flag, CELL_FLAGS)
        return np.flatnonzero(self._has(flag, self.cell_flags, CELL_FLAGS))

    def nodes(self, flag: str) -> NDArray[np.int64]:
        """Return the nodes with a flag.

        Parameters
        ----------
        flag : str
            One of ``flags["nodes"]``.

        Returns
        -------
        ndarray of int, shape (k,)
            Indices of the nodes.

        Raises
        ------
        OptionError
            If there is no such flag.
        """
        check_choice("flag", flag, NODE_FLAGS)
        return np.flatnonzero(self._has(flag, self.node_flags, NODE_FLAGS))

    def reasons(self) -> list[str]:
        """Return what is doubtful.

        Returns
        -------
        list of str
            A clause each, the most serious first; empty if no flag is set.
        """
        found = [] if self.converged else ["the iterations did not converge"]
        total = self.cell_flags.size
        for name in CELL_FLAGS:
            count = len(self.cells(name))
            if count:
                found.append(f"{count} of {total} cells are flagged {name!r}: {_lower(CELL_FLAGS[name])}")
        count = int(self._measured_with("uncertain").sum())
        if count:
            found.append(f"{count} measured nodes are flagged 'uncertain': {_lower(NODE_FLAGS['uncertain'])}")
        if len(self.repeats):
            u, v = self.repeats[0]
            found.append(
                f"the texture repeats itself every ({u:.0f}, {v:.0f}) px: all displacements may be wrong by a multiple "
                "of it; give an initial displacement that is right to less than half of it"
            )
        return found

    def summary(self) -> dict[str, Any]:
        """Return the verdict as JSON types.

        Returns
        -------
        dict
            ``good``, ``reasons`` (list of str), ``noise`` (None if unknown), ``flagged_cells`` and ``flagged_nodes``
            (number by flag), ``saturated_share`` and ``repeats``.
        """
        return {
            "good": bool(self.is_good),
            "reasons": self.reasons(),
            "noise": float(self.noise) if np.isfinite(self.noise) else None,
            "flagged_cells": {name: len(self.cells(name)) for name in CELL_FLAGS},
            "flagged_nodes": {name: len(self.nodes(name)) for name in NODE_FLAGS},
            "saturated_share": list(self.saturated_share),
            "repeats": self.repeats.tolist(),
        }

    def __repr__(self) -> str:
        reasons = "".join(f"; {reason}" for reason in self.reasons())
        return f"Quality({'good' if self.is_good else 'doubtful'}{reasons})"

    @classmethod
    def unknown(cls, mesh: Mesh, *, converged: bool) -> "Quality":
        """Return a verdict without evidence or flags, for a displacement that was not measured here.

        Parameters
        ----------
        mesh : Mesh
            The mesh.
        converged : bool
            Whether the displacement is final.

        Returns
        -------
        Quality
            All evidence is NaN.
        """
        cells, nodes = (np.full(count, np.nan) for count in (mesh.num_cells, mesh.num_nodes))
        unflagged = (np.zeros(count, dtype=np.uint8) for count in (mesh.num_cells, mesh.num_nodes))
        return cls(
            np.nan, cells, cells, cells, cells, cells, nodes, nodes, np.empty((0, 2)), (0.0, 0.0), converged, *unflagged
        )

    def _measured_with(self, flag: str) -> NDArray[np.bool_]:
        return self._has(flag, self.node_flags, NODE_FLAGS) & self.valid_nodes

    @staticmethod
    def _has(flag: str, bits: NDArray[np.uint8], flags: dict[str, str]) -> NDArray[np.bool_]:
        found: NDArray[np.bool_] = bits & (1 << list(flags).index(flag)) != 0
        return found


def _lower(sentence: str) -> str:
    return sentence[0].lower() + sentence[1:].rstrip(".")
