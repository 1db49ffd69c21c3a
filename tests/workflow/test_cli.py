"""The command line: runs, the demo, progress and errors."""

import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

import fedic
import fedic.campaign.series
import fedic.demo
from fedic.cli import app
from fedic.cli.progress import TerminalProgress

RUNNER = CliRunner()

CONFIG = """\
[images]
reference = "reference.png"
deformed = ["moved.png", "reference.png"]
[mesh.rectangle]
size = 20.0
bounds = [30, 30, 170, 130]
[output]
folder = "out"
files = ["vtu", "npz"]
"""


@pytest.fixture
def folder(tmp_path: Path, speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> Path:
    for name, image in zip(("reference", "moved"), speckle_pair, strict=True):
        assert cv2.imwrite(str(tmp_path / f"{name}.png"), image)
    (tmp_path / "test.toml").write_text(CONFIG)
    return tmp_path


def test_version_is_printed() -> None:
    outcome = RUNNER.invoke(app, ["--version"])
    assert (outcome.exit_code, outcome.output) == (0, f"fedic {fedic.__version__}\n")


def test_run_ends_with_status_3_if_a_frame_is_doubtful(folder: Path) -> None:
    moved = cv2.imread(str(folder / "moved.png"), cv2.IMREAD_GRAYSCALE)
    assert moved is not None
    moved[60:100, 80:130] = 10
    assert cv2.imwrite(str(folder / "moved.png"), moved)
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 3, outcome.output
    assert "1 of 2 frames did not converge or are doubtful, the first being moved.png" in outcome.output
    frames = json.loads((folder / "out" / "summary.json").read_text())["frames"]
    assert [frame["quality"]["good"] for frame in frames] == [False, True]
    assert frames[0]["quality"]["flagged_cells"]["uncorrelated"] > 0
    assert not np.load(folder / "out" / "moved.npz")["good"]
    assert b'Name="good"' in (folder / "out" / "moved.vtu").read_bytes()


def test_run_ends_with_status_3_if_a_frame_does_not_converge(folder: Path) -> None:
    text = (folder / "test.toml").read_text() + '[correlation]\nmax_iterations = 1\ninitial = "zero"\n'
    (folder / "test.toml").write_text(text)
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 3, outcome.output
    assert "NOT CONVERGED" in outcome.output


def test_run_writes_the_results(folder: Path) -> None:
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 0, outcome.output
    out = folder / "out"
    assert {path.name for path in out.iterdir()} == {
        "mesh.png",
        "results.vtkhdf",
        "summary.json",
        *(
            f"{stem}{end}"
            for stem in ("moved", "reference")
            for end in (".vtu", ".npz", "_displacement_x.png", "_displacement_y.png", "_residual.png")
        ),
    }
    summary = json.loads((out / "summary.json").read_text())
    assert summary["fedic"] == fedic.__version__
    assert summary["settings"]["correlation"]["interpolation"] == "bspline5"
    assert [frame["converged"] for frame in summary["frames"]] == [True, True]
    assert "moved.png: converged in" in outcome.stdout


def test_run_maps_large_images_from_their_files(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for stem in ("reference", "moved"):
        image = cv2.imread(str(folder / f"{stem}.png"), cv2.IMREAD_UNCHANGED)
        assert cv2.imwrite(str(folder / f"{stem}.tif"), image, [cv2.IMWRITE_TIFF_COMPRESSION, 1])
    (folder / "test.toml").write_text(CONFIG.replace(".png", ".tif") + "pictures = false\n")
    monkeypatch.setattr("fedic.io.images.tiff.reader._MAPPED_BYTES", 1)
    held = []
    correlate = fedic.Correlator.correlate

    def watched(self: fedic.Correlator, deformed: Any, *arguments: Any, **options: Any) -> fedic.Result:
        held.append([isinstance(image.base, np.memmap) for image in (self._reference, deformed)])
        return correlate(self, deformed, *arguments, **options)

    monkeypatch.setattr(fedic.Correlator, "correlate", watched)
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 0, outcome.output
    assert held == [[True, True]] * 2


def test_a_failed_frame_does_not_stop_the_others(folder: Path) -> None:
    assert cv2.imwrite(str(folder / "moved.png"), np.zeros((10, 10), dtype=np.uint8))
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 2
    assert "1 of 2 frames failed, the first being moved.png" in outcome.stderr
    frames = json.loads((folder / "out" / "summary.json").read_text())["frames"]
    assert "reference image is 200 x 160 px" in frames[0]["error"]
    assert frames[1]["converged"]


def test_errors_are_printed_without_traceback(folder: Path) -> None:
    (folder / "test.toml").write_text(CONFIG.replace("bounds", "bonds"))
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("fedic: ")
    assert 'mesh.rectangle.bonds is not a known key; did you mean "bounds"?' in outcome.stderr
    assert "Traceback" not in outcome.output
    assert not (folder / "out").exists()


def test_finished_frames_survive_an_interruption(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured = []
    correlate = fedic.Correlator.correlate

    def interrupted(self: fedic.Correlator, *args: object, **options: object) -> fedic.Result:
        if measured:
            raise KeyboardInterrupt
        measured.append(True)
        return correlate(self, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(fedic.Correlator, "correlate", interrupted)
    outcome = RUNNER.invoke(app, ["run", str(folder / "test.toml")])
    assert outcome.exit_code == 130
    assert len(json.loads((folder / "out" / "summary.json").read_text())["frames"]) == 1


@pytest.fixture(scope="module")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("readme") / "fedic-demo"
    outcome = RUNNER.invoke(app, ["demo", "--output", str(folder)])
    assert outcome.exit_code == 0, outcome.output
    return folder


def test_the_code_of_the_readme_runs(demo_folder: Path, repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    readme = (repository / "README.md").read_text()
    lines = readme.split("```python\n")[1].split("```")[0]
    monkeypatch.chdir(demo_folder.parent)
    names: dict[str, Any] = {}
    exec(lines, names)
    assert names["result"].converged
    np.testing.assert_allclose(names["result"].displacement.mean(axis=0), (-77.79, 38.90), atol=0.01)
    assert (demo_folder.parent / "displacement.vtu").exists()


def test_the_speckle_of_the_demo_has_the_documented_statistics(demo_folder: Path) -> None:
    """A standard deviation of 58 grey levels and a gradient of 23 per pixel along each axis."""
    image = fedic.read_image(demo_folder / "reference.tif").astype(float)
    assert image.std() == pytest.approx(57.3, abs=0.5)
    assert np.sqrt(np.square(np.gradient(image)).mean()) == pytest.approx(24.0, abs=0.5)


def test_demo_finds_the_bias_of_the_lens(demo_folder: Path) -> None:
    assert {path.name for path in demo_folder.iterdir()} == {
        "demo.json",
        "deformed.tif",
        "error-maps.png",
        "reference.tif",
        "with-lens.vtu",
        "without-lens.vtu",
    }
    found = json.loads((demo_folder / "demo.json").read_text())
    np.testing.assert_allclose(found["with_lens"]["bias_px"], 0.0, atol=2e-4)
    assert max(found["with_lens"]["std_px"]) < 0.0022
    np.testing.assert_allclose(found["without_lens"]["bias_px"], (0.0171, 0.0092), atol=1e-3)
    np.testing.assert_allclose(found["without_lens"]["std_px"], (0.0077, 0.0062), rtol=0.1)


def finish_timers() -> None:
    """Wait for the timers that let the progress line appear."""
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.join()


def test_progress_prints_nothing_unless_stderr_is_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("fedic.cli.progress._DELAY_SECONDS", 0.0)
    with TerminalProgress("frame") as progress:
        progress(fedic.Progress("solve", None, 1, 2, 0.1, 3.0))
        finish_timers()
        progress(fedic.Progress("render", 0.5))
    assert capsys.readouterr() == ("", "")


def test_progress_appears_on_a_terminal_after_the_delay(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("fedic.cli.progress._DELAY_SECONDS", 0.0)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with TerminalProgress("frame") as progress:
        progress(fedic.Progress("pyramid", None, 1, 2, 0.125, 3.0))
        finish_timers()
        progress(fedic.Progress("pyramid", None, 1, 3, 0.0625, 3.0))
    # The line is drawn again when it ends.
    assert "frame: pyramid, level 1, iteration 3: correction 0.062 px, residual 3" in capsys.readouterr().err


def test_progress_prints_nothing_before_the_delay(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("fedic.cli.progress._DELAY_SECONDS", 3600.0)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with TerminalProgress("frame") as progress:
        progress(fedic.Progress("pyramid", None, 1, 2, 0.125, 3.0))
    assert capsys.readouterr() == ("", "")


def test_importing_fedic_loads_no_heavy_modules() -> None:
    heavy = (
        "cv2 gmsh imagecodecs matplotlib meshio pydantic rich scipy tifffile typer fedic.calibration fedic.registration"
    )
    code = f"import fedic, sys; print([name for name in {heavy.split()} if name in sys.modules])"
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert outcome.stdout.strip() == "[]"
