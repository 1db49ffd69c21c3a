"""YAML as trees of texts: no tags, no types, no references, limits on everything."""

import re
from pathlib import Path

import yaml

from fedic.cameras.files.syntax.tree import LARGEST_FILE, Tree
from fedic.errors import CameraError
from fedic.io.text import read_text

__all__ = ["read_yaml"]

_DEEPEST = 32
_MOST_EVENTS = 1_000_000
_LOADER = getattr(yaml, "CBaseLoader", yaml.BaseLoader)


def read_yaml(path: Path) -> list[Tree]:
    """Read the documents of a YAML file.

    Every scalar is a text, so that OpenCV's ``1.`` and ``1e5`` are numbers later on and ``010`` is ten; tags such as
    ``!!opencv-matrix`` are ignored, and OpenCV's heading ``%YAML:1.0`` is skipped.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    list of Tree
        The documents that are not empty.

    Raises
    ------
    CameraError
        If the file cannot be read, is not YAML, has references (aliases), a key twice, or is too large or too deep.
    """
    text = re.sub(r"\A\s*%YAML[^\n]*\n", "", read_text(path, LARGEST_FILE, CameraError))
    documents: list[Tree] = []
    try:
        _Builder(path, documents).build(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = "" if mark is None else f" in line {mark.line + 1}"
        what = getattr(error, "problem", None) or "not YAML"
        raise CameraError(
            f"{path}: this file is truncated, or of another format: as YAML it is wrong{place} ({what})."
        ) from None
    return [document for document in documents if document not in ("", None)]


class _Builder:
    """Builds the trees from the events of the parser."""

    def __init__(self, path: Path, documents: list[Tree]) -> None:
        self._path = path
        self._open: list[tuple[Tree, str | None]] = [(documents, None)]

    def build(self, text: str) -> None:
        for count, event in enumerate(yaml.parse(text, Loader=_LOADER)):
            if count > _MOST_EVENTS or len(self._open) > _DEEPEST:
                raise CameraError(f"{self._path}: this file holds too much, or is nested too deep, for a camera.")
            if isinstance(event, yaml.AliasEvent):
                raise CameraError(
                    f"{self._path}: this file has a reference (*{event.anchor}); write the values out where it is."
                )
            if isinstance(event, yaml.ScalarEvent):
                self._add(event.value)
            elif isinstance(event, yaml.SequenceStartEvent):
                self._enter([])
            elif isinstance(event, yaml.MappingStartEvent):
                self._enter({})
            elif isinstance(event, yaml.SequenceEndEvent | yaml.MappingEndEvent):
                self._open.pop()

    def _enter(self, tree: Tree) -> None:
        self._add(tree)
        self._open.append((tree, None))

    def _add(self, tree: Tree) -> None:
        """Add a tree to the one that is open: an entry of a list, a key, or the value of the last key."""
        parent, key = self._open[-1]
        if isinstance(parent, list):
            parent.append(tree)
            return
        if key is None:
            if not isinstance(tree, str):
                raise CameraError(f"{self._path}: a key is not a text; this is no camera file.")
            if tree in parent:
                raise CameraError(f"{self._path}: the key {tree} is there twice; which one counts?")
            self._open[-1] = (parent, tree)
        else:
            parent[key] = tree
            self._open[-1] = (parent, None)
