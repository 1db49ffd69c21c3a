"""OpenCV uses no more threads than a measurement is allowed."""

import threading
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.threads import opencv_threads


@pytest.fixture(autouse=True)
def three_threads() -> Any:
    before = cv2.getNumThreads()
    cv2.setNumThreads(3)
    yield
    cv2.setNumThreads(before)


@pytest.mark.parametrize(("count", "expected"), [(1, 1), (2, 2), (None, 3)])
def test_num_threads_holds_for_the_starts(
    speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    monkeypatch: pytest.MonkeyPatch,
    count: int | None,
    expected: int,
) -> None:
    seen: list[int] = []
    match = cv2.matchTemplate

    def watched(*arguments: Any, **options: Any) -> Any:
        seen.append(cv2.getNumThreads())
        return match(*arguments, **options)

    monkeypatch.setattr(cv2, "matchTemplate", watched)
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    assert fedic.correlate(*speckle_pair, mesh, initial="fft", num_threads=count).converged
    assert seen
    assert set(seen) == {expected}
    assert cv2.getNumThreads() == 3


def test_the_number_is_restored_after_blocks_that_overlap_and_after_errors() -> None:
    inside, leave = threading.Event(), threading.Event()

    def other() -> None:
        with opencv_threads(1):
            inside.set()
            leave.wait(60)

    thread = threading.Thread(target=other)
    with opencv_threads(2):
        thread.start()
        inside.wait(60)
        assert cv2.getNumThreads() == 1
    assert cv2.getNumThreads() == 1
    leave.set()
    thread.join()
    assert cv2.getNumThreads() == 3
    with pytest.raises(KeyError), opencv_threads(1):
        raise KeyError
    assert cv2.getNumThreads() == 3
