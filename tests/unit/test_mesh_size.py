"""A mesh of an impossible size in the image: the message asks for the scale or the camera."""

import numpy as np
import pytest

import fedic

IMAGE = np.random.default_rng(0).integers(0, 255, (400, 500), dtype=np.uint8)
MILLIMETRES = fedic.rectangle_mesh((0, 0, 40, 30), 2.0)


def origin(scale: float) -> tuple[float, float]:
    return (50.0, 50.0 + 30.0 * scale)


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        (fedic.FrontParallel(0.1, origin(0.1)), r"4 x 3 px in an image of 500 x 400 px: is the scale of 0.1 pixels"),
        (fedic.FrontParallel(100.0, origin(0.0)), r"4e\+03 x 3e\+03 px .* is the scale of 100 pixels"),
        (
            fedic.Pinhole((1000.0, 1000.0), (250.0, 200.0), np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 9000.0)),
            r"4.44 x 3.33 px .* the same unit\?",
        ),
    ],
)
def test_the_message_asks_for_the_scale(camera: fedic.FrontParallel, message: str) -> None:
    with pytest.raises((fedic.MeshError, fedic.SolveError), match=message):
        fedic.Correlator(IMAGE, MILLIMETRES, camera)


def test_a_mesh_of_a_usual_size_is_not_remarked_on() -> None:
    with pytest.raises(fedic.MeshError) as caught:
        fedic.Correlator(IMAGE, MILLIMETRES, fedic.FrontParallel(10.0, (300.0, 350.0)))
    assert "The mesh is" not in str(caught.value)
    assert caught.value.cells


def test_the_message_asks_for_a_forgotten_camera() -> None:
    metres = fedic.Mesh(MILLIMETRES.points / 100.0 + 100.0, MILLIMETRES.cells)
    with pytest.raises((fedic.MeshError, fedic.SolveError), match=r"0.4 x 0.3 px in .* was the camera forgotten"):
        fedic.Correlator(IMAGE, metres)
