"""Pages of an image file, named by their number: ``stack.tif#3``."""

from pathlib import Path

import numpy as np
import pytest
import tifffile

import fedic
from fedic.campaign import load_config, measure_series
from fedic.cli.common import check_picture
from fedic.errors import ConfigError
from fedic.io.image_origins import file_of
from fedic.io.images import image_stem, split_page
from fedic.io.kept import KeptImage

RNG = np.random.default_rng(0)
STACK = RNG.integers(0, 256, (5, 40, 50), dtype=np.uint8)

CONFIG = """
[images]
reference = "stack.tif#0"
deformed = {deformed}
[mesh.rectangle]
bounds = [5, 5, 45, 35]
size = 10
[output]
folder = "out"
"""


@pytest.fixture
def stack(tmp_path: Path) -> Path:
    tifffile.imwrite(tmp_path / "stack.tif", STACK, photometric="minisblack", compression="lzw")
    return tmp_path / "stack.tif"


def test_each_page_is_read_by_its_number(stack: Path) -> None:
    for number, page in enumerate(STACK):
        np.testing.assert_array_equal(fedic.read_image(f"{stack}#{number}"), page)
    with pytest.raises(fedic.ImageError, match=r"holds 5 pages; .* stack\.tif#0 to stack\.tif#4"):
        fedic.read_image(stack)
    with pytest.raises(fedic.ImageError, match="page 5 does not exist: the file holds 5"):
        fedic.read_image(f"{stack}#5")
    with pytest.raises(fedic.ImageError, match=r"other\.tif: there is no such image file"):
        fedic.read_image(stack.with_name("other.tif#1"))


def test_a_file_that_really_has_such_a_name_is_read_as_it_is(stack: Path) -> None:
    tifffile.imwrite(stack.with_name("stack.tif#1"), STACK[3])
    np.testing.assert_array_equal(fedic.read_image(f"{stack}#1"), STACK[3])
    assert split_page(f"{stack}#1") == (stack.with_name("stack.tif#1"), None)
    assert split_page(f"{stack}#2") == (stack, 2)


@pytest.mark.parametrize("truncate", [False, True])
def test_a_page_of_a_large_stack_is_mapped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, truncate: bool) -> None:
    monkeypatch.setattr("fedic.io.images.tiff.reader._MAPPED_BYTES", 1)
    tifffile.imwrite(tmp_path / "stack.tif", STACK, photometric="minisblack", truncate=truncate)
    page = fedic.read_image(f"{tmp_path / 'stack.tif'}#3", mapped=True)
    assert isinstance(page.base, np.memmap)
    assert not page.flags.writeable
    np.testing.assert_array_equal(page, STACK[3])


def test_a_page_that_a_result_needs_again_is_found(stack: Path) -> None:
    image = fedic.read_image(f"{stack}#2")
    kept = KeptImage.of(image, "reference", file_of(image))
    assert kept.array is None
    np.testing.assert_array_equal(kept.read(), STACK[2])


def test_pages_are_named_in_a_configuration(stack: Path) -> None:
    for name in ("a.tif", "b.tif"):
        tifffile.imwrite(stack.with_name(name), STACK[:2], photometric="minisblack")
    tifffile.imwrite(stack.with_name("c#1.tif"), STACK[2])
    path = stack.with_name("test.toml")

    def deformed(value: str) -> list[str]:
        path.write_text(CONFIG.format(deformed=value))
        images = load_config(path).images
        assert images.reference == stack.with_name("stack.tif#0")
        return [image.name for image in images.deformed]

    assert deformed('"stack.tif#1"') == ["stack.tif#1"]
    assert deformed('["stack.tif#1", "stack.tif#4", "c#1.tif"]') == ["stack.tif#1", "stack.tif#4", "c#1.tif"]
    assert deformed('"[ab].tif#1"') == ["a.tif#1", "b.tif#1"]
    assert deformed('"c*.tif"') == ["c#1.tif"]
    with pytest.raises(fedic.ImageError, match=r"names .*other\.tif, which does not exist"):
        deformed('"other.tif#1"')
    with pytest.raises(ConfigError, match=r"should name each file once: the results of 'stack\.tif#1'"):
        deformed('["stack.tif#1", "stack.tif#1"]')


def test_results_of_pages_have_names_of_their_own() -> None:
    assert image_stem("folder/stack.tif#3") == "stack-3"
    assert image_stem("folder/frame.tif") == "frame"


def test_a_page_has_its_own_results(tmp_path: Path) -> None:
    texture, frame = fedic.synthetic.Speckle(5.0, seed=1), fedic.ImageFrame()
    images = [fedic.synthetic.render(texture, frame, (60, 80), displacement=(u, 0.0)) for u in (0.0, 0.3, 0.6)]
    tifffile.imwrite(tmp_path / "stack.tif", np.stack(images), photometric="minisblack")
    (tmp_path / "test.toml").write_text(
        CONFIG.format(deformed='["stack.tif#1", "stack.tif#2"]').replace("45, 35", "65, 45")
        + 'pictures = false\nfiles = ["vtu", "npz"]\n'
    )
    frames = list(measure_series(load_config(tmp_path / "test.toml")))
    assert [frame.error for frame in frames] == [None, None]
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"stack-1.vtu", "stack-1.npz", "stack-2.vtu"}


def test_a_picture_does_not_replace_the_file_of_a_page(stack: Path) -> None:
    image = stack.rename(stack.with_name("image.png"))
    with pytest.raises(fedic.FedicError, match="the picture would replace an input image"):
        check_picture(image, [image.with_name("image.png#1")], overwrite=True)


def test_an_image_of_a_configuration_is_a_regular_file(stack: Path) -> None:
    stack.with_name("frames").mkdir()
    path = stack.with_name("test.toml")
    path.write_text(CONFIG.format(deformed='"frames"'))
    with pytest.raises(fedic.ImageError, match=r"images\.deformed names .*frames, which is not a regular file"):
        load_config(path)
