"""Images without texture, and images of few or of large grey levels."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fedic

MESH = fedic.rectangle_mesh((30, 30, 170, 130), 20)


@pytest.mark.parametrize("scale", [1e-20, 1e-6, 1e-3, 1.0, 1e6, 1e15])
def test_the_range_of_the_grey_levels_does_not_matter(
    speckle_pair: tuple[np.ndarray, np.ndarray], scale: float
) -> None:
    images = [(image * scale).astype(np.float32) for image in speckle_pair]
    expected = fedic.correlate(*speckle_pair, MESH)
    found = fedic.correlate(*images, MESH)
    assert_allclose(found.displacement, expected.displacement, atol=2e-5)
    assert_allclose(found.residual_rms, scale * expected.residual_rms, rtol=1e-3)
    assert found.quality.is_good == expected.quality.is_good


@pytest.mark.parametrize(
    "level", [np.uint8(0), np.uint8(200), np.uint16(40_000), np.float32(1e-3), np.float32(65_535.3), np.float32(1e12)]
)
def test_a_constant_image_is_refused(speckle_pair: tuple[np.ndarray, np.ndarray], level: np.generic) -> None:
    textured = speckle_pair[0].astype(level.dtype)
    constant = np.full_like(textured, level)
    with pytest.raises(fedic.ImageError, match="the reference image is flat where the mesh lies"):
        fedic.correlate(constant, textured, MESH)
    with pytest.raises(fedic.ImageError, match="the deformed image is flat where the mesh lies"):
        fedic.correlate(textured, constant, MESH)


@pytest.mark.parametrize("level", [np.uint8(255), np.uint16(65_535)])
def test_a_saturated_image_is_refused(level: np.generic) -> None:
    saturated = np.full((160, 200), level)
    with pytest.raises(fedic.ImageError, match="not saturated; reduce the exposure"):
        fedic.correlate(saturated, saturated, MESH)
