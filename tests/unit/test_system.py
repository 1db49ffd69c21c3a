"""Gauss-Newton steps, solutions and quadrature points against dense computations in NumPy."""

import numpy as np
import pytest

import fedic
from fedic import _core

CELLS = ["triangle", "triangle6", "quad", "quad8", "quad9"]
CURVED = ["triangle6", "quad8", "quad9"]
LENS = fedic.Pinhole(
    (900, 950), (80, 70), rotation=[np.pi + 0.05, -0.04, 0.02], translation=(0.01, 0.02, 1.0), skew_angle=1.55,
    distortion=fedic.BrownDistortion((-0.2, 0.1, 0.05), (0.01, -0.02), (0.01, 0.02)),
)  # fmt: skip
CAMERAS = {"image": fedic.ImageFrame(), "front": fedic.FrontParallel(1000.0, (80.0, 70.0)), "lens": LENS}


def mesh_in_image(camera: object, cell: str, shake: float = 1.0) -> fedic.Mesh:
    """Return a rotated mesh of about 80 x 60 px with perturbed nodes, inside a 160 x 140 image."""
    mesh = fedic.rectangle_mesh((40.3, 40.6, 120.2, 99.8), 20.0, cell)  # type: ignore[arg-type]
    pixels = (mesh.points - (80, 70)) @ np.array([[0.99, 0.12], [-0.1, 0.98]]) + (80, 70)
    pixels += np.random.default_rng(3).uniform(-shake, shake, mesh.points.shape)
    return fedic.Mesh(camera.unproject(pixels)[:, :2], mesh.cells)  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def images() -> tuple[np.ndarray, np.ndarray]:
    texture = fedic.synthetic.Speckle(6.0, seed=2)
    reference = fedic.synthetic.render(texture, fedic.ImageFrame(), (140, 160))
    deformed = fedic.synthetic.render(texture, fedic.ImageFrame(), (140, 160), displacement=(0.4, -0.3))
    return reference, (0.9 * deformed + 7).astype(np.float32)


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("rule", ["rotated", "edges", "diameter", "pixel"])
@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("hessian", ["initial", "updated"])
def test_first_step_agrees_with_a_dense_system(
    images: tuple[np.ndarray, np.ndarray], camera: str, rule: str, cell: str, hessian: str
) -> None:
    projector = CAMERAS[camera]
    # The pixel rule assumes straight edges: a pixel beside a curved edge may be assigned to the neighbouring cell.
    mesh = mesh_in_image(projector, cell, shake=0.0 if rule == "pixel" and cell in CURVED else 1.0)
    # A turned and stretched start: the same deformation gradient at every node.
    gradient_of_motion = np.array([[1.001, 0.002], [-0.001, 0.999]])
    start = (mesh.points - mesh.points.mean(0)) @ (gradient_of_motion - np.eye(2)).T
    core = _core.Correlator(
        images[0], mesh, projector, quadrature=rule, hessian=hessian, interpolation="bspline3", smoothing=0.0,
        max_iterations=1, tolerance=1e-12,
    )  # type: ignore[call-overload]  # fmt: skip
    step = core.correlate(images[1], initial=start).unchecked_displacement - start

    points, weights, _ = core.quadrature_points()
    shape = mesh.interpolate(np.eye(mesh.num_nodes), points)
    assert not np.isnan(shape).any()
    f, gradient = (x.astype(float) for x in _core.interpolate_image(images[0], projector.project(points), "bspline3"))
    moved = points.copy()
    moved[:, :2] += shape @ start
    g = _core.interpolate_image(images[1], projector.project(moved), "bspline3")[0].astype(float)

    def mean(x: np.ndarray) -> float:
        return float(np.average(x, weights=weights))

    gain = np.sqrt(mean((f - mean(f)) ** 2) / mean((g - mean(g)) ** 2))
    residual = f - mean(f) - gain * (g - mean(g))

    def rows_of(at: np.ndarray) -> np.ndarray:
        q = np.einsum("nij,ni->nj", projector.jacobian(at)[:, :, :2], gradient)
        return (shape[:, :, None] * q[:, None, :]).reshape(len(at), -1)

    # An increment of the reference configuration, carried to the deformed one.
    operator = rows_of(points)
    matrix = operator.T @ (weights[:, None] * operator)
    expected = np.linalg.solve(matrix, operator.T @ (weights * residual)).reshape(-1, 2) @ gradient_of_motion.T
    scale = np.abs(expected).max()
    # Gradients are stored in 20 bits; the Jacobian of a lens is taken as linear over a cell where it is to 1e-4.
    np.testing.assert_allclose(step, expected, rtol=0, atol=2e-4 * scale)


@pytest.mark.parametrize("cell", CELLS)
def test_solution_agrees_with_a_dense_double_precision_solver(images: tuple[np.ndarray, np.ndarray], cell: str) -> None:
    """Noisy images: 20-bit gradients and single precision do not change the converged solution."""
    noise = np.random.default_rng(5).normal(0.0, 2.0, (2, 140, 160)).astype(np.float32)
    reference, deformed = images[0] + noise[0], images[1] + noise[1]
    mesh = mesh_in_image(fedic.ImageFrame(), cell)
    core = _core.Correlator(
        reference, mesh, fedic.ImageFrame(), interpolation="bspline3", smoothing=0.0, max_iterations=40, tolerance=1e-12
    )
    found = core.correlate(deformed).displacement

    points, weights, _ = core.quadrature_points()
    shape = mesh.interpolate(np.eye(mesh.num_nodes), points)
    f, gradient = (x.astype(float) for x in _core.interpolate_image(reference, points[:, :2], "bspline3"))
    operator = (shape[:, :, None] * gradient[:, None, :]).reshape(len(points), -1)
    matrix = operator.T @ (weights[:, None] * operator)
    spread = np.sqrt(np.cov(f, aweights=weights, ddof=0))
    expected = np.zeros((mesh.num_nodes, 2))
    for _ in range(40):
        g = _core.interpolate_image(deformed, points[:, :2] + shape @ expected, "bspline3")[0].astype(float)
        gain = spread / np.sqrt(np.cov(g, aweights=weights, ddof=0))
        residual = f - np.average(f, weights=weights) - gain * (g - np.average(g, weights=weights))
        expected += np.linalg.solve(matrix, operator.T @ (weights * residual)).reshape(-1, 2)
    # Measured: at most 5e-7 px with linear edges, 1.9e-6 px with curved ones; on average over the nodes 2e-7 and 4e-7.
    np.testing.assert_allclose(found, expected, rtol=0, atol=3e-6 if cell in CURVED else 1e-6)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 6e-7


def test_quadrature_weights_sum_to_the_area() -> None:
    reference = np.random.default_rng(0).integers(0, 255, (140, 160), dtype=np.uint8)
    mesh = mesh_in_image(LENS, "quad")
    for rule in ("rotated", "edges", "diameter"):
        _, weights, cells = _core.Correlator(reference, mesh, LENS, quadrature=rule).quadrature_points()  # type: ignore[arg-type]
        np.testing.assert_allclose(np.bincount(cells, weights), mesh.areas(), rtol=1e-6)


def test_density_scales_the_number_of_points() -> None:
    reference = np.random.default_rng(0).integers(0, 255, (140, 160), dtype=np.uint8)
    mesh = fedic.rectangle_mesh((40, 40, 120, 100), 20)
    counts = {
        density: fedic.Correlator(reference, mesh, quadrature=fedic.MeshQuadrature(density)).num_points
        for density in (0.25, 1.0, 4.0)
    }
    assert counts == {0.25: 1200, 1.0: 4800, 4.0: 19200}
