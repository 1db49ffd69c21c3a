"""Order of the images of a run, and names of their results."""

import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fedic.campaign.frames.image_list import expand_names, natural_order
from fedic.campaign.outputs import Outputs, result_names


def test_numbers_in_names_are_counted() -> None:
    names = ["run10/f1.tif", "run2/f_10.tif", "run2/f_9b.tif", "run2/f_2.tif", "run2/f.tif", "run2/f_02.tif"]
    ordered = ["run2/f.tif", "run2/f_02.tif", "run2/f_2.tif", "run2/f_9b.tif", "run2/f_10.tif", "run10/f1.tif"]
    assert sorted(names, key=natural_order) == ordered


@given(st.lists(st.integers(0, 10**9), min_size=1, unique=True))
def test_frames_are_ordered_by_their_numbers(numbers: list[int]) -> None:
    names = [f"images/frame_{number}.tif" for number in numbers]
    ordered = [f"images/frame_{number}.tif" for number in sorted(numbers)]
    assert sorted(names, key=natural_order) == ordered


@given(st.lists(st.text(st.sampled_from("0123456789aB._/é²٣ "), min_size=1), max_size=8))
def test_any_names_can_be_ordered(names: list[str]) -> None:
    backwards = names[::-1]
    assert sorted(backwards, key=natural_order) == sorted(names, key=natural_order)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("ref", "f_1", "f_2", "f_10", "g[1]"):
        (tmp_path / f"{name}.tif").touch()
    (tmp_path / "again.tif").symlink_to(tmp_path / "ref.tif")
    return tmp_path


def test_patterns_leave_out_the_reference_and_files_named_already(folder: Path) -> None:
    files, left_out = expand_names(["f_10.tif", "*.tif"], folder, folder / "ref.tif")
    assert files == ["f_10.tif", "f_1.tif", "f_2.tif", "g[1].tif"]
    assert left_out == ["again.tif", "ref.tif"]


def test_the_reference_is_measured_if_it_is_named(folder: Path) -> None:
    assert expand_names(["ref.tif", "f_*.tif"], folder, folder / "ref.tif")[0][0] == "ref.tif"


def test_a_file_with_brackets_is_not_a_pattern(folder: Path) -> None:
    assert expand_names(["g[1].tif"], folder, folder / "ref.tif") == (["g[1].tif"], [])


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["x*.tif"], "should match a file"),
        (["re?.tif"], "another file than the reference"),
        (["f_1.tif", "./f_1.tif"], "name each file once"),
    ],
)
def test_lists_without_a_meaning_are_refused(folder: Path, names: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        expand_names(names, folder, folder / "ref.tif")


@pytest.mark.parametrize(
    ("images", "names"),
    [
        (["a/x.png", "a/y.png"], ["x", "y"]),
        (["a/x.png", "a/x.tif", "a/y.png"], ["x_png", "x_tif", "y"]),
        (["left/x.png", "right/x.png", "right/y.png"], ["left_x", "right_x", "y"]),
        (["left/a/x.png", "right/a/x.png"], ["left_a_x", "right_a_x"]),
        (["a/x.png", "a/X.png"], ["x_1", "X_2"]),
        (["a/x.png", "a/X.png", "a/x_1.png"], ["x_2", "X_3", "x_1"]),
        (["a/\u00e9.png", "a/e\u0301.png"], ["\u00e9_1", "e\u0301_2"]),
    ],
)
def test_names_tell_images_apart(images: list[str], names: list[str]) -> None:
    assert result_names([Path(image) for image in images]) == names


@given(
    st.lists(
        st.builds(
            "{}/{}{}".format,
            st.sampled_from(["a", "A", "a/b", "/r", ".."]),
            st.sampled_from(["x", "X", "x_1", "x_png", "a_x", "mesh", "x_residual", "summary"]),
            st.sampled_from([".png", ".PNG", ".tif", ""]),
        ),
        max_size=12,
        unique=True,
    )
)
def test_no_two_files_of_a_run_are_alike(images: list[str]) -> None:
    outputs = Outputs(Path("out"), result_names([Path(image) for image in images]), (".vtu", ".npz"), True, [])
    files = ["summary.json", *(unicodedata.normalize("NFC", file.name.casefold()) for file in outputs.all())]
    assert len(set(files)) == len(files)
    assert all("/" not in name for name in outputs.names)
