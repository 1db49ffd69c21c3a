"""The unit of the mesh, given once and named in pictures and files."""

import json
import pickle
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.campaign import load_config, measure_series
from scenes.runs import write_run

MESH = fedic.rectangle_mesh((3, 3, 17, 13), size=2.0)
CAMERA = fedic.FrontParallel(10.0, (0.0, 160.0))


@pytest.fixture(scope="module")
def result(speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> fedic.Result:
    return fedic.correlate(*speckle_pair, MESH, CAMERA, unit="µm")


def label(result: fedic.Result, field: Any) -> str:
    return result.plot(field).axes[1].get_ylabel()


def test_pictures_and_files_name_the_unit(result: fedic.Result, tmp_path: Path) -> None:
    assert result.unit == "µm"
    assert pickle.loads(pickle.dumps(result)).unit == "µm"
    assert "(µm)" in label(result, "x")
    assert "(px)" in label(result, "u")
    assert json.loads(result.write(tmp_path / "a.json").read_text())["unit"] == "µm"
    assert np.load(result.write(tmp_path / "a.npz"))["unit"] == "µm"
    text = result.write(tmp_path / "a.vtu").read_text(encoding="utf-8")
    assert '<InformationKey name="UNITS_LABEL" location="vtkDataArray">µm</InformationKey>' in text
    content = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_allclose(content.points[:, :2], MESH.points)
    np.testing.assert_array_equal(content.point_data["displacement"][:, :2], result.displacement)
    np.testing.assert_allclose(fedic.read_mesh(tmp_path / "a.vtu").points, MESH.points)


@pytest.mark.parametrize(("camera", "unit", "named"), [(CAMERA, "mm", "mm"), (CAMERA, None, ""), (None, None, "px")])
def test_a_pickled_correlator_keeps_its_unit(
    speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]], camera: Any, unit: str | None, named: str
) -> None:
    reference, deformed = speckle_pair
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20) if camera is None else MESH
    correlator = fedic.Correlator(reference, mesh, camera or fedic.ImageFrame(), unit=unit)
    assert pickle.loads(pickle.dumps(correlator)).correlate(deformed).unit == named


def test_without_a_unit_none_is_named(
    speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]], tmp_path: Path
) -> None:
    result = fedic.correlate(*speckle_pair, MESH, CAMERA)
    assert "(mesh unit)" in label(result, "y")
    assert result.summary()["unit"] is None
    assert b"UNITS_LABEL" not in result.write(tmp_path / "a.vtu").read_bytes()
    pixels = fedic.correlate(*speckle_pair, fedic.rectangle_mesh((30, 30, 170, 130), size=20))
    assert pixels.unit == "px"
    assert "(px)" in label(pixels, "y")


def test_a_unit_with_a_dollar_sign_is_drawn(speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> None:
    result = fedic.correlate(*speckle_pair, MESH, CAMERA, unit="$_{")
    result.plot("x").savefig("/dev/null", format="png")


@pytest.mark.parametrize("unit", ["", " ", "m" * 21, "a\nb", 3, b"mm"])
def test_what_is_no_unit_is_refused(unit: Any) -> None:
    with pytest.raises(fedic.OptionError, match="give the unit of length") as caught:
        fedic.Correlator(np.zeros((160, 200), np.uint8), MESH, CAMERA, unit=unit)
    assert caught.value.option == "unit"


def test_a_mesh_drawn_in_pixels_has_no_other_unit() -> None:
    with pytest.raises(fedic.OptionError, match="has the unit px"):
        fedic.Correlator(np.zeros((160, 200), np.uint8), MESH, unit="mm")


def test_a_run_takes_the_unit_from_its_mesh(tmp_path: Path) -> None:
    mesh = '[mesh]\nunit = "mm"\n[mesh.rectangle]\nbounds = [2, 2, 10, 8]\nsize = 1.0\n'
    camera = '[camera]\nmodel = "front-parallel"\nscale = 10.0\norigin = [0.0, 96.0]\n'
    config = write_run(tmp_path, ["a.png"], mesh=mesh, more=camera, pictures=True)
    assert [frame.outcome["unit"] for frame in measure_series(load_config(config))] == ["mm"]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["settings"]["mesh"]["unit"] == summary["frames"][0]["unit"] == "mm"
    config.write_text(config.read_text().replace(camera, ""))
    with pytest.raises(fedic.ConfigError, match="has the unit px") as caught:
        load_config(config)
    assert caught.value.key == "mesh.unit"
