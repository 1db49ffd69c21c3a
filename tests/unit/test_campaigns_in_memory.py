"""Campaigns without a file."""

import numpy as np
from numpy.typing import NDArray

import fedic


def test_several_exist_at_once(speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> None:
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    reference, deformed = speckle_pair
    one, other = (fedic.Campaign(reference, [image], mesh).run(progress=False) for image in (deformed, reference))
    assert abs(float(one[0].displacement[:, 0].mean()) - 1.3) < 0.01
    assert abs(float(other[0].displacement[:, 0].mean())) < 0.01
