"""The table of the mesh files of finite element programs: each file gives the plate that it holds, or is refused."""

import importlib.util
from pathlib import Path

import pytest

from scenes.finite_element_files import FILES, FiniteElementFile


@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.program}-{file.variant}")
def test_each_file_is_read_or_refused_as_the_table_says(
    tmp_path: Path, repository: Path, file: FiniteElementFile
) -> None:
    path = repository / "tools" / "formats" / "finite_element_programs.py"
    spec = importlib.util.spec_from_file_location("finite_element_programs", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.outcome(file, tmp_path).startswith("refused: " if file.refused else "read")
