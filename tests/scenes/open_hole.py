"""The open hole experiment: the camera placed by hand and the options of the stored reference results."""

from typing import Any

import numpy as np

import fedic

PYXEL_OPTIONS: dict[str, Any] = {
    "interpolation": "bspline3", "smoothing": 0.0, "quadrature": fedic.MeshQuadrature(rule="edges")
}  # fmt: skip
"""Options that agree with those of pyxel-dic."""


def open_hole_camera(unit: float = 1.0) -> fedic.Pinhole:
    """Return the camera of the reference, a scale of 1 / 0.000095 px/m and a turn; `unit` is 1000 for millimetres."""
    angle = -1.573863
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    translation = unit * np.array([0.081188, 0.096383, 0.000095])
    return fedic.Pinhole((1, 1), (0, 0), rotation=turn @ np.diag([1.0, -1.0, -1.0]), translation=tuple(translation))
