#!/usr/bin/env bash
# meshio 5.3.5: Abaqus files get rigid triangles and axisymmetric quadrilaterals with pore pressure
#
# Behaviour: a plane mesh of triangles and quadrilaterals, written as .inp, has the element types R3D3 (a rigid facet) and CAX4P (an
#   axisymmetric element with pore pressure). Abaqus, and readers that tell rigid from deformable elements, take them as such.
# Expected: a general type, such as S3 and S4, or CPS3 and CPS4.
# Output seen (Python 3.11, NumPy 2.4): *ELEMENT, TYPE=R3D3 and *ELEMENT, TYPE=CAX4P
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5
cd "$folder"
venv/bin/python - <<'PYTHON'
import meshio

points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]]
meshio.Mesh(points, [("triangle", [[1, 4, 2]]), ("quad", [[0, 1, 2, 3]])]).write("mesh.inp")
with open("mesh.inp") as file:
    types = [line.strip() for line in file if line.startswith("*ELEMENT")]
print(*types, sep="\n")
assert types == ["*ELEMENT, TYPE=R3D3", "*ELEMENT, TYPE=CAX4P"], "the behaviour has changed"
PYTHON
