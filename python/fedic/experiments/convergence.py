"""Convergence: the largest motions found from each start, and the numbers of iterations."""

from typing import Any, Literal, TypeAlias

import numpy as np

from fedic._internal.types import CellName, Image
from fedic.correlation import Correlator
from fedic.demo.scene import SPECKLE
from fedic.errors import SolveError
from fedic.experiments.convergence_claims import claims_of
from fedic.experiments.convergence_figures import basin_figure, iteration_figure
from fedic.experiments.motions import Motion, Scene, scenes
from fedic.experiments.outcome import Claim, Outcome, Request, Row

__all__ = ["run"]

_Start: TypeAlias = Literal["zero", "pyramid", "fft"]

STARTS: tuple[_Start, ...] = ("zero", "pyramid", "fft")
MESHES: tuple[tuple[CellName, int], ...] = (
    ("quad", 8),
    ("quad", 20),
    ("quad", 40),
    ("triangle", 20),
    ("triangle6", 40),
    ("quad8", 40),
)
QUICK_MESHES: tuple[tuple[CellName, int], ...] = (("quad", 8), ("quad", 20), ("quad", 40))
MOTIONS: dict[str, tuple[float, ...]] = {
    "translation": (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 160, 200),
    "rotation": (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30),
    "stretch": (1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30),
}
"""Motions in pixels, degrees and percent, tried in order until one is not found."""
QUICK_MOTIONS: dict[str, tuple[float, ...]] = {
    "translation": (1, 2, 4, 8, 48, 200),
    "rotation": (1, 4, 8),
    "stretch": (2, 10),
}
TURNS = (30.0, -30.0)
"""Directions of the translations in degrees; both must be found."""
FOUND = 0.3
"""Largest error of a node, in pixels, of a measurement that found the motion: above the noise of the smallest elements,
below the distance of a wrong minimum."""

NEAR = Motion("translation", 1.0, 30.0)
"""Motion for which iterations are counted, from zero."""
SETTINGS: dict[str, dict[str, Any]] = {
    "default": {},
    "tolerance 1e-2 px": {"tolerance": 1e-2},
    "tolerance 1e-4 px": {"tolerance": 1e-4},
    "tolerance 1e-5 px": {"tolerance": 1e-5},
    'hessian="updated"': {"hessian": "updated"},
    "no smoothing": {"smoothing": 0.0},
    "bspline3": {"interpolation": "bspline3"},
    "bicubic": {"interpolation": "bicubic"},
    "bilinear": {"interpolation": "bilinear"},
    "finite-difference": {"gradient": "finite-difference"},
    "finite-difference, no smoothing": {"gradient": "finite-difference", "smoothing": 0.0},
    "bicubic, finite-difference, no smoothing": {
        "interpolation": "bicubic",
        "gradient": "finite-difference",
        "smoothing": 0.0,
    },
    "analytic, 1e-5 px, no smoothing": {"smoothing": 0.0, "tolerance": 1e-5},
    "finite-difference, 1e-5 px, no smoothing": {
        "gradient": "finite-difference",
        "smoothing": 0.0,
        "tolerance": 1e-5,
    },
}


def run(request: Request) -> Outcome:
    """Find the largest motions from each start, and count iterations from within a pixel.

    Parameters
    ----------
    request : Request
        Its image, if given, is measured in addition to the synthetic one.

    Returns
    -------
    Outcome
        Rows over image, study, cell, size, variant (the start or the setting) and motion.
    """
    found = scenes(request)
    meshes = QUICK_MESHES if request.quick else MESHES
    rows: list[Row] = []
    claims: list[Claim] = []
    done = 0
    for scene in found:
        study = _SceneStudy(scene, QUICK_MOTIONS if request.quick else MOTIONS)
        own: list[Row] = []
        for cell, size in meshes:
            own += study.basins(cell, size) + study.iterations(cell, size)
            done += 1
            request.report(done / (len(found) * len(meshes)))
        rows += own
        claims += claims_of(own)
    return Outcome(
        "convergence",
        "How far the start may be, and how many iterations it takes",
        _TEXT,
        rows,
        claims,
        {"": basin_figure(rows), "iterations": iteration_figure(rows)},
    )


_TEXT = f"""\
The whole image is translated (along two directions {TURNS[0] - TURNS[1]:g} degrees apart), rotated or stretched along
the columns about the middle of a mesh of 200 x 240 px, by more and more; each ladder is climbed until a measurement
with the default options misses the truth at some node by more than {FOUND:g} px or does not converge. *zero*,
*pyramid* and *fft* are the values of `initial`. The synthetic image has speckles of {SPECKLE:g} px and is rendered
anew for each motion; the real one is resampled by Lanczos interpolation.

**Which start:** *zero* for motions below a speckle; *pyramid* for motions of tens of pixels, rotations and stretches;
*fft* for translations of any length that leave the mesh in the image, but rotations and stretches only as small as
*zero* takes. Small elements start from nearer than large ones.

The iterations are counted from zero for a translation of {NEAR.amount:g} px, with a tolerance of 1e-3 px where none
is named.
"""


class _SceneStudy:
    """Measurements of one scene, whose moved images are cached."""

    def __init__(self, scene: Scene, motions: dict[str, tuple[float, ...]]) -> None:
        self._scene = scene
        self._motions = motions
        self._images: dict[Motion, Image] = {}

    def basins(self, cell: CellName, size: int) -> list[Row]:
        """Measure growing motions from every start, up to the first failure."""
        correlator = Correlator(self._scene.reference, self._scene.mesh(size, cell))
        rows: list[Row] = []
        for start in STARTS:
            for kind, amounts in self._motions.items():
                for amount in amounts:
                    turns = TURNS if kind == "translation" else (0.0,)
                    tried = [
                        self._measure(correlator, Motion(kind, float(amount), turn), (cell, size), "basin", start)
                        for turn in turns
                    ]
                    rows += tried
                    if not all(row["found"] for row in tried):
                        break
        return rows

    def iterations(self, cell: CellName, size: int) -> list[Row]:
        """Count the iterations of every setting."""
        rows = []
        for setting, options in SETTINGS.items():
            correlator = Correlator(self._scene.reference, self._scene.mesh(size, cell), **options)
            rows.append(self._measure(correlator, NEAR, (cell, size), "iterations", setting))
        return rows

    def _measure(
        self, correlator: Correlator, motion: Motion, mesh: tuple[CellName, int], study: str, variant: str
    ) -> Row:
        if motion not in self._images:
            self._images[motion] = self._scene.moved(motion)
        cell, size = mesh
        row: Row = {
            "image": self._scene.name,
            "study": study,
            "cell": cell,
            "size_px": size,
            "variant": variant,
            "motion": motion.kind,
            "amount": motion.amount,
            "turn_deg": motion.turn,
        }
        initial = variant if variant in STARTS else "zero"
        try:
            result = correlator.correlate(self._images[motion], initial)
        except SolveError:
            return row | {"iterations": 0, "error_px": float("nan"), "converged": False, "found": False}
        wrong = result.unchecked_displacement - self._scene.displacement(motion, result.mesh.points)
        error = float(np.linalg.norm(wrong, axis=1).max())
        return row | {
            "iterations": result.iterations,
            "error_px": error,
            "converged": result.converged,
            "found": result.converged and error < FOUND,
        }
