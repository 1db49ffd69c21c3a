# Written by `make generate` from the options declared in crates/fedic/src. Do not edit.
"""Names that options take."""

from typing import Literal, TypeAlias

__all__ = [
    "Brightness",
    "Gradient",
    "Hessian",
    "Interpolation",
    "Motion",
    "QuadratureRule",
    "Robust",
]

Brightness: TypeAlias = Literal["auto", "global", "element", "field"] | None
Gradient: TypeAlias = Literal["analytic", "finite-difference"]
Hessian: TypeAlias = Literal["initial", "updated"]
Interpolation: TypeAlias = Literal["bilinear", "bicubic", "bspline3", "bspline5"]
Motion: TypeAlias = Literal["translation", "in-plane", "spatial"]
QuadratureRule: TypeAlias = Literal["rotated", "edges", "diameter"]
Robust: TypeAlias = Literal["huber", "tukey"]
