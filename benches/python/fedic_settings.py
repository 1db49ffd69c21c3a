"""The settings of fedic that are measured, by the option that names them."""

from typing import Any

from measure import Arguments

_CUBIC = {"interpolation": "bspline3", "smoothing": 0.0}
"""The nearest to what the peers do."""


def settings(given: Arguments) -> dict[str, Any]:
    """Return the arguments of the correlator: its defaults, or with ``cubic`` cubic splines without smoothing."""
    chosen = _CUBIC if "cubic" in given.options else {}
    return {**chosen, "num_threads": given.threads}
