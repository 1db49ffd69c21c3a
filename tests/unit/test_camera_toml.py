"""What ``camera.toml`` holds beside the camera: any name and note can be read back."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fedic
from fedic.errors import FedicError
from fedic.io.toml import load_toml

CAMERA = fedic.FrontParallel(12.5, (3.0, 400.0), -0.7, (640, 480))
TEXT = st.text(st.characters(), max_size=30)
VALUE = st.one_of(TEXT, st.booleans(), st.integers(-(2**63), 2**63 - 1), st.floats(allow_nan=False))


def readable(text: str) -> str:
    """Return a text with what is no character replaced."""
    return "".join("\ufffd" if "\ud800" <= each <= "\udfff" else each for each in text)


@settings(max_examples=200, deadline=None)
@given(notes=st.dictionaries(TEXT, st.one_of(VALUE, st.lists(VALUE, max_size=3)), max_size=5))
def test_any_note_is_read_back(notes: dict[str, object], tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("notes") / "camera.toml"
    keys = [readable(key) for key in notes]
    if len(set(keys)) < len(keys):
        return
    fedic.write_camera(CAMERA, path, notes=notes)
    assert fedic.read_camera(path) == CAMERA
    found = load_toml(path).get("calibration", {})
    assert list(found) == keys
    for key, value in notes.items():
        expected = readable(value) if isinstance(value, str) else value
        if isinstance(value, list):
            expected = [readable(each) if isinstance(each, str) else each for each in value]
        assert found[readable(key)] == expected


@pytest.mark.parametrize(
    "name",
    ["im\n5.toml", 'a"b.toml', "a\tb.toml", "x\x7f[red].toml", "\u202eabc.toml", "caf\u00e9.toml", f"{'a.' * 60}toml"],
)
def test_any_name_of_the_file_is_harmless(name: str, tmp_path: Path) -> None:
    path = fedic.write_camera(CAMERA, tmp_path / name, notes={"pose_of": name, "good": True, "odd key": np.float64(2)})
    assert fedic.read_camera(path) == CAMERA
    assert load_toml(path)["calibration"] == {"pose_of": name, "good": True, "odd key": 2.0}


@pytest.mark.parametrize("value", [None, {"a": 1}, object(), [1, None]])
def test_other_notes_are_refused(value: object, tmp_path: Path) -> None:
    with pytest.raises(fedic.OptionError, match=r"notes: odd is a .*; give numbers and texts"):
        fedic.write_camera(CAMERA, tmp_path / "camera.toml", notes={"odd": value})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [FedicError, fedic.ConfigError, fedic.CameraError])
def test_the_error_of_a_toml_file_is_the_one_asked_for(error: type[FedicError], tmp_path: Path) -> None:
    for content, message in (("a = ", "not a valid TOML file"), ("a = 1" + "0" * 5000, "thousands of digits")):
        (tmp_path / "a.toml").write_text(content)
        with pytest.raises(error, match=message), warnings.catch_warnings():
            load_toml(tmp_path / "a.toml", error)
    with pytest.raises(error, match="there is no such TOML file"):
        load_toml(tmp_path / "b.toml", error)
