"""Accuracy of non-parametric lenses for a lens that no parametric model represents."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from fedic._core import BrownDistortion, InverseSplineDistortion, Mesh, Pinhole, SplineDistortion
from fedic._internal.types import Floats
from fedic.calibration import Calibration, calibrate_points
from fedic.cameras.poses import with_pose
from fedic.correlation import correlate
from fedic.demo.scene import FOCAL, HEIGHT, MILLIMETRES, PIXEL_MOTION, PRINCIPAL_POINT, RADIAL, WIDTH, ImagePair, Scene
from fedic.experiments.option_sets import DEFAULT
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import window_mesh
from fedic.plotting.colour_maps import SIGNED
from fedic.registration import register

__all__ = ["run"]

MODELS = ("radial1", "brown", "spline", "inverse-spline")
SPLINE_MODELS = MODELS[2:]
WAVE, AMPLITUDE = 500.0, 0.5
"""Wavelength and amplitude of the waves, in pixels."""
BUMP, BUMP_WIDTH = (200.0, -120.0), 90.0
"""Position of the bump relative to the principal point, and the standard deviation of its shape, in pixels."""
TRUE_INTERVALS = (70, 52)
VIEWS, COLUMNS, ROWS, NOISE = 30, 20, 10, 0.02
PITCH = 45.0
"""Pitch of the target, in pixels of the optical axis."""
MARGIN = 4.0
"""Distance between the target and the borders of the image, in pixels."""
BORDER = 30.0
"""Border of the image, in pixels, in which the cameras are not evaluated: few target points reach its corners."""
LARGEST_TILT, LARGEST_TURN = 0.5, 0.3
CALIBRATIONS, QUICK_CALIBRATIONS = 5, 1
SIZE = 20.0
GRID = 40
LARGEST_ERROR, LEAST_GAIN, LARGEST_DIFFERENCE = 0.01, 5.0, 1e-3


@dataclass(frozen=True, eq=False)
class _Views:
    points: list[Floats]
    pixels: list[Floats]


def run(request: Request) -> Outcome:
    """Calibrate a wavy lens with several models, and measure a large motion with the cameras found.

    Parameters
    ----------
    request : Request
        A quick run has one calibration instead of five.

    Returns
    -------
    Outcome
        Rows over calibration and model.
    """
    scene = Scene(_wavy_lens())
    pair = scene.pair(0).rounded()
    count = QUICK_CALIBRATIONS if request.quick else CALIBRATIONS
    rows: list[Row] = []
    maps: dict[str, Floats] = {}
    for draw in range(count):
        rng = np.random.default_rng(draw)
        views = _views(scene, rng)
        plane = _seen(scene, np.zeros(3), 0.5 * np.array([WIDTH, HEIGHT]), 1.0)
        found: dict[str, Pinhole] = {}
        for place, model in enumerate(MODELS):
            request.report((draw + place / len(MODELS)) / count)
            calibration = calibrate_points(views.points, views.pixels, (WIDTH, HEIGHT), model)
            found[model] = _placed(scene, calibration, pair, *plane)
            maps.setdefault(model, _errors_of_camera(scene, found[model]))
            rows.append(_row(scene, pair, draw, model, calibration, found[model]))
        for row in rows[-len(SPLINE_MODELS) :]:
            row["forms_differ_px"] = _difference(*(found[model].distortion for model in SPLINE_MODELS))
    return Outcome(
        "splines",
        "A lens that Brown's model cannot represent",
        "The paper's camera (Sect. 5.2) behind a lens with, beside its k1, waves "
        f"{WAVE:g} px long and a bump {BUMP_WIDTH:g} px wide, both of {AMPLITUDE:g} px. Each model is calibrated on "
        f"the same {VIEWS} views of {COLUMNS * ROWS} points with a noise of {NOISE:g} px ({count} draws), and placed "
        "before the specimen by the same points in its plane, without noise. *camera*: error of the displacement that "
        "these cameras make of a motion of (-400, -200) px, over all of the image that stays in it, "
        f"{BORDER:g} px from its borders. *measured*: that motion measured on rendered 8-bit images as in Fig. 16 "
        "(300 x 300 px, quadrilaterals of "
        f"{SIZE:g} px). *bias* and *std* are those of the worse component.",
        rows,
        _claims(rows),
        {"": _figure(maps)},
    )


def _wavy_lens() -> SplineDistortion:
    """Make the true lens: a spline far finer than any that is fitted, its coefficients the shape at their places."""
    nx, ny = TRUE_INTERVALS
    width, height = 1.1 * WIDTH, 1.1 * HEIGHT
    domain = (-width / 2, -height / 2, width / 2, height / 2)
    x, y = np.meshgrid(
        np.linspace(domain[0] - width / nx, domain[2] + width / nx, nx + 3),
        np.linspace(domain[1] - height / ny, domain[3] + height / ny, ny + 3),
    )
    wave = 2.0 * np.pi / WAVE
    bump = np.exp(-((x - BUMP[0]) ** 2 + (y - BUMP[1]) ** 2) / (2.0 * BUMP_WIDTH**2))
    along = AMPLITUDE * (np.sin(wave * x + 0.3) * np.cos(0.8 * wave * y) + bump)
    across = AMPLITUDE * (np.cos(0.7 * wave * x) * np.sin(wave * y + 1.0) - bump)
    retinal = np.stack([x, y], axis=-1) / FOCAL
    radial = BrownDistortion(RADIAL).distort(retinal.reshape(-1, 2)).reshape(retinal.shape) - retinal
    x0, y0, x1, y1 = (side / FOCAL for side in domain)
    return SplineDistortion((x0, y0, x1, y1), radial + np.stack([along, across], axis=-1) / FOCAL)


def _views(scene: Scene, rng: np.random.Generator) -> _Views:
    """Return views of the target from many directions, each in a corner of the image or at a random place."""
    views = _Views([], [])
    for view in range(VIEWS):
        angles = rng.uniform(-1.0, 1.0, 3) * (LARGEST_TILT, LARGEST_TILT, LARGEST_TURN)
        place = np.array([view // 2 % 2, view % 2]) if view % 6 < 4 else rng.uniform(0.0, 1.0, 2)
        distance, middle = rng.uniform(0.95, 1.05), 0.5 * np.array([WIDTH, HEIGHT])
        for _ in range(10):
            points, pixels = _seen(scene, angles, middle, distance)
            low, high = pixels.min(axis=0) - MARGIN, pixels.max(axis=0) + MARGIN
            middle = middle + place * (np.array([WIDTH, HEIGHT]) - high) + (1.0 - place) * (0.0 - low)
        views.points.append(points)
        views.pixels.append(pixels + rng.normal(0.0, NOISE, pixels.shape))
    return views


def _seen(scene: Scene, angles: Floats, middle: Floats, distance: float) -> tuple[Floats, Floats]:
    """Return the points of the target and the pixels they are seen at, its middle at one, at a relative distance."""
    import cv2

    column, row = np.meshgrid(np.arange(COLUMNS) - 0.5 * (COLUMNS - 1), np.arange(ROWS) - 0.5 * (ROWS - 1))
    points = np.column_stack([column.ravel(), row.ravel(), np.zeros(column.size)]) * PITCH * MILLIMETRES
    true = scene.camera
    x, y = (middle - PRINCIPAL_POINT) * MILLIMETRES * distance
    rotation = np.asarray(cv2.Rodrigues(angles)[0], dtype=np.float64) @ np.diag([1.0, -1.0, -1.0])
    place = (float(x), float(y), true.translation[2] * distance)
    return points, with_pose(true, rotation, np.array(place)).project(points)


def _placed(scene: Scene, calibration: Calibration, pair: ImagePair, points: Floats, pixels: Floats) -> Pinhole:
    """Return the camera found, before the plane of the scene by points whose places are known in it."""
    start = with_pose(calibration.camera, scene.camera.rotation, np.asarray(scene.camera.translation))
    middle = (np.array([0.5 * WIDTH, 0.5 * HEIGHT]) - PRINCIPAL_POINT) * (MILLIMETRES, -MILLIMETRES)
    where = points + np.array([*middle, 0.0])
    mesh = Mesh(where[[0, COLUMNS - 1, -1, -COLUMNS], :2], {"quad": [[0, 1, 2, 3]]})
    placed = register(mesh, pair.reference, start, points=(where, pixels), pixel_noise=NOISE).camera
    assert isinstance(placed, Pinhole)
    return placed


def _row(scene: Scene, pair: ImagePair, draw: int, model: str, calibration: Calibration, camera: Pinhole) -> Row:
    errors = _errors_of_camera(scene, camera)
    nodes = window_mesh(scene.window, SIZE, "quad")
    mesh = Mesh(camera.unproject(nodes.points)[:, :2], nodes.cells)
    result = correlate(pair.reference, pair.deformed, mesh, camera, initial="fft", **DEFAULT.options)
    nodal = (result.unchecked_displacement - scene.motion) / MILLIMETRES
    return {
        "calibration": draw,
        "model": model,
        "reprojection_px": calibration.reprojection_error,
        "camera_bias_px": float(np.abs(errors.mean(axis=0)).max()),
        "camera_std_px": float(errors.std(axis=0).max()),
        "camera_max_px": float(np.abs(errors).max()),
        "converged": result.converged,
        "measured_bias_px": float(np.abs(nodal.mean(axis=0)).max()),
        "measured_std_px": float(nodal.std(axis=0).max()),
        "forms_differ_px": float("nan"),
    }


def _errors_of_camera(scene: Scene, camera: Pinhole) -> Floats:
    """Return what a camera makes of the motion, less the motion, in pixels: (GRID**2, 2), by rows of the image."""
    left, top = (max(-motion, 0.0) + BORDER for motion in PIXEL_MOTION)
    u, v = np.meshgrid(np.linspace(left, WIDTH - 1.0 - BORDER, GRID), np.linspace(top, HEIGHT - 1.0 - BORDER, GRID))
    before = np.column_stack([u.ravel(), v.ravel()])
    after = scene.camera.project(scene.camera.unproject(before) + np.array([*scene.motion, 0.0]))
    moved = camera.unproject(after) - camera.unproject(before)
    errors: Floats = (moved[:, :2] - scene.motion) / MILLIMETRES
    return errors


def _difference(direct: object, inverse: object) -> float:
    """Return the largest distance of where two lenses show a point within the domains of both, in pixels."""
    assert isinstance(direct, SplineDistortion)
    assert isinstance(inverse, InverseSplineDistortion)
    x0, y0, x1, y1 = inverse.domain
    seen = np.stack(np.meshgrid(np.linspace(x0, x1, 101), np.linspace(y0, y1, 101)), axis=-1).reshape(-1, 2)
    points = inverse.undistort(seen)
    x0, y0, x1, y1 = direct.domain
    inside = (points >= (x0, y0)).all(axis=1) & (points <= (x1, y1)).all(axis=1)
    return float(FOCAL * np.abs(direct.distort(points[inside]) - seen[inside]).max())


def _worst(rows: list[Row], models: tuple[str, ...], *keys: str) -> float:
    return max(float(row[key]) for row in rows for key in keys if row["model"] in models)


def _claims(rows: list[Row]) -> list[Claim]:
    camera, measured = ("camera_bias_px", "camera_std_px"), ("measured_bias_px", "measured_std_px")
    of_brown = {model: _worst(rows, (model,), *camera) for model in MODELS[:2]}
    best = min(of_brown, key=lambda model: of_brown[model])
    splines, difference = _worst(rows, SPLINE_MODELS, *camera), _worst(rows, SPLINE_MODELS, "forms_differ_px")
    return [
        Claim(
            f"displacement error (bias, std) of the cameras with splines at most {LARGEST_ERROR:g} px",
            f"at most {splines:.4f} px (largest anywhere {_worst(rows, SPLINE_MODELS, 'camera_max_px'):.3f} px)",
            splines <= LARGEST_ERROR,
        ),
        Claim(
            f"likewise measured on images: at most {LARGEST_ERROR:g} px",
            f"at most {_worst(rows, SPLINE_MODELS, *measured):.4f} px",
            _worst(rows, SPLINE_MODELS, *measured) <= LARGEST_ERROR and all(row["converged"] for row in rows),
        ),
        Claim(
            f"at least {LEAST_GAIN:g} times below the best of Brown's models",
            f"{of_brown[best] / splines:.0f} times below {best} ({of_brown[best]:.2f} px)",
            of_brown[best] >= LEAST_GAIN * splines,
        ),
        Claim(
            f"direct and inverse form agree to {LARGEST_DIFFERENCE:g} px",
            f"{difference:.1e} px",
            difference <= LARGEST_DIFFERENCE,
        ),
    ]


def _figure(maps: dict[str, Floats]) -> Figure:
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    left, top = (max(-motion, 0.0) + BORDER for motion in PIXEL_MOTION)
    for axes, (model, errors) in zip(figure.subplots(2, 2).ravel(), maps.items(), strict=True):
        field = errors[:, 0].reshape(GRID, GRID)
        limit = float(np.abs(field).max())
        picture = axes.imshow(
            field,
            cmap=SIGNED,
            vmin=-limit,
            vmax=limit,
            extent=(left, WIDTH - 1.0 - BORDER, HEIGHT - 1.0 - BORDER, top),
        )
        axes.set(title=f"{model}: at most {limit:.2g} px", xlabel="u (px)", ylabel="v (px)")
        figure.colorbar(picture, ax=axes, label="error of $U_x$ (px)", shrink=0.9)
    return figure
