"""Measure damaged specimens with and without robust weights; for docs/damage.md."""

import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import fedic

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

_DRAWS = 5
_BOUNDS = (79.5, 79.5, 239.5, 239.5)
_CELLS = {"quad": 16.0, "triangle": 16.0, "triangle6": 32.0, "quad8": 32.0, "quad9": 32.0}
_OPTIONS: tuple[dict[str, Any], ...] = ({}, {"brightness": "element"}, {"robust": "huber"}, {"robust": "tukey"})


def main() -> None:
    """Print a row for each damage: the error of good nodes, in pixels and in predicted standard deviations."""
    from scenes.damaged_plate import NOISE, damaged, good_nodes, hidden_shares

    warnings.simplefilter("ignore")
    for kind in ("clean", "chips", "crack", "shadow"):
        for cell, size in _CELLS.items():
            row = []
            for options in _OPTIONS if cell == "quad" else _OPTIONS[-1:]:
                squares, predicted, flagged, converged = [], [], [], 0
                for draw in range(_DRAWS):
                    scene, mesh = damaged(kind, draw), fedic.rectangle_mesh(_BOUNDS, size, cell)  # type: ignore[arg-type]
                    result = fedic.correlate(scene.reference, scene.deformed, mesh, noise=NOISE, **options)
                    shares = hidden_shares(mesh, scene)
                    good = good_nodes(mesh, shares)
                    error = result.unchecked_displacement - scene.displacement(mesh.points[:, :2])
                    squares.append((error[good] ** 2).sum(axis=1))
                    predicted.append((result.standard_deviations()[good] ** 2).sum(axis=1))
                    flagged.append((result.quality.cell_flags[shares == 0.0] != 0).mean())
                    converged += result.converged
                rms = np.sqrt(np.mean(np.concatenate(squares)))
                ratio = rms / np.sqrt(np.nanmean(np.concatenate(predicted)))
                row.append(f"{rms:.3f} px, {ratio:.2f} sd, {converged}/{_DRAWS}, flagged {np.mean(flagged):.1%}")
            print(f"{kind:7}{cell:10}" + " | ".join(row), flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
