"""Arrays given as images."""

import numpy as np
import pytest

import fedic
from fedic.io.images import as_image

GREY = np.random.default_rng(0).integers(0, 256, (40, 50), dtype=np.uint8)


def test_the_mask_of_an_array_is_not_ignored() -> None:
    masked = np.ma.array(GREY, mask=GREY > 250)
    mesh = fedic.rectangle_mesh((5, 5, 45, 35), 10)
    for images in ((masked, GREY), (GREY, masked)):
        with pytest.raises(fedic.ImageError, match=r"is a masked array.*option mask of fedic\.correlate"):
            fedic.correlate(*images, mesh)


def test_an_array_that_could_have_a_mask_and_has_none_is_an_image() -> None:
    checked = as_image(np.ma.array(GREY), "reference")
    assert type(checked) is np.ndarray
    np.testing.assert_array_equal(checked, GREY)
