"""Strains of measured displacements: rotations leave no strain, and every output names the measure."""

import json
from pathlib import Path

import cv2
import meshio
import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
from fedic.cli import app

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]
BOUNDS = (60.0, 50.0, 180.0, 150.0)


@pytest.fixture(scope="module")
def rotated_pair() -> Pair:
    """Return two images of a specimen rotated by 10 degrees about the middle of the image."""
    angle, centre = np.radians(10.0), np.array([120.0, 100.0])
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    texture, camera, shape = fedic.synthetic.Speckle(4.0, seed=3), fedic.ImageFrame(), (200, 240)
    reference = fedic.synthetic.render(texture, camera, shape)
    deformed = fedic.synthetic.render(
        texture, camera, shape, displacement=lambda points: (points - centre) @ (rotation - np.eye(2)).T
    )
    return reference, deformed  # type: ignore[return-value]


def test_a_rotation_of_the_specimen_leaves_no_strain(rotated_pair: Pair) -> None:
    result = fedic.correlate(*rotated_pair, fedic.rectangle_mesh(BOUNDS, 20), initial="pyramid")
    assert result.converged
    np.testing.assert_allclose(np.mean(result.strains(), axis=0), 0.0, atol=1e-4)  # type: ignore[call-overload]
    for measure in ("green-lagrange", "hencky"):
        for at in ("cells", "nodes", [[100.0, 90.0], [150.0, 120.0]]):
            strains = result.strains(measure, at)  # type: ignore[arg-type]
            np.testing.assert_allclose(strains, 0.0, atol=3e-3)
    small = result.strains("small").mean(axis=0)
    np.testing.assert_allclose(small, [np.cos(np.radians(10.0)) - 1.0] * 2 + [0.0], atol=1e-4)


@pytest.mark.parametrize("measure", [None, "hencky"])
def test_a_run_names_the_measure_in_its_files(rotated_pair: Pair, tmp_path: Path, measure: str | None) -> None:
    for name, image in zip(("reference", "rotated"), rotated_pair, strict=True):
        assert cv2.imwrite(str(tmp_path / f"{name}.png"), image)
    chosen = f'strain_measure = "{measure}"\n' if measure else ""
    (tmp_path / "test.toml").write_text(
        '[images]\nreference = "reference.png"\ndeformed = "rotated.png"\n'
        f"[mesh.rectangle]\nbounds = {list(BOUNDS)}\nsize = 20.0\n"
        '[correlation]\ninitial = "pyramid"\n[output]\nfolder = "out"\npictures = false\n'
        f'files = ["vtu", "npz"]\n{chosen}'
    )
    outcome = CliRunner().invoke(app, ["run", str(tmp_path / "test.toml")])
    assert outcome.exit_code == 0, outcome.output
    expected = measure or "green-lagrange"
    settings = json.loads((tmp_path / "out" / "summary.json").read_text())["settings"]
    assert settings["output"]["strain_measure"] == expected
    with np.load(tmp_path / "out" / "rotated.npz") as arrays:
        assert arrays["strain_measure"] == expected
        strains = arrays["strains"]
    fields = meshio.read(tmp_path / "out" / "rotated.vtu").cell_data
    for component, values in zip(("xx", "yy", "xy"), strains.T, strict=True):
        written = fields[f"{expected.replace('-', '_')}_strain_{component}"][0]
        np.testing.assert_array_equal(written, values)
        assert abs(written.mean()) < 1e-4
