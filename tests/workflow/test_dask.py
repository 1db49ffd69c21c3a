"""Frames measured on Dask workers: the same results, and runs that outlive lost workers."""

import contextlib
import os
import signal
import subprocess
import sys
import time
import unittest.mock
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import distributed
import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.campaign.cluster import connection, executor
from fedic.campaign.cluster.blocks import Block
from fedic.campaign.cluster.connection import connected
from fedic.campaign.frames.series import SeriesFrame
from interruption import read_line, script
from scenes.runs import contents as files_of
from scenes.runs import run, write_image, write_run

Image = NDArray[np.uint8]
COUNT = 16
MESH = fedic.rectangle_mesh((20, 20, 180, 180), 20)
TOLERANCE = 1e-3
"""Pixels; the iterations end at corrections of that size."""


@pytest.fixture(scope="module")
def images() -> list[Image]:
    """Return the reference image and those of a specimen that moves and stretches."""
    texture, camera = fedic.synthetic.Speckle(4.0, seed=5), fedic.ImageFrame()
    shifts = [(0.4 * k, -0.1 * k) for k in range(COUNT + 1)]
    return [fedic.synthetic.render(texture, camera, (200, 200), displacement=shift) for shift in shifts]  # type: ignore[misc]


@pytest.fixture(scope="module")
def files(images: list[Image], tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("images")
    paths = [folder / f"frame_{k:02d}.png" for k in range(len(images))]
    for path, image in zip(paths, images, strict=True):
        write_image(path, image)
    return paths


@pytest.fixture(scope="module")
def client() -> Iterator[distributed.Client]:
    with connected("local:2") as found:
        yield found


def contents(path: Path) -> dict[str, Any]:
    """Return all datasets and attributes of a file of results but the readings of clocks."""
    found: dict[str, Any] = {}

    def add(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and name != "fedic/frames/seconds":
            found[name] = item[()].tobytes()
        found.update({f"{name}@{key}": np.asarray(value).tobytes() for key, value in item.attrs.items()})

    with h5py.File(path) as file:
        file.visititems(add)
    return found


def assert_same(first: Path, second: Path) -> None:
    one, other = contents(first), contents(second)
    assert [name for name in sorted(one | other) if one.get(name) != other.get(name)] == []


def measured(frames: Any, reference: Any, path: Path | None, cluster: Any = None, **options: Any) -> fedic.Campaign:
    options = {"starts": "independent", **options}
    return fedic.Campaign(reference, frames, MESH, store=path, **options).run(progress=False, cluster=cluster)


def worker_ids(client: distributed.Client) -> list[int]:
    return list(client.run(os.getpid, on_error="ignore").values())


@pytest.mark.parametrize("kind", ["files", "arrays", "stream"])
def test_results_are_those_of_a_serial_run(
    client: distributed.Client, files: list[Path], images: list[Image], tmp_path: Path, kind: str
) -> None:
    source: list[Any] = files if kind == "files" else images

    def frames() -> Any:
        return iter(source[1:]) if kind == "stream" else source[1:]

    serial = measured(frames(), source[0], tmp_path / "serial.vtkhdf")
    campaign = measured(frames(), source[0], tmp_path / "dask.vtkhdf", client)
    assert_same(tmp_path / "serial.vtkhdf", tmp_path / "dask.vtkhdf")
    assert [record.index for record in campaign.frames] == list(range(COUNT))
    assert all(record.seconds > 0 for record in campaign.frames)
    np.testing.assert_array_equal(campaign[3].displacement, serial[3].displacement)


def test_a_run_yields_results_that_know_their_images(
    client: distributed.Client, files: list[Path], images: list[Image]
) -> None:
    reports: list[fedic.Progress] = []
    for source in (files, images):
        campaign = fedic.Campaign(source[0], source[1:4], MESH, starts="independent")
        reports.clear()
        found = list(campaign.measure(cluster=client, progress=reports.append))
        assert [item.record.index for item in found] == [0, 1, 2]
        assert [report.frame for report in reports if report.frames] == [1, 2, 3]
        for item, image in zip(found, images[1:], strict=False):
            assert item.result is not None
            own = fedic.correlate(images[0], image, MESH)
            np.testing.assert_array_equal(item.result.residual_map(), own.residual_map())
            np.testing.assert_array_equal(
                item.result.covariance().standard_deviations, own.covariance().standard_deviations
            )


def test_blocks_do_not_depend_on_the_number_of_workers(
    client: distributed.Client, files: list[Path], tmp_path: Path
) -> None:
    serial = measured(files[1:], files[0], tmp_path / "serial.vtkhdf", starts="extrapolated")
    two = measured(files[1:], files[0], tmp_path / "two.vtkhdf", client, starts="extrapolated")
    measured(files[1:], files[0], tmp_path / "one.vtkhdf", "local:1", starts="extrapolated")
    assert_same(tmp_path / "one.vtkhdf", tmp_path / "two.vtkhdf")
    assert two.frames[1].start == "given"
    assert [record.start == "given" for record in two.frames] == [k % 8 != 0 for k in range(COUNT)]
    differences = [np.abs(serial[k].displacement - two[k].displacement).max() for k in range(COUNT)]
    assert differences[:8] == [0.0] * 8
    assert 0.0 < max(differences) < TOLERANCE


@pytest.mark.parametrize("starts", ["independent", "extrapolated"])
def test_an_interrupted_run_goes_on(client: distributed.Client, files: list[Path], tmp_path: Path, starts: Any) -> None:
    measured(files[1:], files[0], tmp_path / "whole.vtkhdf", client, starts=starts)
    path = tmp_path / "parts.vtkhdf"
    campaign = fedic.Campaign(files[0], files[1:], MESH, store=path, starts=starts)
    with contextlib.closing(campaign.measure(cluster=client)) as run:
        for _ in range(5):
            next(run)
    assert len(campaign) == 5
    again = fedic.Campaign(files[0], files[1:], MESH, store=path, starts=starts)
    assert [item.record.index for item in again.measure(cluster=client)] == list(range(5, COUNT))
    assert_same(tmp_path / "whole.vtkhdf", path)


def test_missing_and_broken_frames_are_named(client: distributed.Client, files: list[Path], tmp_path: Path) -> None:
    broken = tmp_path / "broken.png"
    broken.write_bytes(b"damaged")
    frames = [*files[1:4], tmp_path / "missing.png", broken, np.zeros((10, 10), np.uint8), *files[4:6]]
    with pytest.warns(fedic.QualityWarning, match="3 of 8 frames could not be measured, the first being missing"):
        measured(frames, files[0], tmp_path / "serial.vtkhdf")
    with pytest.warns(fedic.QualityWarning, match="3 of 8 frames could not be measured, the first being missing"):
        campaign = measured(frames, files[0], tmp_path / "dask.vtkhdf", client)
    assert [record.index for record in campaign.frames if record.error] == [3, 4, 5]
    assert_same(tmp_path / "serial.vtkhdf", tmp_path / "dask.vtkhdf")


def test_a_fault_of_a_stream_is_raised_at_its_place(client: distributed.Client, images: list[Image]) -> None:
    def camera() -> Iterator[Image]:
        yield from images[1:4]
        raise ConnectionError("unplugged")

    campaign = fedic.Campaign(images[0], camera(), MESH)
    with pytest.raises(ConnectionError, match="unplugged"):
        campaign.run(progress=False, cluster=client)
    assert len(campaign) == 3


def test_a_killed_worker_costs_no_frame(client: distributed.Client, files: list[Path], tmp_path: Path) -> None:
    measured(files[1:], files[0], tmp_path / "serial.vtkhdf")
    path = tmp_path / "dask.vtkhdf"
    campaign = fedic.Campaign(files[0], files[1:], MESH, store=path, starts="independent")
    for item in campaign.measure(cluster=client):
        if item.record.index == 2:
            os.kill(worker_ids(client)[0], signal.SIGKILL)
    assert_same(tmp_path / "serial.vtkhdf", path)


def test_all_workers_may_be_killed_one_after_the_other(files: list[Path], tmp_path: Path) -> None:
    measured(files[1:], files[0], tmp_path / "serial.vtkhdf")
    path = tmp_path / "dask.vtkhdf"
    campaign = fedic.Campaign(files[0], files[1:], MESH, store=path, starts="independent")
    with connected("local:4") as client:
        client.wait_for_workers(4)
        pids = worker_ids(client)
        for item in campaign.measure(cluster=client):
            if item.record.index % 2 == 0 and pids:
                os.kill(pids.pop(), signal.SIGKILL)
        assert pids == []
    assert_same(tmp_path / "serial.vtkhdf", path)


class _Deadly(distributed.WorkerPlugin):
    """Makes a worker die as soon as it reads a certain frame."""

    def setup(self, worker: Any) -> None:
        from fedic.campaign.cluster import worker as module

        load = module.load
        module.load = lambda frame: os._exit(1) if frame.name == "frame_04" else load(frame)  # type: ignore[assignment]


def test_a_frame_that_kills_its_workers_fails_alone(files: list[Path]) -> None:
    with connected("local:2") as client:
        client.register_plugin(_Deadly())
        with pytest.warns(fedic.QualityWarning, match="1 of 8 frames could not be measured"):
            campaign = measured(files[1:9], files[0], None, client)
    assert [record.name for record in campaign.frames if record.error] == ["frame_04"]
    assert "the worker that measured frame_04 was lost 4 times" in campaign.frames[3].error


def test_frames_that_waited_behind_a_deadly_one_are_measured_again() -> None:
    class Lost:
        status = "error"

        def done(self) -> bool:
            return True

        def result(self, timeout: float) -> None:
            raise distributed.KilledWorker("key", None, 3)

        def release(self) -> None: ...

    class Client:
        def submit(self, *arguments: Any, pure: bool) -> Any:
            assert not pure
            return unittest.mock.Mock()

    setup = fedic.Campaign(np.eye(100, dtype=np.uint8), [np.eye(100, dtype=np.uint8)], MESH)._setup
    found = executor._ClusterExecutor(Client(), "name", setup, unittest.mock.Mock())
    frames = [SeriesFrame(index, f"frame {index}", float("nan"), np.eye(100)) for index in range(3)]
    running: dict[Any, Any] = {Lost(): (index, Block([frames[index]], [])) for index in (2, 0, 1)}
    lost = found._collect(running)
    assert list(lost) == [0]
    assert "the worker that measured frame 0 was lost 4 times" in lost[0][0].measured.record.error
    assert sorted(number for number, _ in running.values()) == [1, 2]


def test_updates_of_the_reference_image_are_refused(files: list[Path], tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    for update in ("previous", "auto"):
        with pytest.raises(fedic.OptionError, match=f"reference_update='{update}' needs the frame before"):
            measured(files[1:], files[0], path, "local:2", reference_update=update)
    assert not path.exists()


@pytest.mark.parametrize("cluster", ["local", "local:0", "local:-1", "host:8786", "", 4])
def test_other_clusters_are_refused(files: list[Path], cluster: Any) -> None:
    with pytest.raises(fedic.OptionError, match="give 'local:4' for four processes"):
        measured(files[1:], files[0], None, cluster)


def test_a_missing_package_is_named(files: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(fedic.FedicError, match=r"pip install 'fedic\[dask\]'"):
        measured(files[1:], files[0], None, "local:2")


def test_a_scheduler_out_of_reach_is_named(files: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "_CONNECT_SECONDS", 1.0)
    path = tmp_path / "results.vtkhdf"
    with pytest.raises(fedic.FedicError, match=r"tcp://127\.0\.0\.1:9: no scheduler of Dask answers there"):
        measured(files[1:], files[0], path, "tcp://127.0.0.1:9")
    assert not path.exists()


def test_a_scheduler_without_workers_does_not_hang(files: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executor, "_PATIENCE", 1.0)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as cluster,
        pytest.raises(fedic.FedicError, match="has had no workers for 1 s; start dask worker"),
    ):
        measured(files[1:], files[0], None, cluster.scheduler_address)


def test_workers_that_leave_do_not_hang_the_run(files: list[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executor, "_PATIENCE", 1.0)
    campaign = fedic.Campaign(files[0], files[1:], MESH, starts="independent")
    with distributed.LocalCluster(n_workers=1, processes=False, dashboard_address="127.0.0.1:0") as cluster:
        run = campaign.measure(cluster=cluster.scheduler_address)
        next(run)
        cluster.scale(0)
        with pytest.raises(fedic.FedicError, match="has had no workers"):
            list(run)
    assert len(campaign) >= 1


def test_workers_of_another_version_are_refused(
    client: distributed.Client, files: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executor, "__version__", "9.9.9")
    with pytest.raises(fedic.FedicError, match=f"the workers have fedic {fedic.__version__}, and this is fedic 9.9.9"):
        measured(files[1:], files[0], None, client)
    monkeypatch.setattr(executor, "_answers", lambda *_: ["9.9.9"])
    with pytest.raises(fedic.FedicError, match=f"this worker has fedic {fedic.__version__}, and the run is of fedic 9"):
        measured(files[1:], files[0], None, client)


def test_a_reference_image_travels_by_name_only_if_the_workers_read_it(
    client: distributed.Client, files: list[Path], images: list[Image], tmp_path: Path
) -> None:
    image = fedic.read_image(files[0])
    assert executor._sent(client, files[0], image).source == [files[0]]
    assert isinstance(executor._sent(client, files[1], image).source, np.ndarray)
    assert isinstance(executor._sent(client, [files[0], images[0]], image).source, np.ndarray)
    assert isinstance(executor._sent(client, tmp_path / "gone.png", image).source, np.ndarray)


def test_relative_names_hold_in_the_folders_of_the_workers(
    client: distributed.Client, files: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files[0].parent)
    frames = [files[1].name, [files[2].name, Path(files[3].name)]]
    measured(frames, files[0].name, tmp_path / "serial.vtkhdf")
    measured(frames, files[0].name, tmp_path / "dask.vtkhdf", client)
    assert_same(tmp_path / "serial.vtkhdf", tmp_path / "dask.vtkhdf")


def test_nothing_is_left_on_the_workers(client: distributed.Client, files: list[Path]) -> None:
    run = fedic.Campaign(files[0], files[1:], MESH, starts="independent").measure(cluster=client)
    next(run)
    assert any(name.startswith("fedic-") for names in client.run(_plugins).values() for name in names)
    run.close()
    deadline = time.monotonic() + 5
    while client.processing() != {} and any(client.processing().values()) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(client.processing().values())
    assert not any(client.has_what().values())
    assert not any(name.startswith("fedic-") for names in client.run(_plugins).values() for name in names)


def _plugins(dask_worker: Any) -> list[str]:
    return list(dask_worker.plugins)


def test_the_command_writes_the_same_files(tmp_path: Path) -> None:
    names = ["a.png", "b.png", "broken.png", "c.png"]
    config = write_run(tmp_path, names, pictures=True, more='[series]\nstarts = "independent"\n')
    (tmp_path / "broken.png").write_bytes(b"damaged")
    for folder, arguments in (("serial", []), ("dask", ["--dask", "local:2"])):
        outcome = run(config, *arguments)
        assert outcome.exit_code == 2
        assert "1 of 4 frames failed, the first being broken.png" in outcome.stderr
        (tmp_path / "out").rename(tmp_path / folder)
    assert_same(tmp_path / "serial" / "results.vtkhdf", tmp_path / "dask" / "results.vtkhdf")
    serial, dask = (files_of(tmp_path / folder) for folder in ("serial", "dask"))
    assert serial.keys() == dask.keys()
    assert "c_residual.png" in dask
    assert {name for name in serial if serial[name] != dask[name]} <= {"summary.json", "results.vtkhdf"}


def test_the_command_names_a_wrong_cluster(tmp_path: Path) -> None:
    config = write_run(tmp_path, ["a.png"])
    outcome = run(config, "--dask", "four")
    assert outcome.exit_code == 2
    assert "cluster is 'four'; give 'local:4'" in outcome.stderr


def test_a_script_without_a_guard_is_told_so(files: list[Path], tmp_path: Path) -> None:
    text = f"""
import fedic
frames = [{str(files[1])!r}]
fedic.Campaign({str(files[0])!r}, frames, fedic.rectangle_mesh((20, 20, 180, 180), 20)).run(cluster="local:1")
"""
    path = tmp_path / "unguarded.py"
    path.write_text(text)
    outcome = subprocess.run([sys.executable, path], capture_output=True, text=True, timeout=120)
    assert outcome.returncode == 1
    assert "local workers run the script again while they start; put what the script does" in outcome.stderr


def test_ctrl_c_ends_the_workers_and_keeps_what_is_finished(files: list[Path], tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    text = """
    import multiprocessing
    import sys
    import fedic
    if __name__ == "__main__":
        files = sys.argv[2:]
        mesh = fedic.rectangle_mesh((20, 20, 180, 180), 4)
        campaign = fedic.Campaign(files[0], files[1:] * 20, mesh, store=sys.argv[1])
        try:
            for item in campaign.measure(cluster="local:1"):
                if item.record.index == 2:
                    print(*(child.pid for child in multiprocessing.active_children()), flush=True)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    with script(text, str(path), *map(str, files)) as process:
        children = [int(each) for each in read_line(process).split()]
        assert children
        for pid in [process.pid, *children]:
            os.kill(pid, signal.SIGINT)
        assert read_line(process) == "interrupted"
        assert process.wait(60) == 0
    assert len(fedic.load(path)) >= 2
    for pid in children:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
