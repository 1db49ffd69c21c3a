"""Measure one pair with pyxel-dic, from zero: python pair_pyxel.py REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT [full].

By default pyxel chooses the quadrature points, about one for two pixels here; with ``full`` there is one per pixel.
It has no option for threads: only the libraries below it heed THREADS, through the environment.
"""

import contextlib
import io
import sys
import time

from measure import arguments, report, save_field

_QUAD = 3


class Stamped(io.TextIOBase):
    """The standard output, with the time of every line that announces an iteration."""

    def __init__(self) -> None:
        self.iterations: list[float] = []

    def write(self, text: str) -> int:
        """Pass `text` on."""
        if text.startswith("Iter #"):
            self.iterations.append(time.perf_counter())
        assert sys.__stdout__ is not None
        return sys.__stdout__.write(text)


def main() -> None:
    """Measure on quads and leave the nodal displacement in the image."""
    given = arguments()
    start = time.perf_counter()
    import matplotlib as mpl
    import numpy as np

    mpl.use("Agg")
    import pyxel  # type: ignore[import-not-found]

    imported = time.perf_counter()
    reference, deformed = (pyxel.Image(str(path)).Load() for path in (given.reference, given.deformed))
    x0, y0, x1, y1 = given.bounds
    mesh, camera = pyxel.MeshFromROI(np.array([[x0, y0], [x1, y1]]), given.size, typel=_QUAD)
    mesh.Connectivity()
    if "full" in given.options:
        mesh.DICIntegration(camera)
    output = Stamped()
    with contextlib.redirect_stdout(output):
        unknowns, residual = pyxel.Correlate(reference, deformed, mesh, camera, U0=np.zeros(mesh.ndof))
    stamps = output.iterations

    x, y = mesh.n.T
    along_x, along_y = unknowns[mesh.conn].T
    points = np.column_stack(camera.P(x, y))
    save_field(given.out, points, np.column_stack(camera.P(x + along_x, y + along_y)) - points)
    report(
        points=mesh.npg,
        unknowns=mesh.ndof,
        iterations=len(stamps),
        iteration=(stamps[-1] - stamps[0]) / (len(stamps) - 1) if len(stamps) > 1 else float("nan"),
        residual_rms=float(np.std(residual)),
        seconds=time.perf_counter() - start,
        **{"import": imported - start},
    )


if __name__ == "__main__":
    main()
