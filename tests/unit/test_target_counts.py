"""A wrong number of corners or circles is noticed, and a right one is not taken for wrong."""

from collections import Counter

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.calibration import NotFoundError, Target, find_target
from fedic.calibration.detection import WrongCountError
from scenes.printed import Scene, printed, scene, view, wrong_counts


def outcomes(views: list[NDArray[np.uint8]], target: Target) -> Counter[str]:
    found: Counter[str] = Counter()
    for image in views:
        try:
            find_target(image, target)
            found["accepted"] += 1
        except WrongCountError:
            found["wrong count"] += 1
        except NotFoundError:
            found["not found"] += 1
    return found


@pytest.mark.parametrize("seed", [1, 2, 3, 5, 56])
def test_wrong_counts_are_refused_and_right_ones_accepted(seed: int) -> None:
    drawn = scene(seed, views=2)
    right = outcomes(drawn.views, drawn.target)
    assert right["accepted"] >= 1
    assert right["wrong count"] == 0
    wrong = outcomes(drawn.views, wrong_counts(drawn.target, drawn.rng))
    assert wrong["accepted"] == 0


def plain(kind: str, columns: int, rows: int, views: int = 3, seed: int = 0) -> Scene:
    rng = np.random.default_rng(seed)
    target = Target(kind, columns, rows, 10.0)  # type: ignore[arg-type]
    paper = printed(target, rng)
    return Scene(target, [view(paper, rng) for _ in range(views)], rng)


@pytest.mark.parametrize(("columns", "rows"), [(7, 7), (5, 5), (3, 3), (9, 6), (8, 7)])
def test_a_part_of_a_grid_of_circles_is_refused_with_the_counts_seen(columns: int, rows: int) -> None:
    (image,) = plain("circles", 9, 7, views=1).views
    with pytest.raises(WrongCountError, match=f"goes on beyond {columns} x {rows} circles: at least 9 x 7 are seen"):
        find_target(image, Target("circles", columns, rows, 10.0))


def test_a_part_of_a_large_chessboard_is_refused() -> None:
    drawn = plain("chessboard", 14, 10, views=2)
    with pytest.raises(fedic.CameraError, match="another number of points in 2 of 2 images"):
        fedic.calibrate(drawn.views, "chessboard:7x10:10")


@pytest.mark.parametrize("rows", [7, 8, 10])
def test_asymmetric_circles_are_numbered_row_by_row(rows: int) -> None:
    """OpenCV 5.0 swaps each two rows of a board with an even number of rows in some views."""
    drawn = plain("asymmetric-circles", 4, rows, views=2, seed=rows)
    for image in drawn.views:
        seen = find_target(image, drawn.target)
        matrix, _ = cv2.findHomography(seen.points[:, :2], seen.pixels)
        mapped = cv2.perspectiveTransform(seen.points[:, np.newaxis, :2], matrix)[:, 0]
        assert np.linalg.norm(mapped - seen.pixels, axis=1).max() < 1.0


def test_a_corner_hidden_by_a_glare_does_not_make_a_board_wrong() -> None:
    drawn = plain("chessboard", 9, 6, views=1)
    seen = find_target(drawn.views[0], drawn.target)
    spot = tuple(int(value) for value in seen.pixels[22])
    image = drawn.views[0].copy()
    cv2.circle(image, spot, 3, 250, -1)
    assert len(find_target(image, drawn.target).points) == 54


def test_a_few_views_with_other_counts_are_left_out_with_a_warning() -> None:
    small, large = plain("circles", 7, 5, views=4), plain("circles", 8, 5, views=1)
    with pytest.warns(fedic.CalibrationWarning, match="another number of points in 1 of 5 images"):
        calibration = fedic.calibrate([*small.views, *large.views], small.target)
    assert [view.found for view in calibration.views] == [True] * 4 + [False]


def test_a_board_that_is_seen_in_part_is_not_called_wrong() -> None:
    """The corners in view are fewer than given: the message leaves open which is wrong."""
    drawn = plain("chessboard", 8, 6, views=1)
    seen = find_target(drawn.views[0], drawn.target)
    last = seen.pixels.reshape(6, 8, 2)[:, -1]
    image = drawn.views[0].copy()
    image[:, int(last[:, 0].min()) - 8 :] = 128
    with pytest.raises(NotFoundError) as told:
        find_target(image, drawn.target)
    assert not isinstance(told.value, WrongCountError)
    assert "a part of it is not in view, or the count is wrong" in str(told.value)
