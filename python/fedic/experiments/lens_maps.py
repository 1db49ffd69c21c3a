"""Error maps side by side, with the iso-lines that show the rings of a lens."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.experiments.lens_errors import Measurement
from fedic.plotting import draw_nodal_field

__all__ = ["draw_error_maps"]

_STEP = 0.004
"""Between iso-lines, in pixels."""
_GRID = 300
_MEASURED: dict[str, Any] = {"colors": "k", "linestyles": "solid", "linewidths": 0.6}
_EXPECTED: dict[str, Any] = {"colors": "tab:green", "linestyles": "dashed", "linewidths": 1.6}


def draw_error_maps(cases: Sequence[Measurement], expected: Floats | None = None) -> Figure:
    """Draw the error of the vertical displacement over the mesh, one panel per measurement, on one colour scale.

    Parameters
    ----------
    cases : sequence of Measurement
        What is compared.
    expected : ndarray of float, shape (n, 2), optional
        Error of the nodes that the last measurement is to have by theory, in pixels.

    Returns
    -------
    Figure
        With iso-lines every 0.004 px, that of zero left out.
    """
    reach = max(float(np.abs(case.errors[:, 1]).max()) for case in cases)
    steps = np.arange(1, max(int(reach / _STEP), 1) + 1)
    levels = _STEP * np.concatenate([-steps[::-1], steps])
    figure = Figure(figsize=(10.0, 5.0), layout="compressed")
    panels = figure.subplots(1, len(cases), sharex=True, sharey=True, squeeze=False)[0]
    for axes, case in zip(panels, cases, strict=True):
        mesh = case.result.mesh
        pixels = case.result.camera.project(mesh.points)
        colours = draw_nodal_field(axes, mesh, pixels, case.errors[:, 1], limits=(-reach, reach))
        _draw_iso_lines(axes, mesh, pixels, case.errors[:, 1], levels, _MEASURED)
        if expected is not None and case is cases[-1]:
            _draw_iso_lines(axes, mesh, pixels, expected[:, 1], levels, _EXPECTED)
            figure.legend(
                handles=[
                    Line2D([], [], color="k", linewidth=0.6, label=f"iso-lines of the error, every {_STEP:g} px"),
                    Line2D([], [], color="tab:green", linestyle="dashed", linewidth=1.6, label="the same by theory"),
                ],
                loc="outside lower center",
                ncols=2,
                frameon=False,
            )
        axes.set(
            title=f"{case.name}\nbias {case.bias[1]:+.5f} px, std {case.std[1]:.4f} px", xlabel="u (px)", aspect="equal"
        )
    panels[0].set_ylabel("v (px)")
    panels[0].invert_yaxis()
    figure.colorbar(colours, ax=list(panels), label="error of the vertical displacement (px)", shrink=0.9)
    return figure


def _draw_iso_lines(
    axes: Axes, mesh: Mesh, pixels: Floats, values: Floats, levels: Floats, style: dict[str, Any]
) -> None:
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    u, v = np.meshgrid(np.linspace(low[0], high[0], _GRID), np.linspace(low[1], high[1], _GRID))
    nodal = np.stack([values, values], axis=-1)
    field = Mesh(pixels, mesh.cells).interpolate(nodal, np.stack([u.ravel(), v.ravel()], axis=-1))[:, 0]
    axes.contour(u, v, np.ma.masked_invalid(field.reshape(u.shape)), levels=levels, **style)
