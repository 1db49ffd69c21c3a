"""The lens-distortion demonstration: a large shift measured with and without the model of the lens.

After section 5.2 of Pierré et al., "Unstructured finite element-based digital image correlation with enhanced
management of quadrature and lens distortions": synthetic images of a plane through a real lens, moved by 400 and 200
pixels. The distortion changes the motion by hundredths of a pixel, which a measurement in pixels mistakes for
displacement.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fedic._core import __version__, rectangle_mesh
from fedic._internal.types import Image
from fedic.demo.measurement import Measurement, measure_pair
from fedic.demo.scene import Scene
from fedic.io.atomic import write_json
from fedic.plotting import save_figure
from fedic.plotting.error_maps import draw_error_maps
from fedic.progress import ProgressCallback
from fedic.quadrature import MeshQuadrature, PixelQuadrature

__all__ = ["Demo", "measure", "write_demo"]

_TOLERANCE = 1e-5
_MAX_ITERATIONS = 400


@dataclass(frozen=True, eq=False)
class Demo:
    """The images of the demonstration and its two measurements.

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
    progress: ProgressCallback | None = None,
) -> Demo:
    """Render the images and measure them with and without the lens.

    Parameters
    ----------
    size : float
        Edge of the quadrilateral elements, in pixels.
    seed : int
        Seed of the speckle.
    progress : callable, optional
        Called with a `fedic.Progress` while the images are rendered and measured.

    Returns
    -------
    Demo
        Images, results and errors.
    """
    scene = Scene()
    pair = scene.pair(seed, progress).rounded()
    mesh = rectangle_mesh(scene.window, size=size)
    with_lens, without_lens = (
        measure_pair(
            scene,
            pair,
            mesh,
            lens=lens,
            quadrature=MeshQuadrature() if lens else PixelQuadrature(),
            initial="fft",
            tolerance=_TOLERANCE,
            max_iterations=_MAX_ITERATIONS,
            progress=progress,
        )
        for lens in (True, False)
    )
    return Demo(pair.reference, pair.deformed, with_lens, without_lens)


def write_demo(demo: Demo, folder: Path) -> None:
    """Write the images, the results, the error maps and ``demo.json``.

    Parameters
    ----------
    demo : Demo
        Result of `measure`.
    folder : Path
        An existing folder.
    """
    import tifffile

    tifffile.imwrite(folder / "reference.tif", demo.reference)
    tifffile.imwrite(folder / "deformed.tif", demo.deformed)
    demo.with_lens.result.write(folder / "with-lens.vtu")
    demo.without_lens.result.write(folder / "without-lens.vtu")
    maps = [demo.with_lens.error_map, demo.without_lens.error_map]
    save_figure(draw_error_maps(maps), folder / "error-maps.png")
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
