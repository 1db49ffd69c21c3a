#!/usr/bin/env bash
# meshio 5.3.5: nodes of a Nastran file in a cylindrical system are read as Cartesian
#
# Behaviour: the second field of GRID names the coordinate system of a node. For a system of CORD2C the next three fields are radius,
#   angle in degrees and height. meshio ignores the system: half a circle of radius 1 becomes a line 180 long, without a word.
# Expected: (1, 0, 0), (0, 1, 0), (-1, 0, 0), or an error.
# Output seen (Python 3.11, NumPy 2.4): [[1.0, 0.0, 0.0], [1.0, 90.0, 0.0], [1.0, 180.0, 0.0]]
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5
cd "$folder"
cat > ring.bdf <<'BULK'
BEGIN BULK
CORD2C  1       0       0.      0.      0.      0.      0.      1.
+       1.      0.      0.
GRID    1       1       1.      0.      0.
GRID    2       1       1.      90.     0.
GRID    3       1       1.      180.    0.
CTRIA3  1       1       1       2       3
ENDDATA
BULK
venv/bin/python - <<'PYTHON'
import meshio

points = meshio.read("ring.bdf").points.tolist()
print(points)
assert points == [[1.0, 0.0, 0.0], [1.0, 90.0, 0.0], [1.0, 180.0, 0.0]], "the behaviour has changed"
PYTHON
