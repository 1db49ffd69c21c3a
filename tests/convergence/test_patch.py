"""Patch tests: a displacement that the elements represent exactly is measured to the accuracy of the interpolation.

The images are not smoothed: the filter does not deform with the material, which causes a small error under strain
(`test_the_error_of_smoothing_under_strain_is_small`).
"""

from collections.abc import Callable

import numpy as np
import pytest

import fedic

CELLS = ["triangle", "triangle6", "quad", "quad8", "quad9"]
QUADRATURES = {
    "rotated": fedic.MeshQuadrature(),
    "edges": fedic.MeshQuadrature(rule="edges"),
    "diameter": fedic.MeshQuadrature(rule="diameter"),
    "pixel": fedic.PixelQuadrature(),
}
SHAPE = (140, 160)
CENTRE = np.array([80.0, 70.0])
SPECKLE = fedic.synthetic.Speckle(6.0, seed=5)


def translation(points: np.ndarray) -> np.ndarray:
    return np.broadcast_to([0.37, -0.21], points.shape)


def rotation(points: np.ndarray) -> np.ndarray:
    angle = 0.01
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return (points - CENTRE) @ (turn - np.eye(2))


def affine(points: np.ndarray) -> np.ndarray:
    return (points - CENTRE) @ np.array([[0.008, 0.003], [-0.002, -0.005]]) + (0.3, 0.2)


Field = Callable[[np.ndarray], np.ndarray]
FIELDS: dict[str, Field] = {"translation": translation, "rotation": rotation, "affine": affine}


@pytest.fixture(scope="module")
def images() -> dict[str, np.ndarray]:
    frame = fedic.ImageFrame()
    pairs = {
        name: fedic.synthetic.render(SPECKLE, frame, SHAPE, displacement=field, bits=16)
        for name, field in FIELDS.items()
    }
    return {"reference": fedic.synthetic.render(SPECKLE, frame, SHAPE, bits=16), **pairs}


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("cell", CELLS)
def test_affine_displacement_is_measured(images: dict[str, np.ndarray], field: str, quadrature: str, cell: str) -> None:
    mesh = fedic.rectangle_mesh((25.3, 24.6, 135.7, 114.9), 22.0, cell)  # type: ignore[arg-type]
    result = fedic.correlate(
        images["reference"],
        images[field],
        mesh,
        quadrature=QUADRATURES[quadrature],
        smoothing=0.0,
        tolerance=1e-5,
    )
    assert result.converged
    errors = result.displacement - FIELDS[field](mesh.points)
    assert np.abs(errors).max() < 0.004
    assert errors.std() < 0.0008


def test_the_error_of_smoothing_under_strain_is_small(images: dict[str, np.ndarray]) -> None:
    """The error grows with the strain, here up to 0.8 %; a translation has none."""
    mesh = fedic.rectangle_mesh((25.3, 24.6, 135.7, 114.9), 22.0)
    for name, most in (("translation", 0.00006), ("affine", 0.0008)):
        errors = fedic.correlate(images["reference"], images[name], mesh).displacement - FIELDS[name](mesh.points)
        assert errors.std() < most


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("quadrature", QUADRATURES)
@pytest.mark.parametrize("lens", [None, fedic.BrownDistortion((-8.0, 20.0, 0.0), (0.02, -0.03), (0.01, 0.02))])
def test_affine_displacement_is_measured_in_millimetres(
    cell: str, quadrature: str, lens: fedic.BrownDistortion | None
) -> None:
    """A tilted pinhole with a strong lens, the mesh in millimetres at Z = 2."""
    camera = fedic.Pinhole(
        (1600, 1650),
        (82, 68),
        rotation=[np.pi + 0.1, -0.08, 0.05],
        translation=(0.5, 1.0, 160.0),
        skew_angle=1.56,
        distortion=lens,
    )
    texture = fedic.synthetic.Speckle(0.6, seed=6)

    def stretch(points: np.ndarray) -> np.ndarray:
        return points @ np.array([[0.006, 0.002], [-0.003, -0.004]]) + (0.05, -0.03)

    reference = fedic.synthetic.render(texture, camera, SHAPE, z=2.0, bits=16)
    deformed = fedic.synthetic.render(texture, camera, SHAPE, z=2.0, displacement=stretch, bits=16)
    flat = fedic.rectangle_mesh((-5.13, -4.07, 5.21, 3.91), 2.2, cell)  # type: ignore[arg-type]
    mesh = fedic.Mesh(np.c_[flat.points, np.full(flat.num_nodes, 2.0)], flat.cells)
    result = fedic.correlate(
        reference, deformed, mesh, camera, quadrature=QUADRATURES[quadrature], smoothing=0.0, tolerance=1e-5
    )
    assert result.converged
    errors = result.displacement - stretch(flat.points)
    # Ten pixels per millimetre: the same bounds in pixels as in `test_affine_displacement_is_measured`.
    assert np.abs(errors).max() < 0.0004
    assert errors.std() < 0.00008
