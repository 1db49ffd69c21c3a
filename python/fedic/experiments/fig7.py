"""Fig. 7 of the paper: uncertainty and bias of both quadratures over element size, for sub-pixel translations."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fedic._internal.types import CellName
from fedic.experiments.option_sets import DEFAULT, LEGEND, PAPER, PAPER_SPLINES, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import SIZES, ReferenceImage, reference_images, window_mesh
from fedic.experiments.style import COLOURS, MARKERS
from fedic.experiments.sweep import measure_shifts

__all__ = ["run"]

SHIFTS = ((0.3, 0.0), (0.4, 0.0), (0.5, 0.0))
SETTINGS = (PAPER, PAPER_SPLINES, UNFILTERED, DEFAULT)
CELLS: tuple[CellName, ...] = ("quad", "triangle")
QUICK_SIZES = (10, 20)
SMALLEST_CLAIMED = 10
"""Smallest element size, in pixels, of the claims."""
GAIN, LARGEST_BIAS = 6.0, 1e-4


def run(request: Request) -> Outcome:
    """Measure three sub-pixel translations with every element size, cell, setting and quadrature.

    Parameters
    ----------
    request : Request
        Its image, if given, is measured in addition to the synthetic one.

    Returns
    -------
    Outcome
        Rows over image, setting, quadrature, cell and size.
    """
    images = reference_images(request)
    sizes = QUICK_SIZES if request.quick else SIZES
    rows: list[Row] = []
    for index, subject in enumerate(images):
        rows += _measure(subject, sizes, request.part(index, len(images)))
    return Outcome(
        "fig7",
        "Pixel against mesh quadrature over element size",
        "The reference image is translated by 0.3, 0.4 and 0.5 px along the columns in the Fourier domain, without "
        "rounding. Unstructured meshes of 220 x 321 px with corners off the pixels measure the translation without "
        "brightness correction; bias and standard deviation of the error over the nodes are averaged over the three "
        f"motions (paper, Sect. 4.2). {LEGEND}",
        rows,
        [claim for subject in images for claim in _claims(subject.name, rows)],
        {"": _figure([subject.name for subject in images], rows)},
    )


def _measure(subject: ReferenceImage, sizes: tuple[int, ...], request: Request) -> list[Row]:
    reference = subject.reference
    deformed = [subject.shifted(shift) for shift in SHIFTS]
    rows: list[Row] = []
    total = len(sizes) * len(CELLS) * len(SETTINGS) * 2
    for size in sizes:
        for cell in CELLS:
            mesh = window_mesh(subject.window, size, cell)
            for setting in SETTINGS:
                for kind in ("pixel", "mesh"):
                    found = measure_shifts(reference, deformed, SHIFTS, mesh, setting, setting.quadrature(kind))
                    rows.append(
                        {
                            "image": subject.name,
                            "setting": setting.name,
                            "quadrature": kind,
                            "cell": cell,
                            "size_px": size,
                        }
                        | found.as_row()
                    )
                    request.report(len(rows) / total)
    return rows


def _pick(rows: list[Row], image: str, setting: OptionSet, kind: str) -> dict[tuple[str, int], Row]:
    """Return the rows of the sizes of the claims, by cell and size."""
    return {
        (row["cell"], row["size_px"]): row
        for row in rows
        if (row["image"], row["setting"], row["quadrature"]) == (image, setting.name, kind)
        and row["size_px"] >= SMALLEST_CLAIMED
    }


def _claims(image: str, rows: list[Row]) -> list[Claim]:
    claims = []
    for setting in (PAPER, PAPER_SPLINES):
        pixel, mesh = _pick(rows, image, setting, "pixel"), _pick(rows, image, setting, "mesh")
        gains = np.array([pixel[key]["bias_px"] / mesh[key]["bias_px"] for key in mesh])
        noise = np.array([mesh[key]["std_px"] / pixel[key]["std_px"] for key in mesh])
        claims.append(
            Claim(
                f"{image} image, {setting.name}: bias of pixel quadrature at least {GAIN:g} times that of mesh "
                f"quadrature at every size from {SMALLEST_CLAIMED} px",
                f"{gains.min():.1f} to {gains.max():.1f} times",
                bool(gains.min() >= GAIN),
            )
        )
        claims.append(
            Claim(
                f"{image} image, {setting.name}: standard deviation of mesh quadrature not above pixel quadrature's",
                f"{noise.min():.2f} to {noise.max():.2f} times",
                bool(noise.max() <= 1.0),
            )
        )
    default, paper = _pick(rows, image, DEFAULT, "mesh"), _pick(rows, image, PAPER, "mesh")
    bias = max(row["bias_px"] for row in default.values())
    ratio = max(default[key]["std_px"] / paper[key]["std_px"] for key in default)
    claims.append(
        Claim(
            f"{image} image, default: bias at most {LARGEST_BIAS:g} px at every size from {SMALLEST_CLAIMED} px",
            f"at most {bias:.1e} px",
            bias <= LARGEST_BIAS,
        )
    )
    claims.append(
        Claim(
            f"{image} image, default: standard deviation at most that of the paper's setting",
            f"at most {ratio:.2f} times",
            ratio <= 1.0,
        )
    )
    return claims


def _figure(images: list[str], rows: list[Row]) -> Figure:
    figure = Figure(figsize=(11.0, 4.2 * len(images)), layout="constrained")
    panels = figure.subplots(len(images), 2, squeeze=False)
    for (left, right), image in zip(panels, images, strict=True):
        for axes, key, label in ((left, "std_px", "standard deviation"), (right, "bias_px", "|bias|")):
            _draw(axes, [row for row in rows if row["image"] == image], key)
            axes.set(xlabel="element size (px)", ylabel=f"{label} (px)", yscale="log", title=f"{image} image: {label}")
            axes.grid(visible=True, which="both", alpha=0.25)
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize="small")
    return figure


def _draw(axes: Axes, rows: list[Row], key: str) -> None:
    for (setting, kind), colour in COLOURS.items():
        for cell, marker in MARKERS.items():
            line = [row for row in rows if (row["setting"], row["quadrature"], row["cell"]) == (setting, kind, cell)]
            axes.plot(
                [row["size_px"] for row in line],
                [row[key] for row in line],
                marker=marker,
                color=colour,
                linestyle="-" if cell == "quad" else "--",
                label=f"{setting}, {kind}, {cell}",
            )
