"""Why a file is refused."""

from collections.abc import Callable

import fedic

__all__ = ["refusal"]


def refusal(read: Callable[[str], object], name: str) -> str:
    """Return the message of a file that is refused, or ``"it was read"``."""
    try:
        read(name)
    except (fedic.ImageError, fedic.MeshError) as error:
        return str(error)
    return "it was read"
