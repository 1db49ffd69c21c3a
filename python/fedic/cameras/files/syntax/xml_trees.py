"""XML with the limits and the checks of defusedxml."""

from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import DefusedXMLParser

from fedic.cameras.files.syntax.tree import LARGEST_FILE, Tree
from fedic.errors import CameraError
from fedic.io.text import read_text

__all__ = ["read_xml", "xml_tree"]

_DEEPEST = 32
_MOST_ELEMENTS = 500_000


def read_xml(path: Path) -> Element:
    """Read an XML file; entities and external references are refused.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    CameraError
        If the file cannot be read, is not XML, defines entities, or is too large or too deep.
    """
    parser = DefusedXMLParser(target=_LimitedBuilder(path))
    try:
        parser.feed(read_text(path, LARGEST_FILE, CameraError))
        root: Element = parser.close()
    except ParseError as error:
        raise CameraError(
            f"{path}: this file is truncated, or of another format: as XML it is wrong ({error})."
        ) from None
    except DefusedXmlException as error:
        raise CameraError(
            f"{path}: this file defines entities or refers to others, which is refused ({error})."
        ) from None
    return root


def xml_tree(path: Path, element: Element) -> Tree:
    """Return an element of OpenCV's storage as a tree: children by name, entries of a list, or text."""
    if len(element) == 0:
        return (element.text or "").strip().strip('"')
    if all(child.tag == "_" for child in element):
        return [xml_tree(path, child) for child in element]
    tree: dict[str, Tree] = {}
    for child in element:
        if child.tag in tree:
            raise CameraError(f"{path}: the key {child.tag} is there twice; which one counts?")
        tree[child.tag] = xml_tree(path, child)
    return tree


class _LimitedBuilder(TreeBuilder):
    """A builder of elements with limits."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path
        self._depth = self._count = 0

    def start(self, tag: str, attributes: dict[str, str]) -> Element:
        self._depth += 1
        self._count += 1
        if self._depth > _DEEPEST or self._count > _MOST_ELEMENTS:
            raise CameraError(f"{self._path}: this file holds too much, or is nested too deep, for a camera.")
        return super().start(tag, attributes)

    def end(self, tag: str) -> Element:
        self._depth -= 1
        return super().end(tag)
