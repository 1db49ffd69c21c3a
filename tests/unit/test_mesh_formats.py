"""Every variant of the formats of mesh files is read right or refused by name."""

from pathlib import Path
from typing import Any

import pytest

import fedic
from scenes.meshes.variant import Variant, check
from scenes.meshes.variants import VARIANTS


@pytest.mark.filterwarnings("default::fedic.QualityWarning")
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda each: f"{each.format} {each.name}")
def test_a_variant_is_read_or_refused(tmp_path: Path, gmsh: Any, variant: Variant) -> None:
    name = variant.written(tmp_path)
    if not variant.refusal:
        check(variant, fedic.read_mesh(name))
        return
    with pytest.raises(fedic.MeshError, match=variant.refusal) as error:
        fedic.read_mesh(name)
    assert str(error.value).startswith(f"{tmp_path / variant.file}: ")
