"""Sections of a Gmsh file."""

import re

__all__ = ["Sections"]

_START = re.compile(rb"\$([A-Za-z]\w*)[ \t]*\r?\n")


class Sections:
    """What stands between ``$NAME`` and ``$EndNAME``, by name.

    Parameters
    ----------
    content : bytes
        The file.

    Raises
    ------
    ValueError
        If a section has no end.
    """

    def __init__(self, content: bytes) -> None:
        self._found: dict[str, list[bytes]] = {}
        place = 0
        while (start := _START.search(content, place)) is not None:
            name = start[1]
            end = content.find(b"$End" + name, start.end())
            if end < 0:
                raise ValueError(f"the section ${name.decode()} has no end; the file is damaged")
            self._found.setdefault(name.decode(), []).append(content[start.end() : end])
            place = end + len(name) + len(b"$End")

    def __contains__(self, name: str) -> bool:
        return name in self._found

    def all(self, name: str) -> list[bytes]:
        """Return the sections of a name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        list of bytes
            Empty if there is none.
        """
        return self._found.get(name, [])

    def one(self, name: str) -> bytes:
        """Return the first section of a name.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        bytes
            Its content.

        Raises
        ------
        ValueError
            If there is none.
        """
        if name not in self._found:
            raise ValueError(f"the section ${name} is missing")
        return self._found[name][0]

    def counted(self, name: str) -> tuple[int, bytes]:
        """Return the number in the first line of a section, and the rest of it.

        Parameters
        ----------
        name : str
            The name.

        Returns
        -------
        count : int
            The number.
        rest : bytes
            The lines that follow.

        Raises
        ------
        ValueError
            If there is no such section, or it does not begin with a number.
        """
        first, _, rest = self.one(name).partition(b"\n")
        if not first.strip().isdigit():
            raise ValueError(f"the section ${name} does not begin with a number; the file is damaged")
        return int(first), rest
