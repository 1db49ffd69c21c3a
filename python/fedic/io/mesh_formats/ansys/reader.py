"""Meshes in input and archive files of Ansys."""

import itertools
from pathlib import Path

import numpy as np

from fedic.io._mesh_file import MeshFile
from fedic.io.mesh_formats._coordinates import from_cylindrical
from fedic.io.mesh_formats._labelled_mesh import LabelledMesh, Labels
from fedic.io.mesh_formats._numbers import checked_label, integer, real
from fedic.io.mesh_formats.ansys.blocks import read_element_block, read_integers, read_node_block
from fedic.io.mesh_formats.ansys.elements import MESH_ONLY, element_of, is_known
from fedic.io.mesh_formats.ansys.lines import Lines

__all__ = ["read_ansys"]

_WHOLE_LINE = ("/COM", "/TITLE", "C***", "/TLABEL")
_CHANGING = {
    *("AMESH", "VMESH", "LMESH", "KMESH", "FVMESH", "VSWEEP", "VEXT", "EGEN", "NGEN", "FILL", "QUAD"),
    *("ESYM", "ENSYM", "NSYM", "ENGEN", "NSCALE", "NMODIF", "EMODIF", "EMID", "NDELE", "EDELE", "EREFINE", "NREFINE"),
    *("TRANSFER", "NUMMRG", "NUMCMP", "NREAD", "EREAD", "NRRANG", "ERRANG", "CDREAD", "UPGEOM", "NMOVE", "MOVE"),
    *("ESURF", "EINTF", "ESLN_", "/INPUT", "*USE", "*REPEAT"),
}
"""Commands that make or change the mesh by what fedic does not follow."""
_MESH200 = 200
_LOOPS = {"*DO": 1, "*ENDDO": -1, "*IF": 1, "*ENDIF": -1, "*DOWHILE": 1}


class _Reader:
    """The state of a file while it is read: mesh, components, and the settings of the commands so far."""

    def __init__(self, path: Path) -> None:
        self.lines = Lines(path)
        self.mesh = LabelledMesh()
        self.components: list[tuple[str, str, list[int]]] = []
        self.routines: dict[int, int] = {}
        self.values: dict[str, float] = {}
        self.options: dict[int, int] = {}
        self.kind = 1
        self.system = 0
        self.loops = 0
        self.last_node = self.last_element = 0
        self.open: tuple[int, list[int]] | None = None

    def read(self) -> None:
        while (line := self.lines.next()) is not None:
            text = line.strip()
            whole = text.upper().startswith(_WHOLE_LINE)
            for command in [] if whole else text.split("!")[0].split("$"):
                name, *items = (item.strip() for item in command.split(","))
                self._command(name.upper(), items)
        self._close()

    def _command(self, name: str, items: list[str]) -> None:
        if name != "EMORE":
            self._close()
        if name in _CHANGING:
            raise self.lines.error(
                f"{name} makes or changes the mesh, which fedic does not follow; write it by CDWRITE."
            )
        self.loops += _LOOPS[name] if name in _LOOPS and "THEN" in [*map(str.upper, items), "THEN"][-2:] else 0
        if name in ("N", "E", "EN", "EMORE") and self.loops:
            raise self.lines.error(f"{name} stands in a loop or a condition, which fedic does not follow; use CDWRITE.")
        with self.lines.reported(name):
            if name == "NBLOCK":
                for node, point in read_node_block(self.lines):
                    self._add_node(node, point)
            elif name == "EBLOCK":
                self._element_block([*items, "", ""][1].upper())
            elif name == "CMBLOCK":
                self._component(items)
            elif name == "ETBLOCK":
                self.routines.update((row[0], row[1]) for row in read_integers(self.lines, name) if len(row) > 1)
            elif name == "N":
                self._node(items)
            elif name in ("E", "EN"):
                self._element(name, items)
            elif name == "EMORE" and self.open is not None:
                self.open[1].extend(self._integers(items))
            else:
                self._setting(name, items)

    def _setting(self, name: str, items: list[str]) -> None:
        first, second, third, *_ = [*items, "", "", ""]
        if name == "ET":
            digits = second[len(second.rstrip("0123456789")) :]
            if digits:
                self.routines[self._whole(first)] = integer(digits)
                self.options[self._whole(first)] = self._whole(third) if third else 0
        elif name in ("KEYOPT", "KEYOP", "KEYO") and second == "1":
            self.options[self._whole(first)] = self._whole(third)
        elif name == "TYPE":
            self.kind = self._whole(first)
        elif name == "CSYS":
            self.system = self._whole(first) if first else 0
        elif name == "*SET" or "=" in name:
            key, value = (first.upper(), second) if name == "*SET" else (part.strip() for part in name.split("=", 1))
            try:
                self.values[key] = self._value(value)
            except ValueError:
                self.values.pop(key, None)

    def _element_block(self, key: str) -> None:
        if key not in ("", "SOLID"):
            raise ValueError(f"blocks of the kind {key} are not read; write the mesh by CDWRITE,DB")
        for element, kind, nodes in read_element_block(self.lines, key == "SOLID"):
            self._add(element, kind, nodes)

    def _component(self, items: list[str]) -> None:
        name, kind, count, *_ = [*items, "", "", ""]
        numbers = [
            number for row in read_integers(self.lines, "CMBLOCK", integer(count.partition(" ")[0])) for number in row
        ]
        if kind.upper().startswith(("NODE", "ELEM")):
            self.components.append((name, kind.upper()[:4], numbers))

    def _node(self, items: list[str]) -> None:
        number, *point = [*items, *[""] * 4][:4]
        if number.upper().startswith(("R5", "UNBL")):
            if integer(point[1] or "0") > 0 and point[0].upper() == "LOC":
                raise ValueError("unblocked nodes are not read; write the mesh by CDWRITE,DB in blocks")
            return
        node = checked_label(self._whole(number)) if number else self.last_node + 1
        given = np.array([[self._value(item) if item else 0.0 for item in point]])
        if self.system not in (0, 1):
            raise ValueError(f"nodes in the coordinate system {self.system} are not read, only in 0 and 1")
        x, y, z = (from_cylindrical(given) if self.system == 1 else given)[0].tolist()
        self._add_node(node, (x, y, z))

    def _add_node(self, node: int, point: tuple[float, float, float]) -> None:
        self.mesh.nodes[node] = point
        self.last_node = max(self.last_node, node)

    def _element(self, name: str, items: list[str]) -> None:
        if name == "EN" and items and items[0].upper().startswith(("R5", "UNBL")):
            if [item.upper() for item in items[1:3]] == ["ATTR", "-1"]:  # the end of the elements
                return
            raise ValueError("unblocked elements are not read; write the mesh by CDWRITE,DB in blocks")
        numbers = self._integers(items)
        element = numbers.pop(0) if name == "EN" and numbers else self.last_element + 1
        self.open = (element, numbers)

    def _close(self) -> None:
        """Add the element whose nodes may have been continued by ``EMORE``."""
        if self.open is not None:
            (element, nodes), self.open = self.open, None
            with self.lines.reported("E"):
                self._add(element, self.kind, nodes)

    def _add(self, element: int, kind: int, nodes: list[int]) -> None:
        checked_label(element)
        self.last_element = max(self.last_element, element)
        if kind not in self.routines:
            raise ValueError(f"element {element} is of the type {kind}, which no ET command defines")
        routine = self.routines[kind]
        if routine == _MESH200:
            routine = MESH_ONLY.get(self.options.get(kind, 0), routine)
        if not is_known(routine):
            self.mesh.others.setdefault(f"Ansys type {routine}")
            return
        try:
            self.mesh.elements[element] = element_of(routine, nodes)
        except ValueError as error:
            raise ValueError(f"element {element} cannot be read: {error}") from error

    def _integers(self, items: list[str]) -> list[int]:
        return [self._whole(item) if item else 0 for item in items]

    def _whole(self, text: str) -> int:
        value = self.values.get(text.upper())
        return integer(text if value is None else f"{value:.15g}")

    def _value(self, text: str) -> float:
        if text.upper() in self.values:
            return self.values[text.upper()]
        return real(text)


def read_ansys(path: Path) -> MeshFile:
    """Read the nodes, elements and components of an archive (``.cdb``) or input file.

    Blocks (``NBLOCK``, ``EBLOCK``) and the commands ``N``, ``E`` and ``EN`` are read.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    MeshFile
        Nodes in the order of the file; quadrilaterals whose third and fourth node are one are triangles. Contact and
        surface effect elements come under their number, without nodes.

    Raises
    ------
    MeshError
        If a line cannot be understood, a command makes or changes the mesh, the type of an element is not defined, or
        an element refers to a node that does not exist.
    """
    reader = _Reader(path)
    reader.read()
    mesh = reader.mesh
    elements = np.fromiter(mesh.elements, dtype=np.int64, count=len(mesh.elements))
    sets: dict[str, dict[str, Labels]] = {"NODE": {}, "ELEM": {}}
    for name, kind, numbers in reader.components:
        sets[kind][name] = _members(numbers, mesh.node_labels() if kind == "NODE" else elements)
    return mesh.contents(path, sets["NODE"], sets["ELEM"], keep_apart=False)


def _members(numbers: list[int], labels: Labels) -> Labels:
    """Return the members of a component, in which a negative number ends a range."""
    members = [np.intersect1d(np.array(numbers, dtype=np.int64), labels)]
    for first, last in itertools.pairwise(numbers):
        if last < 0:
            members.append(labels[(labels >= first) & (labels <= -last)])
    return np.concatenate(members)
