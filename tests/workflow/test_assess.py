"""Assessment of static and rigidly moved frames, and the command ``fedic assess``."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import fedic
from fedic.assess import load_assess_config, measure_poses
from fedic.cli import app
from scenes.runs import contents, write_image
from scenes.static import scene, shot

RUNNER = CliRunner()
SHAPE = (160, 200)
SCALE, SQUARE = 10.0, 4.0
CONFIG = """\
[images]
reference = "reference.png"
[[poses]]
name = "rest"
images = "static_*.png"
displacement = [0.0, 0.0]
rotation = 0.0
[[poses]]
images = ["right.png"]
displacement = [0.15, 0.0]
[[poses]]
images = ["down.png"]
displacement = [0.0, -0.2]
[mesh]
unit = "mm"
[mesh.rectangle]
bounds = [2.0, 2.0, 18.0, 14.0]
size = 2.0
[camera]
model = "front-parallel"
scale = 10.0
origin = [0.0, 160.0]
[assessment]
square = 4.0
set_uncertainty = 0.001
traceability = "micrometer stage 12"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, seed, shift in (
        ("reference", 0, (0.0, 0.0)),
        ("static_1", 1, (0.0, 0.0)),
        ("static_2", 2, (0.0, 0.0)),
        ("right", 3, (1.5, 0.0)),
        ("down", 4, (0.0, 2.0)),
    ):
        write_image(tmp_path / f"{name}.png", shot(scene(SHAPE, shift), seed))
    (tmp_path / "assess.toml").write_text(CONFIG)
    return tmp_path


def test_values_are_those_computed_by_hand_from_the_results(folder: Path) -> None:
    found = measure_poses(load_assess_config(folder / "assess.toml"))
    mesh = fedic.rectangle_mesh((2.0, 2.0, 18.0, 14.0), 2.0)
    camera = fedic.FrontParallel(SCALE, (0.0, 160.0))
    correlator = fedic.Correlator(fedic.read_image(folder / "reference.png"), mesh, camera, unit="mm")
    given = {"static_1": (0.0, 0.0), "static_2": (0.0, 0.0), "right": (0.15, 0.0), "down": (0.0, -0.2)}
    # Squares of two by two cells: means of the bilinear field, which are those of its values at the cells' centres.
    squares, strains, measured = [], [], []
    for name in given:
        result = correlator.correlate(fedic.read_image(folder / f"{name}.png"))
        middles = np.stack(np.meshgrid(np.arange(8) * 2.0 + 3.0, np.arange(6) * 2.0 + 3.0), axis=-1)
        u = result.at(middles.reshape(-1, 2)).reshape(3, 2, 4, 2, 2).mean(axis=(1, 3)).reshape(-1, 2)
        parts = (np.arange(160) + 0.5) / 160 * 16.0 + 2.0, (np.arange(120) + 0.5) / 120 * 12.0 + 2.0
        points = np.stack(np.meshgrid(*parts), axis=-1).reshape(-1, 2)
        e = result.strains(at=points).components.reshape(3, 40, 4, 40, 3).mean(axis=(1, 3)).reshape(-1, 3)
        x = middles.reshape(3, 2, 4, 2, 2).mean(axis=(1, 3)).reshape(-1, 2)
        # The rotation by least squares, of small angles.
        a, b = x - x.mean(axis=0), u - u.mean(axis=0)
        angle = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / (a**2).sum()
        squares.append(b - angle * np.column_stack([-a[:, 1], a[:, 0]]))
        strains.append(e)
        measured.append(u.mean(axis=0))
    all_squares, all_strains = np.concatenate(squares), np.concatenate(strains)
    assert found.zd == pytest.approx(np.sqrt((all_squares**2).sum(axis=1).mean()), rel=1e-4)
    np.testing.assert_allclose(found.zero_displacement[1:], np.sqrt((all_squares**2).mean(axis=0)), rtol=1e-4)
    assert found.zs == pytest.approx(np.sqrt((all_strains**2).mean()), rel=1e-3)
    off = np.array(measured) - np.array(list(given.values()))
    for axis in range(2):
        assert found.along[axis].mean == pytest.approx(off[:, axis].mean(), abs=1e-9)
        assert found.along[axis].standard_deviation == pytest.approx(off[:, axis].std(ddof=1), rel=1e-4)
        assert found.along[axis].largest == pytest.approx(np.abs(off[:, axis]).max(), rel=1e-4)
    assert found.d == pytest.approx(np.abs(off).max(), rel=1e-4)
    assert found.d < 1e-3
    assert (found.num_poses, len(found.readings), found.not_measured, found.squares_left_out) == (3, 4, 0, 0)
    assert found.rotation.num_readings == 2
    assert found.unit == "mm"
    # 0.15 and 0.2 mm that moved the image by 1.5 and 2 px.
    assert found.pixel.size == pytest.approx(0.1, rel=1e-3)
    assert found.pixel.uncertainty == pytest.approx(0.1 * 0.001 / 0.25, rel=0.2)


def test_what_was_not_measured_is_left_out_and_counted() -> None:
    image, moved = shot(scene(SHAPE), 1), shot(scene(SHAPE), 2)
    moved[50:115, 60:120] = 90
    mesh = fedic.rectangle_mesh((20, 20, 180, 140), 20)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = fedic.correlate(image, moved, mesh, initial="zero")
    found = fedic.assess_poses([fedic.Pose("rest", [result], (0.0, 0.0))], square=20.0)
    assert found.not_measured == np.count_nonzero(~result.valid_nodes) > 0
    assert found.squares_left_out > 0
    assert found.readings[0].squares == 48 - found.squares_left_out
    assert found.doubtful == 1
    assert np.isfinite([found.zd, found.zs]).all()


def test_a_set_rotation_is_compared_in_degrees() -> None:
    mesh = fedic.rectangle_mesh((20, 20, 180, 140), 20)
    image = shot(scene(SHAPE), 1)
    result = fedic.correlate(image, shot(scene(SHAPE), 2), mesh)
    found = fedic.assess_poses([fedic.Pose("turned", [result], rotation=360.5)], square=20.0, limits={"rotation": 0.4})
    assert found.rotation.mean == pytest.approx(-0.5, abs=0.05)
    assert found.readings[0].rotation_deviation == pytest.approx(0.5, abs=0.05)
    assert np.isnan(found.d)
    assert not found.within_limits


def test_a_value_that_is_not_known_does_not_hold_its_limit() -> None:
    mesh = fedic.rectangle_mesh((20, 20, 180, 140), 20)
    result = fedic.correlate(shot(scene(SHAPE), 1), shot(scene(SHAPE), 2), mesh)
    found = fedic.assess_poses([fedic.Pose("rest", [result])], square=20.0, limits={"d": 1.0, "zd": 1.0})
    assert [check.holds for check in found.checks] == [False, True]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"poses": []}, "no image to assess"),
        ({"limits": {"zx": 1.0}}, 'one of "zd", "zs", "d", "rotation"'),
        ({"limits": {"zd": -1.0}}, "give a positive number"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, object], message: str) -> None:
    given: dict[str, object] = {"poses": [fedic.Pose("rest", [])], "square": 20.0, **arguments}
    with pytest.raises(fedic.OptionError, match=message):
        fedic.assess_poses(**given)  # type: ignore[arg-type]


@pytest.mark.parametrize(("options", "status"), [([], 0), (["--limit-zd", "0.01"], 0), (["--limit-zd", "1e-6"], 4)])
def test_the_exit_status_says_whether_a_limit_is_exceeded(folder: Path, options: list[str], status: int) -> None:
    outcome = RUNNER.invoke(app, ["assess", str(folder / "assess.toml"), *options])
    assert outcome.exit_code == status, outcome.output
    assert "no claim of conformity" in outcome.stdout
    assert ("A limit is exceeded: zd" in outcome.stderr) == (status == 4)


def test_limits_of_the_configuration_and_files(folder: Path) -> None:
    config = folder / "assess.toml"
    config.write_text(CONFIG + "[limits]\nzd = 0.01\nzs = 1e-6\nd = 0.01\n")
    for name in ("table.md", "table.json"):
        outcome = RUNNER.invoke(app, ["assess", str(config), "--output", str(folder / name)])
        assert outcome.exit_code == 4, outcome.output
    text = (folder / "table.md").read_text()
    assert "no claim of conformity" in text
    assert "micrometer stage 12" in text
    assert "a limit is exceeded" in text
    content = json.loads((folder / "table.json").read_text())
    assert [(each["name"], each["holds"]) for each in content["limits"]] == [("zd", True), ("zs", False), ("d", True)]
    assert content["within_limits"] is False
    assert content["d"]["x"]["num_readings"] == 4
    assert content["setup"]["set displacements"] == "micrometer stage 12"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("square = 4.0", "square = 40.0", "fewer than two squares fit"),
        ("square = 4.0", "sqare = 4.0", 'did you mean "square"'),
        ('images = ["right.png"]', 'images = ["missing.png"]', "poses[1].images names"),
        ('images = ["right.png"]', 'images = "none*.png"', "poses[1].images"),
        ('images = ["right.png"]', 'image = "right.png"', 'poses[1].image is not a known key; did you mean "images"'),
        ("displacement = [0.15, 0.0]", "displacement = [0.15]", "poses[1].displacement"),
        ('"reference.png"', '"absent.png"', "images.reference names"),
        ('unit = "mm"', "unit = 3", "mesh.unit"),
    ],
)
def test_faults_of_the_configuration_are_named(folder: Path, old: str, new: str, message: str) -> None:
    assert old in CONFIG
    (folder / "assess.toml").write_text(CONFIG.replace(old, new))
    before = contents(folder)
    outcome = RUNNER.invoke(app, ["assess", str(folder / "assess.toml"), "--output", str(folder / "t.md")])
    assert outcome.exit_code == 2
    assert message in outcome.stderr
    assert contents(folder) == before
