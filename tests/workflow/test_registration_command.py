"""The files a registration writes, and the command `fedic register`."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

import fedic
from fedic.cli import app
from scenes.placed_plate import BOARD, BOUNDARY, FRONT, MESH, PINHOLE, POINTS, TILTED, off, plate
from scenes.plate import wrong


@pytest.fixture(scope="module")
def found() -> fedic.Registration:
    some = POINTS[[0, 11]], FRONT.project(POINTS[[0, 11]])
    return fedic.register(MESH, plate(FRONT, 0.02), FRONT, features=["hole 0", "left", "top"], points=some)


class TestWritten:
    def test_the_camera_file_holds_pose_and_deviations(self, found: fedic.Registration, tmp_path: Path) -> None:
        path = found.write(tmp_path / "camera.toml")
        assert fedic.read_camera(path) == found.camera
        assert "std_angle = " in path.read_text()
        assert "median_distance_hole_0 = " in path.read_text()
        with pytest.raises(fedic.CameraError, match="overwrite"):
            found.write(path)

    def test_the_plot_is_written_as_png(self, found: fedic.Registration, tmp_path: Path) -> None:
        found.plot(tmp_path / "registration.png")
        assert cv2.imread(str(tmp_path / "registration.png")).shape[0] > 300
        with pytest.raises(fedic.FedicError, match="png only"):
            found.plot(tmp_path / "registration.pdf")


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        cv2.imwrite(str(tmp_path / "plate.png"), plate(FRONT, 0.02))
        fedic.write_camera(wrong(FRONT, (1, 1, 1, 1)), tmp_path / "rough.toml")
        import meshio

        points = np.column_stack([MESH.points, np.zeros(MESH.num_nodes)])
        meshio.Mesh(points, [("quad", MESH.cells["quad"])]).write(tmp_path / "plate.vtu")
        np.savetxt(tmp_path / "pairs.csv", np.column_stack([POINTS, FRONT.project(POINTS)]), delimiter=",")
        return tmp_path

    def run(self, folder: Path, *options: str) -> Any:
        files = [str(folder / name) for name in ("plate.vtu", "plate.png", "rough.toml")]
        return CliRunner().invoke(app, ["register", *files, "--output", str(folder / "camera.toml"), *options])

    def test_registration_from_features(self, folder: Path) -> None:
        features = [word for name in BOUNDARY for word in ("--feature", name)]
        outcome = self.run(folder, *features, "--picture", str(folder / "mesh.png"))
        assert outcome.exit_code == 0, outcome.output
        assert "hole 0" in outcome.output
        assert off(fedic.read_camera(folder / "camera.toml"), FRONT).max() < 0.6
        assert (folder / "mesh.png").exists()
        again = self.run(folder, *features)
        assert again.exit_code == 2
        assert "overwrite" in again.output
        assert self.run(folder, *features, "--overwrite").exit_code == 0

    def test_plots_do_not_overwrite_files(self, folder: Path) -> None:
        options = ["--points", str(folder / "pairs.csv"), "--picture"]
        (folder / "old.png").write_bytes(b"kept")
        measured = (folder / "plate.png").read_bytes()
        for more, name, message in (
            ([], "old.png", "old.png: this file exists and was not changed; --overwrite replaces it"),
            ([], "plate.png", "plate.png: the picture would replace an input image"),
            (["--overwrite"], "plate.png", "plate.png: the picture would replace an input image"),
            ([], "no/new.png", "no does not exist; make it first"),
        ):
            outcome = self.run(folder, *options, str(folder / name), *more)
            assert outcome.exit_code == 2
            assert message in outcome.output
            assert not (folder / "camera.toml").exists()
        assert (folder / "old.png").read_bytes() == b"kept"
        assert (folder / "plate.png").read_bytes() == measured
        assert self.run(folder, *options, str(folder / "old.png"), "--overwrite").exit_code == 0
        assert cv2.imread(str(folder / "old.png")) is not None

    @pytest.mark.parametrize("name", ["old.png", "plate.png"])
    def test_plots_of_a_calibration_do_not_overwrite_files(self, folder: Path, name: str) -> None:
        (folder / "old.png").write_bytes(b"kept")
        before = (folder / name).read_bytes()
        files = ["--output", str(folder / "camera.toml"), "--picture", str(folder / name)]
        outcome = CliRunner().invoke(app, ["calibrate", str(folder / "plate.png"), "--target", BOARD, *files])
        assert outcome.exit_code == 2
        assert f"{name}: th" in outcome.output
        assert (folder / name).read_bytes() == before

    @pytest.mark.parametrize(
        ("start", "message"),
        [
            (FRONT, "can hold a Pinhole only, not a FrontParallel; write .toml"),
            (fedic.Pinhole((900, 905), (300, 200), TILTED, (0, 0, 100.0), skew_angle=1.57), "ignores the skew"),
        ],
        ids=["front", "skew"],
    )
    @pytest.mark.parametrize("suffix", [".yml", ".xml"])
    def test_an_output_format_that_cannot_hold_the_camera_is_refused_first(
        self, folder: Path, start: Any, message: str, suffix: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("fedic.registration.register", lambda *_, **__: pytest.fail("the work was begun"))
        fedic.write_camera(start, folder / "rough.toml", overwrite=True)
        outcome = self.run(
            folder, "--points", str(folder / "pairs.csv"), "--overwrite", "--output", str(folder / f"camera{suffix}")
        )
        assert outcome.exit_code == 2
        assert message in outcome.output

    def test_an_opencv_file_is_written(self, folder: Path) -> None:
        fedic.write_camera(PINHOLE, folder / "rough.toml", overwrite=True)
        np.savetxt(folder / "pairs.csv", np.column_stack([POINTS, PINHOLE.project(POINTS)]))
        outcome = self.run(folder, "--points", str(folder / "pairs.csv"), "--output", str(folder / "camera.yml"))
        assert outcome.exit_code == 0, outcome.output
        assert off(fedic.read_camera(folder / "camera.yml"), PINHOLE).max() < 1e-6

    def test_registration_from_points(self, folder: Path) -> None:
        outcome = self.run(folder, "--points", str(folder / "pairs.csv"))
        assert outcome.exit_code == 0, outcome.output
        assert off(fedic.read_camera(folder / "camera.toml"), FRONT).max() < 1e-6

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ([], "hole 0: circle"),
            (["--feature", "rim"], "no boundary part 'rim'"),
            (["--points", "nothing.csv"], "nothing.csv"),
            (["--feature", "hole 0", "--picture", "mesh.pdf"], "png only"),
        ],
    )
    def test_errors_exit_with_code_two(self, folder: Path, options: list[str], message: str) -> None:
        outcome = self.run(folder, *options)
        assert outcome.exit_code == 2
        assert message in outcome.output
        assert not (folder / "camera.toml").exists()
