"""The command ``fedic advise``."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import fedic
from fedic.cli import app
from scenes.runs import write_image
from scenes.static import scene, shot

RUNNER = CliRunner()


@pytest.fixture
def image(tmp_path: Path) -> Path:
    write_image(tmp_path / "reference.png", shot(scene((200, 220)), 1))
    return tmp_path / "reference.png"


def test_tables_files_and_recommendation(image: Path) -> None:
    output, picture = image.with_name("advice.json"), image.with_name("advice.png")
    options = ["--noise", "2.0", "--size", "8", "--size", "16", "--output", str(output), "--picture", str(picture)]
    outcome = RUNNER.invoke(app, ["advise", str(image), *options])
    assert outcome.exit_code == 0, outcome.output
    assert "Recommended: elements of 16 px" in outcome.stdout
    assert "speckle size" in outcome.stdout
    assert json.loads(output.read_text())["recommended_px"] == 16.0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert RUNNER.invoke(app, ["advise", str(image), *options]).exit_code == 2


def test_status_3_if_no_size_meets_the_target(image: Path) -> None:
    outcome = RUNNER.invoke(app, ["advise", str(image), "--noise", "2", "--size", "12", "--target", "0.0001"])
    assert outcome.exit_code == 3, outcome.output
    assert "No size has a standard deviation of at most 0.0001 px" in outcome.stdout
    assert "Doubtful: no size up to 12 px" in outcome.stderr


def test_the_region_is_the_box_around_a_mesh(image: Path) -> None:
    mesh, camera = image.with_name("mesh.vtu"), image.with_name("camera.toml")
    fedic.rectangle_mesh((3.0, 4.0, 15.0, 14.0), 1.0).write(mesh)
    fedic.write_camera(fedic.FrontParallel(10.0, (0.0, 200.0)), camera)
    output = image.with_name("advice.json")
    options = ["--noise", "2", "--size", "16", "--mesh", str(mesh), "--camera", str(camera), "--output", str(output)]
    outcome = RUNNER.invoke(app, ["advise", str(image), *options])
    assert outcome.exit_code == 0, outcome.output
    assert json.loads(output.read_text())["region"] == [30, 60, 151, 161]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--region", "0", "0", "900", "100"], "within the image"),
        (["--camera", "c.toml"], "--camera needs --mesh"),
        (["--mesh", "m.inp", "--region", "0", "0", "100", "100"], "not both"),
        (["--cell", "quod"], "cell must be one of"),
    ],
)
def test_what_is_wrong_is_named(image: Path, options: list[str], message: str) -> None:
    outcome = RUNNER.invoke(app, ["advise", str(image), "--noise", "2", *options])
    assert outcome.exit_code == 2
    assert message in outcome.stderr
