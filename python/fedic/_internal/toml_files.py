"""Reading of TOML files: every fault is a `ConfigError` that names the file, and the key where there is one."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fedic._internal.text_files import decoded_text
from fedic.errors import ConfigError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["read_tables"]

_MOST_BYTES = 2**24
_DEEPEST = 32
_DEEP_LINE = re.compile(rf"([\[{{]\s*){{{_DEEPEST}}}")
_LARGEST_INTEGER = 2**63 - 1
_LONG_NUMBER = re.compile(r"[0-9][0-9_]{4000,}")
_TABLE_LINE = re.compile(r"\s*\[\[?\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_KEY_LINE = re.compile(r"\s*([\w\"'. -]+?)\s*=")


def read_tables(path: Path, what: str) -> dict[str, Any]:
    """Read a TOML file, in UTF-8 or UTF-16.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        Kind of file in messages, such as ``"configuration"``.

    Returns
    -------
    dict
        Its tables; every integer in them has 64 bits.

    Raises
    ------
    ConfigError
        If the file is missing, is not TOML, is nested too deeply, or holds an integer of more than 64 bits.
    """
    text = _text(path, what)
    try:
        tables: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path}: not a valid TOML file: {error}.") from error
    except RecursionError:
        raise _nested_too_deeply(path, _key_at(text, _DEEP_LINE)) from None
    except ValueError as error:
        # Python refuses to convert integers of more than 4300 digits.
        key = _key_at(text, _LONG_NUMBER)
        raise ConfigError(f"{path}: {key or 'a key'} is a number with thousands of digits; shorten it.", key) from error
    for key, value, depth in _entries(tables):
        if depth > _DEEPEST:
            raise _nested_too_deeply(path, key)
        if isinstance(value, int) and not -_LARGEST_INTEGER - 1 <= value <= _LARGEST_INTEGER:
            raise ConfigError(
                f"{path}: {key} is an integer of more than 64 bits, which TOML does not allow; give a smaller number.",
                key,
            )
    return tables


def _text(path: Path, what: str) -> str:
    try:
        if not path.exists():
            raise ConfigError(f"{path}: there is no such {what} file; check the path.")
        if not path.is_file():
            raise ConfigError(f"{path}: not a regular file; give the name of a {what} file.")
        if path.stat().st_size > _MOST_BYTES:
            raise ConfigError(f"{path}: over {_MOST_BYTES >> 20} MB, too large for a {what} file; is it another file?")
        return decoded_text(path.read_bytes())
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: the {what} file is not UTF-8 text; save it as UTF-8.") from error
    except OSError as error:
        raise ConfigError(f"{path}: the {what} file cannot be read ({error.strerror}).") from error
    except ValueError as error:
        raise ConfigError(f"{path}: this cannot be the name of a file ({error}).") from error


def _nested_too_deeply(path: Path, key: str) -> ConfigError:
    return ConfigError(
        f"{path}: {key or 'a key'} holds tables or lists nested over {_DEEPEST} deep; no key needs more than three.",
        key,
    )


def _entries(tables: dict[str, Any]) -> Iterator[tuple[str, object, int]]:
    """Yield the dotted key, the value and the depth of every entry; entries deeper than the limit are not followed."""
    waiting: list[tuple[str, object, int]] = [(name, value, 1) for name, value in reversed(tables.items())]
    while waiting:
        key, value, depth = waiting.pop()
        yield key, value, depth
        if isinstance(value, dict):
            waiting += [(f"{key}.{name}", each, depth + 1) for name, each in reversed(value.items())]
        elif isinstance(value, list):
            waiting += [(f"{key}[{index}]", each, depth + 1) for index, each in reversed([*enumerate(value)])]


def _key_at(text: str, fault: re.Pattern[str]) -> str:
    """Return the dotted key of the first line in which a pattern is found; empty if it is not on a key's own line."""
    found = fault.search(text)
    table, key = "", ""
    for line in text[: found.end()].splitlines() if found else []:
        header, entry = _TABLE_LINE.match(line), _KEY_LINE.match(line)
        if entry is not None:
            key = entry[1]
        elif header is not None:
            table, key = header[1], ""
    return ".".join(part for part in (table, key) if part)
