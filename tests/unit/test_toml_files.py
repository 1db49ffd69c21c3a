"""TOML files as editors write them, and files that no reader should follow to the end."""

import codecs
from pathlib import Path

import pytest

import fedic
from fedic.io.toml import load_toml

TEXT = '# Größe\n[mesh.rectangle]\nsize = 20\n[output]\nfolder = "résultats"\n'
TABLES = {"mesh": {"rectangle": {"size": 20}}, "output": {"folder": "résultats"}}


@pytest.mark.parametrize(
    ("mark", "encoding"),
    [
        (b"", "utf-8"),
        (codecs.BOM_UTF8, "utf-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le"),
        (codecs.BOM_UTF16_BE, "utf-16-be"),
        (codecs.BOM_UTF32_LE, "utf-32-le"),
        (codecs.BOM_UTF32_BE, "utf-32-be"),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_byte_order_marks_and_line_ends_are_read(tmp_path: Path, mark: bytes, encoding: str, newline: str) -> None:
    path = tmp_path / "run.toml"
    path.write_bytes(mark + TEXT.replace("\n", newline).encode(encoding))
    assert load_toml(path, fedic.ConfigError, "configuration") == TABLES


@pytest.mark.parametrize(
    ("text", "key", "message"),
    [
        ("[mesh.rectangle]\nbounds = [1, 2]\nsize = 2" + 4300 * "0", "mesh.rectangle.size", "thousands of digits"),
        ("[mesh.rectangle]\nsize = 2" + 4300 * "_0", "mesh.rectangle.size", "thousands of digits"),
        ("[correlation]\nmax_iterations = 18446744073709551616", "correlation.max_iterations", "64 bits"),
        ("[camera]\nrotation = [0, 0, -1" + 310 * "0" + "]", "camera.rotation[2]", "64 bits"),
        ("[camera]\nfocal = " + 2000 * "[" + 2000 * "]", "camera.focal", "nested over 32"),
        ("[camera]\nfocal = " + 100 * "[" + 100 * "]", "camera.focal" + 31 * "[0]", "nested over 32"),
        ("a = " + 60 * "{b = " + "1" + 60 * "}", ".".join("a" + 32 * "b"), "nested over 32"),
        ("a" + 500 * ".b" + " = 1", "", "nested over 32"),
        ("[images]\nreference = = 3", "", "line 2"),
        ("[images]\nreference = 'a'\nreference = 'b'\n", "", "overwrite"),
    ],
)
def test_faults_name_the_key_or_the_line(tmp_path: Path, text: str, key: str, message: str) -> None:
    path = tmp_path / "run.toml"
    path.write_text(text)
    with pytest.raises(fedic.ConfigError, match=message) as caught:
        load_toml(path, fedic.ConfigError, "configuration")
    assert caught.value.key == key
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 1000 + len(str(path))


def test_what_is_not_a_text_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fedic.ConfigError, match="this is a folder"):
        load_toml(tmp_path, fedic.ConfigError, "configuration")
    with pytest.raises(fedic.ConfigError, match="there is no such camera file"):
        load_toml(tmp_path / "nothing.toml", fedic.ConfigError, "camera")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(fedic.ConfigError, match="it holds zero bytes"):
        load_toml(binary, fedic.ConfigError, "configuration")
    large = tmp_path / "large.toml"
    with large.open("wb") as file:
        file.truncate(2**25)
    with pytest.raises(fedic.ConfigError, match="has at most"):
        load_toml(large, fedic.ConfigError, "configuration")
    with pytest.raises(fedic.ConfigError, match=r"cannot be read .*too long"):
        load_toml(tmp_path / ("a" * 300), fedic.ConfigError, "configuration")
    with pytest.raises(fedic.ConfigError, match=r"cannot be read .*null"):
        load_toml(Path(f"{tmp_path}/a\0b"), fedic.ConfigError, "configuration")
