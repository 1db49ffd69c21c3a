"""Measure one pair with pyxel-dic, from zero: python pair_pyxel.py REF DEF X0 Y0 X1 Y1 SIZE OUT [full].

By default pyxel chooses the quadrature points, about one for two pixels here; with ``full`` there is one per pixel.
"""

import time

from measure import arguments, report, save_field

_QUAD = 3


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
    unknowns, residual = pyxel.Correlate(reference, deformed, mesh, camera, U0=np.zeros(mesh.ndof))

    x, y = mesh.n.T
    along_x, along_y = unknowns[mesh.conn].T
    points = np.column_stack(camera.P(x, y))
    save_field(given.out, points, np.column_stack(camera.P(x + along_x, y + along_y)) - points)
    times = {"seconds": time.perf_counter() - start, "import": imported - start}
    report(points=mesh.npg, dofs=mesh.ndof, residual_std=float(np.std(residual)), **times)


if __name__ == "__main__":
    main()
