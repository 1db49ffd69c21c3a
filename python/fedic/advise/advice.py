"""Advice on the size of elements."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fedic._internal.types import CellName, Floats
from fedic.advise.patches import Region
from fedic.advise.texture import Texture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Advice"]


@dataclass(frozen=True, eq=False, repr=False)
class Advice:
    """Predicted standard deviations against the size of the elements, and the smallest size that meets the targets.

    Attributes
    ----------
    sizes : ndarray, shape (k,)
        Sizes of the elements, in pixels.
    displacement : ndarray, shape (k, 2)
        Predicted standard deviation of the displacement along x and y at nodes inside a mesh, in pixels.
    border : ndarray, shape (k, 2)
        The same at the nodes of its border.
    strain : ndarray, shape (k, 3)
        Predicted standard deviation of ``exx, eyy, exy`` at the centres of cells inside a mesh.
    recommended : float
        Smallest of the sizes, in pixels, from which on the predicted standard deviation of both displacements, and of
        the three strains if they have a target, is at most the target; NaN if there is none.
    displacement_target : float
        Target of the displacement, in pixels.
    strain_target : float
        Target of the strains; NaN if there is none.
    noise : float
        Standard deviation of the noise of one image, in grey levels.
    cell : str
        Type of the elements.
    region : (int, int, int, int)
        First column and row of the part of the image, and those after the last.
    texture : Texture
        Speckle size, contrast, gradient and saturation.
    doubts : tuple of str
        What is doubtful, in sentences.
    """

    sizes: Floats
    displacement: Floats
    border: Floats
    strain: Floats
    recommended: float
    displacement_target: float
    strain_target: float
    noise: float
    cell: CellName
    region: Region
    texture: Texture
    doubts: tuple[str, ...]

    def __repr__(self) -> str:
        size = f"{self.recommended:g} px" if math.isfinite(self.recommended) else "none"
        doubts = "".join(f"; {doubt}" for doubt in self.doubts)
        return f"Advice({self.cell} of {size} for {self.criterion}{doubts})"

    @property
    def criterion(self) -> str:
        """The targets in words."""
        strain = "" if math.isnan(self.strain_target) else f" and {self.strain_target:g} of the strains"
        return f"a standard deviation of at most {self.displacement_target:g} px of the displacement{strain}"

    def summary(self) -> dict[str, Any]:
        """Return the advice as JSON types.

        Returns
        -------
        dict
            The attributes by name, None where a number is not known; sizes and displacements in pixels.
        """
        texture = {name: _json(getattr(self.texture, name)) for name in self.texture.__dataclass_fields__}
        return {
            "recommended_px": _json(self.recommended),
            "criterion": self.criterion,
            "cell": self.cell,
            "noise": self.noise,
            "region": list(self.region),
            "sizes_px": _json(self.sizes.tolist()),
            "displacement_px": _json(self.displacement.tolist()),
            "border_displacement_px": _json(self.border.tolist()),
            "strain": _json(self.strain.tolist()),
            "texture": texture,
            "doubts": list(self.doubts),
        }

    def plot(self) -> "Figure":
        """Draw the standard deviations against the size of the elements.

        Returns
        -------
        matplotlib.figure.Figure
            Displacement and strain on logarithmic axes, with the targets and the recommended size.
        """
        from fedic.plotting.advice import draw_size_curves

        return draw_size_curves(
            self.sizes,
            {"x": self.displacement[:, 0], "y": self.displacement[:, 1]},
            {name: self.strain[:, k] for k, name in enumerate(("exx", "eyy", "exy"))},
            targets=(self.displacement_target, self.strain_target),
            recommended=self.recommended,
            title=f"{self.cell}, noise {self.noise:g} grey levels",
        )


def _json(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_json(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
