"""``fedic run`` replaces no file that it reads."""

import os
from pathlib import Path

import numpy as np
import pytest

import fedic
from scenes.runs import contents, run, write_run

MESH_FILE = '[mesh]\nfile = "{}"\n'


def write_mesh(path: Path) -> None:
    images = [fedic.synthetic.render(fedic.synthetic.Speckle(3.0), fedic.ImageFrame(), (96, 120))] * 2
    fedic.correlate(*images, fedic.rectangle_mesh((24, 24, 96, 72), size=12)).write(path)


def check_refused(config: Path, *words: str) -> None:
    """Check that the run is refused, with and without ``--overwrite``, and changes nothing."""
    before = contents(config.parent)
    for arguments in ((), ("--overwrite",)):
        outcome = run(config, *arguments)
        assert outcome.exit_code == 2, outcome.output
        assert outcome.stderr.startswith("fedic: ")
        for word in ("output.folder", "input", *words):
            assert word in outcome.stderr, outcome.stderr
        assert contents(config.parent) == before


@pytest.mark.parametrize("output", [".", "", "../{name}", "sub/.."])
def test_a_mesh_named_like_an_image_is_not_replaced(tmp_path: Path, output: str) -> None:
    (tmp_path / "sub").mkdir()
    write_mesh(tmp_path / "specimen.vtu")
    place = output.format(name=tmp_path.name)
    config = write_run(tmp_path, ["specimen.png"], mesh=MESH_FILE.format("specimen.vtu"), output=place)
    check_refused(config, "specimen.vtu", "mesh.file")


def test_images_named_like_pictures_are_not_replaced(tmp_path: Path) -> None:
    for other in ("x_residual.png", "x_displacement_y.png", "mesh.png"):
        (tmp_path / other).mkdir()
        config = write_run(tmp_path / other, ["x.png", other], output=".", pictures=True)
        check_refused(config, other, "images.deformed")
    # Without pictures nothing is in the way.
    config = write_run(tmp_path / "free", ["x.png", "x_residual.png"], output=".")
    assert run(config).exit_code == 0


def test_the_reference_the_camera_and_the_configuration_are_not_replaced(tmp_path: Path) -> None:
    folder = tmp_path / "camera"
    camera = '[camera]\nfile = "x.npz"\n'
    config = write_run(folder, ["x.png"], output=".", more=camera)
    np.savez(folder / "x.npz", K=np.diag([1.0, 1.0, 1.0]), D=np.zeros(4), R=np.eye(3), T=[0.0, 0.0, 1.0])
    check_refused(config, "x.npz", "camera.file")
    config = write_run(tmp_path / "config", ["x.png"], output=".").rename(tmp_path / "config" / "summary.json")
    check_refused(config, "summary.json", "this configuration")
    config = write_run(tmp_path / "reference", ["x.png"], output=".", pictures=True)
    (config.parent / "ref.png").rename(config.parent / "mesh.png")
    config.write_text(config.read_text().replace("ref.png", "mesh.png"))
    check_refused(config, "mesh.png", "images.reference")


def test_links_lead_to_the_same_files(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    write_mesh(tmp_path / "data" / "x.vtu")
    (tmp_path / "results").symlink_to(tmp_path / "data")
    config = write_run(tmp_path, ["x.png"], mesh=MESH_FILE.format("data/x.vtu"), output="results")
    check_refused(config, "mesh.file")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "x.vtu").symlink_to(tmp_path / "data" / "x.vtu")
    check_refused(write_run(tmp_path, ["x.png"], mesh=MESH_FILE.format("data/x.vtu"), output="other"), "mesh.file")
    (tmp_path / "linked.vtu").symlink_to(tmp_path / "data" / "x.vtu")
    check_refused(write_run(tmp_path, ["x.png"], mesh=MESH_FILE.format("linked.vtu"), output="data"), "mesh.file")
    (tmp_path / "hard").mkdir()
    os.link(tmp_path / "data" / "x.vtu", tmp_path / "hard" / "x.vtu")
    check_refused(write_run(tmp_path, ["x.png"], mesh=MESH_FILE.format("data/x.vtu"), output="hard"), "mesh.file")


def test_an_earlier_result_that_is_read_now_is_not_removed(tmp_path: Path) -> None:
    assert run(write_run(tmp_path, ["x.png"])).exit_code == 0
    config = write_run(tmp_path, ["y.png"], mesh=MESH_FILE.format("out/x.vtu"))
    before = contents(tmp_path)
    outcome = run(config, "--overwrite")
    assert outcome.exit_code == 2
    assert "is a result of an earlier run" in outcome.stderr
    assert contents(tmp_path) == before


@pytest.mark.parametrize("name", ["x.vtu", "x.npz", "summary.json", "mesh.png"])
def test_a_folder_in_the_place_of_a_result_is_refused(tmp_path: Path, name: str) -> None:
    config = write_run(tmp_path, ["x.png"], pictures=True)
    (tmp_path / "out" / name).mkdir(parents=True)
    outcome = run(config, "--overwrite")
    assert outcome.exit_code == 2
    assert "another kind of file" in outcome.stderr
    assert [path.name for path in (tmp_path / "out").iterdir()] == [name]


@pytest.mark.parametrize("output", ["file", "file/below"])
def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path, output: str) -> None:
    config = write_run(tmp_path, ["x.png"], output=output)
    (tmp_path / "file").write_text("kept")
    outcome = run(config, "--overwrite")
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("fedic: ")
    assert (tmp_path / "file").read_text() == "kept"
