#!/usr/bin/env bash
# Gmsh 4.15.2: an element in two physical groups is written twice in format 2.2
#
# Behaviour: a surface that belongs to two physical groups is one set of triangles in Gmsh and in format 4.1. In format 2.2, which many
#   programs ask for, Gmsh writes each triangle once for each group. Readers such as meshio 5.3.5 return twice the number of cells:
#   stiffness and Hessian count double there, and predicted standard deviations are too small by the square root of two.
# Expected by readers: each element once. Gmsh cannot write two groups for one element in this format; a reader must merge them.
# Output seen (Gmsh 4.15.2, meshio 5.3.5): format 2.2: 2 times, format 4.1: 1 times
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2 meshio==5.3.5
cd "$folder"
venv/bin/python - <<'PYTHON'
import gmsh
import meshio

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addRectangle(0.0, 0.0, 0.0, 1.0, 1.0)
gmsh.model.occ.synchronize()
for name in ("plate", "painted"):
    gmsh.model.addPhysicalGroup(2, [1], name=name)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.3)
gmsh.model.mesh.generate(2)
count = len(gmsh.model.mesh.getElementsByType(2)[0])
times = {}
for version in (2.2, 4.1):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write("mesh.msh")
    read = sum(len(block.data) for block in meshio.read("mesh.msh").cells if block.type == "triangle")
    times[version] = read / count
    print(f"format {version}: {times[version]:.0f} times")
assert times == {2.2: 2.0, 4.1: 1.0}, "the behaviour has changed"
PYTHON
