"""Quick versions of the experiments on resolution and convergence, against reference values."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.experiments import Claim, Outcome, Request, run_experiment
from fedic.experiments.dic_challenge_star import star_mesh, synthetic_star, turned_mesh
from fedic.experiments.motions import Motion, scenes
from fedic.experiments.outcome import Row
from fedic.experiments.reconstruction import Space, reconstruct

Shared = Callable[[str], Path]


@pytest.fixture(scope="module")
def convergence() -> Outcome:
    return run_experiment("convergence", Request(quick=True))


def row_of(outcome: Outcome, **wanted: object) -> Row:
    found = [row for row in outcome.rows if all(row[key] == value for key, value in wanted.items())]
    assert len(found) == 1
    return found[0]


def broken(claims: list[Claim]) -> list[str]:
    return [f"{claim.text}: {claim.measured}" for claim in claims if not claim.holds]


def check_star(outcome: Outcome, star: str, *, turned_loss: float) -> None:
    """Compare one star with the reference values, which scatter by a few per cent."""
    quad = row_of(outcome, star=star, group="sizes", cell="quad")
    assert float(quad["noise_px"]) == pytest.approx(0.0100, rel=0.05)
    assert float(quad["period_px"]) == pytest.approx(28.6, rel=0.06)
    nodes = row_of(outcome, star=star, variant="nodes alone")
    assert float(nodes["noise_px"]) / float(quad["noise_px"]) == pytest.approx(1.74, rel=0.05)
    eight = row_of(outcome, star=star, group="sizes", cell="quad8")
    assert float(eight["mei"]) <= 0.25
    assert float(eight["mei"]) == pytest.approx(float(eight["noise_px"]) * float(eight["period_px"]))
    turned = row_of(outcome, star=star, group="turned", cell="quad8")
    assert float(turned["mei"]) > turned_loss * float(eight["mei"])


def test_resolution_of_both_stars(shared_data: Shared) -> None:
    names = ("star/DIC_Challenge_Star_Noise_Ref.tiff", "star/DIC_Challenge_Star_Noise_Def.tiff")
    pair = tuple(fedic.read_image(shared_data(name)) for name in names)
    states: list[fedic.Progress] = []
    outcome = run_experiment("resolution", Request(quick=True, star=pair, progress=states.append))  # type: ignore[arg-type]
    check_star(outcome, "synthetic", turned_loss=1.8)
    check_star(outcome, "real", turned_loss=2.0)
    assert min(float(row["mei"]) for row in outcome.rows if row["star"] == "real" and row["group"] == "sizes") <= 0.25
    assert broken(outcome.claims) == []
    seen = [state.fraction or 0.0 for state in states]
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert set(outcome.figures) == {"", "amplitude", "variants"}


def test_resolution_without_the_real_star_omits_its_claims() -> None:
    outcome = run_experiment("resolution", Request(quick=True))
    check_star(outcome, "synthetic", turned_loss=1.8)
    assert not [claim for claim in outcome.claims if "real" in claim.text]


def test_star_images_of_another_shape_are_refused() -> None:
    image = np.zeros((50, 60), dtype=np.uint8)
    with pytest.raises(fedic.ImageError, match="501 x 4000"):
        run_experiment("resolution", Request(quick=True, star=(image, image)))


def test_the_meshes_of_the_star_have_nodes_on_the_crest() -> None:
    star = synthetic_star(quick=True)
    for laid in (star_mesh(star, 28, "quad8"), turned_mesh(star, 28, "quad8", 45)):
        on_crest = np.abs(laid.mesh.points[:, 1] - star.middle) < 1e-9
        assert on_crest.sum() > 30
    moved = star_mesh(star, 28, "quad", (0.0, 0.5)).mesh.points
    assert np.abs(moved[:, 1] - star.middle).min() == pytest.approx(14.0)


@pytest.mark.parametrize(
    ("space", "power"),
    [
        (Space("tensor", 1, 2), 1),
        (Space("tensor", 2, 4), 2),
        (Space("serendipity", 3, 4), 3),
        (Space("spline", 3, 2), 3),
    ],
)
def test_reconstruction_preserves_polynomials_of_its_degree(space: Space, power: int) -> None:
    """Up to the error of the four-noded interpolation between the fine nodes."""
    size = 8.0
    mesh = fedic.rectangle_mesh((0.0, -64.0, 128.0, 64.0), size)

    def true(points: np.ndarray) -> np.ndarray:
        return np.stack([(points[:, 1] / 64.0) ** power, points[:, 0] / 64.0], axis=1)

    blank = np.zeros(0)
    result = fedic.Result(
        mesh,
        fedic.ImageFrame(),
        true(mesh.points),
        true(mesh.points),
        True,
        0.0,
        1,
        [],
        0,
        0.0,
        blank,
        blank.astype(int),
        true(mesh.points),
        fedic.Quality.unknown(mesh, converged=True),
        "given",
    )
    field, reach = reconstruct(result, size, space)
    assert reach == 64.0
    x, y = np.arange(3.0, 126.0, 5.0), np.arange(-62.0, 63.0, 4.0)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    expected = true(grid.reshape(-1, 2)).reshape(grid.shape)
    np.testing.assert_allclose(field(x, y), expected, atol=1e-7 if power == 1 else 0.02)


def test_convergence_experiment_holds_its_claims(convergence: Outcome) -> None:
    assert broken(convergence.claims) == []
    far = row_of(convergence, variant="zero", motion="translation", amount=8.0, size_px=20, turn_deg=30.0)
    assert not far["found"]
    assert row_of(convergence, variant="pyramid", motion="translation", amount=48.0, size_px=20, turn_deg=30.0)["found"]
    lost = row_of(convergence, variant="pyramid", motion="translation", amount=200.0, size_px=20, turn_deg=30.0)
    assert not lost["found"]
    found = row_of(convergence, variant="fft", motion="translation", amount=200.0, size_px=20, turn_deg=30.0)
    assert float(found["error_px"]) < 0.02
    default = row_of(convergence, study="iterations", variant="default", size_px=20)
    assert 3 <= int(default["iterations"]) <= 5
    assert float(default["error_px"]) < 0.01
    assert set(convergence.figures) == {"", "iterations"}


def test_scenes_move_by_their_stated_displacement() -> None:
    """The measured displacement of a rotated image is that of the scene."""
    scene = scenes(Request(quick=True))[0]
    motion = Motion("rotation", 3.0)
    mesh = scene.mesh(20, "quad")
    result = fedic.correlate(scene.reference, scene.moved(motion), mesh, initial="pyramid")
    wrong = result.displacement - scene.displacement(motion, mesh.points)
    assert np.abs(wrong).max() < 0.02
