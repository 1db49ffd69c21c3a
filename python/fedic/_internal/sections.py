"""Sections of TOML files as pydantic models, and error messages that name the key at fault."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails

from fedic.errors import ConfigError

__all__ = [
    "InFolder",
    "Positive",
    "Real",
    "Schema",
    "Section",
    "config_error",
    "in_folder",
]


class Section(BaseModel):
    """A table of a TOML file: immutable, unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def in_folder(path: Path, info: ValidationInfo) -> Path:
    """Return a path relative to the folder of the file that is read."""
    return Path((info.context or {}).get("folder", "."), path)


def _possible(path: Path) -> Path:
    """Check that the file system can look up a path."""
    if "\0" in str(path):
        raise ValueError("should be a name without the character NUL")
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:
        raise ValueError(f"should be a path that can be looked up ({error.strerror})") from None
    return path


Real: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive: TypeAlias = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0)]
InFolder: TypeAlias = Annotated[Path, AfterValidator(in_folder), AfterValidator(_possible)]


@dataclass(frozen=True)
class Schema:
    """The sections of a file, for error messages.

    Attributes
    ----------
    sections : mapping of str to type
        The model of each section by its dotted name; a section that is one of several models has the tag of the model
        as last part of its name, such as ``"camera.pinhole"``; of a list of sections all have one name.
    choices : mapping of str to tuple of str
        For each section that is one of several models, the values of its key ``model``.
    """

    sections: Mapping[str, type[Section]]
    choices: Mapping[str, tuple[str, ...]]


def config_error(path: Path, error: ValidationError, schema: Schema, *, within: str = "") -> ConfigError:
    """Convert the error of a validation.

    Parameters
    ----------
    path : Path
        The file.
    error : ValidationError
        The error.
    schema : Schema
        The sections of the file.
    within : str
        Prefix of the dotted names that the message leaves out.

    Returns
    -------
    ConfigError
        One line per key at fault, misspelt keys first, since they cause others to be missing.
    """
    details = error.errors(include_url=False)
    details.sort(key=lambda detail: detail["type"] != "extra_forbidden")
    faults = [_fault(detail, schema) for detail in details]
    faults = [(key.removeprefix(within), message) for key, message in faults]
    return ConfigError(f"{path}: " + "\n".join(f"{key} {message}" for key, message in faults), faults[0][0])


def _fault(details: ErrorDetails, schema: Schema) -> tuple[str, str]:
    """Return the dotted key at fault and the message about it."""
    location = details["loc"]
    key = _dotted(location, schema)
    kind = details["type"]
    if kind == "extra_forbidden":
        return key, f"is not a known key; {_suggestion(location, schema)}"
    if kind == "missing":
        return key, "is missing."
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        choices = ", ".join(schema.choices[_name(location)])
        if kind == "union_tag_not_found":
            return f"{key}.model", f"is missing; choose one of {choices}."
        return f"{key}.model", f"= {details['input']['model']!r} is unknown; choose one of {choices}."
    if kind == "path_type":
        return key, f"= {_short(details['input'])} should be the name of a file or folder."
    expected = details["msg"].removeprefix("Value error, ").removeprefix("Input ")
    if isinstance(details["input"], dict):
        return key, f"{expected}."
    return key, f"= {_short(details['input'])} {expected}."


def _name(location: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in location)


def _dotted(location: tuple[int | str, ...], schema: Schema) -> str:
    """Return a location as the file has it: without the tags pydantic inserts, indices in brackets."""
    parts = [part for index, part in enumerate(location) if _name(location[:index]) not in schema.choices]
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in parts).removeprefix(".")


def _suggestion(location: tuple[int | str, ...], schema: Schema) -> str:
    section = _name(tuple(part for part in location[:-1] if isinstance(part, str)))
    known = list(schema.sections[section].model_fields)
    nearest = difflib.get_close_matches(str(location[-1]), known, n=1)
    return f'did you mean "{nearest[0]}"?' if nearest else f"the keys here are {', '.join(known)}."


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
