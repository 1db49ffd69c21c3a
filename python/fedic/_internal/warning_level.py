"""Place in the caller's code that a warning names."""

import sys

__all__ = ["levels_within_fedic"]


def levels_within_fedic() -> int:
    """Return how many calls up, counted from the caller, the code that uses fedic is: the `stacklevel` of a warning."""
    levels, frame = 1, sys._getframe(1)
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).startswith("fedic."):
        levels, frame = levels + 1, frame.f_back
    return levels
