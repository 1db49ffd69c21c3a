"""Processes that end well: killed and interrupted runs, and the process of Gmsh."""

import json
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import meshio
import numpy as np
import pytest

import fedic
from interruption import interrupt, read_line, script
from scenes.runs import run, write_run

_COMMAND = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from fedic.cli import app
app(sys.argv[1:])
"""


def command(*arguments: str) -> subprocess.Popen[str]:
    """Start ``fedic`` in a process of its own, which SIGINT reaches even if this one ignores it."""
    return subprocess.Popen(
        [sys.executable, "-c", _COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def check_whole(folder: Path) -> None:
    """Check that every file in a folder can be read, and that the summary names files that are there."""
    for path in folder.iterdir():
        if path.name.startswith(".fedic-"):
            continue
        if path.suffix == ".npz":
            assert np.load(path)["displacement"].shape[1] == 2
        elif path.suffix == ".vtkhdf":
            assert all(not record.error for record in fedic.load(path).frames)
        elif path.suffix == ".vtu":
            assert len(meshio.read(path).points)
        elif path.suffix == ".png":
            assert fedic.read_image(path).size
        else:
            for frame in json.loads(path.read_text())["frames"]:
                assert (folder / f"{frame['name']}.vtu").exists()
                assert (folder / f"{frame['name']}.npz").exists()


@pytest.mark.parametrize("pictures", [False, True])
def test_a_killed_run_leaves_whole_files_and_the_next_run_cleans_up(tmp_path: Path, pictures: bool) -> None:
    """Killed while it writes: once before the first frame and then after some of them."""
    config = write_run(tmp_path, [f"f{number}.png" for number in range(8)], pictures=pictures)
    out = tmp_path / "out"
    for frames in (0, 1, 4):
        with command("run", str(config), "--overwrite") as process:
            assert process.stdout is not None
            for _ in range(frames):
                assert process.stdout.readline()
            while not (frames or (out / "summary.json").exists()):
                assert process.poll() is None
                time.sleep(0.01)
            process.send_signal(signal.SIGKILL)
        check_whole(out)
    (out / f".fedic-{'0' * 32}.png").touch()
    assert run(config, "--overwrite").exit_code == 0
    assert not [path for path in out.iterdir() if path.name.startswith(".")]
    check_whole(out)


@pytest.mark.parametrize("moment", ["at the start", "during a frame"])
def test_ctrl_c_ends_a_run_with_status_130(tmp_path: Path, moment: str) -> None:
    config = write_run(tmp_path, [f"f{number}.png" for number in range(60)])
    with command("run", str(config)) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        if moment == "at the start":
            while not (tmp_path / "out").exists():
                time.sleep(0.01)
        else:
            assert process.stdout.readline()
        interrupt(process)
        errors = process.stderr.read()
        assert process.wait() == 130
    assert "Traceback" not in errors
    assert "fedic: interrupted" in errors
    check_whole(tmp_path / "out")


def test_ctrl_c_while_the_command_is_imported_ends_it_with_status_130() -> None:
    """The interruption arrives while the module of the application is loaded."""
    code = """
        import sys
        class Interrupted:
            def find_spec(self, name, path=None, target=None):
                if name == "fedic.cli._app":
                    raise KeyboardInterrupt
        sys.meta_path.insert(0, Interrupted())
        from fedic.cli import app
    """
    with script(code) as process:
        assert process.wait() == 130


@pytest.mark.usefixtures("gmsh")
@pytest.mark.skipif(sys.platform != "linux", reason="looks for the process in /proc")
def test_ctrl_c_ends_gmsh() -> None:
    """Four million triangles take Gmsh minutes."""
    child = """
        import fedic
        print("meshing", flush=True)
        try:
            fedic.unstructured_mesh([(0, 0), (1, 0), (1, 1), (0, 1)], 0.00076)
        except KeyboardInterrupt:
            print(seconds_since_signal(), flush=True)
    """
    with script(child) as process:
        assert read_line(process) == "meshing"
        while not (begun := _children(process.pid)):
            time.sleep(0.05)
        time.sleep(2.0)
        interrupt(process)
        assert float(read_line(process)) < 2.0
        assert process.wait() == 0
        assert not [each for each in begun if _runs(each)]


@pytest.mark.usefixtures("gmsh")
@pytest.mark.skipif(sys.platform != "linux", reason="looks for the process in /proc")
def test_gmsh_ends_with_a_killed_parent() -> None:
    child = """
        import fedic
        print("meshing", flush=True)
        fedic.unstructured_mesh([(0, 0), (1, 0), (1, 1), (0, 1)], 0.00076)
    """
    with script(child) as process:
        assert read_line(process) == "meshing"
        while not (begun := _children(process.pid)):
            time.sleep(0.05)
        time.sleep(1.0)
        process.kill()
        process.wait()
        deadline = time.monotonic() + 30.0
        while any(map(_runs, begun)) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not any(map(_runs, begun))


@pytest.mark.usefixtures("gmsh")
def test_threads_mesh_at_the_same_time() -> None:
    made: list[fedic.Mesh] = []
    square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
    threads = [threading.Thread(target=lambda: made.append(fedic.unstructured_mesh(square, 1.0))) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(made[0].points, made[1].points)


def _children(parent: int) -> list[int]:
    return [int(pid) for pid in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()]


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False
