"""Registration in large images: number of trials, memory, and limits of the search."""

import tracemalloc
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.registration import _edges as edges
from fedic.registration import _search as search
from fedic.registration._sampling import sample_feature
from fedic.registration._space import in_space
from scenes.plate import LENGTH, Plate, plate_mesh, wrong

MESH = plate_mesh()
FEATURES = ["hole 0", "left", "right", "bottom", "top"]
LARGE = fedic.FrontParallel(40.0, (300.0, 1250.0), 0.03)
LARGE_SHAPE = (1500, 3000)


@pytest.fixture(scope="module")
def large() -> NDArray[np.uint8]:
    return fedic.synthetic.render(Plate(0.5, seed=3), LARGE, LARGE_SHAPE, supersampling=1, noise=2.0)  # type: ignore[return-value,arg-type]


def off(found: Any, true: Any) -> float:
    return float(np.linalg.norm(found.project(MESH.points) - true.project(MESH.points), axis=1).max())


def strips(camera: Any) -> list[edges.Strip]:
    return [
        edges.prepare_strip(each.name, MESH, sample_feature(MESH, each, camera, 12.0), camera)
        for each in fedic.boundary_features(MESH)
        if each.name in FEATURES
    ]


@pytest.mark.parametrize("sign", [(1, 1, 1, 1), (-1, 1, -1, 1)])
def test_wide_searches_are_bounded_in_trials_and_memory(
    large: NDArray[np.uint8], sign: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full grid of 7.5 px steps over 200 px, 4 degrees and 6 % has over two million trials."""
    tried = []

    def scores(channels: Any, outline: Any, candidates: Any, *rest: Any) -> Any:
        tried.append(len(candidates))
        return counted(channels, outline, candidates, *rest)

    counted = search._scores
    monkeypatch.setattr(search, "_scores", scores)
    u, v = LARGE.origin
    start = wrong(fedic.FrontParallel(LARGE.scale, (u + 120.0 * sign[0], v - 110.0), LARGE.angle), sign)
    tracemalloc.start()
    found = fedic.register(MESH, large, start, features=FEATURES, search=200.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert sum(tried) < 130_000
    assert peak < 120e6
    assert off(found.camera, LARGE) < 1.0


def test_the_memory_of_a_search_does_not_grow_with_the_features() -> None:
    """Features of 7000 px in an empty image of 100 megapixels."""
    image = np.zeros((6500, 15000), dtype=np.uint8)
    camera = fedic.FrontParallel(200.0, (1500.0, 6250.0), 0.03)
    ready = strips(camera)
    for reach in (60.0, 200.0):
        tracemalloc.start()
        search.nearby(image, camera, ready, ("u0", "v0", "angle", "scale"), reach)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 6.0 * image.size


def test_the_reduced_image_does_not_depend_on_the_band_height(
    large: NDArray[np.uint8], monkeypatch: pytest.MonkeyPatch
) -> None:
    banded = search._reduced(large)
    monkeypatch.setattr(search, "_ROWS_AT_ONCE", 2 * len(large))
    for some, whole in zip(banded.channels, search._reduced(large).channels, strict=True):
        assert some.shape == (LARGE_SHAPE[0] // 2, LARGE_SHAPE[1] // 2)
        np.testing.assert_allclose(some, whole, rtol=0, atol=1e-4)


def test_pixels_of_the_reduced_image_keep_their_position() -> None:
    image = np.zeros((203, 301), dtype=np.uint8)
    image[104:112, 160:168] = 255
    level = search._reduced(image)
    for _ in range(3):
        rows, columns = level.index(np.array([163.5 + 107.5j]))
        around = level.channels[0][rows[0] - 1 : rows[0] + 2, columns[0] - 1 : columns[0] + 2]
        assert around[1, 1] == around.max() > 60.0
        level = level.halved()


@pytest.mark.parametrize("reach", [1e4, 1e6])
def test_too_wide_searches_are_refused(large: NDArray[np.uint8], reach: float) -> None:
    with pytest.raises(
        fedic.OptionError, match=r"search=.*: too wide for features .* Give a search up to \d+"
    ) as caught:
        fedic.register(MESH, large, LARGE, features=FEATURES, search=reach)
    largest = float(str(caught.value).split("up to ")[1].split(" px")[0])
    assert 200.0 < largest < reach


def whole_grey_levels(image: Any, places: NDArray[np.float64]) -> NDArray[np.float64]:
    levels, _ = fedic._core.interpolate_image(image, places.reshape(-1, 2), "bilinear")
    return levels.astype(np.float64).reshape(places.shape[:2])


@pytest.mark.parametrize("shift", [0.0, 700.0], ids=["inside", "partly outside"])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
def test_edges_are_sampled_from_the_surrounding_image_only(
    large: NDArray[np.uint8], kind: type, shift: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    image, sizes = large.astype(kind), []

    def read(part: Any, *rest: Any) -> Any:
        sizes.append(part.size)
        return fedic._core.interpolate_image(part, *rest)

    u, v = LARGE.origin
    camera = fedic.FrontParallel(LARGE.scale, (u + shift, v + shift), LARGE.angle)
    ready = strips(camera)
    names = ("u0", "v0", "angle", "scale")
    monkeypatch.setattr(edges, "interpolate_image", read)
    near = [edges.measure_edge(image, camera, strip, names, 24.0, 16.0) for strip in ready]
    assert sizes
    assert max(sizes) < 0.04 * image.size
    monkeypatch.setattr(edges, "_grey_levels", whole_grey_levels)
    for strip, found in zip(ready, near, strict=True):
        expected = edges.measure_edge(image, camera, strip, names, 24.0, 16.0)
        np.testing.assert_array_equal(found.distances, expected.distances)
        np.testing.assert_array_equal(found.valid, expected.valid)


def test_pixels_that_are_not_finite_are_located(large: NDArray[np.uint8]) -> None:
    image = large.astype(np.float32)
    image[7, 11] = np.nan
    with pytest.raises(fedic.ImageError, match=r"is nan at \(u, v\) = \(11, 7\)"):
        fedic.register(MESH, image, LARGE, features=FEATURES)


def test_in_space_appends_a_zero_coordinate() -> None:
    flat = np.array([[1.0, 2.0], [LENGTH, 4.0]])
    np.testing.assert_array_equal(in_space(flat), [[1.0, 2.0, 0.0], [LENGTH, 4.0, 0.0]])
    raised = np.array([[1.0, 2.0, 3.0]])
    assert in_space(raised) is raised
