"""Sets that a Gmsh file holds as fields: one for members, zero for others."""

from fedic.io._mesh_file import Indices
from fedic.io.mesh_formats._set_fields import SET_PREFIX
from fedic.io.mesh_formats.msh._numbers import Numbers
from fedic.io.mesh_formats.msh._sections import Sections

__all__ = ["read_set_fields"]


def read_set_fields(sections: Sections, binary: bool, order: str) -> tuple[dict[str, Indices], dict[str, Indices]]:
    """Return the sets in the fields ``set:NAME``.

    Parameters
    ----------
    sections : Sections
        The sections of the file.
    binary : bool
        Whether it is binary.
    order : str
        Its byte order, ``"<"`` or ``">"``.

    Returns
    -------
    of_nodes, of_elements : dict of str to ndarray of int
        Tags of the members by the name of the set.

    Raises
    ------
    ValueError
        If a field is damaged.
    """
    sets: dict[str, dict[str, Indices]] = {"NodeData": {}, "ElementData": {}}
    for kind, section in [(each, section) for each in sets for section in sections.all(each)]:
        words: list[list[bytes]] = []
        rest = section
        for _ in range(3):  # texts, numbers and integers that describe the field
            count, _, rest = rest.partition(b"\n")
            words.append([])
            for _ in range(min(_integer(count), len(rest))):
                word, _, rest = rest.partition(b"\n")
                words[-1].append(word.strip())
        texts, _, integers = words
        name = texts[0].strip(b'"').decode("utf-8", "replace") if texts else ""
        if name.startswith(SET_PREFIX):
            if len(integers) < 3:
                raise ValueError(f"the field {name} does not say how many values it has")
            tags, values = Numbers(rest, binary, order, f"${kind}").records(
                _integer(integers[2]), ("int", 1), ("double", _integer(integers[1]))
            )
            sets[kind][name.removeprefix(SET_PREFIX)] = tags[values.any(axis=1), 0]
    return sets["NodeData"], sets["ElementData"]


def _integer(text: bytes) -> int:
    if not text.strip().isdigit():
        raise ValueError("the description of a field is damaged")
    return int(text)
