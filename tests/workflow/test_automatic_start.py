"""The default start on motions of any size: it converges, says which start won, and fails with advice."""

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.motion import moved
from scenes.moved_plate import motion, pair
from scenes.open_hole import open_hole_camera

SIDE = 500
HALF = 100
MESH = fedic.rectangle_mesh((150, 150, 350, 350), size=20)


def iterations(result: fedic.Result) -> int:
    """Return the number of iterations on the images at full resolution."""
    return max(iteration.iteration for iteration in result.history if iteration.level == 0)


def check(matrix: NDArray[np.float64], mesh: fedic.Mesh = MESH) -> fedic.Result:
    result = fedic.correlate(*pair(matrix, side=SIDE), mesh)
    error = np.linalg.norm(result.displacement - (moved(matrix, mesh.points) - mesh.points), axis=1)
    assert result.converged
    assert np.sqrt((error**2).mean()) < 0.02
    assert iterations(result) <= 6
    assert result.quality.is_good
    return result


@pytest.mark.parametrize("angle", [10, 40, 90, 130, 180])
def test_any_rotation_converges(angle: float) -> None:
    check(motion(angle, side=SIDE))


@pytest.mark.parametrize("stretch", [(1.3, 1.0), (1.5, 1.0), (0.7, 0.7), (1.4, 1.4)])
def test_large_stretches_and_scales_converge(stretch: tuple[float, float]) -> None:
    check(motion(stretch=stretch, side=SIDE))


@pytest.mark.parametrize("shift", [40.0, 140.0, 300.0])
def test_large_shifts_converge(shift: float) -> None:
    check(motion(shift=(shift, 0.0), side=SIDE), fedic.rectangle_mesh((20, 150, 160, 350), size=20))


@pytest.mark.parametrize("draw", range(6))
def test_combined_motions_converge(draw: int) -> None:
    rng = np.random.default_rng(draw)
    scale, stretch = rng.uniform(0.8, 1.25), rng.uniform(0.0, 0.3)
    angle, shift = rng.uniform(-180, 180), rng.uniform(-60, 60, 2)
    mesh = fedic.rectangle_mesh((170, 170, 330, 330), size=20)
    check(motion(angle, (scale * (1 + stretch), scale), tuple(shift), side=SIDE), mesh)


def test_the_result_says_which_start_won_and_what_each_left() -> None:
    result = check(motion(60, side=SIDE))
    assert result.start == "features"
    assert [attempt.start for attempt in result.attempts][-1] == "features"
    assert {"zero", "pyramid"} < {attempt.start for attempt in result.attempts}
    small = check(motion(shift=(0.7, -0.3), side=SIDE))
    assert (small.start, len(small.attempts)) == ("zero", 1)
    assert small.summary()["attempts"][0]["start"] == "zero"


@pytest.mark.parametrize("start", ["features", "log-polar"])
def test_estimators_can_be_asked_for(start: str) -> None:
    matrix = motion(75, side=SIDE)
    result = fedic.correlate(*pair(matrix, side=SIDE), MESH, initial=start)  # type: ignore[arg-type]
    assert (result.start, result.converged) == (start, True)
    blank = pair(matrix, side=SIDE)[0]
    with pytest.raises(fedic.SolveError, match="finds no motion"):
        fedic.correlate(blank, np.ascontiguousarray(blank[:, ::-1]), MESH, initial=start)  # type: ignore[arg-type]


def test_an_earlier_result_is_a_start() -> None:
    first = check(motion(20, side=SIDE))
    reference, deformed = pair(motion(20.3, side=SIDE), side=SIDE)
    result = fedic.correlate(reference, deformed, MESH, initial=first)
    assert (result.start, result.converged) == ("given", True)
    with pytest.raises(fedic.OptionError, match="remembers no earlier frame"):
        fedic.correlate(reference, deformed, MESH, initial="previous")  # type: ignore[arg-type]
    with pytest.raises(fedic.OptionError, match="a result on a mesh of"):
        fedic.correlate(reference, deformed, fedic.rectangle_mesh((150, 150, 350, 350), size=10), initial=first)


def test_a_failure_says_what_was_tried() -> None:
    reference = pair(motion(side=SIDE), side=SIDE)[0]
    other = fedic.synthetic.render(fedic.synthetic.Speckle(5.0, seed=77), fedic.ImageFrame(), (SIDE, SIDE))
    with pytest.warns(fedic.ConvergenceWarning, match=r"Starts tried: .*zero.*Check that both images"):
        result = fedic.correlate(reference, other, MESH)
    assert not result.quality.is_good
    assert np.isnan(result.displacement).mean() > 0.3


@pytest.mark.parametrize(("frame", "more"), [("0054", 1), ("0070", 1)])
def test_real_images_turned_by_quarter_turns_give_the_turned_field(
    frame: str, more: int, shared_data: Callable[[str], Path]
) -> None:
    reference, deformed = (fedic.read_image(shared_data(f"openhole/zoom-{number}_1.tif")) for number in ("0053", frame))
    height, width = reference.shape
    side = max(height, width)

    def square(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        return np.pad(image, ((0, side - height), (0, side - width)))

    mesh = fedic.read_mesh(shared_data("openhole/abaqus_q4_m.inp"))
    correlator = fedic.Correlator(square(reference), mesh, open_hole_camera())  # type: ignore[arg-type]
    at_rest = open_hole_camera().project(mesh.points)
    unturned = turned_back = None
    needed = 0
    for turns in range(4):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fedic.QualityWarning)
            result = correlator.correlate(np.ascontiguousarray(np.rot90(square(deformed), turns)))  # type: ignore[arg-type]
        assert result.converged
        turned_back = at_rest + result.pixel_displacement
        for _ in range(turns):
            turned_back = np.stack([side - 1 - turned_back[:, 1], turned_back[:, 0]], axis=1)
        if unturned is None:
            unturned, needed = turned_back, iterations(result)
        assert iterations(result) <= needed + more
        np.testing.assert_allclose(turned_back, unturned, atol=1e-3)


@pytest.mark.parametrize("frame", ["0058", "0062", "0066"])
def test_real_series_converge_without_any_option(frame: str, shared_data: Callable[[str], Path]) -> None:
    reference, deformed = (fedic.read_image(shared_data(f"openhole/zoom-{number}_1.tif")) for number in ("0053", frame))
    mesh = fedic.read_mesh(shared_data("openhole/gmsh_t3_mm.msh"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        assert fedic.correlate(reference, deformed, mesh, open_hole_camera(1000.0)).converged
