"""TOML files, with limits that hold for any input; every fault names the file, and the key where there is one."""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fedic.errors import ConfigError, FedicError
from fedic.io.text import read_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["load_toml", "parse_toml"]

_MOST_BYTES = 2**24
_DEEPEST = 32
_DEEP_LINE = re.compile(rf"([\[{{]\s*){{{_DEEPEST}}}")
_LARGEST_INTEGER = 2**63 - 1
_LONG_NUMBER = re.compile(r"[0-9][0-9_]{4000,}")
_TABLE_LINE = re.compile(r"\s*\[\[?\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_STRING = re.compile(r"""\"(?:[^"\\\n]|\\.)*\"?|'[^'\n]*'?""")  # the end may be missing, so that the time is linear
_DEEP_KEY = re.compile(rf"""(?<![\w-])(?:[\w-]+|\"\")(?:[ \t]*\.[ \t]*(?:[\w-]+|\"\")){{{_DEEPEST}}}""")
_KEY_LINE = re.compile(r"\s*([\w\"'. -]+?)\s*=")


def parse_toml(text: str) -> dict[str, Any]:
    """Return the tables of a text that was written by this package."""
    tables: dict[str, Any] = tomllib.loads(text)
    return tables


def load_toml(path: Path, error: type[FedicError] = FedicError, what: str = "TOML") -> dict[str, Any]:
    """Read a TOML file, in UTF-8 or UTF-16.

    Parameters
    ----------
    path : Path
        The file.
    error : type of FedicError
        What is raised; a `ConfigError` gets the key at fault.
    what : str
        Kind of file in messages, such as ``"configuration"``.

    Returns
    -------
    dict
        Its tables; every integer in them has 64 bits.

    Raises
    ------
    FedicError
        Of the type `error`, if the file cannot be read, is larger than 16 MB, is not TOML, is nested more than 32 deep,
        or holds an integer of more than 64 bits.
    """
    text = read_text(path, _MOST_BYTES, error, f"{what} file")
    try:
        # The time to read a dotted key grows with the square of its parts.
        if _DEEP_KEY.search(_STRING.sub('""', text)):
            raise RecursionError
        tables: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        raise error(f"{path}: not a valid TOML file: {fault}.") from fault
    except RecursionError:
        raise _nested_too_deeply(path, _key_at(text, _DEEP_LINE), error) from None
    except ValueError as fault:
        # Python refuses to convert integers of more than 4300 digits.
        key = _key_at(text, _LONG_NUMBER)
        message = f"{path}: {key or 'a key'} is a number with thousands of digits; shorten it."
        raise _with_key(error, message, key) from fault
    for key, value, depth in _entries(tables):
        if depth > _DEEPEST:
            raise _nested_too_deeply(path, key, error)
        if isinstance(value, int) and not -_LARGEST_INTEGER - 1 <= value <= _LARGEST_INTEGER:
            message = f"{path}: {key} is an integer of more than 64 bits, which TOML does not have; shorten it."
            raise _with_key(error, message, key)
    return tables


def _with_key(error: type[FedicError], message: str, key: str) -> FedicError:
    return error(message, key) if issubclass(error, ConfigError) else error(message)


def _nested_too_deeply(path: Path, key: str, error: type[FedicError]) -> FedicError:
    message = f"{path}: {key or 'a key'} holds tables or lists nested over {_DEEPEST} deep; none needs more than three."
    return _with_key(error, message, key)


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
