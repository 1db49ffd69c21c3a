"""Every variant of the formats of mesh files is read right or refused by name."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fedic
from formats.mesh_variants import AREA, VARIANTS, Variant


@pytest.mark.filterwarnings("default::fedic.QualityWarning")
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda each: f"{each.format} {each.name}")
def test_a_variant_is_read_or_refused(tmp_path: Path, gmsh: Any, variant: Variant) -> None:
    path = tmp_path / variant.file
    variant.write(path)
    name = f"{path}#{variant.choice}" if variant.choice else path
    if variant.refusal:
        with pytest.raises(fedic.MeshError, match=variant.refusal) as error:
            fedic.read_mesh(name)
        assert str(error.value).startswith(f"{path}: ")
        return
    mesh = fedic.read_mesh(name)
    assert {cell: len(nodes) for cell, nodes in mesh.cells.items()} == variant.cells
    area = AREA * sum(variant.cells.values()) / 6 if variant.choice == "TWO" else AREA
    assert mesh.areas().sum() == pytest.approx(area)
    assert tuple(sorted(mesh.sets)) == variant.sets
    for left in (name for name in mesh.sets if name.lower() == "left"):
        of_cells = (mesh.points[:, 0] == 0.0) & mesh.used_nodes
        np.testing.assert_array_equal(mesh.sets[left].nodes, np.flatnonzero(of_cells))
