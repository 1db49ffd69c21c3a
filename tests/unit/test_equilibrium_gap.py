"""Regularization by the equilibrium gap: what it accepts, what it leaves alone, and what it lowers."""

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.campaign.config.correlation_section import CorrelationSection

Floats = NDArray[np.float64]
SHAPE = (280, 280)
LOW, HIGH = 30.0, 250.0
CENTRE = np.array([140.0, 140.0])
SIZE, LENGTH = 10.0, 80.0


def edge(mesh: fedic.Mesh, axis: int, place: float) -> NDArray[np.int64]:
    return np.flatnonzero(np.abs(mesh.points[:, axis] - place) < 1e-9)


def plate(cell: str = "quad", size: float = SIZE, margin: float = 0.0) -> fedic.Mesh:
    low, high = LOW + margin, HIGH - margin
    mesh = fedic.rectangle_mesh((low, low, high, high), size, cell)  # type: ignore[arg-type]
    names = {"top": (1, low), "bottom": (1, high), "left": (0, low), "right": (0, high)}
    return mesh.with_sets({name: fedic.MeshSet(edge(mesh, *place)) for name, place in names.items()})


def speckle(seed: int) -> tuple[fedic.synthetic.Speckle, Floats]:
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    return fedic.synthetic.Speckle(4.0, seed=seed), np.column_stack([u.ravel(), v.ravel()])


def image(texture: fedic.synthetic.Speckle, points: Floats) -> NDArray[np.float32]:
    return (35.0 + 180.0 * texture.values(points)).reshape(SHAPE).astype(np.float32)


def pair(gradient: Floats, seed: int = 3) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    texture, pixels = speckle(seed)
    origins = (pixels - CENTRE) @ np.linalg.inv(gradient).T + CENTRE
    return image(texture, pixels), image(texture, origins)


def rotation(degrees: float) -> Floats:
    angle = np.deg2rad(degrees)
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def error(result: fedic.Result, gradient: Floats) -> Floats:
    found: Floats = result.displacement - (result.mesh.points[:, :2] - CENTRE) @ (gradient - np.eye(2)).T
    return found


@pytest.mark.parametrize(
    ("make", "option"),
    [
        (lambda: fedic.EquilibriumGap(0.6), "nu"),
        (lambda: fedic.EquilibriumGap(-1.0), "nu"),
        (lambda: fedic.EquilibriumGap("0.3"), "nu"),  # type: ignore[arg-type]
        (lambda: fedic.EquilibriumGap.orthotropic(-1.0, 1.0, 0.3, 1.0), "E1"),
        (lambda: fedic.EquilibriumGap.orthotropic(1.0, 0.0, 0.3, 1.0), "E2"),
        (lambda: fedic.EquilibriumGap.orthotropic(1.0, 1.0, 1.0, 1.0), "nu12"),
        (lambda: fedic.EquilibriumGap.orthotropic(1.0, 1.0, 0.3, np.nan), "G12"),
        (lambda: fedic.EquilibriumGap.orthotropic(1.0, 1.0, 0.3, 1.0, angle=np.inf), "angle"),
        (lambda: fedic.EquilibriumGap(free="top", loaded="bottom"), "loaded"),
        (lambda: fedic.EquilibriumGap(free=3), "free"),  # type: ignore[arg-type]
        (lambda: fedic.EquilibriumGap(loaded=[[0.5, 1.5]]), "loaded"),
    ],
)
def test_what_is_no_material_or_edge_is_refused_by_name(make: Any, option: str) -> None:
    with pytest.raises(fedic.OptionError, match=option) as caught:
        make()
    assert caught.value.option == option


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"free": "side"}, "no set 'side'; its sets are 'bottom', 'left', 'right', 'top'"),
        ({"loaded": ["top", [30]]}, "1 of 1 nodes of the nodes given are not at the boundary"),
        ({"free": [10**6]}, "have node 1000000; the mesh has 529 nodes"),
        ({"free": [-1]}, "have node -1"),
    ],
)
def test_edges_that_the_mesh_does_not_have_are_refused(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(fedic.OptionError, match=words) as caught:
        fedic.EquilibriumGap(**arguments).free_nodes(plate())
    assert caught.value.option == next(iter(arguments))


def test_a_gap_needs_a_length_and_nodes_without_load() -> None:
    reference, _ = pair(np.eye(2))
    with pytest.raises(fedic.OptionError, match="must be a positive wavelength in pixels with") as caught:
        fedic.Correlator(reference, plate(), regularization=fedic.EquilibriumGap())
    assert caught.value.option == "regularization_length"
    with pytest.raises(fedic.OptionError, match="got 'gap'") as caught:
        fedic.Correlator(reference, plate(), regularization="gap", regularization_length=80.0)  # type: ignore[arg-type]
    assert caught.value.option == "regularization"
    strip = fedic.rectangle_mesh((LOW, LOW, HIGH, LOW + 20.0), 20.0)
    with pytest.raises(fedic.OptionError, match="nodes inside it, or edges that are named as free") as caught:
        fedic.Correlator(reference, strip, regularization=fedic.EquilibriumGap(), regularization_length=100.0)
    assert caught.value.option == "regularization"


def test_edges_are_names_nodes_or_both_and_all_others_are_free_if_the_loaded_ones_are_named() -> None:
    mesh = plate()
    boundary = np.flatnonzero(mesh.boundary_nodes)
    top, left = mesh.sets["top"].nodes, mesh.sets["left"].nodes
    assert boundary.size == 4 * 22
    assert fedic.EquilibriumGap().free_nodes(mesh).size == 0
    np.testing.assert_array_equal(fedic.EquilibriumGap(loaded=[]).free_nodes(mesh), boundary)
    np.testing.assert_array_equal(fedic.EquilibriumGap(free="top").free_nodes(mesh), top)
    np.testing.assert_array_equal(fedic.EquilibriumGap(free=top).free_nodes(mesh), top)
    both = np.union1d(top, left)
    np.testing.assert_array_equal(fedic.EquilibriumGap(free=["top", left]).free_nodes(mesh), both)
    np.testing.assert_array_equal(
        fedic.EquilibriumGap(loaded=("top", left.tolist())).free_nodes(mesh), np.setdiff1d(boundary, both)
    )


@pytest.mark.parametrize("cell", ["triangle6", "quad8", "quad9"])
def test_a_loaded_edge_given_by_its_corners_has_its_middle_nodes(cell: str) -> None:
    mesh = plate(cell, 20.0)
    top = mesh.sets["top"].nodes
    corners = top[(mesh.points[top, 0] - LOW) % 20.0 < 1e-9]
    assert corners.size < top.size
    free = fedic.EquilibriumGap(loaded=[corners]).free_nodes(mesh)
    np.testing.assert_array_equal(free, np.setdiff1d(np.flatnonzero(mesh.boundary_nodes), top))


def test_both_sides_of_a_crack_are_edges() -> None:
    mesh = plate()
    crack = mesh.split([(140.0, 140.0), (250.0, 140.0)])
    free = fedic.EquilibriumGap(loaded=["top", "bottom"]).free_nodes(crack)
    doubled = np.unique(crack.coincident_nodes())
    assert doubled.size == 2 * 11
    assert np.isin(doubled, free).all()


def test_gaps_are_compared_shown_and_pickled() -> None:
    gap = fedic.EquilibriumGap(0.25, loaded=["top", np.arange(3)])
    assert pickle.loads(pickle.dumps(gap)) == gap != fedic.EquilibriumGap(0.25)
    assert hash(gap) == hash(fedic.EquilibriumGap(0.25, loaded=["top", [0, 1, 2]]))
    assert repr(gap) == "EquilibriumGap(nu=0.25, loaded=['top', '3 nodes'])"
    assert gap.moduli == {"nu": 0.25}
    assert gap != "smooth"


@pytest.mark.parametrize("cell", ["triangle", "quad", "quad8"])
@pytest.mark.filterwarnings("ignore::fedic.QualityWarning")
def test_a_shear_wave_of_the_stated_length_is_halved(cell: str) -> None:
    texture, pixels = speckle(1)
    phase = 2.0 * np.pi / LENGTH
    origins = pixels.copy()
    origins[:, 1] -= 0.3 * np.sin(phase * pixels[:, 0])
    reference, deformed = image(texture, pixels), image(texture, origins)
    mesh = plate(cell)
    places = np.random.default_rng(0).uniform(90.0, 190.0, (4000, 2))
    columns = np.column_stack([np.sin(phase * places[:, 0]), np.cos(phase * places[:, 0]), np.ones(len(places))])

    def amplitude_left(**options: Any) -> float:
        result = fedic.correlate(reference, deformed, mesh, smoothing=0.0, tolerance=1e-5, **options)
        assert result.converged
        return float(np.linalg.lstsq(columns, result.at(places)[:, 1], rcond=None)[0][0]) / 0.3

    assert amplitude_left() == pytest.approx(1.0, abs=0.01)
    left = amplitude_left(regularization=fedic.EquilibriumGap(), regularization_length=LENGTH)
    assert left == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("degrees", [30.0, 90.0])
@pytest.mark.parametrize("length", [80.0, 400.0])
def test_rotations_are_left_alone_up_to_free_edges(degrees: float, length: float) -> None:
    gradient = rotation(degrees)
    reference, deformed = pair(gradient)
    free = fedic.EquilibriumGap(loaded=[])
    plain, gap = (
        fedic.correlate(reference, deformed, plate(margin=30.0), tolerance=1e-5, **options)
        for options in ({}, {"regularization": free, "regularization_length": length})
    )
    assert plain.converged
    assert gap.converged
    assert np.abs(error(gap, gradient)).max() < max(1e-5, np.abs(error(plain, gradient)).max())
    assert np.sqrt((error(gap, gradient) ** 2).mean()) < 1e-4 + 0.5 * np.sqrt((error(plain, gradient) ** 2).mean())


@pytest.mark.parametrize("stretch", [0.01, 0.1])
def test_uniaxial_tension_is_left_alone_with_free_sides(stretch: float) -> None:
    """With the kept Hessian, and with a new one at each iteration from strains of 5 % on."""
    gradient = rotation(20.0) @ np.diag([1.0 - 0.3 * stretch, 1.0 + stretch])
    reference, deformed = pair(gradient)
    gap, mesh = fedic.EquilibriumGap(0.3, loaded=["top", "bottom"]), plate(margin=30.0)
    result = fedic.correlate(reference, deformed, mesh, regularization=gap, regularization_length=400.0, tolerance=1e-5)
    assert result.converged
    assert np.abs(error(result, gradient)).max() < 0.005


@pytest.mark.filterwarnings("ignore::fedic.QualityWarning")
def test_another_ratio_of_poisson_bends_the_free_sides_alone() -> None:
    gradient = np.diag([1.0 - 0.3 * 0.01, 1.01])
    reference, deformed = pair(gradient)
    mesh = plate(margin=30.0)

    def errors(**edges: Any) -> float:
        gap = fedic.EquilibriumGap(0.0, **edges)
        result = fedic.correlate(reference, deformed, mesh, regularization=gap, regularization_length=400.0)
        return float(np.abs(error(result, gradient)).max())

    assert errors(loaded=["top", "bottom"]) > 0.05
    assert errors() < 0.005


def test_noise_inside_is_lowered_to_less_than_a_tenth_and_reported() -> None:
    reference, deformed = pair(np.eye(2))
    mesh = plate()
    gap = fedic.EquilibriumGap(loaded=["top", "bottom"])
    options: dict[str, Any] = {"regularization": gap, "regularization_length": LENGTH}
    plain, smooth, regular = (
        fedic.correlate(reference, deformed, mesh, **options)
        for options in ({}, {"regularization_length": LENGTH}, options)
    )
    assert regular.resolution == LENGTH
    assert regular.summary()["resolution"] == LENGTH
    inside = (np.abs(mesh.points[:, :2] - CENTRE) < 65.0).all(axis=1)
    sides = (np.abs(mesh.points[:, 0] - CENTRE[0]) > 109.0) & (np.abs(mesh.points[:, 1] - CENTRE[1]) < 65.0)
    loaded = (np.abs(mesh.points[:, 1] - CENTRE[1]) > 109.0) & (np.abs(mesh.points[:, 0] - CENTRE[0]) < 65.0)

    def noise(result: fedic.Result, nodes: NDArray[np.bool_]) -> float:
        deviations = [each.standard_deviations(2.0)[nodes] for each in (result, plain)]
        return float(np.linalg.norm(deviations[0]) / np.linalg.norm(deviations[1]))

    assert noise(regular, inside) < 0.09
    assert noise(regular, inside) < 0.85 * noise(smooth, inside)
    assert noise(regular, sides) < 0.11
    assert noise(regular, loaded) > 0.5


def test_the_standard_deviations_are_those_of_many_noisy_pairs() -> None:
    reference, _ = pair(np.eye(2))
    mesh = plate(size=20.0)
    options: dict[str, Any] = {
        "regularization": fedic.EquilibriumGap(loaded=["top", "bottom"]),
        "regularization_length": 60.0,
    }
    generator = np.random.default_rng(5)

    def noisy() -> NDArray[np.float32]:
        return reference + generator.normal(0.0, 2.0, SHAPE).astype(np.float32)

    found = []
    for _ in range(30):
        result = fedic.correlate(noisy(), noisy(), mesh, initial="zero", noise=2.0, **options)
        found.append(result.displacement)
    predicted = fedic.Correlator(reference, mesh, **options).standard_deviations(2.0)
    inside = (np.abs(mesh.points[:, :2] - CENTRE) < 95.0).all(axis=1)
    ratio = np.sqrt((np.array(found)[:, inside] ** 2).mean() / (predicted[inside] ** 2).mean())
    assert ratio == pytest.approx(1.0, abs=0.12)


def test_a_result_and_a_correlator_keep_their_gap_when_pickled() -> None:
    reference, deformed = pair(np.diag([1.0, 1.01]))
    gap = fedic.EquilibriumGap(0.3, free="left")
    correlator = fedic.Correlator(reference, plate(), regularization=gap, regularization_length=LENGTH)
    result = correlator.correlate(deformed)
    again = pickle.loads(pickle.dumps(correlator)).correlate(deformed)
    np.testing.assert_array_equal(again.displacement, result.displacement)
    expected = result.standard_deviations(1.0)
    del correlator
    # The correlator is gone: another one is prepared, with the same gap.
    np.testing.assert_allclose(result.standard_deviations(1.0), expected, rtol=1e-12)


@pytest.mark.filterwarnings("ignore::fedic.QualityWarning")
def test_cells_without_texture_are_filled_inside_and_refused_at_loaded_edges() -> None:
    reference, _ = pair(np.eye(2))
    moved = np.roll(reference, (1, 2), axis=(0, 1))
    mesh = plate()
    inside, border = ((120, 160), (120, 160)), ((0, 55), (120, 160))
    for (low, high), (first, last) in (inside, border):
        flat = [each.copy() for each in (reference, moved)]
        for each in flat:
            each[low:high, first:last] = 120.0
        gap = fedic.EquilibriumGap()
        free = fedic.EquilibriumGap(free="top")
        options: dict[str, Any] = {"initial": "pyramid", "regularization_length": LENGTH}
        if low > 0:
            result = fedic.correlate(flat[0], flat[1], mesh, regularization=gap, **options)
            np.testing.assert_allclose(
                result.unchecked_displacement, np.tile([2.0, 1.0], (mesh.num_nodes, 1)), atol=0.2
            )
            continue
        with pytest.raises(fedic.SolveError, match="name the edge as free") as caught:
            fedic.correlate(flat[0], flat[1], mesh, regularization=gap, **options)
        assert set(caught.value.nodes) <= set(mesh.sets["top"].nodes)
        result = fedic.correlate(flat[0], flat[1], mesh, regularization=free, **options)
        np.testing.assert_allclose(result.unchecked_displacement, np.tile([2.0, 1.0], (mesh.num_nodes, 1)), atol=0.3)


def test_a_configuration_names_the_material_and_the_edges() -> None:
    section = CorrelationSection(regularization_length=80.0, equilibrium_gap={"nu": 0.33, "loaded": ["top"]})
    options = section.options()
    assert options["regularization"] == fedic.EquilibriumGap(0.33, loaded=["top"])
    moduli = {"E1": 140e3, "E2": 10e3, "nu12": 0.3, "G12": 5e3, "angle": 0.5}
    section = CorrelationSection(regularization_length=80.0, equilibrium_gap=moduli)
    assert section.options()["regularization"] == fedic.EquilibriumGap.orthotropic(**moduli)
    assert "regularization" not in CorrelationSection().options()
    for wrong in ({"nu": 0.7}, {"nu": 0.3, "E1": 1.0}, {"E1": 1.0}, {"angle": 0.1}, {"free": "top"}):
        with pytest.raises(ValueError, match="equilibrium_gap"):
            CorrelationSection(regularization_length=80.0, equilibrium_gap=wrong)
    with pytest.raises(ValueError, match="regularization_length should be given"):
        CorrelationSection(equilibrium_gap={})
