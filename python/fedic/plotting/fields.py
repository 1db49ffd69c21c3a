"""Meshes, displacements, strains and residuals drawn over images."""

from typing import Any, Literal, Protocol, TypeAlias, get_args

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fedic._core import CELL_TYPES, Mesh
from fedic._internal.choices import check_choice
from fedic._internal.types import Camera, Floats, Image
from fedic.errors import ImageError
from fedic.plotting.colour_maps import IMAGE, SEQUENTIAL, SIGNED
from fedic.results.quality import Quality
from fedic.results.strains import StrainMeasure, Strains

__all__ = [
    "Component",
    "Strain",
    "draw_nodal_field",
    "plot_displacement",
    "plot_field",
    "plot_mesh",
    "plot_residual",
    "plot_strain",
]

Component: TypeAlias = Literal["x", "y", "u", "v"]
Strain: TypeAlias = Literal["exx", "eyy", "exy", "e1", "e2", "von_mises"]
Configuration: TypeAlias = Literal["deformed", "reference"]


class MeasuredField(Protocol):
    """A displacement field with its mesh and camera, such as a `fedic.Result`."""

    @property
    def mesh(self) -> Mesh:
        """The mesh."""

    @property
    def camera(self) -> Camera:
        """The camera that projects it."""

    @property
    def displacement(self) -> Floats:
        """Nodal displacements (n, 2) in the mesh's unit."""

    @property
    def pixel_displacement(self) -> Floats:
        """Nodal displacements (n, 2) in pixels."""

    @property
    def quality(self) -> Quality:
        """The verdict."""

    @property
    def unit(self) -> str:
        """The mesh's unit; empty if it is not known."""

    def strains(self, measure: StrainMeasure, at: Literal["nodes"]) -> Strains:
        """Return the strains at the nodes."""


_STRAIN_SYMBOLS: dict[Strain, str] = {
    "exx": r"$\varepsilon_{xx}$",
    "eyy": r"$\varepsilon_{yy}$",
    "exy": r"$\varepsilon_{xy}$",
    "e1": r"$\varepsilon_1$",
    "e2": r"$\varepsilon_2$",
    "von_mises": "von Mises",
}
_MEASURE_NAMES: dict[StrainMeasure, str] = {
    "green-lagrange": "Green-Lagrange strain",
    "hencky": "Hencky strain",
    "small": "small strain",
}
_BACKDROP_SIDE = 2000
_DOUBTFUL = "tab:red"
_LONG_SIDE_INCHES = 7.0
_MARGIN = 0.06
_CLIPPED_PERCENT = 0.5


def plot_displacement(
    field: MeasuredField,
    image: Image,
    component: Component = "x",
    *,
    on: Configuration = "deformed",
) -> Figure:
    """Draw a component of the displacement over an image.

    Parameters
    ----------
    field : Result
        The displacement field.
    image : ndarray, shape (height, width)
        The deformed or the reference image.
    component : {"x", "y", "u", "v"}
        ``x``, ``y`` in the mesh's unit; ``u`` (column), ``v`` (row) in pixels.
    on : {"deformed", "reference"}
        Configuration in which the mesh is drawn.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.

    Raises
    ------
    OptionError
        If `component` or `on` is unknown.
    """
    check_choice("component", component, get_args(Component))
    in_pixels = component in ("u", "v")
    vectors = field.pixel_displacement if in_pixels else field.displacement
    values = vectors[:, 0 if component in ("x", "u") else 1]
    name = component if in_pixels else f"$U_{component}$"
    unit = "px" if in_pixels else field.unit.replace("$", r"\$") or "mesh unit"
    return _plot_nodal_field(field, image, values, f"{name} ({unit})", on)


def plot_strain(
    field: MeasuredField,
    image: Image,
    component: Strain = "eyy",
    *,
    measure: StrainMeasure = "green-lagrange",
    on: Configuration = "deformed",
) -> Figure:
    """Draw a strain, projected onto the nodes, over an image.

    Parameters
    ----------
    field : Result
        The displacement field.
    image : ndarray, shape (height, width)
        The deformed or the reference image.
    component : {"exx", "eyy", "exy", "e1", "e2", "von_mises"}
        Component along the axes of the mesh's frame, principal strain, or von Mises strain; see `fedic.Strains`.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure; the colour bar names it.
    on : {"deformed", "reference"}
        Configuration in which the mesh is drawn.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.

    Raises
    ------
    OptionError
        If `component`, `measure` or `on` is unknown.
    """
    check_choice("component", component, get_args(Strain))
    strains = field.strains(measure, at="nodes")
    e1, e2 = strains.principal.T
    values = {
        "exx": strains.exx,
        "eyy": strains.eyy,
        "exy": strains.exy,
        "e1": e1,
        "e2": e2,
        "von_mises": strains.von_mises,
    }
    label = f"{_STRAIN_SYMBOLS[component]} ({_MEASURE_NAMES[strains.measure]})"
    return _plot_nodal_field(field, image, values[component], label, on)


def plot_field(
    field: MeasuredField,
    image: Image,
    name: Component | Strain,
    *,
    measure: StrainMeasure = "green-lagrange",
    on: Configuration = "deformed",
) -> Figure:
    """Draw a displacement or a strain over an image.

    Parameters
    ----------
    field : Result
        The displacement field.
    image : ndarray, shape (height, width)
        The deformed or the reference image.
    name : str
        A component of `plot_displacement` or of `plot_strain`.
    measure : {"green-lagrange", "hencky", "small"}
        Measure of the strain.
    on : {"deformed", "reference"}
        Configuration in which the mesh is drawn.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.

    Raises
    ------
    OptionError
        If `name`, `measure` or `on` is unknown.
    """
    check_choice("field", name, (*get_args(Strain), *get_args(Component)))
    match name:
        case "x" | "y" | "u" | "v":
            return plot_displacement(field, image, name, on=on)
        case _:
            return plot_strain(field, image, name, measure=measure, on=on)


def _plot_nodal_field(field: MeasuredField, image: Image, values: Floats, label: str, on: Configuration) -> Figure:
    check_choice("on", on, get_args(Configuration))
    pixels = field.camera.project(field.mesh.points)
    if on == "deformed":
        # Nodes that were not measured are drawn at rest, in the outlines of flagged cells only.
        pixels = pixels + np.nan_to_num(field.pixel_displacement)
    figure, axes = _image_figure(image, pixels[field.mesh.used_nodes])
    colours = draw_nodal_field(axes, field.mesh, pixels, values, alpha=0.8)
    figure.colorbar(colours, ax=axes, label=label, extend="both", shrink=0.9)
    _mark_doubtful(axes, field, pixels)
    return figure


def _mark_doubtful(axes: Axes, field: MeasuredField, pixels: Floats) -> None:
    """Draw the outlines of flagged cells, and say in the title what is doubtful."""
    quality = field.quality
    flagged = quality.cell_flags != 0
    first = 0
    for outline in field.mesh.outlines():
        of_type = outline[flagged[first : first + len(outline)]]
        first += len(outline)
        closed = np.concatenate([of_type, of_type[:, :1]], axis=1)
        axes.add_collection(LineCollection(list(pixels[closed]), colors=_DOUBTFUL, linewidths=0.8))
    if not quality.is_good:
        parts = [] if quality.converged else ["NOT CONVERGED"]
        parts += [f"{flagged.sum()} of {flagged.size} cells flagged"] if flagged.any() else []
        parts += ["periodic texture"] if len(quality.repeats) else []
        axes.set_title("; ".join(parts) or "doubtful", color=_DOUBTFUL, fontsize="medium")


def plot_residual(residual: NDArray[np.float32]) -> Figure:
    """Draw a residual map, cropped to the mesh.

    Parameters
    ----------
    residual : ndarray of float32, shape (height, width)
        From `fedic.Correlator.residual_map`; NaN is left blank.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.

    Raises
    ------
    ImageError
        If the map is NaN everywhere.
    """
    inside = np.isfinite(residual)
    if not inside.any():
        raise ImageError("The residual map has no pixel inside the mesh.")
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    corners = np.array([[columns[0], rows[0]], [columns[-1], rows[-1]]], dtype=np.float64)
    limits = _limits(residual.shape, corners)
    figure, axes = _axes(limits)
    left, right, top, bottom = limits
    step = -(-max(right - left, bottom - top) // _BACKDROP_SIDE)
    reach = 3.0 * float(residual[inside].std()) or 1.0
    drawn = axes.imshow(
        residual[top:bottom:step, left:right:step],
        cmap=SIGNED,
        vmin=-reach,
        vmax=reach,
        extent=_extent(limits),
        interpolation="nearest",
    )
    figure.colorbar(drawn, ax=axes, label="residual (grey levels)", extend="both", shrink=0.9)
    return figure


def plot_mesh(mesh: Mesh, camera: Camera, image: Image) -> Figure:
    """Draw a mesh over an image.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    camera : ImageFrame, FrontParallel or Pinhole
        Camera that projects the mesh.
    image : ndarray, shape (height, width)
        The reference image.

    Returns
    -------
    Figure
        The figure; `fedic.plotting.save_figure` writes it.
    """
    pixels = camera.project(mesh.points)
    figure, axes = _image_figure(image, pixels[mesh.used_nodes])
    for outline in mesh.outlines():
        closed = np.concatenate([outline, outline[:, :1]], axis=1)
        axes.add_collection(LineCollection(list(pixels[closed]), colors="tab:orange", linewidths=0.5))
    return figure


def draw_nodal_field(
    axes: Axes,
    mesh: Mesh,
    pixels: Floats,
    values: Floats,
    *,
    limits: tuple[float, float] | None = None,
    alpha: float = 1.0,
) -> ScalarMappable:
    """Draw a nodal field with interpolated colours, without the cells where it is NaN.

    Parameters
    ----------
    axes : Axes
        Axes to draw into.
    mesh : Mesh
        The mesh.
    pixels : ndarray, shape (n, 2)
        Positions of its nodes in the figure.
    values : ndarray, shape (n,)
        Nodal values.
    limits : (float, float), optional
        Values at the ends of the colour scale; by default from the field.
    alpha : float
        Opacity.

    Returns
    -------
    ScalarMappable
        The mappable, for a colour bar.
    """
    low, high = limits or _colour_limits(values[mesh.used_nodes])
    points, all_values, triangles = _triangles(mesh, pixels, values)
    is_known = np.isfinite(points[triangles]).all(axis=(1, 2)) & np.isfinite(all_values[triangles]).all(axis=1)
    colours = Normalize(low, high)
    if not is_known.any():
        return ScalarMappable(colours, SEQUENTIAL)
    return axes.tripcolor(
        points[:, 0],
        points[:, 1],
        all_values,
        triangles=triangles[is_known],
        shading="gouraud",
        cmap=SIGNED if low == -high else SEQUENTIAL,
        norm=colours,
        alpha=alpha,
    )


def _colour_limits(values: Floats) -> tuple[float, float]:
    """Return limits of the field without its extreme values, symmetric about zero if it clearly has both signs."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 1.0
    low, high = np.percentile(known, (_CLIPPED_PERCENT, 100.0 - _CLIPPED_PERCENT))
    reach = max(abs(low), abs(high))
    if low < 0.0 < high and min(-low, high) > 0.1 * reach:
        return -float(reach), float(reach)
    if low == high:
        reach = max(reach * 1e-6, 1e-12)
        return float(low - reach), float(high + reach)
    return float(low), float(high)


def _triangles(mesh: Mesh, pixels: Floats, values: Floats) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Cut each cell into triangles around its centre; triangles stay whole."""
    points, all_values, triangles = [pixels], [values], []
    count = len(pixels)
    for (name, nodes), outline in zip(mesh.cells.items(), mesh.outlines(), strict=True):
        if outline.shape[1] == 3:
            triangles.append(outline)
            continue
        weights = np.array(CELL_TYPES[name].centre_weights)
        points.append(np.einsum("k,mkd->md", weights, pixels[nodes]))
        all_values.append(values[nodes] @ weights)
        hub = np.broadcast_to(count + np.arange(len(outline))[:, np.newaxis], outline.shape)
        triangles.append(np.stack([hub, outline, np.roll(outline, -1, axis=1)], axis=-1).reshape(-1, 3))
        count += len(outline)
    return np.concatenate(points), np.concatenate(all_values), np.concatenate(triangles)


def _limits(shape: tuple[int, ...], pixels: Floats) -> tuple[int, int, int, int]:
    """Return left, right, top, bottom (right and bottom excluded) of the part of an image around some pixels."""
    height, width = shape
    low, high = np.nanmin(pixels, axis=0), np.nanmax(pixels, axis=0)
    margin = _MARGIN * float((high - low).max())
    left, top = np.clip(np.floor(low - margin), 0, (width - 1, height - 1)).astype(int)
    right, bottom = np.clip(np.ceil(high + margin) + 1, (left + 1, top + 1), (width, height)).astype(int)
    return int(left), int(right), int(top), int(bottom)


def _extent(limits: tuple[int, int, int, int]) -> tuple[float, float, float, float]:
    left, right, top, bottom = limits
    return left - 0.5, right - 0.5, bottom - 0.5, top - 0.5


def _axes(limits: tuple[int, int, int, int]) -> tuple[Figure, Axes]:
    left, right, top, bottom = limits
    inches = _LONG_SIDE_INCHES / max(right - left, bottom - top)
    figure = Figure(figsize=(2.0 + inches * (right - left), 0.8 + inches * (bottom - top)), layout="compressed")
    axes = figure.add_subplot()
    axes.set(xlabel="u (px)", ylabel="v (px)", aspect="equal")
    return figure, axes


def _image_figure(image: Image, pixels: Floats) -> tuple[Figure, Axes]:
    """Make a figure of an image in grey, cropped around some pixels."""
    import cv2

    limits = _limits(image.shape, pixels)
    left, right, top, bottom = limits
    crop: NDArray[Any] = np.ascontiguousarray(image[top:bottom, left:right])
    step = max(crop.shape) / _BACKDROP_SIDE
    if step > 1.0:
        size = (max(1, round(crop.shape[1] / step)), max(1, round(crop.shape[0] / step)))
        crop = np.asarray(cv2.resize(crop, size, interpolation=cv2.INTER_AREA))
    figure, axes = _axes(limits)
    axes.imshow(crop, cmap=IMAGE, extent=_extent(limits))
    axes.set_xlim(left - 0.5, right - 0.5)
    axes.set_ylim(bottom - 0.5, top - 0.5)
    axes.autoscale(False)
    return figure, axes
