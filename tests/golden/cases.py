"""The measurements whose results are stored: mesh, camera, images and options of each."""

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

import fedic

FOLDER = Path(__file__).parent
FEDIC_RESULTS = FOLDER / "fedic_results.npz"
CELLS = ("triangle", "triangle6", "quad", "quad8", "quad9")
CENTRE = np.array([100.0, 80.0])
SCALE = 10.0
"""Pixels per mesh unit of the cameras, about; `ImageFrame` has 1."""
NOISE = 1.0
"""Grey levels, of the stored standard deviations."""

LENS = fedic.BrownDistortion((-8.0, 20.0, 0.0), (0.02, -0.03), (0.01, 0.02))
DOMAIN = (-0.1, -0.08, 0.1, 0.08)
"""Normalised image coordinates that the spline lenses cover."""

Arrays = dict[str, NDArray[Any]]


def _pinhole(lens: Any = None) -> fedic.Pinhole:
    return fedic.Pinhole(
        (1600.0, 1650.0),
        (102.0, 78.0),
        rotation=[np.pi + 0.1, -0.08, 0.05],
        translation=(0.1, 0.2, 160.0),
        skew_angle=1.56,
        distortion=lens,
    )


def _spline() -> fedic.SplineDistortion:
    """Return a spline lens of given coefficients, which move image points by up to 3 px."""
    i, j = np.meshgrid(np.arange(9.0), np.arange(8.0))
    return fedic.SplineDistortion(DOMAIN, 0.002 * np.stack([np.sin(1.1 * j + 1.0), np.cos(0.9 * i)], axis=-1))


CAMERAS: dict[str, Any] = {
    "image_frame": fedic.ImageFrame(),
    "front_parallel": fedic.FrontParallel(SCALE, (102.0, 78.0), 0.1),
    "pinhole": _pinhole(),
    "brown": _pinhole(LENS),
    "spline": _pinhole(_spline()),
    "inverse_spline": _pinhole(fedic.InverseSplineDistortion.from_lens(_spline(), tolerance=1e-6)),
}


def mesh(cell: str, camera: str = "image_frame", size: float = 22.0) -> fedic.Mesh:
    """Return a distorted mesh over the middle of the image; quadratic cells have curved edges."""
    flat = fedic.rectangle_mesh((45.3, 36.6, 155.3, 124.6), size, cell)  # type: ignore[arg-type]
    points = flat.points[:, :2]
    wave = np.column_stack([np.sin(0.31 * points[:, 1] + 0.2 * points[:, 0]), np.cos(0.27 * points[:, 0])])
    pixels = points + 1.5 * wave
    if camera == "image_frame":
        return fedic.Mesh(pixels, flat.cells)
    return fedic.Mesh((pixels - CENTRE) * [1.0, -1.0] / SCALE, flat.cells)


def mixed_mesh() -> fedic.Mesh:
    """Return a mesh of quads, the right half of them cut into triangles."""
    quads = mesh("quad")
    cells = quads.cells["quad"]
    right = quads.points[cells].mean(axis=1)[:, 0] > CENTRE[0]
    cut = cells[right]
    triangles = np.concatenate([cut[:, :3], cut[:, [0, 2, 3]]])
    return fedic.Mesh(quads.points[:, :2], {"quad": cells[~right], "triangle": triangles})


@dataclass(frozen=True)
class Case:
    """One measurement, and the tolerance of its comparison in pixels."""

    mesh: fedic.Mesh
    camera: Any = field(default_factory=fedic.ImageFrame)
    deformed: str = "deformed"
    options: dict[str, Any] = field(default_factory=dict)
    noise: bool = False
    """Whether the standard deviations are stored as well."""


def _cases() -> dict[str, Case]:
    cases = {}
    for cell in CELLS:
        for name, camera in CAMERAS.items():
            cases[f"{name}/{cell}"] = Case(mesh(cell, name), camera, noise=name in ("image_frame", "brown"))
        cases[f"updated/{cell}"] = Case(mesh(cell, "brown"), CAMERAS["brown"], options={"hessian": "updated"})
        for brightness in ("global", "element", None):
            options = {"brightness": brightness}
            cases[f"brightness_{brightness}/{cell}"] = Case(mesh(cell), deformed="uneven_light", options=options)
        for rule in ("edges", "diameter"):
            options = {"quadrature": fedic.MeshQuadrature(rule=rule)}  # type: ignore[arg-type]
            cases[f"{rule}/{cell}"] = Case(mesh(cell), options=options)
        cases[f"pixel/{cell}"] = Case(mesh(cell), options={"quadrature": fedic.PixelQuadrature()})
        cases[f"regularized/{cell}"] = Case(mesh(cell), options={"regularization_length": 60.0}, noise=True)
        cases[f"pyramid/{cell}"] = Case(mesh(cell), deformed="far", options={"initial": "pyramid"})
    for interpolation in ("bilinear", "bicubic", "bspline3"):
        cases[f"{interpolation}/quad"] = Case(mesh("quad"), options={"interpolation": interpolation})
    for density in (0.3, 4.0):
        options = {"quadrature": fedic.MeshQuadrature(density=density)}
        cases[f"density_{density}/triangle"] = Case(mesh("triangle"), options=options, noise=True)
    for smoothing in (0.0, 2.0):
        cases[f"smoothing_{smoothing}/quad"] = Case(mesh("quad"), options={"smoothing": smoothing}, noise=True)
    cases["finite_difference/quad"] = Case(mesh("quad"), options={"gradient": "finite-difference"})
    cases["mixed"] = Case(mixed_mesh(), noise=True)
    start = np.full((mesh("quad9").num_nodes, 2), [13.2, -9.1])
    cases["given_start/quad9"] = Case(mesh("quad9"), deformed="far", options={"initial": start})
    # More than a thousand cells: the start is followed by the fit of a smooth field.
    cases["smooth_start/quad"] = Case(mesh("quad", size=3.0), options={"regularization_length": 20.0})
    return cases


CASES = _cases()


def image(name: str) -> NDArray[np.uint8]:
    """Return a stored image."""
    found = cv2.imread(str(FOLDER / "images" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
    assert found is not None
    return found  # type: ignore[return-value]


def measure(case: Case) -> Arrays:
    """Return what is stored of a measurement; displacements and standard deviations in the mesh's unit."""
    options = {"tolerance": 1e-5, "max_iterations": 200, "initial": "zero", **case.options}
    correlator = fedic.Correlator(image("reference"), case.mesh, case.camera, **options)
    with warnings.catch_warnings():
        # The regularization is too long for the field, and the light uneven.
        warnings.simplefilter("ignore", fedic.QualityWarning)
        result = correlator.correlate(image(case.deformed))
    assert result.converged
    found: Arrays = {
        "displacement": result.unchecked_displacement,
        "iterations": np.array(result.iterations),
        "num_points": np.array(result.num_points),
        "residual_rms": np.array(result.residual_rms),
        "cell_residuals": result.cell_residuals,
    }
    if case.noise:
        found["standard_deviations"] = correlator.standard_deviations(NOISE)
    return found
