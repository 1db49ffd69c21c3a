"""Residual maps and standard deviations of results, from the images they refer to."""

import gc
import pickle
import weakref
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic

Image = NDArray[np.uint8]
MESH = fedic.rectangle_mesh((10, 10, 80, 60), size=10)
OPTIONS: dict = {"smoothing": 0.5, "brightness": None, "quadrature": fedic.MeshQuadrature(density=0.7)}


def pair() -> tuple[Image, Image]:
    speckle = fedic.synthetic.Speckle(4.0, seed=5)
    moved = fedic.synthetic.render(
        speckle,
        fedic.ImageFrame(),
        (70, 90),
        displacement=lambda points: np.full((len(points), 2), (0.4, -0.3)),
        noise=2.0,
    )
    return fedic.synthetic.render(speckle, fedic.ImageFrame(), (70, 90)), moved  # type: ignore[return-value]


@pytest.mark.parametrize("kept", [True, False], ids=["correlator kept", "correlator gone"])
def test_a_result_gives_what_its_correlator_gives(kept: bool) -> None:
    reference, deformed = pair()
    correlator = fedic.Correlator(reference, MESH, **OPTIONS)
    result = correlator.correlate(deformed)
    residual, deviations = (
        correlator.residual_map(deformed, result.displacement),
        correlator.standard_deviations(2.0, result.displacement),
    )
    if not kept:
        gone = weakref.ref(correlator)
        del correlator
        gc.collect()
        assert gone() is None
        reference[:] = 0  # The result refers to the correlator's copy of the reference image.
    np.testing.assert_array_equal(result.residual_map(), residual)
    np.testing.assert_array_equal(result.standard_deviations(2.0), deviations)
    assert np.isfinite(residual[15:55, 15:75]).all()


def test_a_result_of_correlate_gives_the_same() -> None:
    reference, deformed = pair()
    result = fedic.correlate(reference, deformed, MESH, **OPTIONS)
    correlator = fedic.Correlator(reference, MESH, **OPTIONS)
    np.testing.assert_array_equal(result.residual_map(), correlator.residual_map(deformed, result.displacement))
    np.testing.assert_array_equal(
        result.standard_deviations(2.0), correlator.standard_deviations(2.0, result.displacement)
    )


def test_the_map_is_that_of_a_replaced_displacement() -> None:
    result = fedic.correlate(*pair(), MESH, **OPTIONS)
    worse = replace(result, unchecked_displacement=np.zeros_like(result.displacement))
    assert np.nanstd(worse.residual_map()) > 3.0 * np.nanstd(result.residual_map())


def test_an_array_is_referenced_and_an_image_of_a_file_is_not(tmp_path: Path) -> None:
    reference, deformed = pair()
    correlator = fedic.Correlator(reference, MESH)
    kept = correlator.correlate(deformed)
    assert kept._measurement is not None
    assert kept._measurement.deformed.array is deformed
    path = tmp_path / "deformed.png"
    assert cv2.imwrite(str(path), deformed)
    read = fedic.read_image(path)
    from_file = correlator.correlate(read)
    gone = weakref.ref(read)
    del read
    gc.collect()
    assert gone() is None
    np.testing.assert_array_equal(from_file.residual_map(), kept.residual_map())


def test_an_image_changed_after_reading_is_referenced(tmp_path: Path) -> None:
    reference, deformed = pair()
    path = tmp_path / "deformed.png"
    assert cv2.imwrite(str(path), deformed)
    read = fedic.read_image(path)
    read //= 2
    result = fedic.correlate(reference, read, MESH)
    assert result._measurement is not None
    assert result._measurement.deformed.array is read


def test_a_pickled_result_reads_its_images_from_their_files(tmp_path: Path) -> None:
    paths = [tmp_path / "reference.png", tmp_path / "deformed.tif"]
    for path, image in zip(paths, pair(), strict=True):
        assert cv2.imwrite(str(path), image)
    reference, deformed = (fedic.read_image(path) for path in paths)
    result = fedic.correlate(reference, deformed, MESH, **OPTIONS)
    copy = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(copy.displacement, result.displacement)
    np.testing.assert_array_equal(copy.residual_map(), result.residual_map())
    np.testing.assert_array_equal(copy.standard_deviations(1.0), result.standard_deviations(1.0))
    paths[1].unlink()
    with pytest.raises(
        fedic.ImageError, match=r"The deformed image of this result cannot be read again: .*deformed\.tif"
    ):
        copy.residual_map()
    assert cv2.imwrite(str(paths[1]), reference)
    with pytest.raises(fedic.ImageError, match=r"The deformed image of this result has changed .*deformed\.tif"):
        copy.residual_map()


def test_a_pickled_result_drops_arrays_and_says_so() -> None:
    result = fedic.correlate(*pair(), MESH)
    copy = pickle.loads(pickle.dumps(result))
    assert copy._measurement.deformed.array is None
    np.testing.assert_array_equal(copy.displacement, result.displacement)
    for ask, name in ((copy.residual_map, "deformed"), (lambda: copy.standard_deviations(1.0), "reference")):
        with pytest.raises(
            fedic.ImageError, match=f"The {name} image of this result is not known any more: .*unpickled"
        ):
            ask()


def test_an_array_that_was_overwritten_is_noticed() -> None:
    reference, deformed = pair()
    result = fedic.correlate(reference, deformed, MESH)
    deformed[:] = reference
    with pytest.raises(fedic.ImageError, match="The deformed image of this result has changed since the measurement"):
        result.residual_map()


def test_a_result_made_by_hand_says_that_it_knows_no_images() -> None:
    result = replace(fedic.correlate(*pair(), MESH), _measurement=None)
    with pytest.raises(fedic.ImageError, match="This result does not know its images"):
        result.standard_deviations(1.0)


@pytest.mark.parametrize("noise", [-1.0, float("nan")])
def test_a_bad_noise_is_refused(noise: float) -> None:
    with pytest.raises(fedic.OptionError, match="noise must be zero or a positive standard deviation in grey levels"):
        fedic.correlate(*pair(), MESH).standard_deviations(noise)
