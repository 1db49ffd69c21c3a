#!/usr/bin/env bash
# VTK 9.7.2: vtkIntegrateAttributes integrates fields on quadratic cells as linear between the nodes
#
# Behaviour: a cell of second order carries a quadratic field, which interpolation and gradient in VTK use exactly. Integrate Variables
#   cuts the cell into triangles between its nodes and integrates a linear field on each: x^2 over a square of four quadratic cells a
#   side is 0.40 % too large, as on linear cells of half their size. The area of straight cells is exact, so nothing shows it.
# Expected: the integral of the interpolated field, exact for quadratic fields on straight quadratic cells.
# Output seen (vtk 9.7.2, NumPy 2.4): quadratic cells 1.0040 times the integral, linear cells 1.0161 times, both with the exact area
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check vtk==9.7.2 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'PYTHON'
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

START, STOP, CELLS = 24.0, 120.0, 4


def integrals(order: int) -> tuple[float, float]:
    """Return the area and the integral of x^2 over a square of cells of a given order, relative to the exact ones."""
    line = np.linspace(START, STOP, order * CELLS + 1)
    x, y = (values.ravel() for values in np.meshgrid(line, line))
    number = np.arange(len(x)).reshape(len(line), len(line))
    grid, points = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    for position in zip(x, y):
        points.InsertNextPoint(*position, 0.0)
    grid.SetPoints(points)
    corners = [(0, 0), (0, 2), (2, 2), (2, 0)]
    middles = [(0, 1), (1, 2), (2, 1), (1, 0), (1, 1)]
    places = [*corners, *middles] if order == 2 else [(r // 2, c // 2) for r, c in corners]
    kind = vtk.VTK_BIQUADRATIC_QUAD if order == 2 else vtk.VTK_QUAD
    for row in range(0, order * CELLS, order):
        for column in range(0, order * CELLS, order):
            nodes = [int(number[row + r, column + c]) for r, c in places]
            grid.InsertNextCell(kind, len(nodes), nodes)
    field = numpy_to_vtk(x**2, deep=True)
    field.SetName("square")
    grid.GetPointData().AddArray(field)
    integrate = vtk.vtkIntegrateAttributes()
    integrate.SetInputData(grid)
    integrate.Update()
    found = integrate.GetOutput()
    area = found.GetCellData().GetArray("Area").GetValue(0) / (STOP - START) ** 2
    exact = (STOP - START) * (STOP**3 - START**3) / 3.0
    return area, found.GetPointData().GetArray("square").GetTuple(0)[0] / exact


found = {order: integrals(order) for order in (1, 2)}
for order, (area, integral) in found.items():
    print(f"order {order}: area {area:.4f}, integral {integral:.4f} of the exact ones")
assert all(abs(area - 1.0) < 1e-9 for area, _ in found.values()), "the behaviour has changed"
assert abs(found[2][1] - 1.0040) < 1e-4, "the behaviour has changed"
assert abs(found[1][1] - 1.0161) < 1e-4, "the behaviour has changed"
PYTHON
