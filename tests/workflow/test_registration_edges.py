"""Registration from the edges of rendered plates: accuracy, standard deviations, hidden edges, errors."""

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from scenes.placed_plate import BOUNDARY, CAMERAS, FRONT, MESH, PINHOLE, POINTS, SHAPE, errors, off, plate
from scenes.plate import Plate, plate_mesh, signs, wrong


@pytest.mark.parametrize(
    ("name", "ground"),
    [("front", 0.02), ("front", 0.5), ("pinhole", 0.5), ("pinhole", 0.98)],
    ids=["front-dark", "front-mean", "pinhole-mean", "pinhole-bright"],
)
def test_a_rendered_plate_is_found_from_wrong_starts(name: str, ground: float) -> None:
    """Measured error of the worst node: 0.5 px with four unknowns, 0.8 px with six; speckles hide the edge."""
    camera, worst = CAMERAS[name], {"front": 0.6, "pinhole": 1.0}[name]
    image = plate(camera, ground, seed=3)
    for sign in signs()[::3]:
        start = wrong(camera, sign)
        assert off(start, camera).max() > 20.0
        found = fedic.register(MESH, image, start, features=BOUNDARY)
        assert off(found.camera, camera).max() < worst
        assert np.median(off(found.camera, camera)) < 0.5 * worst
        for distances in found.features.values():
            assert distances.median < 0.8
            assert distances.used.sum() >= 0.8 * len(distances.used)
    again = fedic.register(MESH, image, start, features=BOUNDARY)
    assert again.camera == found.camera
    np.testing.assert_array_equal(again.covariance, found.covariance)


def test_standard_deviations_from_edges_agree_with_monte_carlo() -> None:
    """The errors of the edges come from the speckle: each draw has a new one."""
    camera, start = fedic.FrontParallel(5.0, (20.0, 160.0), 0.05), fedic.FrontParallel(5.01, (20.5, 159.5), 0.051)
    ratios = []
    for seed in range(20):
        image = fedic.synthetic.render(Plate(0.02, seed, 0.6), camera, (180, 330), supersampling=2, seed=seed)
        found = fedic.register(MESH, image, start, features=["hole 0", "left", "bottom"], search=0.0)
        ratios.append(errors(found.camera, camera) / list(found.standard_deviations.values()))
    scores = np.array(ratios)
    assert (np.abs(scores) < 3.0).sum(axis=0).min() >= 19
    assert np.all(scores.std(axis=0) < 1.4)


def test_edges_without_speckle_are_found_to_hundredths_of_a_pixel() -> None:
    class Plain(Plate):
        def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
            self._speckle = _Constant()  # type: ignore[assignment]
            return super().values(points)

    for camera in CAMERAS.values():
        for ground in (0.1, 0.9):
            image = fedic.synthetic.render(Plain(ground), camera, SHAPE, noise=1.0, bits=12)  # type: ignore[arg-type]
            found = fedic.register(MESH, image, wrong(camera, (1, 1, -1, -1)), features=BOUNDARY)
            assert off(found.camera, camera).max() < 0.03


class _Constant:
    def values(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.full(len(points), 0.5)


def test_chords_of_a_coarse_mesh_do_not_shrink_the_hole() -> None:
    coarse = plate_mesh("triangle", divisions=4)
    image = plate(FRONT, 0.98)
    fine = fedic.register(MESH, image, FRONT, features=["hole 0", "bottom", "top"], search=0.0)
    found = fedic.register(coarse, image, FRONT, features=["hole 0", "bottom", "top"], search=0.0)
    assert off(found.camera, fine.camera).max() < 0.05


def test_hidden_edges_and_dirt_are_rejected() -> None:
    image = plate(FRONT, 0.02)
    image[240:275, 130:210] = 128  # a clip over the lower side
    image[60:75, 300:330] = 255
    found = fedic.register(MESH, image, wrong(FRONT, (1, -1, 1, -1)), features=BOUNDARY)
    assert off(found.camera, FRONT).max() < 0.8
    bottom = found.features["bottom"]
    assert not bottom.used[(bottom.pixels[:, 0] > 140) & (bottom.pixels[:, 0] < 200)].any()


def test_points_and_edges_are_combined() -> None:
    image = plate(PINHOLE, 0.02)
    clicked = PINHOLE.project(POINTS[:2]) + np.array([[0.4, -0.3], [-0.2, 0.5]])
    found = fedic.register(
        MESH, image, wrong(PINHOLE, (1, 1, 1, 1)), points=(POINTS[:2], clicked), features=BOUNDARY, pixel_noise=0.5
    )
    assert off(found.camera, PINHOLE).max() < 0.6
    assert found.residuals.shape == (2, 2)
    assert set(found.features) == set(BOUNDARY)


def test_speckle_without_edges_is_refused() -> None:
    texture = fedic.synthetic.Speckle(0.4, seed=2)
    image = fedic.synthetic.render(texture, FRONT, SHAPE)
    with pytest.raises(fedic.ImageError, match="is not found in the image"):
        fedic.register(MESH, image, FRONT, features=BOUNDARY)


def test_a_tilt_that_a_long_lens_does_not_determine_is_named() -> None:
    upright = np.diag([1.0, -1.0, -1.0])
    far = fedic.Pinhole((80000, 80000), (300, 200), upright, (-30.0, 12.5, 10000.0))
    image = plate(far, 0.02)
    with pytest.raises(
        fedic.SolveError, match=r"hardly determine rx \(standard deviation .*leave known parameters out of free"
    ):
        fedic.register(MESH, image, far, features=BOUNDARY, search=0.0)
    found = fedic.register(MESH, image, far, features=BOUNDARY, search=0.0, free=["rz", "tx", "ty", "tz"])
    assert off(found.camera, far).max() < 0.6
