"""Error maps side by side, with the iso-lines that show the rings of a lens."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.plotting.fields import draw_nodal_field

__all__ = ["ErrorMap", "draw_error_maps"]

_STEP = 0.004
"""Interval between iso-lines, in pixels."""
_GRID = 300
_MEASURED: dict[str, Any] = {"colors": "k", "linestyles": "solid", "linewidths": 0.6}
_EXPECTED: dict[str, Any] = {"colors": "tab:green", "linestyles": "dashed", "linewidths": 1.6}


class ErrorMap(NamedTuple):
    """Errors of the nodes of a mesh.

    Attributes
    ----------
    name : str
        First line of the title.
    mesh : Mesh
        The mesh.
    pixels : ndarray, shape (n, 2)
        Image points of its nodes.
    errors : ndarray, shape (n, 2)
        Errors of the nodes along ``u`` and ``v``, in pixels.
    """

    name: str
    mesh: Mesh
    pixels: Floats
    errors: Floats


def draw_error_maps(maps: Sequence[ErrorMap], expected: Floats | None = None) -> Figure:
    """Draw the error of the vertical displacement over the mesh, one panel per map, on one colour scale.

    Parameters
    ----------
    maps : sequence of ErrorMap
        The maps.
    expected : ndarray of float, shape (n, 2), optional
        Theoretical errors of the nodes of the last map, in pixels.

    Returns
    -------
    Figure
        A figure with iso-lines every 0.004 px, without that of zero.
    """
    limit = max(float(np.abs(each.errors[:, 1]).max()) for each in maps)
    steps = np.arange(1, max(int(limit / _STEP), 1) + 1)
    levels = _STEP * np.concatenate([-steps[::-1], steps])
    figure = Figure(figsize=(10.0, 5.0), layout="compressed")
    panels = figure.subplots(1, len(maps), sharex=True, sharey=True, squeeze=False)[0]
    for axes, (name, mesh, pixels, errors) in zip(panels, maps, strict=True):
        vertical = errors[:, 1]
        colours = draw_nodal_field(axes, mesh, pixels, vertical, limits=(-limit, limit))
        _draw_iso_lines(axes, mesh, pixels, vertical, levels, _MEASURED)
        title = f"{name}\nbias {vertical.mean():+.5f} px, std {vertical.std():.4f} px"
        axes.set(title=title, xlabel="u (px)", aspect="equal")
    if expected is not None:
        _draw_iso_lines(panels[-1], maps[-1].mesh, maps[-1].pixels, expected[:, 1], levels, _EXPECTED)
        handles = [
            Line2D([], [], color="k", linewidth=0.6, label=f"iso-lines of the error, every {_STEP:g} px"),
            Line2D([], [], color="tab:green", linestyle="dashed", linewidth=1.6, label="iso-lines of the theory"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
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
