"""Initial displacements: names of starts, arrays, or earlier results."""

from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from fedic._core import Mesh
from fedic._internal.types import Floats
from fedic.errors import OptionError
from fedic.results import Result

__all__ = ["Initial", "Start", "checked_initial"]

Start: TypeAlias = Literal["auto", "zero", "pyramid", "fft", "features", "log-polar", "flow"]
Initial: TypeAlias = Start | ArrayLike | Result


def checked_initial(initial: Initial, mesh: Mesh) -> Start | Floats:
    """Check an initial displacement.

    Parameters
    ----------
    initial : str, Result or array_like of shape (n, 2)
        As given to `fedic.correlate`.
    mesh : Mesh
        The mesh.

    Returns
    -------
    str or ndarray of float64, shape (n, 2)
        The name of a start, or finite displacements; zero at nodes of no cell.

    Raises
    ------
    OptionError
        If the name is unknown, or the displacements do not fit the mesh.
    """
    names = get_args(Start)
    if isinstance(initial, Result):
        if initial.mesh.num_nodes != mesh.num_nodes:
            raise OptionError(
                f"initial is a result on a mesh of {initial.mesh.num_nodes} nodes; this one has {mesh.num_nodes}",
                "initial",
            )
        return np.nan_to_num(initial.unchecked_displacement)
    if isinstance(initial, str) and initial == "previous":
        raise OptionError(
            "a correlator remembers no earlier frame: give its result as initial, or measure with fedic.Campaign",
            "initial",
        )
    if isinstance(initial, str) and initial in names:
        return initial  # type: ignore[return-value]
    if isinstance(initial, str) or initial is None:
        choices = ", ".join(f'"{name}"' for name in names)
        raise OptionError(
            f"initial must be {choices}, an array of nodal displacements or a result, got {initial!r}", "initial"
        )
    try:
        start = np.array(initial, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise OptionError(f"initial is not an array of numbers ({error}).", "initial") from error
    if start.shape != (mesh.num_nodes, 2):
        raise OptionError(
            f"initial has shape {start.shape}; give one displacement per node, shape ({mesh.num_nodes}, 2).", "initial"
        )
    used = mesh.used_nodes
    start[~used] = 0.0
    bad = np.flatnonzero(~np.isfinite(start).all(axis=1))
    if bad.size:
        raise OptionError(f"initial is not finite at {bad.size} nodes, the first being node {bad[0]}.", "initial")
    return start
