"""Program that meshes polygons by Gmsh, run in a process of its own by `fedic.meshing`.

Gmsh cannot be interrupted and keeps one state for a whole process. This file imports nothing of fedic. The first line
on stdin is the task in JSON; the mesh goes to stdout as an .npz file, a message of Gmsh to stderr with exit status 3.
The process ends when stdin is closed, as it is if the parent is killed.
"""

import io
import json
import os
import signal
import sys
import threading
from typing import Any

_MODEL = "fedic"
_ALL_QUADS = 1


def _main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends this process
    result = os.dup(1)
    os.dup2(2, 1)  # what Gmsh prints
    task = json.loads(sys.stdin.buffer.readline())
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    sys.path[:] = task["path"]
    import gmsh
    import numpy as np

    try:
        arrays = _meshed(gmsh, task)
    except Exception as error:  # gmsh raises nothing more precise
        sys.stderr.write(str(error))
        sys.stderr.flush()
        os._exit(3)
    content = io.BytesIO()
    np.savez(content, **dict(zip(("tags", "coordinates", "connectivity"), arrays, strict=True)))
    with os.fdopen(result, "wb") as file:
        file.write(content.getvalue())
    os._exit(0)


def _end_with_the_parent() -> None:
    sys.stdin.buffer.read()
    os._exit(1)


def _meshed(gmsh: Any, task: dict[str, Any]) -> tuple[Any, Any, Any]:
    """Return the tags of the nodes, their coordinates and the nodes of the cells, all flat."""
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    for name, value in task["options"].items():
        gmsh.option.setNumber(name, value)
    gmsh.model.add(_MODEL)
    _fill(gmsh, task["polygons"], task["size"])

    def code(family: str) -> int:
        number: int = gmsh.model.mesh.getElementType(family, task["order"], task["incomplete"])
        return number

    if task["family"] == "Quadrangle" and len(gmsh.model.mesh.getElementsByType(code("Triangle"))[0]):
        # An odd number of edges on the border leaves triangles: cut a mesh twice as coarse into quadrilaterals.
        gmsh.model.remove()
        gmsh.model.add(_MODEL)
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", _ALL_QUADS)
        _fill(gmsh, task["polygons"], 2.0 * task["size"])
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, connectivity = gmsh.model.mesh.getElementsByType(code(task["family"]))
    return tags, coordinates, connectivity


def _fill(gmsh: Any, polygons: list[list[list[float]]], size: float) -> None:
    geometry = gmsh.model.geo
    loops = []
    for polygon in polygons:
        corners = [geometry.addPoint(x, y, 0.0, size) for x, y in polygon]
        edges = [geometry.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        loops.append(geometry.addCurveLoop(edges))
    geometry.addPlaneSurface(loops)
    geometry.synchronize()
    gmsh.model.mesh.generate(2)


if __name__ == "__main__":
    _main()
