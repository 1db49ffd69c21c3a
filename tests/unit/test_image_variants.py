"""Image files of many kinds are read exactly or refused by name."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fedic
from scenes.images import tiff_writer
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


@settings(max_examples=200, deadline=5000, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 2**32 - 1),
    height=st.integers(1, 40),
    width=st.integers(1, 40),
    bits=st.integers(1, 16),
    compression=st.sampled_from(["none", "LZW", "deflate", "PackBits", "ZSTD", "LZMA"]),
    predictor=st.sampled_from([1, 2]),
    tile=st.sampled_from([0, 16, 32]),
    rows=st.integers(1, 40),
    order=st.sampled_from("<>"),
    big=st.booleans(),
    white_is_zero=st.booleans(),
)
def test_the_levels_of_a_tiff_do_not_depend_on_how_it_is_stored(
    tmp_path: Path,
    seed: int,
    height: int,
    width: int,
    bits: int,
    predictor: int,
    order: str,
    big: bool,
    white_is_zero: bool,
    **layout: Any,
) -> None:
    levels = np.random.default_rng(seed).integers(0, 2**bits, (height, width), np.uint8 if bits <= 8 else np.uint16)
    stored = levels.dtype.type(2**bits - 1) - levels if white_is_zero else levels
    if bits not in (8, 16):
        predictor = 1
    if predictor == 2 and layout["compression"] in ("none", "PackBits"):
        predictor = 1
    page = tiff_writer.page(
        stored, bits=bits, predictor=predictor, order=order, photometric=0 if white_is_zero else 1, **layout
    )
    (tmp_path / "image.tif").write_bytes(tiff_writer.write([page], order=order, big=big))
    read = fedic.read_image(tmp_path / "image.tif")
    assert read.dtype == levels.dtype
    np.testing.assert_array_equal(read, levels)
