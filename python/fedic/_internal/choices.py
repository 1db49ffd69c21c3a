"""Arguments that take one of a few names."""

from collections.abc import Iterable

from fedic.errors import OptionError

__all__ = ["check_choice"]


def check_choice(name: str, value: object, choices: Iterable[str]) -> None:
    """Check that an argument is one of a few names.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        The argument.
    choices : iterable of str
        The names that it takes.

    Raises
    ------
    OptionError
        If it is none of them.
    """
    known = list(choices)
    if value not in known:
        listed = ", ".join(f'"{choice}"' for choice in known)
        raise OptionError(f"{name} must be one of {listed}, got {value!r}", name)
