"""Figures of fields, calibrations and registrations.

Figures are made without pyplot: nothing is shown, kept or configured globally.
"""

from fedic.plotting.fields import (
    draw_nodal_field,
    plot_displacement,
    plot_field,
    plot_mesh,
    plot_residual,
    plot_strain,
)
from fedic.plotting.png_files import save_figure

__all__ = [
    "draw_nodal_field",
    "plot_displacement",
    "plot_field",
    "plot_mesh",
    "plot_residual",
    "plot_strain",
    "save_figure",
]
