"""Predicted standard deviations of the displacement against dense matrices and Monte Carlo."""

import warnings

import numpy as np
import pytest
from scipy.stats import norm

import fedic
from fedic import _core

SHAPE = (140, 170)
BOUNDS = (20.3, 20.6, 150.2, 129.1)
SHIFT = np.array([0.37, -0.21])
TILTED = fedic.Pinhole(
    (240, 250), (85, 70), rotation=[np.pi + 0.5, -0.3, 0.05], translation=(0.01, 0.02, 1.0), skew_angle=1.55,
    distortion=fedic.BrownDistortion((-0.2, 0.1, 0.05), (0.01, -0.02), (0.01, 0.02)),
)  # fmt: skip
CAMERAS = {"image": fedic.ImageFrame(), "tilted": TILTED}
BARE = {"interpolation": "bspline3", "smoothing": 0.0}
DENSE = fedic.MeshQuadrature()
COARSE = fedic.MeshQuadrature(density=0.25)
PIXELS = fedic.PixelQuadrature()


def speckle(shift: np.ndarray | float = 0.0) -> np.ndarray:
    """Return the grey levels of a speckle moved by `shift` pixels, not rounded."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    points = np.stack([u, v], axis=-1).reshape(-1, 2) - shift
    grey: np.ndarray = 35 + 180 * fedic.synthetic.Speckle(5.0, seed=2).values(points).reshape(SHAPE)
    return grey


def shaken_mesh(cell: str) -> fedic.Mesh:
    """Return a mesh in pixels with perturbed nodes and straight edges."""
    corner = {"quad8": "quad", "quad9": "quad", "triangle6": "triangle"}.get(cell, cell)
    coarse = fedic.rectangle_mesh(BOUNDS, 20.0, corner)  # type: ignore[arg-type]
    moves = np.random.default_rng(0).uniform(-2, 2, coarse.points.shape)
    fine = fedic.rectangle_mesh(BOUNDS, 20.0, cell)  # type: ignore[arg-type]
    return fedic.Mesh(fine.points + coarse.interpolate(moves, fine.points), fine.cells)


def border_factors(mesh: fedic.Mesh, pixels: np.ndarray, cells: np.ndarray, smoothing: float) -> np.ndarray:
    """Return the variance of the noise gathered at points of a mesh of quads in pixels, relative to that inside."""
    edges: dict[frozenset[int], list[tuple[int, int, int]]] = {}
    for cell, nodes in enumerate(mesh.cells["quad"]):
        for a, b in zip(nodes, np.roll(nodes, -1), strict=True):
            edges.setdefault(frozenset((int(a), int(b))), []).append((cell, a, b))
    factors = np.ones(len(pixels))
    for (cell, a, b), *others in edges.values():
        if others:
            continue
        of_cell = np.flatnonzero(cells == cell)
        along, start = mesh.points[b, :2] - mesh.points[a, :2], mesh.points[a, :2]
        place = (pixels[of_cell] - start) @ along / (along @ along)
        across = along[0] * (pixels[of_cell, 1] - start[1]) - along[1] * (pixels[of_cell, 0] - start[0])
        distance = np.abs(across) / np.hypot(*along) / smoothing
        lacking = 2.0 * norm.cdf(distance) * norm.sf(distance)
        factors[of_cell] *= np.where((distance < 4.0) & (place >= 0) & (place < 1), 1.0 - 0.74 * lacking, 1.0)
    return factors


def dense_covariance(
    image: np.ndarray, mesh: fedic.Mesh, camera: object, quadrature: object, noise: float, smoothing: float = 0.0
) -> np.ndarray:
    """Return the covariance of all nodes from dense matrices, for a mesh in a plane."""
    rule, density = ("pixel", 1.0) if quadrature is PIXELS else (quadrature.rule, quadrature.density)  # type: ignore[attr-defined]
    core = _core.Correlator(image, mesh, camera, quadrature=(rule, density))  # type: ignore[arg-type]
    points, weights, _ = core.quadrature_points()
    shape = mesh.interpolate(np.eye(mesh.num_nodes), points)
    jacobian = camera.jacobian(points)  # type: ignore[attr-defined]
    smooth = image
    if smoothing > 0.0:
        rows, columns = np.indices(image.shape).reshape(2, -1).astype(float)
        at_pixels = np.column_stack([columns, rows])
        smooth = _core.interpolate_image(image, at_pixels, "bspline3", smoothing=smoothing)[0].reshape(image.shape)

    def rows(read: np.ndarray) -> np.ndarray:
        gradient = _core.interpolate_image(read, camera.project(points), "bspline3", smoothing=smoothing)[1]  # type: ignore[attr-defined]
        q = np.einsum("nij,ni->nj", jacobian[:, :, :2], gradient.astype(float))
        return (shape[:, :, None] * q[:, None, :]).reshape(len(points), -1)

    pixels = np.ones(len(points))
    if quadrature is not PIXELS:
        tangents = np.linalg.svd(points - points.mean(0), full_matrices=False)[2][:2]
        pixels = weights * np.abs(np.linalg.det(jacobian @ tangents.T))
    pixels = np.minimum(pixels, max(1.25, 4 * np.pi * smoothing**2))
    if smoothing > 0.0:
        pixels /= border_factors(mesh, camera.project(points), core.quadrature_points()[2], smoothing)  # type: ignore[attr-defined]
    q, h = rows(image), rows(smooth)
    inverse = np.linalg.inv(q.T @ (weights[:, None] * q))
    gathered = h.T @ ((weights**2 / pixels)[:, None] * h)
    covariance: np.ndarray = 2 * noise**2 * inverse @ gathered @ inverse
    return covariance


def dense_deviations(
    image: np.ndarray, mesh: fedic.Mesh, camera: object, quadrature: object, noise: float, smoothing: float = 0.0
) -> np.ndarray:
    """Return the standard deviations from dense matrices, for a mesh in a plane."""
    variances = np.diag(dense_covariance(image, mesh, camera, quadrature, noise, smoothing))
    deviations: np.ndarray = np.sqrt(variances).reshape(-1, 2)
    return deviations


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("quadrature", [DENSE, COARSE, PIXELS], ids=str)
@pytest.mark.parametrize("cell", ["triangle", "quad", "quad8"])
def test_standard_deviations_agree_with_dense_matrices(camera: str, quadrature: object, cell: str) -> None:
    projector = CAMERAS[camera]
    in_pixels = shaken_mesh(cell)
    mesh = fedic.Mesh(projector.unproject(in_pixels.points)[:, :2], in_pixels.cells)
    image = speckle().astype(np.float32)
    found = fedic.Correlator(image, mesh, projector, quadrature=quadrature, **BARE).standard_deviations(3.0)  # type: ignore[arg-type]
    expected = dense_deviations(image, mesh, projector, quadrature, 3.0)
    np.testing.assert_allclose(found, expected, rtol=1e-4)


@pytest.mark.parametrize("quadrature", [DENSE, fedic.MeshQuadrature(density=0.05)], ids=str)
def test_standard_deviations_with_smoothing_agree_with_dense_matrices(quadrature: object) -> None:
    image, mesh = speckle().astype(np.float32), shaken_mesh("quad")
    correlator = fedic.Correlator(image, mesh, quadrature=quadrature, interpolation="bspline3")  # type: ignore[arg-type]
    expected = dense_deviations(image, mesh, fedic.ImageFrame(), quadrature, 3.0, smoothing=0.8)
    np.testing.assert_allclose(correlator.standard_deviations(3.0), expected, rtol=1e-4)


def test_standard_deviations_on_a_slanted_plane_agree_with_dense_matrices() -> None:
    camera = fedic.FrontParallel(10.0, (0.0, 140.0))
    flat = fedic.rectangle_mesh((2.03, 2.06, 15.02, 12.91), 2.0)
    mesh = fedic.Mesh(np.column_stack([flat.points, 0.6 * flat.points[:, 0]]), flat.cells)
    image = speckle().astype(np.float32)
    found = fedic.Correlator(image, mesh, camera, **BARE).standard_deviations(3.0)  # type: ignore[arg-type]
    np.testing.assert_allclose(found, dense_deviations(image, mesh, camera, DENSE, 3.0), rtol=1e-4)
    # The image of the slanted plane is that of the flat one, and so are the deviations.
    np.testing.assert_allclose(found, fedic.Correlator(image, flat, camera, **BARE).standard_deviations(3.0), rtol=1e-4)


@pytest.mark.parametrize(
    ("cell", "options", "within"),
    [
        ("quad", {}, 0.05),
        ("triangle", {}, 0.05),
        ("quad8", {}, 0.05),
        ("quad", BARE, 0.03),
        ("triangle", BARE, 0.05),
        ("quad8", BARE, 0.03),
        ("quad", {"quadrature": PIXELS, **BARE}, 0.03),
        ("quad", {"quadrature": COARSE, **BARE}, 0.05),
        ("quad", {"brightness": "element", **BARE}, 0.03),
        ("quad", {"regularization_length": 80.0, **BARE}, 0.03),
    ],
)
def test_the_scatter_of_noisy_measurements_agrees_with_the_prediction(
    cell: str, options: dict[str, object], within: float
) -> None:
    """Both images are noisy; the prediction uses the noisy reference of the first draw."""
    noise, draws = 1.0, 200
    images, mesh, rng = (speckle(), speckle(SHIFT)), shaken_mesh(cell), np.random.default_rng(5)
    errors, predicted = [], None
    for _ in range(draws):
        reference, deformed = ((image + rng.normal(0, noise, SHAPE)).astype(np.float32) for image in images)
        correlator = fedic.Correlator(reference, mesh, **options)  # type: ignore[arg-type]
        if predicted is None:
            predicted = correlator.standard_deviations(noise)
        result = correlator.correlate(deformed)
        assert result.converged
        errors.append(result.displacement - SHIFT)
    measured = np.std(errors, axis=0, ddof=1)
    assert np.mean(measured / predicted) == pytest.approx(1.0, abs=within)
    assert np.abs(np.mean(errors, axis=(0, 1))).max() < 4 * measured.mean() / np.sqrt(draws)


def test_finite_difference_gradients_scatter_less_than_predicted() -> None:
    """Finite differences underestimate the gradient of this fine speckle by 11 %."""
    images, mesh, rng = (speckle(), speckle(SHIFT)), shaken_mesh("quad"), np.random.default_rng(5)
    found = []
    for _ in range(100):
        reference, deformed = ((image + rng.normal(0, 1.0, SHAPE)).astype(np.float32) for image in images)
        correlator = fedic.Correlator(reference, mesh, gradient="finite-difference", **BARE)  # type: ignore[arg-type]
        found.append(correlator.correlate(deformed).displacement)
    ratio = np.mean(np.std(found, axis=0, ddof=1) / correlator.standard_deviations(1.0))
    assert 0.85 < ratio < 0.95


def test_standard_deviations_are_proportional_to_the_noise() -> None:
    correlator = fedic.Correlator(speckle().astype(np.float32), shaken_mesh("quad"))
    once = correlator.standard_deviations(1.5)
    assert once.min() > 0.0
    np.testing.assert_allclose(correlator.standard_deviations(3.0), 2 * once, rtol=1e-12)
    np.testing.assert_array_equal(correlator.standard_deviations(0.0), np.zeros_like(once))


@pytest.mark.parametrize("quadrature", [DENSE, PIXELS], ids=str)
def test_standard_deviations_are_in_the_unit_of_the_mesh(quadrature: object) -> None:
    image = speckle().astype(np.float32)

    def deviations(unit: float) -> np.ndarray:
        mesh = fedic.rectangle_mesh(tuple(c / unit for c in BOUNDS), 20.0 / unit)  # type: ignore[arg-type]
        camera = fedic.FrontParallel(unit, (0.0, 140.0))
        return fedic.Correlator(image, mesh, camera, quadrature=quadrature).standard_deviations(1.0)  # type: ignore[arg-type]

    millimetres, metres = deviations(10.0), deviations(10_000.0)
    np.testing.assert_allclose(metres, 1e-3 * millimetres, rtol=1e-4)


def test_regularization_lowers_the_standard_deviations() -> None:
    image, mesh = speckle().astype(np.float32), shaken_mesh("quad")
    free, smooth = (
        fedic.Correlator(image, mesh, regularization_length=length).standard_deviations(1.0) for length in (None, 80.0)
    )
    assert (smooth < free).all()


def test_unused_nodes_are_nan() -> None:
    mesh = shaken_mesh("quad")
    image = speckle().astype(np.float32)
    points = np.vstack([[[1e6, -1e6]], mesh.points, [[5.0, 5.0]]])
    spare = fedic.Mesh(points, {"quad": mesh.cells["quad"] + 1})
    found = fedic.Correlator(image, spare).standard_deviations(1.0)
    assert np.isnan(found[[0, -1]]).all()
    np.testing.assert_array_equal(found[1:-1], fedic.Correlator(image, mesh).standard_deviations(1.0))


@pytest.mark.parametrize("noise", [-1.0, float("nan"), float("inf")])
def test_bad_noise_is_refused(noise: float) -> None:
    correlator = fedic.Correlator(speckle().astype(np.float32), shaken_mesh("quad"))
    with pytest.raises(fedic.OptionError, match="noise must be zero or a positive standard deviation in grey levels"):
        correlator.standard_deviations(noise)


@pytest.mark.parametrize(
    ("cell", "options"),
    [
        ("quad", {}),
        ("triangle", {}),
        ("triangle6", {}),
        ("quad8", {}),
        ("quad9", {}),
        ("quad", {"regularization_length": 80.0}),
        ("quad", {"robust": "tukey"}),
    ],
)
def test_strains_gauges_and_the_border_scatter_as_predicted(cell: str, options: dict[str, object]) -> None:
    """The scatter of 150 draws is known to 6 %, that of a mean over many nodes or cells much better."""
    noise, draws = 1.5, 150
    size = 20.0 if cell in ("quad", "triangle") else 40.0
    mesh = fedic.rectangle_mesh((22.5, 22.5, 142.5, 122.5), size, cell)  # type: ignore[arg-type]
    images, rng = (speckle(), speckle(SHIFT)), np.random.default_rng(8)
    start = np.tile(SHIFT, (mesh.num_nodes, 1))
    points = np.stack(np.meshgrid(np.linspace(50, 110, 25), np.linspace(50, 100, 25)), axis=-1).reshape(-1, 2)
    found: dict[str, list[np.ndarray]] = {"nodes": [], "strains": [], "gauge": [], "point": []}
    covariance = None
    for _ in range(draws):
        reference, deformed = ((image + rng.normal(0, noise, SHAPE)).astype(np.float32) for image in images)
        result = fedic.correlate(reference, deformed, mesh, initial=start, noise=noise, **options)  # type: ignore[arg-type]
        covariance = covariance or result.covariance()
        found["nodes"].append(result.unchecked_displacement)
        found["strains"].append(mesh.strains(result.unchecked_displacement).components)
        found["gauge"].append(mesh.strains(result.unchecked_displacement, "small", points).components.mean(axis=0))
        found["point"].append(mesh.interpolate(result.unchecked_displacement, points[[40, 300]]))
    assert covariance is not None
    predicted = {
        "nodes": covariance.standard_deviations,
        "strains": covariance.strain_deviations(),
        "gauge": np.sqrt(np.diag(covariance.gauge(points, "small"))),
        "point": np.sqrt(np.diagonal(covariance.at(points[[40, 300]]), axis1=1, axis2=2)),
    }
    ratios = {name: np.std(values, axis=0, ddof=1) / predicted[name] for name, values in found.items()}
    low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
    border = np.any((mesh.points[:, :2] == low) | (mesh.points[:, :2] == high), axis=1)
    assert ratios["nodes"][~border].mean() == pytest.approx(1.0, abs=0.05)
    assert ratios["nodes"][border].mean() == pytest.approx(1.0, abs=0.05)
    assert ratios["strains"].mean() == pytest.approx(1.0, abs=0.05)
    assert np.abs(ratios["gauge"] - 1.0).max() < 0.2
    assert np.abs(ratios["point"] - 1.0).max() < 0.2


def test_functions_of_the_displacement_have_the_covariance_of_points_and_nodes() -> None:
    mesh = fedic.rectangle_mesh((22.5, 22.5, 142.5, 122.5), 20.0)
    image = speckle().astype(np.float32)
    turned = np.column_stack([-0.3 * mesh.points[:, 1], 0.2 * mesh.points[:, 0]])
    result = fedic.correlate(image, speckle(SHIFT).astype(np.float32), mesh)
    covariance = result.covariance(2.0)
    weights = np.zeros((3, mesh.num_nodes, 2))
    weights[0, 10, 0] = weights[1, 10, 1] = 1.0
    weights[2, 10, 0], weights[2, 17, 0] = -1.0, 1.0
    found = covariance.of(weights)
    np.testing.assert_allclose(found[:2, :2], covariance.nodes[10], rtol=1e-5)
    np.testing.assert_allclose(covariance.at(mesh.points[[10], :2])[0], covariance.nodes[10], rtol=1e-5)
    np.testing.assert_allclose(found, found.T)
    assert np.linalg.eigvalsh(found).min() > 0
    centre = mesh.points[mesh.cells["quad"][7], :2].mean(axis=0)
    np.testing.assert_allclose(covariance.gauge(centre[None], "small"), covariance.strains("small")[7], rtol=1e-4)
    assert np.isnan(covariance.at([[0.0, 0.0]])).all()
    with pytest.raises(fedic.OptionError, match="weights has shape"):
        covariance.of(turned)


@pytest.mark.parametrize("cell", ["triangle", "quad", "quad8"])
def test_strains_agree_with_dense_matrices(cell: str) -> None:
    image, mesh = speckle().astype(np.float32), shaken_mesh(cell)
    core = _core.Correlator(image, mesh, fedic.ImageFrame(), **BARE)
    dense = dense_covariance(image, mesh, fedic.ImageFrame(), DENSE, 3.0)
    found = core.covariance(3.0).cell_strains("small")
    for index, nodes in list(enumerate(mesh.cells[cell]))[:: max(1, mesh.num_cells // 6)]:
        rows = []
        for node in nodes:
            for component in range(2):
                unit = np.zeros((mesh.num_nodes, 2))
                unit[node, component] = 1.0
                rows.append(mesh.strains(unit, "small").components[index])
        dofs = (2 * nodes[:, None] + np.arange(2)).ravel()
        expected = np.transpose(rows) @ dense[np.ix_(dofs, dofs)] @ np.array(rows)
        np.testing.assert_allclose(found[index], expected, rtol=1e-3, atol=1e-4 * expected.max())


@pytest.mark.parametrize("measure", ["green-lagrange", "hencky", "small"])
@pytest.mark.parametrize("slope", [0.0, 0.6])
def test_strains_have_the_covariance_of_their_derivatives(measure: str, slope: float) -> None:
    """Derivatives by finite differences, on a plane seen from the front and on a slanted one."""
    camera = fedic.FrontParallel(10.0, (0.0, 140.0))
    flat = fedic.rectangle_mesh((2.03, 2.06, 15.02, 12.91), 2.0)
    mesh = fedic.Mesh(np.column_stack([flat.points[:, :2], slope * flat.points[:, 0]]), flat.cells)
    points = mesh.points[:, :2]
    displacement = 0.02 * np.column_stack([points[:, 0] - 2 * points[:, 1], 3 * points[:, 0] + points[:, 1]])
    core = _core.Correlator(speckle().astype(np.float32), mesh, camera).covariance(2.0, displacement)
    known = (np.ones(number, dtype=bool) for number in (mesh.num_nodes, mesh.num_cells))
    covariance = fedic.Covariance(mesh, 2.0, *known, core)
    cell, step = 9, 1e-6
    nodes = mesh.cells["quad"][cell]
    weights = np.zeros((3, mesh.num_nodes, 2))
    for node in nodes:
        for component in range(2):
            moved = [displacement.copy(), displacement.copy()]
            moved[0][node, component] += step
            moved[1][node, component] -= step
            up, down = (mesh.strains(each, measure).components[cell] for each in moved)  # type: ignore[arg-type]
            weights[:, node, component] = (up - down) / (2 * step)
    expected = covariance.of(weights)
    np.testing.assert_allclose(covariance.strains(measure)[cell], expected, rtol=1e-4, atol=1e-5 * expected.max())  # type: ignore[arg-type]
    centre = points[nodes].mean(axis=0)
    gauge = covariance.gauge(centre[None], measure)  # type: ignore[arg-type]
    np.testing.assert_allclose(gauge, expected, rtol=1e-4, atol=1e-5 * expected.max())


def test_deviations_of_nodes_that_were_not_measured_are_nan() -> None:
    mesh = fedic.rectangle_mesh((22.5, 22.5, 142.5, 122.5), 20.0)
    deformed = speckle(SHIFT).astype(np.float32)
    deformed[20:70, 20:75] = 250.0
    with pytest.warns(fedic.QualityWarning):
        result = fedic.correlate(speckle().astype(np.float32), deformed, mesh, robust="tukey", noise=1.0)
    deviations = result.standard_deviations()
    np.testing.assert_array_equal(np.isnan(deviations).any(axis=1), ~result.valid_nodes)
    assert 0 < result.valid_nodes.sum() < mesh.num_nodes
    assert np.isnan(result.covariance().strain_deviations()[~result.valid_cells]).all()


def shares_at(mesh: fedic.Mesh, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the factor of each cell on its part of the noise at a displacement, and the gradient of each node."""
    nodes = mesh.cells["quad"]
    slopes = 0.25 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    before, after = (np.einsum("cni,nj->cij", field[nodes], slopes) for field in (mesh.points[:, :2], displacement))
    gradients = np.eye(2) + after @ np.linalg.inv(before)
    of_nodes = np.zeros((mesh.num_nodes, 2, 2))
    np.add.at(of_nodes, nodes, gradients[:, None])
    return 0.5 * (1 + 1 / np.linalg.det(gradients)), of_nodes / np.bincount(nodes.ravel())[:, None, None]


@pytest.mark.parametrize("options", [{}, {"regularization_length": 60.0}], ids=["free", "regularized"])
@pytest.mark.parametrize(("kind", "within"), [("uniform", 1e-7), ("bending", 2e-3)])
def test_the_noise_at_a_displacement_is_that_of_the_cells(kind: str, within: float, options: dict[str, float]) -> None:
    """A factor on the noise of each cell at rest, carried by the gradient of each node."""
    mesh = fedic.rectangle_mesh((20.0, 20.0, 150.0, 120.0), 10.0)
    x, y = mesh.points[:, :2].T
    turn = np.radians(40)
    fields = {
        "uniform": 1.3 * mesh.points[:, :2] @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
        - mesh.points[:, :2],
        # The area changes by 10 % over the height of the mesh.
        "bending": 1e-3 * np.column_stack([(x - 85) * (y - 70), -0.5 * (x - 85) ** 2]),
    }
    core = _core.Correlator(speckle().astype(np.float32), mesh, fedic.ImageFrame(), **options)  # type: ignore[arg-type]
    shares, gradients = shares_at(mesh, fields[kind])
    assert np.ptp(shares) > 0.04 if kind == "bending" else shares == pytest.approx(0.5 + 0.5 / 1.69)
    by_cells = core.covariance(2.0, None, (np.column_stack([np.ones(mesh.num_cells), shares]), [], [])).nodes()
    expected = np.diagonal(gradients @ by_cells @ gradients.transpose(0, 2, 1), axis1=1, axis2=2)
    found = np.diagonal(core.covariance(2.0, fields[kind]).nodes(), axis1=1, axis2=2)
    np.testing.assert_allclose(np.sqrt(found), np.sqrt(expected), rtol=within)


def test_frames_of_a_series_have_the_covariance_of_a_fresh_correlator() -> None:
    mesh, image = fedic.rectangle_mesh((22.5, 22.5, 142.5, 122.5), 20.0), speckle().astype(np.float32)
    dark = speckle(SHIFT).astype(np.float32)
    dark[20:70, 20:75] = 250.0
    frames = [speckle(SHIFT).astype(np.float32), dark, speckle(2 * SHIFT).astype(np.float32)]
    used = fedic.Correlator(image, mesh, robust="tukey")

    def numbers(correlator: fedic.Correlator, frame: np.ndarray, noise: float) -> bytes:
        covariance = correlator.correlate(frame).covariance(noise)
        return covariance.nodes.tobytes() + covariance.strains().tobytes() + covariance.at([[70.0, 60.0]]).tobytes()

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        for frame in [*frames, *frames]:
            for noise in (2.0, 1.0, 2.0):
                fresh = fedic.Correlator(image, mesh, robust="tukey")
                assert numbers(used, frame, noise) == numbers(fresh, frame, noise)


def test_strains_of_a_total_displacement_have_the_noise_of_the_last_step() -> None:
    """Two steps that keep the area give the covariance of the direct measurement."""
    centre = np.array([85.0, 70.0])
    steps = [np.array([[1.15, 0.1], [0.0, 1 / 1.15]]), np.array([[1.0, 0.0], [-0.2, 1.0]])]
    mesh = fedic.rectangle_mesh((55.0, 45.0, 115.0, 95.0), 10.0)

    def moved(points: np.ndarray, gradient: np.ndarray) -> np.ndarray:
        return (points - centre) @ gradient.T + centre

    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]]
    pixels = np.stack([u, v], axis=-1).reshape(-1, 2).astype(float)
    places = moved(pixels, np.linalg.inv(steps[0]))
    grey = 35 + 180 * fedic.synthetic.Speckle(5.0, seed=2).values(places).reshape(SHAPE)
    points = mesh.points[:, :2]
    between = fedic.Mesh(moved(points, steps[0]), mesh.cells)
    last = moved(between.points[:, :2], steps[1])
    direct = fedic.Correlator(speckle().astype(np.float32), mesh).covariance(2.0, last - points)
    step = fedic.Correlator(grey.astype(np.float32), between).covariance(2.0, last - between.points[:, :2])
    total = step.of_total(mesh, last - points)
    np.testing.assert_array_equal(total.nodes, step.nodes)
    np.testing.assert_allclose(total.standard_deviations, direct.standard_deviations, rtol=0.05)
    for measure in ("green-lagrange", "hencky", "small"):
        found, expected = (each.strain_deviations(measure) for each in (total, direct))  # type: ignore[arg-type]
        np.testing.assert_allclose(found, expected, rtol=0.07)
        assert found.mean() == pytest.approx(expected.mean(), rel=0.01)
        gauges = (np.diag(each.gauge([[80.0, 61.0], [93.0, 77.0]], measure)) for each in (total, direct))  # type: ignore[arg-type]
        np.testing.assert_allclose(*gauges, rtol=0.07)
    np.testing.assert_allclose(total.at([[80.0, 61.0]]), direct.at([[80.0, 61.0]]), rtol=0.07, atol=1e-6)
    assert np.abs(step.strain_deviations() / total.strain_deviations() - 1.0).max() > 0.2

    with pytest.raises(fedic.OptionError, match="mesh must be the mesh of the prediction on other points"):
        step.of_total(fedic.rectangle_mesh((55.0, 45.0, 115.0, 95.0), 20.0), last - points)
    with pytest.raises(fedic.OptionError, match="displacement must have one finite value"):
        step.of_total(mesh, np.full((mesh.num_nodes, 2), np.nan))


@pytest.mark.parametrize("cell", list(fedic.CELL_TYPES))
def test_functions_of_one_cell_have_the_covariance_that_the_system_gives(cell: str) -> None:
    """Two points far apart are solved for; one alone follows from the known blocks of its cell."""
    mesh = fedic.rectangle_mesh((16.0, 16.0, 112.0, 112.0), 16.0, cell)
    texture, camera = fedic.synthetic.Speckle(4.0, seed=3), fedic.ImageFrame()
    reference = fedic.synthetic.render(texture, camera, (128, 128))
    turned = 0.2 * np.column_stack([-mesh.points[:, 1], mesh.points[:, 0]])
    covariance = fedic.Correlator(reference, mesh, camera).covariance(1.5, turned)
    points = np.array([[30.0, 40.0], [95.0, 101.0]])
    shapes = np.column_stack([mesh.interpolate(unit, points) for unit in np.eye(mesh.num_nodes)[..., np.newaxis]])
    weights = np.zeros((4, mesh.num_nodes, 2))
    weights[[0, 2], :, 0] = weights[[1, 3], :, 1] = shapes
    together = covariance.of(weights)
    blocks = covariance.at(points)
    scale = abs(blocks).max()
    np.testing.assert_allclose(together[:2, :2], blocks[0], atol=1e-5 * scale)
    np.testing.assert_allclose(together[2:, 2:], blocks[1], atol=1e-5 * scale)
    assert abs(together[:2, 2:]).max() < 0.1 * scale
    np.testing.assert_allclose(covariance.of(weights[:2]), blocks[0], rtol=1e-12)
