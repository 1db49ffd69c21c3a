"""Small mesh files of finite element programs: the same plate of two squares, 20 by 10, in many ways of writing it."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

import fedic
from scenes.refusal import refusal

__all__ = ["FILES", "FiniteElementFile", "outcome"]


class FiniteElementFile(NamedTuple):
    """A mesh file of the plate, or one that is refused.

    Attributes
    ----------
    program, variant : str
        What wrote it, and how.
    name : str
        Name of the file.
    text : str
        What it holds.
    refused : str
        What the message says if the file is refused; empty if it is read.
    beside : dict of str to str
        Further files, by name.
    encoding : str
        How the text is written.
    """

    program: str
    variant: str
    name: str
    text: str
    refused: str = ""
    beside: dict[str, str] = {}  # noqa: RUF012 - a constant
    encoding: str = "utf-8"

    def write(self, folder: Path) -> Path:
        """Write the file, and those beside it, and return its path."""
        for name, text in {self.name: self.text, **self.beside}.items():
            (folder / name).write_bytes(text.encode(self.encoding if name == self.name else "utf-8"))
        return folder / self.name


def outcome(file: FiniteElementFile, folder: Path) -> str:
    """Write and read a file; return ``"read"``, or ``"refused: "`` with the reason, or fail if it should be another."""
    path = file.write(folder)
    if file.refused:
        reason = refusal(fedic.read_mesh, str(path))
        assert file.refused in reason, f"{file.program}, {file.variant}: {reason}"
        return f"refused: {file.refused}"
    areas = fedic.read_mesh(path).areas()
    assert np.isclose(areas.sum(), 200.0, rtol=1e-12), f"{file.program}, {file.variant}: {areas}"
    return "read"


POINTS = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (20.0, 0.0), (20.0, 10.0))
NODES = "".join(f"{label}, {x}, {y}, 0.\n" for label, (x, y) in enumerate(POINTS, 1))
ELEMENTS = "1, 1, 2, 3, 4\n2, 2, 5, 6, 3\n"
DECK = f"*NODE\n{NODES}*ELEMENT, TYPE=CPS4, ELSET=ALL\n{ELEMENTS}"
PART = f"*PART, NAME=PLATE\n{DECK}*END PART\n"
CORNERS = "*NODE\n1, 0., 0.\n3, 20., 0.\n11, 0., 10.\n13, 20., 10.\n"
LINES = f"{CORNERS}*NGEN, NSET=LOW\n1, 3\n*NGEN, NSET=HIGH\n11, 13\n"
ROW = "*ELEMENT, TYPE=CPS4\n1, 1, 2, 12, 11\n*ELGEN\n1, 2\n"
SQUARE = "*NODE, NSET=A\n1, 0., 0.\n2, 10., 0.\n3, 10., 10.\n4, 0., 10.\n*ELEMENT, TYPE=S4, ELSET=A\n1, 1, 2, 3, 4\n"
PIN_BODY = "*NODE\n1, 3., 3.\n2, 4., 3.\n3, 4., 4.\n4, 3., 4.\n*ELEMENT, TYPE=R3D4\n1, 1, 2, 3, 4\n"
PIN = f"*PART, NAME=PIN\n{PIN_BODY}*END PART\n"
POLAR = "*NODE, SYSTEM=C\n1\n2, 10.\n4, 10., 90.\n5, 20.\n*NODE\n3, 10., 10.\n6, 20., 10.\n"


def _assembly(*instances: str) -> str:
    blocks = "".join(f"*INSTANCE, {each}\n*END INSTANCE\n" for each in instances)
    return f"*ASSEMBLY, NAME=A\n{blocks}*END ASSEMBLY\n"


def _abaqus(variant: str, text: str, refused: str = "", **more: object) -> FiniteElementFile:
    return FiniteElementFile("Abaqus", variant, "plate.inp", text, refused, **more)  # type: ignore[arg-type]


_ABAQUS = [
    _abaqus("nodes and elements", DECK),
    _abaqus("spaces, small letters, comments", DECK.lower().replace("*node", "** a comment\n * node")),
    _abaqus("keyword lines continued", DECK.replace("CPS4, ", "CPS4,\n ")),
    _abaqus("abbreviated parameters", DECK.replace("ELSET", "ELS")),
    _abaqus("exponents 1.D+01 and 1.+1", DECK.replace("10.0", "1.D+01").replace("20.0", "2.+1")),
    _abaqus("blank fields", DECK.replace(" 0.0", "").replace(", 0.\n", "\n")),
    _abaqus("UTF-8 with a byte order mark", DECK, encoding="utf-8-sig"),
    _abaqus("UTF-16", DECK, encoding="utf-16"),
    _abaqus(
        "*INCLUDE, quoted and with backslashes", '*INCLUDE, INPUT=".\\the part.inp"\n', beside={"the part.inp": DECK}
    ),
    _abaqus(
        "INPUT= of *NODE and *ELEMENT",
        "*NODE, INPUT=n.txt\n*ELEMENT, TYPE=CPS4, INPUT=e.txt\n",
        beside={"n.txt": NODES, "e.txt": ELEMENTS},
    ),
    _abaqus("node given twice: the last counts", DECK.replace("3, 10.0", "3, 7., 7.\n3, 10.0")),
    _abaqus("element given twice", f"{DECK}*ELEMENT, TYPE=CPS4\n3, 2, 5, 6, 3\n"),
    _abaqus("*PARAMETER with plain numbers", "*PARAMETER\nw = 10.\n" + DECK.replace("10.0", "<w>")),
    _abaqus("*PARAMETER with expressions", "*PARAMETER\nw = 5. * 2\n" + DECK.replace("10.0", "<w>"), "*PARAMETER"),
    _abaqus("*NGEN, straight", LINES + ROW),
    _abaqus(
        "*NGEN, LINE=C",
        CORNERS + "*NGEN, LINE=C\n1, 3, 1, , 10., 0., 0., 0., 0., 1.\n*NGEN\n11, 13\n*NODE\n2, 10.\n" + ROW,
    ),
    _abaqus("*NGEN, LINE=P", CORNERS + "*NGEN, LINE=P\n1, 3, 1, 11\n" + ROW, "LINE=P is not read"),
    _abaqus(
        "*NFILL", "*NODE, NSET=L\n1, 0.\n11, 0., 10.\n*NODE, NSET=R\n3, 20.\n13, 20., 10.\n*NFILL\nL, R, 2\n" + ROW
    ),
    _abaqus(
        "*NCOPY, *ELCOPY",
        SQUARE + "*NCOPY, SHIFT, OLD SET=A, CHANGE NUMBER=9\n10.\n*ELCOPY, OLD SET=A, ELEMENT SHIFT=1, SHIFT NODES=9\n",
    ),
    _abaqus("*NCOPY, POLE", SQUARE + "*NCOPY, POLE, OLD SET=A, CHANGE NUMBER=9\n9.\n", "POLE is not read"),
    _abaqus("*NMAP, rectangular", "*NODE, NSET=ALL\n" + DECK[6:] + "*NMAP, NSET=ALL, TYPE=RECTANGULAR\n0., 0.\n"),
    _abaqus(
        "*NMAP, spherical", "*NODE, NSET=ALL\n" + DECK[6:] + "*NMAP, NSET=ALL, TYPE=SPHERICAL\n0.\n", "is not read"
    ),
    _abaqus(
        "*SYSTEM",
        "*SYSTEM\n0., 0., 0., 0., 1., 0.\n*NODE\n"
        + "".join(f"{i}, {y}, {-x}\n" for i, (x, y) in enumerate(POINTS, 1))
        + DECK[DECK.index("*EL") :],
    ),
    _abaqus("*NODE, SYSTEM=C", POLAR + DECK[DECK.index("*EL") :]),
    _abaqus("*NODE, SYSTEM=S", DECK.replace("*NODE", "*NODE, SYSTEM=S"), "SYSTEM=S is not read"),
    _abaqus(
        "instance moved and turned",
        PART + _assembly("NAME=I, PART=PLATE\n10., 20.\n10., 20., 0., 10., 20., 1., 90."),
    ),
    _abaqus(
        "two instances of a part",
        f"*PART, NAME=P\n{SQUARE}*END PART\n" + _assembly("NAME=A, PART=P", "NAME=B, PART=P\n10., 0."),
    ),
    _abaqus("rigid pin beside the specimen", PIN + PART + _assembly("NAME=I, PART=PIN", "NAME=J, PART=PLATE")),
    _abaqus("two parts without an assembly", PART + PART.replace("PLATE", "OTHER"), "select one"),
    _abaqus("too many nodes on a line", DECK.replace("3, 4\n2,", "3, 4, 2,"), "element 1 has 9 nodes"),
    _abaqus("*IMPERFECTION", f"{DECK}*IMPERFECTION, FILE=b, STEP=1\n1, 0.1\n", "*IMPERFECTION changes the mesh"),
]

GRIDS = "".join(f"GRID    {i:<8}        {x:<8}{y:<8}0.\n" for i, (x, y) in enumerate(POINTS, 1))
QUADS = "CQUAD4  1       7       1       2       3       4\nCQUAD4  2       7       2       5       6       3\n"
LONG = "".join(f"GRID*   {i:<16}{'':<16}{x:<16}{y:<16}\n*       0.\n" for i, (x, y) in enumerate(POINTS, 1))
FREE = "".join(f"GRID,{i},,{x},{y}\n" for i, (x, y) in enumerate(POINTS, 1))
SYSTEM = "CORD2{kind},5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"


def _nastran(variant: str, text: str, refused: str = "", name: str = "plate.bdf", **more: object) -> FiniteElementFile:
    return FiniteElementFile("Nastran", variant, name, text, refused, **more)  # type: ignore[arg-type]


_NASTRAN = [
    _nastran("fields of 8 columns", f"SOL 101\nCEND\nBEGIN BULK\n{GRIDS}{QUADS}ENDDATA\n"),
    _nastran("fields of 16 columns", f"BEGIN BULK\n{LONG}{QUADS}ENDDATA\n"),
    _nastran("fields with commas", f"BEGIN BULK\n{FREE}CQUAD4,1,7,1,2,3,4\nCQUAD4,2,7,2,5,6,3,30.\nENDDATA\n"),
    _nastran("bulk data alone, no ENDDATA", GRIDS + QUADS),
    _nastran("exponents without E", f"{FREE.replace('20.0', '2.+1')}{QUADS}"),
    _nastran("INCLUDE", f"INCLUDE 'grids.bdf'\n{QUADS}", beside={"grids.bdf": GRIDS}),
    _nastran(".dat, told by its contents", GRIDS + QUADS, name="plate.dat"),
    _nastran(
        "nodes in a cylindrical system",
        FREE.replace("GRID,4,,0.0,10.0", "GRID,4,5,10.,90.") + QUADS + SYSTEM.format(kind="C"),
    ),
    _nastran(
        "nodes in a spherical system",
        FREE.replace("GRID,4,,0.0,10.0", "GRID,4,5,10.,90.,90.") + QUADS + SYSTEM.format(kind="S"),
    ),
    _nastran(
        "system that is missing", FREE.replace("GRID,4,", "GRID,4,9") + QUADS, "the coordinate system 9 is not defined"
    ),
    _nastran("some middle nodes missing", f"{GRIDS}CQUAD8,1,7,1,2,3,4,5\n", "lacks the nodes 6, 7, 8"),
    _nastran("superelements", f"BEGIN SUPER=1\n{GRIDS}{QUADS}", "superelements"),
]

_ROWS = "".join(f"{i:9d}{0:9d}{0:9d}{x:21.13E}{y:21.13E}\n" for i, (x, y) in enumerate(POINTS, 1))
NBLOCK = f"NBLOCK,6,SOLID,6,6\n(3i9,6e21.13e3)\n{_ROWS}N,R5.3,LOC,       -1,\n"
CELLS = ((1, 2, 3, 4), (2, 5, 6, 3))


def _eblock(cells: tuple[tuple[int, ...], ...]) -> str:
    rows = [[1, 1, 1, 1, 0, 0, 0, 0, len(nodes), 0, i, *nodes] for i, nodes in enumerate(cells, 1)]
    return "EBLOCK,19,SOLID\n(19i9)\n" + "".join("".join(f"{x:9d}" for x in row) + "\n" for row in rows) + "       -1\n"


def _compact(cells: tuple[tuple[int, ...], ...]) -> str:
    rows = [[i, 1, 1, 1, 0, *nodes] for i, nodes in enumerate(cells, 1)]
    return "eblock,10\n(15i9)\n" + "".join("".join(f"{x:9d}" for x in row) + "\n" for row in rows) + "-1\n"


def _ansys(variant: str, text: str, refused: str = "", name: str = "plate.cdb") -> FiniteElementFile:
    return FiniteElementFile("Ansys", variant, name, f"/PREP7\nET,1,182\n{text}", refused)


COMMANDS = "".join(f"N,{i},{x},{y}\n" for i, (x, y) in enumerate(POINTS, 1))
_ANSYS = [
    _ansys("NBLOCK, EBLOCK", NBLOCK + _eblock(CELLS)),
    _ansys(".inp, told by its contents", NBLOCK + _eblock(CELLS), name="plate.inp"),
    _ansys(".dat of Workbench, compact EBLOCK", NBLOCK + _compact(CELLS), name="plate.dat"),
    _ansys("triangles with a repeated node", NBLOCK + _eblock(((1, 2, 3, 3), (1, 3, 4, 4), CELLS[1]))),
    _ansys("columns too narrow for the numbers", NBLOCK.replace("E+0", "E+00") + _eblock(CELLS)),
    _ansys("N and E commands", f"{COMMANDS}E,1,2,3,4\nE,2,5,6,3\n", name="plate.inp"),
    _ansys("N in CSYS,1", f"{COMMANDS}CSYS,1\nN,4,10,90\nE,1,2,3,4\nE,2,5,6,3\n", name="plate.inp"),
    _ansys(
        "element type not in the file",
        NBLOCK + _eblock(CELLS).replace("        1        1", "        1        2", 1),
        "no ET",
    ),
    _ansys(
        "mesh made by commands", "RECTNG,0,20,0,10\nAMESH,ALL\n", "AMESH makes or changes the mesh", name="plate.inp"
    ),
]


def _dataset(number: int, *lines: str) -> str:
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1\n"])


def _unv_nodes(system: int = 1) -> str:
    lines = [
        line
        for i, (x, y) in enumerate(POINTS, 1)
        for line in (f"{i:10d}{system:10d}{1:10d}{11:10d}", f"{x:25.16E}{y:25.16E}{0:25.16E}".replace("E", "D"))
    ]
    return _dataset(2411, *lines)


def _unv_cells(number: int = 2412) -> str:
    head = [1, 1, 7, 4] if number == 2412 else [1, 1, 1, 1, 7, 4]
    rows = [line for i, nodes in enumerate(CELLS, 1) for line in ([i, 44, *head], nodes)]
    return _dataset(number, *("".join(f"{x:10d}" for x in row) for row in rows))


_CYLINDRICAL = _dataset(
    2420, f"{1:10d}", "Part", f"{1:10d}{1:10d}{8:10d}", "CS1", " 1. 0. 0.", " 0. 1. 0.", " 0. 0. 1.", " 0. 0. 0."
)


def _unv(variant: str, text: str, refused: str = "") -> FiniteElementFile:
    return FiniteElementFile("Universal file", variant, "plate.unv", text, refused)


_UNV = [
    _unv("datasets 2411, 2412", _unv_nodes() + _unv_cells()),
    _unv("datasets 781, 780", _unv_nodes().replace("  2411", "   781") + _unv_cells(780)),
    _unv("nodes in a cylindrical system", _CYLINDRICAL + _unv_nodes() + _unv_cells(), "which is not the global one"),
    _unv("dataset without an end", _unv_nodes() + _unv_cells().removesuffix("    -1\n"), "has no end"),
]

FILES = [*_ABAQUS, *_NASTRAN, *_ANSYS, *_UNV]
