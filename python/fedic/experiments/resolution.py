"""Noise against resolution on the star of the DIC Challenge 2.0, over cells, sizes and options."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fedic._internal.types import CellName, Floats
from fedic.correlation import correlate
from fedic.experiments.dic_challenge_star import Star, StarMesh, real_star, star_mesh, synthetic_star, turned_mesh
from fedic.experiments.mei import Field, Measured, field_of, measure_merit
from fedic.experiments.option_sets import DEFAULT, PAPER, UNFILTERED
from fedic.experiments.outcome import Outcome, Request
from fedic.experiments.reconstruction import Space, reconstruct
from fedic.experiments.resolution_claims import claims_of
from fedic.experiments.resolution_figures import amplitude_figure, merit_figure, variant_figure
from fedic.quadrature import MeshQuadrature, PixelQuadrature
from fedic.results import Result

__all__ = ["run"]

CellAndSize: TypeAlias = tuple[CellName, int]
Options: TypeAlias = dict[str, Any]

SIZES: dict[CellName, tuple[int, ...]] = {
    "quad": (8, 10, 12, 16, 20, 24, 28, 32),
    "triangle": (8, 12, 16, 20, 24, 28, 32),
    "quad8": (16, 20, 24, 28, 32, 36, 40, 48),
    "quad9": (16, 20, 24, 28, 32, 36, 40, 48),
    "triangle6": (16, 20, 24, 28, 32, 36, 40, 48),
}
COMPARED: dict[CellName, int] = {"quad": 16, "triangle": 16, "quad8": 28, "quad9": 28, "triangle6": 28}
"""One size of each cell type, of similar resolution, for quick runs and for rotated meshes."""
CHOSEN: tuple[CellAndSize, ...] = (("quad8", 28), ("quad", 16), ("triangle6", 28))
"""Cells and sizes on which options are compared."""
BEST, FOUR_NODED = CHOSEN[0], CHOSEN[1]
PLAIN: Options = {**UNFILTERED.options, "quadrature": UNFILTERED.mesh}
WAYS: dict[str, Options] = {
    "default": {**DEFAULT.options, "quadrature": DEFAULT.mesh},
    "rule edges": PLAIN | {"quadrature": MeshQuadrature(rule="edges")},
    "rule diameter": PLAIN | {"quadrature": MeshQuadrature(rule="diameter")},
    "density 2": PLAIN | {"quadrature": MeshQuadrature(density=2.0)},
    "pixel quadrature": PLAIN | {"quadrature": PixelQuadrature()},
    "bspline3": PLAIN | {"interpolation": "bspline3"},
    "bspline3, rule edges": PLAIN | {"interpolation": "bspline3", "quadrature": MeshQuadrature(rule="edges")},
    "bicubic": PLAIN | {"interpolation": "bicubic"},
    "smoothing 0.4 px": PLAIN | {"smoothing": 0.4},
    "smoothing 0.6 px": PLAIN | {"smoothing": 0.6},
    "smoothing 0.8 px": PLAIN | {"smoothing": 0.8},
    "smoothing 1.0 px": PLAIN | {"smoothing": 1.0},
    "no brightness correction": PLAIN | {"brightness": None},
    "brightness by element": PLAIN | {"brightness": "element"},
    "finite-difference gradient": PLAIN | {"gradient": "finite-difference"},
    "paper": {**PAPER.options, "quadrature": PAPER.mesh},
}
QUICK_WAYS = ("default", "rule edges")
FINE = 8
"""Edge, in pixels, of the four-noded elements from which fields are reconstructed."""
SPACES: dict[str, Space] = {
    "8 px nodes to quad": Space("tensor", 1, 2),
    "8 px nodes to quad8": Space("serendipity", 2, 4),
    "8 px nodes to quad9": Space("tensor", 2, 4),
    "8 px nodes to cubic splines": Space("spline", 3, 2),
    "8 px nodes to serendipity of degree 3": Space("serendipity", 3, 5),
    "8 px nodes to serendipity of degree 4": Space("serendipity", 4, 7),
    "8 px nodes to serendipity of degree 6": Space("serendipity", 6, 14),
}
TURN = 45
"""Degrees."""


_Task: TypeAlias = Callable[[], Measured]


def run(request: Request) -> Outcome:
    """Measure the star with every cell, size and set of options.

    Parameters
    ----------
    request : Request
        Its star, if given, is measured in addition to the synthetic one, and all options are compared on it.

    Returns
    -------
    Outcome
        Rows over star, group, variant, cell and size.
    """
    given = [] if request.star is None else [real_star(request.star)]
    stars = [synthetic_star(quick=request.quick), *given]
    tasks = [task for star in stars for task in _tasks(star, request.quick, everything=star is stars[-1])]
    found: list[Measured] = []
    for task in tasks:
        found.append(task())
        request.report(len(found) / len(tasks))
    return Outcome(
        "resolution",
        "Noise against resolution on the star of the DIC Challenge 2.0",
        _TEXT,
        [each.as_row() for each in found],
        [claim for star in stars for claim in claims_of([each for each in found if each.star == star.name])],
        {
            "": merit_figure(found),
            "amplitude": amplitude_figure(found),
            "variants": variant_figure([each for each in found if each.star == stars[-1].name]),
        },
    )


_TEXT = """\
The reference is compared with an image moved vertically by `0.5 cos(2 pi y / p)` px, `y` from the middle row, where
the period `p` grows from 10 px along the columns. *Noise* is the standard deviation of the horizontal displacement,
truly zero, over the columns from 62.5 to 97.5 % of the width and more than 1.5 elements from the mesh's upper and
lower edge, one sample of the field per pixel; *period* the shortest one at which the amplitude on the middle row,
averaged over 40 columns, reaches 0.9 of the true one; MEI their product, lower is better. Meshes are regular with a
line of nodes on the middle row; nothing is regularised. *plain* is the default without smoothing. One pair of images
holds few independent values: expect some 2 % of scatter from one mesh to another.

**Read the field, not the nodes:** the nodes of four-noded cells have about 1.74 times the noise of the field between
them.

**The figure tells what is seen, not what is measured right.** On a line of nodes the amplitude rises past the true
one and comes back at longer periods. `kept_period_px` is the period from which on the amplitude stays above 0.9,
`accurate_period_px` that from which on it stays within 10 % of the true one, `peak_amplitude` its largest part of it.

**The figure sees one direction only.** The wave of the star runs along the edges of these elements. Families of
elements without mixed terms have fewer unknowns and pay nothing for it here; with the mesh turned by 45 degrees
(group `turned`) they pay. The same holds for averages over meshes moved along the crest: moved along the wave, the
average loses what the line of nodes gave (*mean of 2 moved down*, which leaves the protocol). Fields reconstructed
from the nodes of an 8 px mesh (group `nodes`) are reduced by generalised least squares with the mesh's own
correlation matrix, taken as that of a uniform texture.

The synthetic pair has the texture and the noise estimated from the real one: 37.8 grey levels of standard deviation,
a gradient of 19.7 levels per pixel, a noise of variance `0.84**2 + 0.032 g` at grey level `g`, 2.1 levels on the
average.
"""


def _tasks(star: Star, quick: bool, *, everything: bool) -> Iterator[_Task]:
    for cell, sizes in SIZES.items():
        for size in (COMPARED[cell],) if quick else sizes:
            yield partial(_one, star, "sizes", "plain", (cell, size), PLAIN)
    for cell in ("quad8", "triangle6") if quick else SIZES:
        yield partial(_turned, star, (cell, COMPARED[cell]))
    yield partial(_nodes_alone, star, FOUR_NODED)
    if not everything:
        return
    for chosen in CHOSEN[:1] if quick else CHOSEN:
        for name in QUICK_WAYS if quick else WAYS:
            yield partial(_one, star, "settings", name, chosen, WAYS[name])
        for name, shifts in _averages(quick).items():
            yield partial(_average, star, name, chosen, shifts)
    for chosen in () if quick else CHOSEN:
        yield partial(_symmetric, star, chosen)
    fine = _Fine(star)
    for name in ("8 px nodes to quad8",) if quick else SPACES:
        yield partial(fine.reduced, name)


def _averages(quick: bool) -> dict[str, list[tuple[float, float]]]:
    along = {f"mean of {count} moved along": [(part / count, 0.0) for part in range(count)] for count in (2, 4)}
    if quick:
        return {name: along[name] for name in list(along)[:1]}
    return along | {"mean of 2 moved down": [(0.0, 0.0), (0.0, 0.5)]}


def _measure(star: Star, laid: StarMesh, options: Options) -> Result:
    return correlate(star.reference, star.deformed, laid.mesh, initial="zero", **options)


def _judged(
    star: Star, labels: tuple[str, str], chosen: CellAndSize, field: Field, reach: float, results: list[Result]
) -> Measured:
    group, variant = labels
    cell, size = chosen
    merit = measure_merit(field, star, size, reach)
    iterations = max(result.iterations for result in results)
    return Measured(
        star.name, group, variant, cell, size, merit, iterations, all(result.converged for result in results)
    )


def _one(star: Star, group: str, variant: str, chosen: CellAndSize, options: Options) -> Measured:
    laid = star_mesh(star, chosen[1], chosen[0])
    result = _measure(star, laid, options)
    return _judged(star, (group, variant), chosen, field_of(result), laid.reach, [result])


def _turned(star: Star, chosen: CellAndSize) -> Measured:
    laid = turned_mesh(star, chosen[1], chosen[0], TURN)
    result = _measure(star, laid, PLAIN)
    return _judged(star, ("turned", f"plain, turned {TURN} degrees"), chosen, field_of(result), laid.reach, [result])


def _average(star: Star, variant: str, chosen: CellAndSize, shifts: list[tuple[float, float]]) -> Measured:
    """Average the fields of meshes that are shifted by parts of an element."""
    meshes = [star_mesh(star, chosen[1], chosen[0], shift) for shift in shifts]
    results = [_measure(star, laid, PLAIN) for laid in meshes]
    fields = [field_of(result) for result in results]

    def mean(columns: Floats, rows: Floats) -> Floats:
        total: Floats = sum((field(columns, rows) for field in fields[1:]), start=fields[0](columns, rows))
        return total / len(fields)

    reach = min(laid.reach for laid in meshes)
    return _judged(star, ("averages", variant), chosen, mean, reach, results)


def _symmetric(star: Star, chosen: CellAndSize) -> Measured:
    """Average the motion and the negative motion back, evaluated at the displaced nodes."""
    laid = star_mesh(star, chosen[1], chosen[0])
    there = _measure(star, laid, PLAIN)
    back = correlate(star.deformed, star.reference, laid.mesh, initial="zero", **PLAIN)
    forth = there.unchecked_displacement
    returned = laid.mesh.interpolate(back.unchecked_displacement, laid.mesh.points + forth)
    returned = np.where(np.isnan(returned), -forth, returned)
    both = replace(there, unchecked_displacement=(forth - returned) / 2.0)
    return _judged(star, ("averages", "there and back"), chosen, field_of(both), laid.reach, [there, back])


def _nodes_alone(star: Star, chosen: CellAndSize) -> Measured:
    """Evaluate the noise of the nodes instead of that of the field."""
    laid = star_mesh(star, chosen[1], chosen[0])
    result = _measure(star, laid, PLAIN)
    judged = _judged(star, ("nodes", "nodes alone"), chosen, field_of(result), laid.reach, [result])
    noise = float(result.unchecked_displacement[_calm(star, laid), 0].std())
    return replace(judged, merit=replace(judged.merit, noise=noise))


def _calm(star: Star, laid: StarMesh) -> NDArray[np.bool_]:
    """Return the nodes in the region where the noise is evaluated."""
    points, columns = laid.mesh.points, star.calm_columns
    inside = np.abs(points[:, 1] - star.middle) < laid.reach - 1.5 * laid.size
    chosen: NDArray[np.bool_] = inside & (points[:, 0] >= columns[0]) & (points[:, 0] <= columns[-1])
    return chosen


class _Fine:
    """A fine mesh, measured once, from which several fields are reconstructed."""

    def __init__(self, star: Star) -> None:
        self._star = star
        self._result: Result | None = None

    def reduced(self, name: str) -> Measured:
        if self._result is None:
            self._result = _measure(self._star, star_mesh(self._star, FINE, "quad"), PLAIN)
        space = SPACES[name]
        field, reach = reconstruct(self._result, FINE, space)
        size = FINE * space.ratio
        merit = measure_merit(field, self._star, size, reach)
        result = self._result
        return Measured(self._star.name, "nodes", name, "quad", size, merit, result.iterations, result.converged)
