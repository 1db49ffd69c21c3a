"""Table of the image files that are read."""

from pathlib import Path

import numpy as np

import fedic
from scenes.images.catalogue import variants
from scenes.images.variant import Variant
from scenes.refusal import refusal

TITLE = "Images"
COLUMNS = ("format", "variant", "outcome", "by")


def rows(folder: Path) -> list[tuple[str, ...]]:
    """Write each file, read it and compare the grey levels with those written.

    Parameters
    ----------
    folder : Path
        Where the files are written.

    Returns
    -------
    list of tuple of str
        Format, variant, outcome and library.

    Raises
    ------
    AssertionError
        If a file gives other grey levels, or another reason, than it should.
    """
    return [
        (variant.format, variant.name, _outcome(variant, folder / f"{index}{variant.suffix}"), variant.library)
        for index, variant in enumerate(variants())
    ]


def _outcome(variant: Variant, path: Path) -> str:
    variant.write(path)
    name = f"{path}{variant.page}"
    if variant.truth is None:
        assert variant.refusal in (reason := refusal(fedic.read_image, name)), f"{variant}: {reason}"
        return f"refused: {variant.refusal}"
    image = fedic.read_image(name)
    np.testing.assert_allclose(image, variant.truth, rtol=0, atol=variant.tolerance, err_msg=str(variant))
    return f"read as {image.dtype}" + (f", to {variant.tolerance:g} levels" if variant.tolerance else "")
