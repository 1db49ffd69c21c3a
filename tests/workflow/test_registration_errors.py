"""Registration of bad input: each error says what was wrong and what to do."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from scenes.placed_plate import BARE, BLANK, BOUNDARY, FRONT, MESH, PINHOLE, POINTS, plate

BAD: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({}, fedic.OptionError, r"give points, features or a target; .*\n  left: straight, \(0, 25\) to \(0, 0\)"),
    (
        {"features": ["hole"]},
        fedic.OptionError,
        r"no boundary part 'hole'; it has\n  left: .*\n(.*\n)*  hole 0: circle",
    ),
    ({"features": "hole 0"}, fedic.OptionError, "give a list of names"),
    ({"features": ["top", "top"]}, fedic.OptionError, "'top' is given twice"),
    ({"features": ["bottom", "top"]}, fedic.SolveError, "do not determine .*u0.* Add point pairs or features"),
    ({"features": ["hole 0"]}, fedic.SolveError, "do not determine u0, v0 and angle"),
    (
        {"points": (POINTS[4:5], FRONT.project(POINTS[4:5]))},
        fedic.SolveError,
        "do not determine u0, v0, angle and scale",
    ),
    ({"points": POINTS}, fedic.OptionError, r"points: .*give points=\(points"),
    ({"points": (POINTS, POINTS[:3])}, fedic.OptionError, r"pixels of shape \(3, 2\)"),
    ({"points": (["a"], [1])}, fedic.OptionError, "not a pair of arrays of numbers"),
    ({"points": (POINTS * np.nan, POINTS)}, fedic.OptionError, "pair number 0 is not finite"),
    ({"points": (POINTS, POINTS + 1e4)}, fedic.OptionError, r"pixel number 0 .* outside the image of 600 x 400 px"),
    (
        {"features": BOUNDARY, "free": ["tilt"]},
        fedic.OptionError,
        "'tilt' is not a parameter of a FrontParallel; .* u0",
    ),
    ({"features": BOUNDARY, "free": []}, fedic.OptionError, "free: nothing is not a parameter"),
    ({"features": BOUNDARY, "search": -1.0}, fedic.OptionError, "search=-1.0"),
    ({"features": BOUNDARY, "pixel_noise": 0.0}, fedic.OptionError, "pixel_noise=0.0"),
    ({"features": BOUNDARY, "pixel_noise": "x"}, fedic.OptionError, "pixel_noise='x': give a positive number"),
    ({"features": BOUNDARY, "search": "a"}, fedic.OptionError, "search='a': give a number of pixels, zero or more"),
    ({"features": BOUNDARY, "search": np.nan}, fedic.OptionError, "search=nan"),
    (
        {"features": BOUNDARY, "target_origin": (1, 2)},
        fedic.OptionError,
        "target_origin is given without a target; add target=",
    ),
    (
        {"features": BOUNDARY, "target_angle": 0.1},
        fedic.OptionError,
        "target_angle is given without a target; add target=",
    ),
    (
        {"features": BOUNDARY, "target_thickness": 1.0},
        fedic.OptionError,
        "target_thickness is given without a target; add target=",
    ),
    ({"features": BOUNDARY, "camera": fedic.ImageFrame()}, fedic.OptionError, "ImageFrame has no pose"),
    (
        {"features": BOUNDARY, "camera": fedic.FrontParallel(8.0, (3000.0, 270.0))},
        fedic.CameraError,
        r"puts the feature 'hole 0' around .*, outside the image of 600 x 400 px; correct it",
    ),
    (
        {"features": BOUNDARY, "camera": fedic.FrontParallel(8.0, (60.0, 370.0), -0.1)},
        fedic.ImageError,
        "is not found in the image: .* further than search = 60 px",
    ),
    ({"features": BOUNDARY, "image": BLANK}, fedic.ImageError, "is not found in the image: 0 of its .* segments show"),
    ({"features": BOUNDARY, "image": None}, fedic.ImageError, "give a NumPy array"),
    ({"features": BOUNDARY, "camera": BARE}, fedic.CameraError, "does not see all of the feature 'hole 0'"),
    (
        {"points": (POINTS[[0, 3, 6]], PINHOLE.project(POINTS[[0, 3, 6]])), "camera": PINHOLE},
        fedic.SolveError,
        "do not determine",
    ),
]


@pytest.fixture(scope="module")
def image() -> NDArray[np.uint8]:
    return plate(FRONT, 0.02)


@pytest.mark.parametrize(("options", "error", "message"), BAD)
def test_bad_input_is_refused(
    image: NDArray[np.uint8], options: dict[str, Any], error: type[Exception], message: str
) -> None:
    given: dict[str, Any] = {"image": image, "camera": FRONT, **options}
    with pytest.raises(error, match=message):
        fedic.register(MESH, **given)
