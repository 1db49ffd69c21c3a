"""Calibration on the specimen: errors of the lens from its motions, and of measurements with that camera."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fedic._core import BrownDistortion, Mesh, Pinhole, rectangle_mesh
from fedic._internal.types import Floats, Image
from fedic.calibration.specimen import calibrate_on_specimen
from fedic.correlation import correlate
from fedic.demo.scene import HEIGHT, LEVELS, MILLIMETRES, PRINCIPAL_POINT, RADIAL, SPECKLE, WIDTH, ImagePair, Scene
from fedic.experiments.lens_errors import measure
from fedic.experiments.option_sets import DEFAULT
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.synthetic import Speckle, add_noise, render

__all__ = ["run"]

DIRECTIONS = ((-1.0, -0.5), (0.75, -0.625), (0.125, 1.0))
"""Directions of the motions, to be multiplied by the largest component in pixels."""
LENGTHS, QUICK_LENGTHS = (50.0, 100.0, 200.0, 400.0), (400.0,)
NOISES = (0.0, 2.0)
"""Added before rounding to 8 bits, in grey levels."""
PARAMETERS = ("k1", "cx", "cy")
CELLS, SIZE = 40.0, 20.0
"""Edges of the cells for the calibration and for the measurement, in pixels."""
OTHER_TEXTURE = 7
LARGEST_K1_ERROR, LARGEST_ERROR, IGNORED, LARGEST_ADDED = 0.01, 0.003, 0.016, 2e-4
_STEPS_OF_8_BITS = 65535 / 255


def run(request: Request) -> Outcome:
    """Calibrate on motions of several lengths, and measure another specimen with the camera found.

    Parameters
    ----------
    request : Request
        A quick run has the largest length only, and images with fewer samples per pixel.

    Returns
    -------
    Outcome
        Rows over length and noise.
    """
    scene = Scene()
    texture = Speckle(SPECKLE * MILLIMETRES, seed=0)
    supersampling = 2 if request.quick else 3
    reference = _image(scene, texture, None, supersampling)
    pair = scene.pair(OTHER_TEXTURE).rounded()
    window = rectangle_mesh(scene.window, SIZE)
    ignored = measure(scene, pair, window, DEFAULT, DEFAULT.quadrature("pixel"), lens=False).errors
    lengths = QUICK_LENGTHS if request.quick else LENGTHS
    rows: list[Row] = []
    for done, length in enumerate(lengths):
        request.report(done / len(lengths))
        clean = [reference] + [_image(scene, texture, (length * u, length * v), supersampling) for u, v in DIRECTIONS]
        for noise in NOISES:
            images = [add_noise(image, noise=noise, seed=seed, bits=8) for seed, image in enumerate(clean)]
            rows.append(_row(scene, images, pair, window, ignored, length, noise))
    return Outcome(
        "specimen",
        "The camera from the specimen itself",
        "The paper's camera (Sect. 5.2: 1388 x 1036 px, k1 = -0.0321253) sees a speckled plane at rest and after three "
        f"translations. `calibrate_on_specimen` finds {', '.join(PARAMETERS)} from these four 8-bit images, from no "
        "lens and the middle of the image, without being told the motions; *noise* is that of the images before "
        "rounding. With the camera found, another texture moved by (-400, -200) px is measured as in Fig. 16 "
        f"(quadrilaterals of {SIZE:g} px; *error* is the larger component), and in pixels as if there were no lens.",
        rows,
        _claims(rows),
        {"": _figure(rows)},
    )


def _image(
    scene: Scene, texture: Speckle, motion: tuple[float, float] | None, supersampling: int
) -> NDArray[np.float32]:
    """Render in grey levels of 8 bits, not rounded."""
    moved = None if motion is None else (motion[0] * MILLIMETRES, -motion[1] * MILLIMETRES)
    fine = render(
        texture,
        scene.camera,
        (HEIGHT, WIDTH),
        displacement=moved,
        supersampling=supersampling,
        levels=LEVELS,
        bits=16,
    )
    grey: NDArray[np.float32] = fine.astype(np.float32) / np.float32(_STEPS_OF_8_BITS)
    return grey


def _row(
    scene: Scene, images: Sequence[Image], pair: ImagePair, window: Mesh, ignored: Floats, length: float, noise: float
) -> Row:
    true = scene.camera
    start = Pinhole(true.focal, ((WIDTH - 1) / 2, (HEIGHT - 1) / 2), true.rotation, true.translation)
    pixels = rectangle_mesh((0.0, 0.0, WIDTH - 1.0, HEIGHT - 1.0), CELLS)
    mesh = Mesh(start.unproject(pixels.points)[:, :2], pixels.cells)
    found = calibrate_on_specimen(images[0], images[1:], mesh, start, PARAMETERS)
    lens = found.camera.distortion
    values = (lens.radial[0] if isinstance(lens, BrownDistortion) else 0.0, *found.camera.principal_point)
    errors = dict(zip(PARAMETERS, np.array(values) - (RADIAL[0], *PRINCIPAL_POINT), strict=True))
    deviations = found.standard_deviations
    nodal = _errors(scene, found.camera, pair, window)
    exact = _errors(scene, true, pair, window)
    return {
        "motion_px": length,
        "noise": noise,
        "converged": found.converged,
        "noise_found": found.noise,
        **{f"{name}_error": float(error) for name, error in errors.items()},
        **{f"{name}_deviation": deviation for name, deviation in deviations.items()},
        "largest_score": max(abs(float(errors[name])) / deviations[name] for name in PARAMETERS),
        "bias_px": float(np.abs(nodal.mean(axis=0)).max()),
        "std_px": float(nodal.std(axis=0).max()),
        "true_camera_bias_px": float(np.abs(exact.mean(axis=0)).max()),
        "true_camera_std_px": float(exact.std(axis=0).max()),
        "of_the_camera_px": float(np.sqrt(np.mean((nodal - exact) ** 2))),
        "ignored_bias_px": float(np.abs(ignored.mean(axis=0)).max()),
        "ignored_std_px": float(ignored.std(axis=0).max()),
    }


def _errors(scene: Scene, camera: Pinhole, pair: ImagePair, window: Mesh) -> Floats:
    """Measured less true displacement of the nodes with a camera, in pixels of the optical axis."""
    mesh = Mesh(camera.unproject(window.points)[:, :2], window.cells)
    result = correlate(pair.reference, pair.deformed, mesh, camera, initial="fft", **DEFAULT.options)
    errors: Floats = (result.unchecked_displacement - scene.motion) / MILLIMETRES * (1.0, -1.0)
    return errors


def _claims(rows: list[Row]) -> list[Claim]:
    longest = [row for row in rows if row["motion_px"] == max(row["motion_px"] for row in rows)]
    worst_k1 = max(abs(row["k1_error"] / RADIAL[0]) for row in longest)
    bias, std = (max(row[key] for row in longest) for key in ("bias_px", "std_px"))
    ignored = longest[0]["ignored_bias_px"]
    return [
        Claim(
            f"three translations of up to {longest[0]['motion_px']:g} px: k1 within {LARGEST_K1_ERROR:.0%}",
            ", ".join(f"{abs(row['k1_error'] / RADIAL[0]):.3%} (noise {row['noise']:g})" for row in longest),
            worst_k1 <= LARGEST_K1_ERROR,
        ),
        Claim(
            f"with that camera: bias and standard deviation of the displacement at most {LARGEST_ERROR:g} px where "
            "ignoring the lens gives a bias of 0.017 px",
            f"bias {bias:.1e} px, standard deviation {std:.1e} px; ignored: bias {ignored:.4f} px",
            max(bias, std) <= LARGEST_ERROR and ignored >= IGNORED,
        ),
        Claim(
            f"at every length and noise the camera found adds at most {LARGEST_ADDED:g} px to that displacement (root "
            "mean square)",
            f"at most {max(row['of_the_camera_px'] for row in rows):.1e} px",
            all(row["of_the_camera_px"] <= LARGEST_ADDED for row in rows),
        ),
        Claim(
            "k1, cx and cy within three of their standard deviations, at every length and noise",
            f"at most {max(row['largest_score'] for row in rows):.1f}",
            all(row["largest_score"] <= 3.0 for row in rows),
        ),
    ]


def _figure(rows: list[Row]) -> Figure:
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for noise, colour in zip(NOISES, ("tab:blue", "tab:orange"), strict=True):
        line = [row for row in rows if row["noise"] == noise]
        motions = [row["motion_px"] for row in line]
        label = f"noise of {noise:g} grey levels" if noise else "rounding to 8 bits only"
        left.plot(motions, [abs(row["k1_deviation"] / RADIAL[0]) for row in line], "-", color=colour, label=label)
        left.plot(motions, [abs(row["k1_error"] / RADIAL[0]) for row in line], "o", color=colour)
        right.plot(motions, [row["of_the_camera_px"] for row in line], "o-", color=colour, label=f"camera, {label}")
    lengths = sorted({row["motion_px"] for row in rows})
    exact, ignored = rows[0]["true_camera_std_px"], rows[0]["ignored_bias_px"]
    right.axhline(ignored, color="tab:red", linestyle="--", label="lens ignored (bias)")
    right.axhline(exact, color="k", linestyle="-.", label="true camera (rounding alone)")
    left.set(title="k1 from the specimen", ylabel="relative standard deviation (line), error (points)")
    right.set(title="what it adds to a displacement of (400, 200) px", ylabel="root mean square error (px)")
    for axes in (left, right):
        axes.set(xscale="log", yscale="log", xlabel="largest motion of the specimen (px)")
        axes.set_xticks(lengths, [f"{length:g}" for length in lengths])
        axes.set_xticks([], minor=True)
        axes.grid(visible=True, which="both", alpha=0.25)
        axes.legend(fontsize="small")
    return figure
