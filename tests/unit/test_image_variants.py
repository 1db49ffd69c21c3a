"""Image files of many kinds are read exactly or refused by name."""

import re
from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.images.catalogue import variants
from scenes.images.variant import Variant

VARIANTS = list(variants())


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: f"{variant.format}, {variant.name}")
def test_an_image_file_is_read_exactly_or_refused_by_name(
    tmp_path: Path, variant: Variant, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"image{variant.suffix}"
    variant.write(path)
    name = f"{path}{variant.page}"
    if variant.truth is None:
        with pytest.raises(fedic.ImageError, match=re.escape(variant.refusal)) as caught:
            fedic.read_image(name)
        assert str(caught.value).startswith(f"{name}: ")
        assert "damaged" not in str(caught.value)
    else:
        read = fedic.read_image(name)
        assert read.dtype.type in (np.uint8, np.uint16, np.float32)
        assert read.flags.c_contiguous
        assert read.dtype.isnative
        if variant.tolerance == 0.0:
            assert read.dtype == variant.truth.dtype
        np.testing.assert_allclose(read, variant.truth, rtol=0, atol=variant.tolerance)
        monkeypatch.setattr("fedic.io.images.tiff.reader._MAPPED_BYTES", 1)
        mapped = fedic.read_image(name, mapped=True)
        assert not mapped.flags.writeable
        np.testing.assert_array_equal(mapped, read)
    assert capfd.readouterr() == ("", "")
