"""The options of a correlation: what each changes and what it leaves unchanged."""

from typing import Literal

import numpy as np
import pytest

import fedic

SPECKLE = fedic.synthetic.Speckle(5.0, seed=8)
FRAME = fedic.ImageFrame()
MESH = fedic.rectangle_mesh((30.4, 25.3, 210.8, 165.9), 20.0)


def motion(points: np.ndarray) -> np.ndarray:
    return (points - (120, 95)) @ np.array([[0.004, 0.001], [-0.002, -0.003]]) + (1.4, -0.8)


@pytest.fixture(scope="module")
def pair() -> tuple[np.ndarray, np.ndarray]:
    render = fedic.synthetic.render
    reference = render(SPECKLE, FRAME, (190, 240), bits=16)
    return reference, render(SPECKLE, FRAME, (190, 240), displacement=motion, bits=16)


def errors(pair: tuple[np.ndarray, np.ndarray], **options: object) -> np.ndarray:
    result = fedic.correlate(*pair, MESH, tolerance=1e-6, **options)  # type: ignore[arg-type]
    assert result.converged
    return result.displacement - motion(MESH.points)


def test_global_brightness_corrects_gain_and_offset(pair: tuple[np.ndarray, np.ndarray]) -> None:
    darker = (0.7 * pair[1] + 900.0).astype(np.float32)
    plain, corrected = errors(pair), errors((pair[0], darker))
    np.testing.assert_allclose(corrected, plain, atol=1e-5)
    assert np.abs(errors((pair[0], darker), brightness=None)).max() > 3 * np.abs(plain).max()


def test_element_brightness_corrects_uneven_light(pair: tuple[np.ndarray, np.ndarray]) -> None:
    light = 1.0 + 0.3 * np.sin(np.arange(240) / 80.0)
    uneven = (pair[0], (pair[1] * light * 0.7).astype(np.float32))
    everywhere, by_element = errors(uneven), errors(uneven, brightness="element")
    assert by_element.std() < 0.5 * everywhere.std()
    assert by_element.std() < 0.025


def test_the_hessian_option_does_not_change_the_solution() -> None:
    """A close camera, whose Jacobian changes by several per cent over the motion."""
    camera = fedic.Pinhole((300, 300), (120, 95), rotation=[np.pi + 0.3, 0.2, 0.0], translation=(0.0, 0.0, 1.0))
    texture = fedic.synthetic.Speckle(0.02, seed=9)
    images = [fedic.synthetic.render(texture, camera, (190, 240), displacement=s) for s in (None, (0.02, 0.01))]
    mesh = fedic.rectangle_mesh((-0.2, -0.15, 0.2, 0.15), 0.06)
    results = [
        fedic.correlate(images[0], images[1], mesh, camera, hessian=h, initial="pyramid", tolerance=1e-6)
        for h in ("initial", "updated")
    ]
    assert all(result.converged for result in results)
    difference = results[0].pixel_displacement - results[1].pixel_displacement
    assert np.abs(difference).max() < 1e-5
    np.testing.assert_allclose(results[0].displacement.mean(0), (0.02, 0.01), atol=2e-5)


@pytest.mark.parametrize(
    ("options", "largest"),
    [
        ({}, 0.003),
        ({"smoothing": 0.0}, 0.003),
        ({"interpolation": "bspline3"}, 0.005),
        ({"interpolation": "bicubic"}, 0.05),
        ({"interpolation": "bilinear", "smoothing": 1.0}, 0.05),
        ({"gradient": "finite-difference"}, 0.005),
        ({"quadrature": fedic.MeshQuadrature(density=2.0)}, 0.005),
    ],
)
def test_every_option_measures_an_affine_motion(
    pair: tuple[np.ndarray, np.ndarray], options: dict[str, object], largest: float
) -> None:
    found = errors(pair, **options, max_iterations=200)
    assert np.abs(found).max() < largest


def test_the_pyramid_converges_where_the_zero_start_fails() -> None:
    far = np.array([28.0, -21.0])

    def field(points: np.ndarray) -> np.ndarray:
        return 0.02 * (points - (200, 160)) + far

    reference = fedic.synthetic.render(SPECKLE, FRAME, (320, 400))
    deformed = fedic.synthetic.render(SPECKLE, FRAME, (320, 400), displacement=field)
    mesh = fedic.rectangle_mesh((60, 60, 340, 260), 20)
    result = fedic.correlate(reference, deformed, mesh, initial="pyramid")
    assert result.converged
    assert {iteration.level for iteration in result.history} == {0, 1, 2, 3, 4, 5}
    assert np.abs(result.displacement - field(mesh.points)).max() < 0.05
    lost = fedic.correlate(reference, deformed, mesh, initial="zero")
    assert not lost.converged
    assert np.median(np.abs(lost.unchecked_displacement - field(mesh.points))) > 10.0
    assert lost.residual_rms > 10.0 * result.residual_rms


def test_the_correlator_copies_the_reference_buffer(pair: tuple[np.ndarray, np.ndarray]) -> None:
    def everything(correlator: fedic.Correlator) -> list[np.ndarray]:
        found = [correlator.correlate(pair[1], initial=start).displacement for start in ("pyramid", "fft")]
        return [*found, correlator.residual_map(pair[1], found[0]), correlator.standard_deviations(100.0)]

    mesh = fedic.rectangle_mesh((30.4, 25.3, 210.8, 165.9), 40.0)
    buffer = pair[0].copy()
    correlator = fedic.Correlator(buffer, mesh)
    buffer[:] = np.random.default_rng(0).integers(0, 65536, buffer.shape)
    for found, expected in zip(everything(correlator), everything(fedic.Correlator(pair[0], mesh)), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_a_given_start_saves_iterations(pair: tuple[np.ndarray, np.ndarray]) -> None:
    close = motion(MESH.points)
    from_zero, from_close = (fedic.correlate(*pair, MESH, initial=start) for start in ("zero", close))
    assert from_close.iterations < from_zero.iterations
    np.testing.assert_allclose(from_close.displacement, from_zero.displacement, atol=1e-4)


def test_quadrature_rules_have_nearly_equal_noise() -> None:
    """On the same noisy images without smoothing, one point per pixel is at most 3 % noisier than two and more."""
    texture = fedic.synthetic.render(SPECKLE, FRAME, (240, 240), bits=16) / 257.0
    mesh = fedic.rectangle_mesh((20.3, 20.7, 212.1, 213.9), 20.0)
    shaken = mesh.points + np.random.default_rng(0).uniform(-3, 3, mesh.points.shape)
    mesh = fedic.Mesh(shaken, mesh.cells)
    rng = np.random.default_rng(1)
    draws = [[(texture + rng.normal(0, 2, texture.shape)).astype(np.float32) for _ in range(2)] for _ in range(15)]

    def noise(rule: Literal["rotated", "edges", "diameter"]) -> float:
        options = {"quadrature": fedic.MeshQuadrature(rule=rule), "interpolation": "bspline3", "smoothing": 0.0}
        return float(np.std([fedic.correlate(*pair, mesh, **options).displacement for pair in draws]))  # type: ignore[arg-type]

    finest = noise("diameter")
    assert 1.0 < noise("edges") / finest < 1.03
    assert 1.0 < noise("rotated") / finest < 1.03


def test_the_rotated_rule_has_less_bias_than_the_edges_rule() -> None:
    """With elements of whole pixels, all points of `edges` have the same position within their pixel."""
    fine = fedic.synthetic.Speckle(2.2, seed=3)
    reference = fedic.synthetic.render(fine, FRAME, (200, 200), supersampling=5)
    deformed = fedic.synthetic.fourier_shift(reference, (0.3, 0.0))
    mesh = fedic.rectangle_mesh((30.3, 30.3, 170.3, 170.3), 20.0)
    bias = {
        rule: abs((fedic.correlate(reference, deformed, mesh, quadrature=fedic.MeshQuadrature(rule=rule))  # type: ignore[arg-type]
                   .displacement[:, 0] - 0.3).mean())
        for rule in ("edges", "rotated")
    }  # fmt: skip
    assert bias["rotated"] < 1.2e-4
    assert bias["edges"] > 8 * bias["rotated"]
