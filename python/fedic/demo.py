"""The lens-distortion experiment: a large shift measured with and without the model of the lens.

After section 5.2 of Pierré et al., "Unstructured finite element-based digital image correlation with enhanced
management of quadrature and lens distortions": synthetic images of a plane through a real lens, moved by 400 and 200
pixels. The lens bends the motion by hundredths of a pixel, which a measurement in pixels takes for displacement.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fedic._core import BrownDistortion, ImageFrame, Pinhole, __version__, rectangle_mesh
from fedic._types import Floats, Image, Progress
from fedic.correlation import correlate
from fedic.files import write_json
from fedic.quadrature import MeshQuadrature, PixelQuadrature
from fedic.result import Result
from fedic.synthetic import Speckle, render

__all__ = ["Demo", "Measurement", "measure", "write_demo"]

SHAPE = (1036, 1388)
FOCAL = 8381.24
PRINCIPAL_POINT = (706.053, 503.725)
RADIAL = (-0.0321253, 0.0, 0.0)
DISTANCE = 1630.0
"""From the camera to the plane, in millimetres."""
PIXEL_MOTION = (-400.0, -200.0)
"""The paper samples its texture at X + S with S = (400, 200) px: the material moves by -S."""
BOUNDS = (800.3, 500.2, 1100.3, 800.2)
"""Of the mesh, in pixels."""
SPECKLE_PIXELS = 5.5
LEVELS = (0.04, 0.96)
"""With this size: a standard deviation of 57 grey levels and a gradient of 24 per pixel along each axis."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """One measurement of the demo against the truth.

    Attributes
    ----------
    name : str
        What was used.
    result : Result
        The measurement.
    errors : ndarray of float, shape (n, 2)
        Measured minus true displacement of the nodes along ``u`` and ``v``, in pixels.
    seconds : float
        Time of the correlation.
    """

    name: str
    result: Result
    errors: Floats
    seconds: float

    @property
    def bias(self) -> tuple[float, float]:
        """Mean of the errors, in pixels."""
        u, v = self.errors.mean(axis=0)
        return float(u), float(v)

    @property
    def std(self) -> tuple[float, float]:
        """Standard deviation of the errors, in pixels."""
        u, v = self.errors.std(axis=0)
        return float(u), float(v)


@dataclass(frozen=True, eq=False)
class Demo:
    """The images of the experiment and its two measurements.

    Attributes
    ----------
    reference, deformed : ndarray of uint8, shape (1036, 1388)
        The synthetic images.
    with_lens : Measurement
        Mesh in millimetres, calibrated camera, mesh quadrature.
    without_lens : Measurement
        Mesh in pixels, no camera, pixel quadrature.
    """

    reference: Image
    deformed: Image
    with_lens: Measurement
    without_lens: Measurement


def measure(
    size: float = 20.0,
    seed: int = 0,
    *,
    progress: Progress | None = None,
    on_render: Callable[[float], object] | None = None,
) -> Demo:
    """Make the images and measure them both ways.

    Parameters
    ----------
    size : float
        Edge of the quadrilateral elements, in pixels.
    seed : int
        Seed of the speckle.
    progress : callable, optional
        Progress of the correlations, see `fedic.Correlator.correlate`.
    on_render : callable, optional
        Called with the fraction of each image done.

    Returns
    -------
    Demo
        Images, results and errors.
    """
    millimetres = DISTANCE / FOCAL
    motion = (PIXEL_MOTION[0] * millimetres, -PIXEL_MOTION[1] * millimetres)  # Y is up, v is down
    camera = Pinhole(
        (FOCAL, FOCAL),
        PRINCIPAL_POINT,
        rotation=np.diag([1.0, -1.0, -1.0]),
        translation=(0.0, 0.0, DISTANCE),
        distortion=BrownDistortion(radial=RADIAL),
    )
    texture = Speckle(SPECKLE_PIXELS * millimetres, seed=seed)
    reference = render(texture, camera, SHAPE, levels=LEVELS, progress=on_render)
    deformed = render(texture, camera, SHAPE, displacement=motion, levels=LEVELS, progress=on_render)

    (left, bottom), (right, top) = camera.unproject([[BOUNDS[0], BOUNDS[3]], [BOUNDS[2], BOUNDS[1]]])[:, :2]
    start = time.perf_counter()
    with_lens = correlate(
        reference,
        deformed,
        rectangle_mesh((left, bottom, right, top), size=size * millimetres),
        camera,
        quadrature=MeshQuadrature(),
        initial="fft",
        tolerance=1e-5,
        progress=progress,
    )
    between = time.perf_counter()
    without_lens = correlate(
        reference,
        deformed,
        rectangle_mesh(BOUNDS, size=size),
        ImageFrame(),
        quadrature=PixelQuadrature(),
        initial="fft",
        tolerance=1e-5,
        progress=progress,
    )
    end = time.perf_counter()
    lens_errors = (with_lens.displacement - motion) / millimetres * (1.0, -1.0)
    flat_errors = without_lens.displacement - PIXEL_MOTION
    return Demo(
        reference,
        deformed,
        Measurement("mesh, with the lens", with_lens, lens_errors, between - start),
        Measurement("pixels, without the lens", without_lens, flat_errors, end - between),
    )


def write_demo(demo: Demo, folder: Path) -> None:
    """Write the images, the results, the error maps and ``demo.json``.

    Parameters
    ----------
    demo : Demo
        From `measure`.
    folder : Path
        An existing folder.
    """
    import tifffile

    tifffile.imwrite(folder / "reference.tif", demo.reference)
    tifffile.imwrite(folder / "deformed.tif", demo.deformed)
    demo.with_lens.result.write(folder / "with-lens.vtu")
    demo.without_lens.result.write(folder / "without-lens.vtu")
    _write_error_maps(demo, folder / "error-maps.png")
    cases = {"with_lens": demo.with_lens, "without_lens": demo.without_lens}
    write_json(folder / "demo.json", {"fedic": __version__, **{name: _summary(case) for name, case in cases.items()}})


def _summary(case: Measurement) -> dict[str, Any]:
    return {
        "name": case.name,
        "bias_px": list(case.bias),
        "std_px": list(case.std),
        "iterations": case.result.iterations,
        "num_points": case.result.num_points,
        "converged": case.result.converged,
        "seconds": round(case.seconds, 3),
    }


def _write_error_maps(demo: Demo, path: Path) -> None:
    from matplotlib.figure import Figure

    from fedic.plot import draw_nodal_field, save_figure

    cases = (demo.with_lens, demo.without_lens)
    reach = max(float(np.abs(case.errors[:, 1]).max()) for case in cases)
    figure = Figure(figsize=(10.0, 5.0), layout="compressed")
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, case in zip(panels, cases, strict=True):
        result = case.result
        pixels = result.camera.project(result.mesh.points)
        colours = draw_nodal_field(axes, result.mesh, pixels, case.errors[:, 1], limits=(-reach, reach))
        axes.set(
            title=f"{case.name}\nbias {case.bias[1]:+.5f} px, std {case.std[1]:.4f} px",
            xlabel="u (px)",
            aspect="equal",
        )
    panels[0].set_ylabel("v (px)")
    panels[0].invert_yaxis()
    figure.colorbar(colours, ax=panels, label="error of the vertical displacement (px)", shrink=0.9)
    save_figure(figure, path)
