"""Effect of each kind of lens distortion on a large shift, with and without the lens in the projector."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fedic._core import BrownDistortion, Mesh
from fedic._internal.types import CellName, Floats
from fedic.demo.measurement import Measurement
from fedic.demo.scene import FOCAL, MILLIMETRES, RADIAL, ImagePair, Scene
from fedic.experiments.lens import SENSOR, ignored_distortion
from fedic.experiments.lens_errors import average_errors, measure, rounding_bound
from fedic.experiments.option_sets import DEFAULT, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import window_mesh
from fedic.experiments.sweep import rms

__all__ = ["run"]

SIZE = 20
CELL: CellName = "quad"
SETTINGS = (UNFILTERED, DEFAULT)
PIXEL_MOTION = (-400.3, -200.6)
"""Motion in pixels, not whole: undistorted images would otherwise be identical, including their rounding."""
WIDE_FOCAL = 1400.0
TEXTURES, QUICK_TEXTURES = 2, 1
LARGEST_BIAS, NEAR_BOUND, NEAR_THEORY = 1e-4, 0.1, 0.03
LARGEST_CORNER = 10.0
"""Distortion at the corner of the sensor, in pixels, up to which the smoothing is claimed to cost nothing."""
LEAST_FITTED = 1e-3
"""Error of ignoring the lens, in pixels, from which it is fitted."""
_NONE = "none"


@dataclass(frozen=True)
class Series:
    """Values of one coefficient, the others being zero.

    Attributes
    ----------
    name : str
        Name of the coefficient.
    distortion : callable
        Function from a value to the lens.
    values : tuple of float
        Values of a full run.
    quick_values : tuple of float
        Values of a quick run; may be empty.
    panel, colour : str
        Panel and colour in the figure.
    focal : float
        Focal length in pixels.
    """

    name: str
    distortion: Callable[[float], BrownDistortion]
    values: tuple[float, ...]
    quick_values: tuple[float, ...]
    panel: str
    colour: str
    focal: float = FOCAL

    def scene(self, value: float) -> Scene:
        """Return the scene through the lens of one value."""
        return Scene(self.distortion(value), self.focal, SENSOR, PIXEL_MOTION)


_DECADES, _TWO = (1e-5, 1e-4, 1e-3, 1e-2, 3e-2), (1e-3, 3e-2)
SERIES = (
    Series(
        f"k1, f = {FOCAL:g} px",
        lambda k: BrownDistortion(radial=(k, 0.0, 0.0)),
        (-1e-4, -1e-3, -1e-2, RADIAL[0], -0.1, -0.3),
        (RADIAL[0], -0.3),
        "radial",
        "tab:blue",
    ),
    Series(
        f"k1, f = {WIDE_FOCAL:g} px",
        lambda k: BrownDistortion(radial=(k, 0.0, 0.0)),
        (-1e-4, -1e-3, -1e-2, -0.03, -0.1, -0.3),
        (-0.01, -0.3),
        "radial",
        "tab:purple",
        WIDE_FOCAL,
    ),
    Series("d1", lambda d: BrownDistortion(decentering=(d, 0.0)), _DECADES, _TWO, "decentering", "tab:orange"),
    Series("d2", lambda d: BrownDistortion(decentering=(0.0, d)), _DECADES, (), "decentering", "tab:brown"),
    Series("p1", lambda p: BrownDistortion(prism=(p, 0.0)), _DECADES, _TWO, "prism", "tab:green"),
    Series("p2", lambda p: BrownDistortion(prism=(0.0, p)), _DECADES, (), "prism", "tab:olive"),
)


def run(request: Request) -> Outcome:
    """Sweep each coefficient; measure with the lens and without, in 8 and in 16 bits.

    Parameters
    ----------
    request : Request
        A quick run has two values of four coefficients, and one texture.

    Returns
    -------
    Outcome
        Rows over coefficient, value, setting, lens and depth.
    """
    cases: list[tuple[str, float, Scene]] = [(_NONE, 0.0, Scene(BrownDistortion(), FOCAL, SENSOR, PIXEL_MOTION))]
    for series in SERIES:
        for value in series.quick_values if request.quick else series.values:
            cases.append((series.name, value, series.scene(value)))
    count = QUICK_TEXTURES if request.quick else TEXTURES
    rows: list[Row] = []
    for done, case in enumerate(cases):
        request.report(done / len(cases))
        rows += _rows(*case, count)
    return Outcome(
        "distortion",
        "What each kind of distortion does to a large shift",
        "The scene of Fig. 16, moved by (-400.3, -200.6) px, seen through lenses of one distortion coefficient each: "
        f"k1 with the paper's focal length of {FOCAL:g} px and with a wide angle of {WIDE_FOCAL:g} px, the "
        f"decentering coefficients d1 and d2, the prism coefficients p1 and p2. Quadrilaterals of {SIZE} px measure "
        "the motion in millimetres through the camera (mesh quadrature, *lens*) and in pixels as if there were no "
        f"lens (pixel quadrature), {count} texture{'s' if count > 1 else ''}, from half a pixel beside the truth. "
        "Drawn are root mean square errors of the nodes in the default setting in 8 bits, and thin, with the lens, "
        "in 16 bits. *Theory* is the distortion where a node arrives less the distortion where it was. Without "
        "rounding the error with the lens grows with the distortion, though it stays below that of rounding up to "
        "some 10 px at the corner of the image: where the lens magnifies differently in the two places, the pixel's "
        "aperture and the smoothing, which are of one size in pixels, blur the material differently. The smoothing "
        "of 0.8 px is the larger part, and `smoothing=0` is the better choice with such lenses.",
        rows,
        _claims(rows),
        {"": _figure(rows)},
    )


def _rows(name: str, value: float, scene: Scene, count: int) -> list[Row]:
    fine = [scene.pair(seed) for seed in range(count)]
    coarse = [pair.rounded() for pair in fine]
    mesh = window_mesh(scene.window, SIZE, CELL)
    expected = ignored_distortion(scene, mesh)
    bound = rounding_bound(scene, coarse[0], mesh)
    rows: list[Row] = []
    for setting in SETTINGS:
        for lens in (True, False):
            theory = 0.0 * expected if lens else expected
            for bits, pairs in ((8, coarse), (16, fine)):
                found = [_measure(scene, pair, mesh, setting, lens) for pair in pairs]
                errors = np.array([each.errors for each in found])
                rows.append(
                    {
                        "coefficient": name,
                        "value": value,
                        "focal_px": scene.focal,
                        "corner_px": _at_the_corner(scene),
                        "setting": setting.name,
                        "lens": lens,
                        "bits": bits,
                        **average_errors(found).as_row(),
                        "max_px": float(np.abs(errors).max()),
                        "rms_px": rms(errors),
                        "theory_rms_px": rms(theory),
                        "rms_from_theory_px": rms(errors - theory),
                        "bound_px": bound if bits == 8 else np.nan,
                    }
                )
    return rows


def _measure(scene: Scene, pair: ImagePair, mesh: Mesh, setting: OptionSet, lens: bool) -> Measurement:
    """Measure from a start half a pixel from the truth, since the start is not the subject of this experiment."""
    truth = np.tile(scene.motion, (mesh.num_nodes, 1)) if lens else ignored_distortion(scene, mesh) + scene.pixel_motion
    start = truth + 0.5 * (MILLIMETRES if lens else 1.0)
    rule = setting.quadrature("mesh" if lens else "pixel")
    return measure(scene, pair, mesh, setting, rule, lens=lens, initial=start)


def _at_the_corner(scene: Scene) -> float:
    """Return the distortion at the upper left corner of the whole sensor, in pixels."""
    lens = Scene(scene.distortion, scene.focal).camera
    ideal = Scene(BrownDistortion(), scene.focal).camera
    corner = ideal.unproject([[0.0, 0.0]])
    return float(np.linalg.norm(lens.project(corner) - ideal.project(corner)))


def _pick(rows: list[Row], setting: OptionSet, lens: bool, bits: int) -> list[Row]:
    return [row for row in rows if (row["setting"], row["lens"], row["bits"]) == (setting.name, lens, bits)]


def _column(rows: list[Row], key: str) -> Floats:
    return np.array([float(row[key]) for row in rows])


def _claims(rows: list[Row]) -> list[Claim]:
    claims = []
    for setting in SETTINGS:
        lens, fine = _pick(rows, setting, True, 8), _pick(rows, setting, True, 16)
        draws = np.stack([_column(lens, "bias_u_px"), _column(lens, "bias_v_px")])
        biases = np.stack([_column(fine, "bias_u_px"), _column(fine, "bias_v_px")])
        ratios = _column(lens, "std_px") / _column(lens, "bound_px")
        near = _column(lens, "corner_px") <= LARGEST_CORNER
        worst = int(np.argmax(ratios))
        claims += [
            Claim(
                f"{setting.name}, with the lens: |bias| at most {LARGEST_BIAS:g} px along u and v, at every value in "
                "16 bits, on average in 8 bits",
                f"at most {biases.max():.1e} px in 16 bits; {draws.mean():.1e} px on average in 8 bits, at most "
                f"{draws.max():.1e} px",
                bool(biases.max() <= LARGEST_BIAS and draws.mean() <= LARGEST_BIAS),
            ),
            Claim(
                f"{setting.name}, with the lens: standard deviation within {100 * NEAR_BOUND:.0f} % of the bound of "
                f"rounding, up to {LARGEST_CORNER:g} px of distortion at the corner",
                f"{ratios[near].min():.3f} to {ratios[near].max():.3f} times; of all values at most "
                f"{ratios[worst]:.2f} times, at {lens[worst]['coefficient']}: {lens[worst]['value']}, "
                f"{float(lens[worst]['corner_px']):.3g} px",
                bool((np.abs(ratios[near] - 1.0) <= NEAR_BOUND).all()),
            ),
        ]
    wide = _pick(rows, UNFILTERED, True, 8)
    ratios = _column(wide, "std_px") / _column(wide, "bound_px")
    claims.append(
        Claim(
            f"unfiltered, with the lens: std within {100 * NEAR_BOUND:.0f} % of the bound of rounding at "
            f"every value, up to {_column(wide, 'corner_px').max():.3g} px at the corner",
            f"{ratios.min():.3f} to {ratios.max():.3f} times",
            bool((np.abs(ratios - 1.0) <= NEAR_BOUND).all()),
        )
    )
    fine = [row for row in _pick(rows, DEFAULT, False, 16) if float(row["theory_rms_px"]) >= LEAST_FITTED]
    ratios = _column(fine, "rms_px") / _column(fine, "theory_rms_px")
    claims.append(
        Claim(
            f"lens ignored: the error is theory's within {100 * NEAR_THEORY:.0f} % (root mean square in 16 bits, "
            f"from {LEAST_FITTED:g} px)",
            f"{ratios.min():.4f} to {ratios.max():.4f} times, at most {_column(fine, 'rms_px').max():.2g} px",
            bool((np.abs(ratios - 1.0) <= NEAR_THEORY).all()),
        )
    )
    slopes = {}
    for name in dict.fromkeys(str(row["coefficient"]) for row in fine):
        line = [row for row in fine if row["coefficient"] == name]
        values, errors = np.log(np.abs(_column(line, "value"))), np.log(_column(line, "rms_px"))
        slopes[name] = float(np.polyfit(values, errors, 1)[0])
    claims.append(
        Claim(
            f"lens ignored: the error grows as each coefficient, slope 1 within {100 * NEAR_THEORY:.0f} %",
            ", ".join(f"{name}: {slope:.3f}" for name, slope in slopes.items()),
            all(abs(slope - 1.0) <= NEAR_THEORY for slope in slopes.values()),
        )
    )
    return claims


def _figure(rows: list[Row]) -> Figure:
    figure = Figure(figsize=(13.0, 4.8), layout="constrained")
    names = list(dict.fromkeys(series.panel for series in SERIES))
    panels = dict(zip(names, figure.subplots(1, len(names), sharey=True), strict=True))
    for series in SERIES:
        lens, fine = _pick(rows, DEFAULT, True, 8), _pick(rows, DEFAULT, True, 16)
        axes = panels[series.panel]
        for found, key, style in (
            (_pick(rows, DEFAULT, False, 8), "rms_px", {"marker": "o", "linestyle": "none"}),
            (_pick(rows, DEFAULT, False, 8), "theory_rms_px", {"linestyle": "-", "linewidth": 1.0}),
            (lens, "rms_px", {"marker": "s", "linestyle": "--", "markerfacecolor": "none"}),
            (fine, "rms_px", {"marker": ".", "linestyle": ":", "linewidth": 0.8}),
        ):
            _draw(axes, [row for row in found if row["coefficient"] == series.name], key, series.colour, style)
        axes.plot([], [], color=series.colour, linewidth=4.0, label=series.name)
    bound = float(_column(_pick(rows, DEFAULT, True, 8), "bound_px")[0])
    for name, axes in panels.items():
        axes.axhline(bound, color="k", linewidth=0.8, linestyle="-.")
        axes.set(xscale="log", yscale="log", title=f"{name} distortion", xlabel="|coefficient|")
        axes.grid(visible=True, alpha=0.25)
        axes.legend(loc="upper left", fontsize="small")
    panels[names[0]].set_ylabel("root mean square error of the displacement (px)")
    figure.legend(
        handles=[
            Line2D([], [], color="k", marker="o", linestyle="none", label="lens ignored"),
            Line2D([], [], color="k", linewidth=1.0, label="lens ignored, theory"),
            Line2D([], [], color="k", marker="s", linestyle="--", markerfacecolor="none", label="with the lens"),
            Line2D([], [], color="k", marker=".", linestyle=":", linewidth=0.8, label="with the lens, 16 bits"),
            Line2D([], [], color="k", linewidth=0.8, linestyle="-.", label="Cramér-Rao bound of rounding"),
        ],
        loc="outside lower center",
        ncols=5,
        frameon=False,
    )
    return figure


def _draw(axes: Axes, line: list[Row], key: str, colour: str, style: dict[str, Any]) -> None:
    axes.plot(np.abs(_column(line, "value")), _column(line, key), color=colour, markersize=6.0, **style)
