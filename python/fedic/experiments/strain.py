"""Error of the displacement under uniform strain and rotation, with and without smoothing, on images without noise."""

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from fedic._core import Mesh, rectangle_mesh
from fedic._internal.types import CellName, Floats
from fedic.correlation import Correlator
from fedic.experiments.option_sets import DEFAULT, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.sweep import rms
from fedic.experiments.waves import LONGEST, SHORTEST, Waves
from fedic.quadrature import MeshQuadrature

__all__ = ["run"]

IMAGE_SIZE = 540
"""Height and width of the images in pixels: the mesh stays inside when turned and stretched by 50 %."""
MESHES: tuple[tuple[CellName, int, int], ...] = (("quad", 20, 240), ("quad9", 32, 256))
"""Cell types, their size and that of the mesh, in pixels."""
DENSE = OptionSet("density 2", {}, MeshQuadrature(density=2.0))
"""Default options with twice as many quadrature points."""
SETTINGS = (DEFAULT, DENSE, UNFILTERED)
_POSITIVE = (0.1, 0.24, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
STRAINS = (*(-strain for strain in reversed(_POSITIVE)), 0.0, *_POSITIVE, 50.0)
QUICK_STRAINS = (-20.0, 0.0, 0.24, 1.0, 5.0, 20.0)
"""Strains along the columns of the reference image, in percent."""
ANGLES = (0.0, 45.0)
DRAWS, QUICK_DRAWS = 6, 2
TARGETS = {1.0: 1e-4, 5.0: 1e-4, 20.0: 1.5e-4, -20.0: 1.5e-4}
"""Accepted root mean square error of the nodes in pixels, over the strain in percent."""
LARGEST_BIAS = 5e-5
START_ERROR = 0.3
"""Largest error of the start in pixels, since the start is not the subject of this experiment."""
_COLOURS = {DEFAULT.name: "tab:green", DENSE.name: "tab:purple", UNFILTERED.name: "tab:blue"}
_STYLES: dict[float, dict[str, Any]] = {
    0.0: {"linestyle": "-", "marker": "o"},
    45.0: {"linestyle": "--", "marker": "s", "markerfacecolor": "none"},
}
_TICKS = (-20.0, -5.0, -1.0, -0.24, 0.0, 0.24, 1.0, 5.0, 20.0, 50.0)
_LINEAR = 0.1
"""Strain in percent below which the axis is linear."""


@dataclass(frozen=True)
class Pose:
    """A random texture, position of the mesh in the pixels, and translation.

    Attributes
    ----------
    texture : Waves
        The texture.
    corner : ndarray of float, shape (2,)
        Position of the corner of the mesh relative to a pixel.
    shift : ndarray of float, shape (2,)
        Translation in pixels, after the deformation.
    """

    texture: Waves
    corner: Floats
    shift: Floats

    @classmethod
    def draw(cls, seed: int) -> "Pose":
        """Draw a pose.

        Parameters
        ----------
        seed : int
            Seed of the draw.

        Returns
        -------
        Pose
            The same for the same seed.
        """
        rng = np.random.default_rng([seed, 1])
        return cls(Waves(seed), rng.uniform(0.0, 1.0, 2), rng.uniform(-0.5, 0.5, 2))

    def mesh(self, cell: CellName, size: int, side: int) -> Mesh:
        """Return a square mesh about the centre of the image."""
        u, v = (IMAGE_SIZE - side) // 2 + self.corner
        return rectangle_mesh((u, v, u + side, v + side), float(size), cell)


@dataclass(frozen=True)
class _Measured:
    errors: Floats
    iterations: int
    converged: bool


def run(request: Request) -> Outcome:
    """Measure images of an analytic texture, stretched and turned.

    Parameters
    ----------
    request : Request
        A quick run has six strains and two draws.

    Returns
    -------
    Outcome
        Rows over cell, setting, angle and strain.
    """
    strains = QUICK_STRAINS if request.quick else STRAINS
    draws = QUICK_DRAWS if request.quick else DRAWS
    measured: dict[tuple[CellName, str, float, float], list[_Measured]] = {}
    for seed in range(draws):
        pose = Pose.draw(seed)
        reference = pose.texture.image(IMAGE_SIZE, np.eye(2))
        meshes = {cell: pose.mesh(cell, size, side) for cell, size, side in MESHES}
        correlators = {
            (cell, setting.name): Correlator(reference, mesh, quadrature=setting.mesh, **setting.options)
            for (cell, mesh), setting in product(meshes.items(), SETTINGS)
        }
        for angle, strain in product(ANGLES, strains):
            gradient = _gradient(strain, angle)
            deformed = pose.texture.image(IMAGE_SIZE, gradient, pose.shift)
            for (cell, setting), correlator in correlators.items():
                points = meshes[cell].points
                truth = (points - IMAGE_SIZE / 2.0) @ (gradient - np.eye(2)).T + pose.shift
                start = truth + START_ERROR * np.sin(points[:, ::-1] / 50.0)
                result = correlator.correlate(deformed, initial=start)
                found = _Measured(result.unchecked_displacement - truth, result.iterations, result.converged)
                measured.setdefault((cell, setting, angle, strain), []).append(found)
        request.report((seed + 1) / draws)
    rows = [_row(*case, found) for case, found in measured.items()]
    rows.sort(key=lambda row: (row["cell"], [s.name for s in SETTINGS].index(row["setting"]), row["angle_deg"]))
    return Outcome(
        "strain",
        "Error of the displacement under strain and rotation",
        f"An analytic texture of plane waves of {SHORTEST:g} to {LONGEST:g} px, in float32 images without noise, is "
        "stretched along the columns, turned by 0 or 45 degrees and translated by a fraction of a pixel, and measured "
        + " and ".join(f"with {cell} cells of {size} px" for cell, size, _ in MESHES)
        + f". Each of the {draws} draws has its own texture, translation and position of the mesh in the pixels; "
        f"*rms_px* is the root mean square error of the nodes over all draws, *worst_rms_px* that of the worst draw, "
        "*bias_px* the largest mean error of a draw, along u or v. The claims and the figure refer to the worst draw. "
        "*default*: the "
        "default options, with a smoothing of 0.8 px on the material from a stretch of 0.25 % on; *density 2*: the "
        "same with two quadrature points per pixel; *unfiltered*: the default without smoothing. What is left without "
        "smoothing is the error of the interpolation, which more quadrature points average out.",
        rows,
        _claims(rows),
        {"": _figure(rows)},
    )


def _gradient(strain: float, angle: float) -> Floats:
    """Return the deformation gradient of a stretch in percent followed by a rotation in degrees."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return np.array([[c, -s], [s, c]]) @ np.diag([1.0 + strain / 100.0, 1.0])


def _row(cell: CellName, setting: str, angle: float, strain: float, found: list[_Measured]) -> Row:
    return {
        "cell": cell,
        "size_px": next(size for name, size, _ in MESHES if name == cell),
        "setting": setting,
        "angle_deg": angle,
        "strain_percent": strain,
        "draws": len(found),
        "rms_px": rms(np.array([each.errors for each in found])),
        "worst_rms_px": max(rms(each.errors) for each in found),
        "bias_px": max(float(np.abs(each.errors.mean(axis=0)).max()) for each in found),
        "max_px": max(float(np.abs(each.errors).max()) for each in found),
        "iterations": max(each.iterations for each in found),
        "converged": all(each.converged for each in found),
    }


def _claims(rows: list[Row]) -> list[Claim]:
    claims = []
    for cell, size, _ in MESHES:
        subject = f"{cell} cells of {size} px"
        mine = [row for row in rows if row["cell"] == cell and row["strain_percent"] in TARGETS]
        default = [row for row in mine if row["setting"] == DEFAULT.name]
        for strain, accepted in TARGETS.items():
            line = [row for row in default if row["strain_percent"] == strain]
            claims.append(
                Claim(
                    f"{subject}: rms error of the nodes at most {accepted:g} px at a strain of {strain:g} %, at 0 and "
                    "at 45 degrees",
                    " / ".join(f"{row['worst_rms_px']:.1e}" for row in line)
                    + " px; over all draws "
                    + " / ".join(f"{row['rms_px']:.1e}" for row in line)
                    + " px",
                    all(_within(row, accepted) for row in line),
                )
            )
        worst = max(default, key=lambda row: float(row["bias_px"]))
        claims.append(
            Claim(
                f"{subject}: |bias| at most {LARGEST_BIAS:g} px at these strains and angles",
                f"at most {worst['bias_px']:.1e} px, at {worst['strain_percent']:g} % and {worst['angle_deg']:g} "
                "degrees",
                all(row["bias_px"] <= LARGEST_BIAS for row in default),
            )
        )
        dense = [row for row in mine if row["setting"] == DENSE.name]
        largest = {
            strain: max(row["worst_rms_px"] for row in dense if row["strain_percent"] == strain) for strain in TARGETS
        }
        claims.append(
            Claim(
                f"{subject}, two quadrature points per pixel: rms error and bias within the same limits",
                ", ".join(f"{error:.1e} px at {strain:g} %" for strain, error in largest.items())
                + f"; bias at most {max(row['bias_px'] for row in dense):.1e} px",
                all(_within(row, TARGETS[row["strain_percent"]]) and row["bias_px"] <= LARGEST_BIAS for row in dense),
            )
        )
    return claims


def _within(row: Row, accepted: float) -> bool:
    return bool(row["converged"] and row["worst_rms_px"] <= accepted)


def _figure(rows: list[Row]) -> Figure:
    figure = Figure(figsize=(12.0, 5.2), layout="constrained")
    panels = figure.subplots(1, len(MESHES), sharey=True)
    for axes, (cell, size, _) in zip(panels, MESHES, strict=True):
        for setting, angle in product(SETTINGS, ANGLES):
            wanted = (cell, setting.name, angle)
            line = [row for row in rows if (row["cell"], row["setting"], row["angle_deg"]) == wanted]
            axes.plot(
                [row["strain_percent"] for row in line],
                [row["worst_rms_px"] for row in line],
                color=_COLOURS[setting.name],
                markersize=4.0,
                **_STYLES[angle],
            )
        axes.plot(list(TARGETS), list(TARGETS.values()), "kv", markersize=7.0)
        _strain_axis(axes)
        axes.set(title=f"{cell} cells of {size} px")
    panels[0].set_ylabel(f"rms error of the nodes, worst of {rows[0]['draws']} draws (px)")
    settings = [Line2D([], [], color=_COLOURS[s.name], linewidth=3.0, label=s.name) for s in SETTINGS]
    angles = [Line2D([], [], color="k", label=f"turned by {angle:g}°", **_STYLES[angle]) for angle in ANGLES]
    target = Line2D([], [], color="k", marker="v", linestyle="none", label="target, with the default options")
    figure.legend(handles=[*settings, *angles, target], loc="outside lower center", ncols=6, frameon=False)
    return figure


def _strain_axis(axes: Axes) -> None:
    axes.set_xscale("symlog", linthresh=_LINEAR, linscale=0.4)
    axes.set(yscale="log", xlabel="strain along the columns (%)")
    axes.set_xticks(_TICKS)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xticks([], minor=True)
    axes.grid(visible=True, which="both", alpha=0.25)
