"""The output folder of ``fedic run``: results of one run only, and faults that end one frame only."""

import errno
import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fedic
import fedic.campaign.series
import fedic.campaign.setup
import fedic.io.mesh_formats.vtk
from fedic.campaign import load_config, measure_series
from scenes.runs import contents, run, speckle, write_image, write_run


def names(folder: Path) -> set[str]:
    """Names of the files of a folder, but that of all frames."""
    found = {path.name for path in folder.iterdir()}
    assert "results.vtkhdf" in found
    return found - {"results.vtkhdf"}


def frames(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "out" / "summary.json").read_text())["frames"]
    return found


def test_frames_are_measured_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    images = [f"frame_{number}.png" for number in range(1, 12)]
    config = write_run(tmp_path, images, deformed='"*.png"')
    outcome = run(config)
    assert outcome.exit_code == 0, outcome.output
    assert [Path(frame["image"]).name for frame in frames(tmp_path)] == images
    assert "ref.png: the reference image, left out" in outcome.stderr
    # Frame by frame the specimen moves on.
    shifts = [np.load(tmp_path / "out" / f"frame_{n}.npz")["displacement"][:, 0].mean() for n in range(1, 12)]
    np.testing.assert_allclose(shifts, 0.3 * np.arange(1, 12), atol=0.02)


def test_results_are_not_replaced_unless_asked_for(tmp_path: Path) -> None:
    config = write_run(tmp_path, ["a.png"])
    assert run(config).exit_code == 0
    before = contents(tmp_path)
    outcome = run(config)
    assert outcome.exit_code == 0
    assert "1 of 1 frames had been measured before" in outcome.stdout
    assert contents(tmp_path) == before
    config.write_text(config.read_text().replace("size = 12.0", "size = 16.0"))
    outcome = run(config)
    assert outcome.exit_code == 2
    assert "these results are of another campaign: mesh differ" in outcome.stderr
    (tmp_path / "out" / "results.vtkhdf").rename(tmp_path / "results.vtkhdf")
    outcome = run(config)
    assert outcome.exit_code == 2
    assert "holds results already" in outcome.stderr
    assert "--overwrite" in outcome.stderr
    assert run(config, "--overwrite").exit_code == 0
    assert contents(tmp_path / "out").keys() == {Path(name).name for name in before if name.startswith("out/")}


def test_nothing_of_the_older_run_stays(tmp_path: Path) -> None:
    assert run(write_run(tmp_path, ["a.png", "b.png", "c.png"], pictures=True)).exit_code == 0
    (tmp_path / "out" / "notes.txt").write_text("kept")
    (tmp_path / "out" / "b_mine.png").write_text("kept")
    config = write_run(tmp_path, ["b.png", "d.png"])
    (tmp_path / "b.png").write_bytes(b"damaged")
    assert run(config, "--overwrite").exit_code == 2
    assert names(tmp_path / "out") == {"notes.txt", "b_mine.png", "summary.json", "d.vtu", "d.npz"}


def test_only_results_in_the_folder_are_removed(tmp_path: Path) -> None:
    config = write_run(tmp_path, ["a.png"])
    (tmp_path / "out").mkdir()
    (tmp_path / "kept.png").write_text("kept")
    listed = ["../kept.png", str(tmp_path / "kept.png"), "..", ".", "", 3, None, "notes.txt", "x\0.png", "old.vtu"]
    (tmp_path / "out" / "summary.json").write_text(json.dumps({"files": listed}))
    for name in ("notes.txt", "old.vtu"):
        (tmp_path / "out" / name).write_text("older")
    assert run(config, "--overwrite").exit_code == 0
    assert (tmp_path / "kept.png").read_text() == "kept"
    assert names(tmp_path / "out") == {"notes.txt", "summary.json", "a.vtu", "a.npz"}


@pytest.mark.parametrize("content", ["", "[1, 2]", "{", "[" * 10000, '{"files": 3}', "\udcff"])
def test_a_summary_of_another_program_lists_nothing(tmp_path: Path, content: str) -> None:
    config = write_run(tmp_path, ["a.png"])
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "summary.json").write_bytes(content.encode("utf-8", "surrogateescape"))
    assert run(config).exit_code == 2
    assert run(config, "--overwrite").exit_code == 0


def test_the_older_results_are_kept_if_the_run_cannot_begin(tmp_path: Path) -> None:
    assert run(write_run(tmp_path, ["a.png"])).exit_code == 0
    before = contents(tmp_path / "out")
    config = write_run(tmp_path, ["b.png"])
    (tmp_path / "ref.png").write_bytes(b"damaged")
    assert run(config, "--overwrite").exit_code == 2
    assert contents(tmp_path / "out") == before


def test_unfinished_files_of_a_killed_run_are_removed(tmp_path: Path) -> None:
    config = write_run(tmp_path, ["a.png"])
    out = tmp_path / "out"
    out.mkdir()
    (out / f".fedic-{'0' * 32}.png").touch()
    (out / f".fedic-{'a' * 32}").touch()
    (out / ".fedic-notes.png").touch()
    assert run(config).exit_code == 0
    assert names(out) == {".fedic-notes.png", "summary.json", "a.vtu", "a.npz"}


def test_images_of_one_name_have_results_of_their_own(tmp_path: Path) -> None:
    config = write_run(tmp_path, ["left/x.png", "right/x.png", "right/X.png", "y.png"])
    outcome = run(config)
    assert outcome.exit_code == 0, outcome.output
    assert [frame["name"] for frame in frames(tmp_path)] == ["x_1", "x_2", "X_3", "y"]
    assert "x.png (as x_2): converged" in outcome.stdout
    for number, name in enumerate(["x_1", "x_2", "X_3", "y"], start=1):
        shift = np.load(tmp_path / "out" / f"{name}.npz")["displacement"][:, 0].mean()
        assert shift == pytest.approx(0.3 * number, abs=0.02)


@pytest.mark.parametrize(("length", "pictures"), [(250, False), (251, True), (240, True)])
def test_a_name_too_long_for_its_results_fails_one_frame(tmp_path: Path, length: int, pictures: bool) -> None:
    long = "n" * length + ".png"
    if length > 250:
        long = "n" * length
    config = write_run(tmp_path, ["a.png", long, "b.png"], pictures=pictures)
    outcome = run(config)
    kept = not pictures and length + len(".vtu") <= os.pathconf(tmp_path, "PC_NAME_MAX")
    assert outcome.exit_code == (0 if kept else 2), outcome.output
    assert ["error" in frame for frame in frames(tmp_path)] == [False, not kept, False]
    assert kept or "rename the image" in frames(tmp_path)[1]["error"]
    assert any(name.startswith("nn") for name in names(tmp_path / "out")) == kept


def test_a_full_disk_fails_the_frames_that_do_not_fit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = fedic.io.mesh_formats.vtk.write_vtu
    written: list[Path] = []

    def full(path: Path, *arguments: Any) -> None:
        written.append(path)
        if len(written) == 2:
            path.write_bytes(b"part")
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(path, *arguments)

    monkeypatch.setattr(fedic.io.mesh_formats.vtk, "write_vtu", full)
    outcome = run(write_run(tmp_path, ["a.png", "b.png", "c.png"]))
    assert outcome.exit_code == 2
    assert "No space left on device" in outcome.stderr
    assert names(tmp_path / "out") == {"summary.json", "a.vtu", "a.npz", "c.vtu", "c.npz"}


def test_a_frame_that_fails_halfway_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(fedic.campaign.series, "plot_residual", full)
    outcome = run(write_run(tmp_path, ["a.png"], pictures=True))
    assert outcome.exit_code == 2
    assert "not enough memory" in outcome.stderr
    assert names(tmp_path / "out") == {"summary.json", "mesh.png"}


def test_a_summary_that_cannot_be_written_once_does_not_end_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = fedic.campaign.series.write_json
    broken = {2}
    calls: list[Path] = []

    def full(path: Path, content: dict[str, Any]) -> None:
        calls.append(path)
        if len(calls) in broken:
            raise fedic.FedicError("summary: no space")
        write(path, content)

    monkeypatch.setattr(fedic.campaign.series, "write_json", full)
    config = write_run(tmp_path, ["a.png", "b.png"])
    assert run(config).exit_code == 0
    assert [frame["name"] for frame in frames(tmp_path)] == ["a", "b"]
    broken = {6}
    outcome = run(config, "--overwrite")
    assert outcome.exit_code == 2
    assert "summary: no space" in outcome.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="needs a folder in which not even root can write")
def test_a_folder_that_cannot_be_written_ends_the_run_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fedic.campaign.setup, "Correlator", None)
    for output in ("/proc", "/proc/fedic"):
        outcome = run(write_run(tmp_path, ["a.png"], output=output))
        assert outcome.exit_code == 2
        assert outcome.stderr.startswith("fedic: /proc")


def test_images_that_vanish_or_break_during_the_run_are_named(tmp_path: Path) -> None:
    images = [f"f{number}.png" for number in range(12)]
    config = load_config(write_run(tmp_path, images))
    series = measure_series(config)
    done = [next(series)]
    # A few frames are read ahead.
    (tmp_path / "f5.png").unlink()
    (tmp_path / "f7.png").write_bytes(b"")
    (tmp_path / "f8.png").write_bytes((tmp_path / "f9.png").read_bytes()[:500])
    (tmp_path / "f10.png").unlink()
    (tmp_path / "f10.png").mkdir()
    with pytest.raises(fedic.FedicError, match=r"4 of 12 frames failed, the first being f5\.png"):
        done.extend(series)
    assert [frame.image.name for frame in done if frame.error] == ["f5.png", "f7.png", "f8.png", "f10.png"]
    measured = {"f0", "f1", "f2", "f3", "f4", "f6", "f9", "f11"}
    assert {path.stem for path in (tmp_path / "out").glob("*.vtu")} == measured


def test_strange_names_are_measured(tmp_path: Path) -> None:
    strange = ["a b", "=1+1", "<b>&", "..tif", "-dash", "new\nline", "\x1b[31mred", "im[red]4", "\u202eright", "\udcff"]
    config = write_run(tmp_path, [], deformed='["images/*", "images/..tif.png"]')
    for name in strange:
        write_image(tmp_path / "images" / f"{name}.png", speckle(0.5))
    outcome = run(config)
    assert outcome.exit_code == 0, outcome.output
    assert names(tmp_path / "out") == {
        "summary.json",
        *(f"{name}{end}" for name in strange for end in (".vtu", ".npz")),
    }
    for text in ("im[red]4.png: ", r"new\nline.png: ", r"\x1b[31mred.png: ", r"\u202eright.png: ", r"\udcff.png: "):
        assert text in outcome.stdout
    assert "\x1b" not in outcome.output
