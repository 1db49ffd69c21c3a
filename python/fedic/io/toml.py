"""TOML files, with limits that hold for any input."""

import re
import sys
from pathlib import Path
from typing import Any

from fedic.errors import FedicError
from fedic.io.text import read_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["load_toml"]

_LARGEST_FILE = 2**20
_DEEPEST = 32
_LARGEST_INTEGER = 2**63
_STRING = re.compile(r"""\"(?:[^"\\\n]|\\.)*\"?|'[^'\n]*'?""")  # the end may be missing, so that the time is linear
_DEEP_KEY = re.compile(rf"""(?<![\w-])(?:[\w-]+|\"\")(?:[ \t]*\.[ \t]*(?:[\w-]+|\"\")){{{_DEEPEST}}}""")


def load_toml(path: Path, error: type[FedicError] = FedicError) -> dict[str, Any]:
    """Read a TOML file.

    Parameters
    ----------
    path : Path
        The file.
    error : type of FedicError
        What is raised.

    Returns
    -------
    dict
        Its content.

    Raises
    ------
    FedicError
        Of the type `error`, if the file cannot be read, is larger than 1 MB, is not TOML, is nested more than 32 deep,
        or holds an integer of more than 64 bits.
    """
    text = read_text(path, _LARGEST_FILE, error)
    if _has_deep_key(text):
        raise error(f"{path}: a dotted key has more than {_DEEPEST} parts.")
    try:
        content: dict[str, Any] = tomllib.loads(text)
    except RecursionError:
        raise error(f"{path}: arrays or tables are nested more than {_DEEPEST} deep.") from None
    except ValueError as fault:  # the error of tomllib is a ValueError, as is that of an integer of too many digits
        kind = "not a valid TOML file" if isinstance(fault, tomllib.TOMLDecodeError) else "a number cannot be read"
        raise error(f"{path}: {kind}: {str(fault).split(';')[0]}.") from None
    _check(path, content, error)
    return content


def _has_deep_key(text: str) -> bool:
    """Return true if a dotted key has many parts: the time to read it grows with their square."""
    return _DEEP_KEY.search(_STRING.sub('""', text)) is not None


def _check(path: Path, content: dict[str, Any], error: type[FedicError]) -> None:
    """Check depth and integers."""
    waiting: list[tuple[object, int, str]] = [(content, 0, "")]
    while waiting:
        value, depth, key = waiting.pop()
        if depth > _DEEPEST:
            raise error(f"{path}: {key.split('.')[0]} is nested more than {_DEEPEST} deep.")
        if isinstance(value, dict):
            waiting += [(each, depth + 1, f"{key}.{name}".lstrip(".")) for name, each in value.items()]
        elif isinstance(value, list):
            waiting += [(each, depth + 1, key) for each in value]
        elif isinstance(value, int) and not -_LARGEST_INTEGER <= value < _LARGEST_INTEGER:
            raise error(f"{path}: {key} holds an integer of more than 64 bits.")
