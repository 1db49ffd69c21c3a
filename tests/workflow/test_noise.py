"""The noise floor of a measurement, its prediction, and the command ``fedic noise``."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
from fedic.cli import app
from scenes.runs import contents, write_image
from scenes.static import scene, shot

RUNNER = CliRunner()
SHAPE = (160, 180)
BOUNDS = (20.3, 20.6, 160.2, 139.1)
MESH = """\
[mesh.rectangle]
bounds = [20, 20, 160, 140]
size = 20.0
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number in range(3):
        write_image(tmp_path / f"static{number}.png", shot(scene(SHAPE), number))
    write_image(tmp_path / "moved.png", shot(scene(SHAPE, (0.06, 0.0)), 9))
    (tmp_path / "test.toml").write_text(
        f'[images]\nreference = "static0.png"\ndeformed = "moved.png"\n{MESH}[output]\nfolder = "out"\n'
    )
    return tmp_path


def test_the_noise_floor_is_that_of_the_results() -> None:
    images = [shot(scene(SHAPE), seed) for seed in range(4)]
    mesh = fedic.rectangle_mesh(BOUNDS, 20.0)
    floor = fedic.noise_floor(images, mesh, noise=2.0)
    results = [fedic.correlate(images[0], image, mesh) for image in images[1:]]
    fields = [np.column_stack([result.displacement]) for result in results]
    np.testing.assert_allclose(floor.bias[:2], np.mean(fields, axis=(0, 1)), atol=1e-12)
    variances = [field.var(axis=0, ddof=1) for field in fields]
    np.testing.assert_allclose(floor.std[:2], np.sqrt(np.mean(variances, axis=0)), rtol=1e-12)
    strains = [result.strains().components for result in results]
    np.testing.assert_allclose(floor.bias[2:], np.mean(strains, axis=(0, 1)), atol=1e-12)
    predicted = fedic.Correlator(images[0], mesh).standard_deviations(2.0)
    np.testing.assert_allclose(floor.predicted[:2], np.sqrt((predicted**2).mean(axis=0)), rtol=1e-12)
    assert (floor.num_images, floor.num_nodes, floor.not_measured, floor.unit) == (3, mesh.num_nodes, 0, "px")
    # The noise of the first image is common to all: the scatter of one pair is that of 5 components by chance.
    np.testing.assert_allclose(floor.std / floor.predicted, 1.0, atol=0.3)


def test_nodes_that_are_not_measured_are_left_out_and_counted() -> None:
    images = [shot(scene(SHAPE), seed) for seed in range(2)]
    images[1][60:115, 60:115] = shot(scene(SHAPE), 7)[::-1][60:115, 60:115]
    floor = fedic.noise_floor(images, fedic.rectangle_mesh(BOUNDS, 20.0), noise=2.0)
    assert floor.not_measured > 0
    assert floor.doubtful == 1
    assert np.isfinite(floor.std).all()


def predicted_strains(image: NDArray[Any], size: float, **options: float) -> NDArray[np.float64]:
    correlator = fedic.Correlator(image, fedic.rectangle_mesh(BOUNDS, size), **options)  # type: ignore[arg-type]
    return correlator.covariance(2.0).strain_deviations("small")


def test_predicted_strain_deviations_agree_with_the_scatter_of_many_pairs() -> None:
    mesh = fedic.rectangle_mesh(BOUNDS, 20.0)
    strains = []
    for seed in range(40):
        pair = [fedic.synthetic.add_noise(scene(SHAPE), noise=2.0, seed=2 * seed + k) for k in range(2)]
        strains.append(fedic.correlate(*pair, mesh, initial="zero").strains("small").components)
    measured = np.std(strains, axis=0, ddof=1)
    predicted = predicted_strains(scene(SHAPE).astype(np.float32), 20.0)
    ratio = np.sqrt((measured**2).mean(axis=0) / (predicted**2).mean(axis=0))
    np.testing.assert_allclose(ratio, 1.0, atol=0.06)


def test_strains_are_predicted_on_fine_meshes_and_through_a_regularization() -> None:
    image = shot(scene(SHAPE), 1)
    coarse, fine = (predicted_strains(image, size) for size in (20.0, 3.0))
    smooth = predicted_strains(image, 20.0, regularization_length=60.0)
    assert 20.0 * coarse.mean() < fine.mean() < 200.0 * coarse.mean()
    assert 0.0 < smooth.mean() < coarse.mean()


def test_the_command_prints_and_writes_noise_and_noise_floor(folder: Path) -> None:
    files = [str(folder / f"static{number}.png") for number in range(3)]
    output, picture = folder / "noise.json", folder / "noise.png"
    options = ["--config", str(folder / "test.toml"), "--output", str(output), "--picture", str(picture)]
    outcome = RUNNER.invoke(app, ["noise", *files, *options])
    assert outcome.exit_code == 0, outcome.output
    assert "noise of one image" in outcome.stdout
    assert "displacement x (px)" in outcome.stdout
    content = json.loads(output.read_text())
    assert content["camera_noise"]["std"] == pytest.approx(np.sqrt(4.0 + 1.0 / 12.0), rel=0.015)
    assert content["camera_noise"]["num_images"] == 3
    floor = content["noise_floor"]
    assert floor["num_images"] == 2
    assert set(floor["components"]) == {"x", "y", "exx", "eyy", "exy"}
    assert all(0.0 < each["std"] < 0.1 for each in floor["components"].values())
    assert picture.read_bytes().startswith(b"\x89PNG")
    before = contents(folder)
    outcome = RUNNER.invoke(app, ["noise", *files, *options])
    assert outcome.exit_code == 2
    assert "this file exists and was not changed" in outcome.stderr
    assert contents(folder) == before


def test_the_command_ends_with_status_3_if_the_images_moved(folder: Path) -> None:
    outcome = RUNNER.invoke(app, ["noise", str(folder / "static0.png"), str(folder / "moved.png")])
    assert outcome.exit_code == 3, outcome.output
    assert "Doubtful: the images moved by 0.059 px: the noise reads 12% too high" in outcome.stderr


def test_the_command_takes_a_mesh_and_a_camera(folder: Path) -> None:
    camera = fedic.FrontParallel(10.0, (0.0, 160.0))
    fedic.write_camera(camera, folder / "camera.toml")
    fedic.rectangle_mesh((2.0, 2.0, 14.0, 14.0), 2.0).write(folder / "mesh.vtu")
    files = [str(folder / f"static{number}.png") for number in range(2)]
    options = ["--mesh", str(folder / "mesh.vtu"), "--camera", str(folder / "camera.toml")]
    outcome = RUNNER.invoke(app, ["noise", *files, *options, "--output", str(folder / "n.json")])
    assert outcome.exit_code == 0, outcome.output
    floor = json.loads((folder / "n.json").read_text())["noise_floor"]
    assert floor["num_nodes"] == 49
    assert floor["unit"] is None
    assert floor["components"]["x"]["std"] < 0.01


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["static0.png"], "1 image was given"),
        (["static0.png", "static0.png"], "equals the one before"),
        (["static0.png", "missing.png"], "missing.png"),
        (["static0.png", "static1.png", "--camera", "c.toml"], "--camera needs --mesh"),
        (["static0.png", "static1.png", "--mesh", "m.inp", "--config", "test.toml"], "not both"),
        (["static0.png", "static1.png", "--output", "n.txt"], "cannot be written as '.txt'"),
        (["static0.png", "static1.png", "--output", "none/n.json"], "the folder none does not exist"),
        (["static0.png", "static1.png", "--picture", "static0.png"], "would replace an input image"),
    ],
)
def test_the_command_names_what_is_wrong(
    folder: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(folder)
    before = contents(folder)
    outcome = RUNNER.invoke(app, ["noise", *arguments])
    assert outcome.exit_code == 2
    assert message in outcome.stderr
    assert contents(folder) == before
