"""Cycles of a graph of files."""

from collections.abc import Mapping
from pathlib import Path

MAX_LINES = 500


def cycles(graph: Mapping[Path, set[Path]]) -> list[list[Path]]:
    """Return the strongly connected components of more than one node (Tarjan), each sorted."""
    index: dict[Path, int] = {}
    low: dict[Path, int] = {}
    stack: list[Path] = []
    found: list[list[Path]] = []

    def visit(node: Path) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in graph.get(node, set()):
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            component = [stack.pop()]
            while component[-1] != node:
                component.append(stack.pop())
            if len(component) > 1:
                found.append(sorted(component))

    for node in graph:
        if node not in index:
            visit(node)
    return sorted(found)


def long_files(files: list[Path]) -> dict[Path, int]:
    """Return the files of more than 500 lines and their numbers of lines."""
    counts = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    return {path: count for path, count in counts.items() if count > MAX_LINES}
