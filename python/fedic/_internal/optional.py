"""Packages that are not needed by every measurement."""

from importlib import import_module
from typing import Any

from fedic.errors import FedicError

__all__ = ["optional_module"]


def optional_module(name: str, extra: str, purpose: str) -> Any:
    """Import a module of an optional package.

    Parameters
    ----------
    name : str
        Name of the module.
    extra : str
        Extra of fedic that installs it.
    purpose : str
        What it is needed for.

    Returns
    -------
    module
        The module.

    Raises
    ------
    FedicError
        If it is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        raise FedicError(
            f"{package} is needed for {purpose} and is not installed: pip install 'fedic[{extra}]'."
        ) from error
