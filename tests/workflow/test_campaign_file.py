"""The file of a campaign: other readers, runs that are killed, and files that cannot be used."""

import errno
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
import pytest

import fedic
from fedic.campaign.store.campaign_file import CampaignFile
from scenes.series import MESH, frame, frames, write_frames

_RUN = """
import sys, warnings
import fedic
from scenes.series import MESH
warnings.simplefilter("ignore")
store, *files = sys.argv[1:]
for measured in fedic.Campaign(files[0], files[1:], MESH, store=store, reference_update="auto").measure():
    print(measured.record.index, flush=True)
"""


def run(*arguments: Any, **options: Any) -> fedic.Campaign:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        return fedic.Campaign(*arguments, **options).run(progress=False)


def differences(first: Path, second: Path) -> set[str]:
    """Return the names of the datasets and attributes that differ in two files, bit by bit."""
    found: set[str] = set()
    with h5py.File(first) as one, h5py.File(second) as other:

        def compare(name: str, entry: Any) -> None:
            twin = other[name]
            assert entry.attrs.keys() == twin.attrs.keys()
            found.update(
                f"{name}@{key}" for key in entry.attrs if not np.array_equal(entry.attrs[key], twin.attrs[key])
            )
            if isinstance(entry, h5py.Dataset) and np.asarray(entry[()]).tobytes() != np.asarray(twin[()]).tobytes():
                found.add(name)

        names: list[str] = []
        other.visit(names.append)
        one.visititems(compare)
        assert sorted(names) == sorted(_names(one))
    return found


def _names(file: h5py.File) -> list[str]:
    names: list[str] = []
    file.visit(names.append)
    return names


def start(store: Path, files: list[Path]) -> subprocess.Popen[str]:
    folder = str(Path(__file__).parents[1])
    code = f"import sys; sys.path.insert(0, {folder!r})\n{_RUN}"
    return subprocess.Popen(
        [sys.executable, "-c", code, str(store), *map(str, files)], stdout=subprocess.PIPE, text=True
    )


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_run_killed_at_any_moment_goes_on_and_ends_with_the_same_bits(tmp_path: Path) -> None:
    files = write_frames(tmp_path / "images", 16)
    files[5].unlink()
    whole, killed = tmp_path / "whole.vtkhdf", tmp_path / "killed.vtkhdf"
    begun = time.monotonic()
    with start(whole, files) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "0\n"
        first = time.monotonic()
        assert process.wait() == 0
    length = time.monotonic() - first
    assert length < 60.0, begun
    moments = np.random.default_rng(4).uniform(0.0, length / 4.0, 5)
    measured = []
    for moment in moments:
        with start(killed, files) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(moment)
            process.send_signal(signal.SIGKILL)
        measured.append(fedic.load(killed)._file.num_frames() if killed.exists() else 0)
    assert measured == sorted(measured)
    with start(killed, files) as process:
        assert process.stdout is not None
        numbers = [int(line) for line in process.stdout]
    assert numbers == list(range(measured[-1], 16))
    assert differences(whole, killed) == {"fedic/frames/seconds"}


def test_finished_frames_are_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = tmp_path / "test.vtkhdf"
    run(frame(0), frames(3), MESH, store=store)
    numbers = [m.record.index for m in fedic.Campaign(frame(0), frames(5), MESH, store=store).measure()]
    assert numbers == [3, 4]
    run(frame(0), frames(5), MESH, store=tmp_path / "other.vtkhdf")
    assert differences(store, tmp_path / "other.vtkhdf") == {"fedic/frames/seconds"}
    monkeypatch.setattr(fedic.Correlator, "correlate", None)
    assert len(run(frame(0), frames(5), MESH, store=store)) == 5


@pytest.mark.parametrize("mode", ["first", "previous"])
def test_frames_of_a_stream_are_stored_and_resumed_as_those_of_a_list(tmp_path: Path, mode: Any) -> None:
    """A stream has no known length: the file grows, and is cut to its length at the end."""
    images = [frame(1 + number / 4) for number in range(18)]
    one, other = tmp_path / "list.vtkhdf", tmp_path / "stream.vtkhdf"
    run(frame(0), images, MESH, store=one, reference_update=mode)
    stream = fedic.Campaign(frame(0), iter(images), MESH, store=other, reference_update=mode).measure()
    for _ in range(17):
        next(stream)
    stream.close()
    assert len(fedic.load(other)) == 17
    run(frame(0), iter(images), MESH, store=other, reference_update=mode)
    assert differences(one, other) == {"fedic/frames/seconds"}


class Damaged(NamedTuple):
    path: Path
    campaign: fedic.Campaign


@pytest.fixture(params=list(fedic.CELL_TYPES))
def damaged(request: pytest.FixtureRequest, tmp_path: Path) -> Damaged:
    """A campaign on one cell type with a frame that fails and a hidden region."""
    mesh = fedic.rectangle_mesh((24.0, 24.0, 120.0, 120.0), 24.0, request.param)
    hidden = frame(2).copy()
    hidden[24:90, 24:90] = 0
    images = [frame(1), hidden, np.zeros_like(hidden), frame(4)]
    path = tmp_path / "test.vtkhdf"
    return Damaged(path, run(frame(0), images, mesh, store=path, times=[0.5, 1.0, 2.0, 1e9 + 0.25]))


def steps(path: Path) -> Iterator[tuple[float, Any]]:
    """Yield time and grid of each step as VTK reads it."""
    import vtk

    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for moment in reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()):
        reader.UpdateTimeStep(moment)
        grid = vtk.vtkUnstructuredGrid()
        grid.DeepCopy(reader.GetOutputDataObject(0))
        yield moment, grid


def test_vtk_reads_every_step(damaged: Damaged) -> None:
    from vtk.util.numpy_support import vtk_to_numpy

    found = list(steps(damaged.path))
    assert [moment for moment, _ in found] == [0.5, 1.0, 2.0, 1e9 + 0.25]
    for index, (_, grid) in enumerate(found):
        assert grid.GetNumberOfPoints() == damaged.campaign.mesh.num_nodes
        displacement = vtk_to_numpy(grid.GetPointData().GetArray("displacement"))
        strain = vtk_to_numpy(grid.GetCellData().GetArray("green_lagrange_strain_xx"))
        deviation = vtk_to_numpy(grid.GetPointData().GetArray("standard_deviation"))
        if index == 2:
            assert np.isnan(displacement).all()
            assert np.isnan(strain).all()
            continue
        result = damaged.campaign[index]
        np.testing.assert_array_equal(displacement[:, :2], result.displacement)
        np.testing.assert_allclose(strain, result.strains().exx, rtol=1e-5, atol=1e-9)
        np.testing.assert_allclose(deviation[:, :2], result.standard_deviations(), rtol=1e-5)
        assert np.isnan(displacement).any() == (index == 1)


def test_filters_do_with_nan_what_the_docs_say(damaged: Damaged) -> None:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    grid = list(steps(damaged.path))[1][1]
    unknown = np.isnan(damaged.campaign[1].displacement).any(axis=1)
    assert unknown.any()

    def output(kind: Any, array: str, association: int = 0) -> Any:
        tool = kind()
        tool.SetInputData(grid)
        tool.SetInputArrayToProcess(0, 0, 0, association, array)
        if kind is vtk.vtkThreshold:
            tool.SetLowerThreshold(-10.0)
            tool.SetUpperThreshold(10.0 if array != "residual" else 1e9)
        tool.Update()
        return tool.GetOutput()

    cells = vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS
    kept = output(vtk.vtkThreshold, "green_lagrange_strain_xx", cells)
    assert kept.GetNumberOfCells() == np.isfinite(damaged.campaign[1].strains().exx).sum()
    assert np.isfinite(vtk_to_numpy(kept.GetPointData().GetArray("displacement"))).all()
    assert output(vtk.vtkThreshold, "residual", cells).GetNumberOfCells() == damaged.campaign.mesh.num_cells
    warped = vtk_to_numpy(output(vtk.vtkWarpVector, "displacement").GetPoints().GetData())
    np.testing.assert_array_equal(np.isnan(warped).any(axis=1), unknown)
    integral = output(vtk.vtkIntegrateAttributes, "displacement")
    assert np.isnan(integral.GetPointData().GetArray("displacement").GetTuple(0)[0])
    assert integral.GetCellData().GetArray("Area").GetValue(0) == pytest.approx(96.0**2)
    gradient = vtk_to_numpy(output(vtk.vtkGradientFilter, "displacement").GetPointData().GetArray("Gradients"))
    beside = np.zeros(len(unknown), dtype=bool)
    for nodes in damaged.campaign.mesh.cells.values():
        beside[nodes[unknown[nodes].any(axis=1)]] = True
    np.testing.assert_array_equal(np.isnan(gradient).any(axis=1), beside)


def test_pyvista_reads_the_first_step(damaged: Damaged) -> None:
    import pyvista

    grid = pyvista.get_reader(str(damaged.path)).read()
    np.testing.assert_array_equal(grid["displacement"][:, :2], damaged.campaign[0].displacement)


def test_h5py_reads_the_numbers(damaged: Damaged) -> None:
    nodes, cells = damaged.campaign.mesh.num_nodes, damaged.campaign.mesh.num_cells
    with h5py.File(damaged.path) as file:
        grid = file["VTKHDF"]
        assert grid["Steps"].attrs["NSteps"] == 4
        displacement = grid["PointData/displacement"][:].reshape(4, nodes, 3)
        residual = grid["CellData/residual"][:].reshape(4, cells)
        errors = file["fedic/frames/error"][:]
    for index in (0, 1, 3):
        np.testing.assert_array_equal(displacement[index, :, :2], damaged.campaign[index].displacement)
        np.testing.assert_array_equal(residual[index], damaged.campaign[index].cell_residuals)
    assert b"without a texture" in errors[2]


def test_a_loaded_campaign_has_the_results_that_were_measured(damaged: Damaged) -> None:
    loaded = fedic.load(damaged.path)
    assert repr(loaded.frames) == repr(damaged.campaign.frames)
    for name in ("points", "used_nodes"):
        np.testing.assert_array_equal(getattr(loaded.mesh, name), getattr(damaged.campaign.mesh, name))
    image = frame(1)
    direct = fedic.Correlator(frame(0), damaged.campaign.mesh).correlate(image)
    result = loaded[0]
    np.testing.assert_allclose(result.displacement, direct.displacement, atol=1e-12)
    np.testing.assert_allclose(result.quality.correlation, direct.quality.correlation, rtol=1e-6)
    np.testing.assert_array_equal(result.quality.cell_flags, direct.quality.cell_flags)
    assert result.history == direct.history
    assert result.summary()["quality"] == direct.summary()["quality"]
    assert (loaded[1].valid_nodes == damaged.campaign[1].valid_nodes).all()


@pytest.mark.parametrize("robust", [None, "tukey"])
def test_what_needs_the_images_is_found_again_from_their_files(tmp_path: Path, robust: Any) -> None:
    files = write_frames(tmp_path, 2)
    store = tmp_path / "test.vtkhdf"
    mask = np.zeros((144, 144), dtype=bool)
    mask[30:50, 30:50] = True
    options: dict[str, Any] = {"mask": mask, "robust": robust, "smoothing": 0.6}
    gap = fedic.EquilibriumGap(0.3, loaded=[])
    run(files[0], files[1:], MESH, store=store, regularization=gap, regularization_length=60.0, **options)
    direct = fedic.Correlator(
        fedic.read_image(files[0]), MESH, regularization=gap, regularization_length=60.0, **options
    ).correlate(fedic.read_image(files[1]))
    result = fedic.load(store)[0]
    np.testing.assert_allclose(result.residual_map(), direct.residual_map(), atol=1e-3)
    np.testing.assert_allclose(result.standard_deviations(), direct.standard_deviations(), rtol=1e-3)
    files[0].unlink()
    with pytest.raises(fedic.ImageError, match="cannot be read again"):
        fedic.load(store)[0].residual_map()
    assert fedic.load(store).covariance(0) is None


def test_sets_labels_camera_and_unit_are_loaded(tmp_path: Path) -> None:
    sets = {"left/top": fedic.MeshSet(nodes=[0, 1, 2]), "all": fedic.MeshSet(cells=range(MESH.num_cells))}
    camera = fedic.Pinhole(
        (2000.0, 2000.0), (72.0, 72.0), translation=(0.0, 0.0, 2000.0), distortion=fedic.BrownDistortion((0.01, 0, 0))
    )
    points = MESH.points[:, :2] - 72.0
    labels = {"node_labels": np.arange(len(points)) + 100, "cell_labels": np.arange(MESH.num_cells) * 2 + 1}
    mesh = fedic.Mesh(np.column_stack([points, np.zeros(len(points))]), MESH.cells, sets, **labels)
    campaign = run(frame(0), frames(1), mesh, camera, unit="mm", store=tmp_path / "test.vtkhdf")
    loaded = fedic.load(tmp_path / "test.vtkhdf")
    assert loaded.unit == "mm"
    assert loaded.mesh.sets.keys() == sets.keys()
    np.testing.assert_array_equal(loaded.mesh.node_labels, labels["node_labels"])
    np.testing.assert_array_equal(loaded.mesh.cell_labels, labels["cell_labels"])
    for name, found in mesh.sets.items():
        np.testing.assert_array_equal(loaded.mesh.sets[name].nodes, found.nodes)
        np.testing.assert_array_equal(loaded.mesh.sets[name].cells, found.cells)
    np.testing.assert_array_equal(loaded.camera.project(mesh.points), camera.project(mesh.points))
    np.testing.assert_array_equal(loaded[0].displacement, campaign[0].displacement)


def test_a_second_run_on_one_file_is_refused(tmp_path: Path) -> None:
    store = tmp_path / "test.vtkhdf"
    measuring = fedic.Campaign(frame(0), frames(3), MESH, store=store).measure()
    next(measuring)
    other = f"import fedic; fedic.load({str(store)!r})"
    outcome = subprocess.run([sys.executable, "-c", other], capture_output=True, text=True, check=False)
    assert "the file is being written by another run; wait until it ends" in outcome.stderr
    for overwrite in (False, True):
        with pytest.raises(fedic.FedicError, match="the file is being written by another run"):
            fedic.Campaign(frame(0), frames(3), MESH, store=store).run(overwrite=overwrite, progress=False)
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parents[1])!r})\n"
        "import fedic\nfrom scenes.series import MESH, frame, frames\n"
        f"fedic.Campaign(frame(0), frames(1), MESH, store={str(store)!r}).run(overwrite=True)"
    )
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "the file is being written by another run" in outcome.stderr
    assert len(list(measuring)) == 2
    assert subprocess.run([sys.executable, "-c", other], check=False).returncode == 0


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"smoothing": 1.0}, "smoothing differ"),
        ({"starts": "previous"}, "starts differ"),
        ({"mask": [[(30.0, 30.0), (50.0, 30.0), (50.0, 50.0)]]}, "mask differ"),
        ({"mesh": fedic.rectangle_mesh((24.0, 24.0, 120.0, 120.0), 24.0)}, "mesh differ"),
        ({"camera": fedic.ImageFrame((1.0, 0.0))}, "camera differ"),
        ({"reference": frame(1)}, "reference image differ"),
        ({"frames": [frame(1)]}, "number 1 is frame 1 there, and missing among the frames given"),
    ],
)
def test_results_of_another_campaign_are_kept(tmp_path: Path, change: dict[str, Any], named: str) -> None:
    store = tmp_path / "test.vtkhdf"
    same: dict[str, Any] = {"reference": frame(0), "frames": frames(2), "mesh": MESH}
    run(**same, store=store)
    before = store.read_bytes()
    with pytest.raises(fedic.FedicError, match=named):
        run(**{**same, **change}, store=store)
    with pytest.raises(fedic.FedicError, match="there are results already"):
        fedic.Campaign(**same, store=store).run(resume=False)
    assert store.read_bytes() == before
    other = fedic.Campaign(**{**same, **change}, store=store).run(overwrite=True, progress=False)
    assert len(other) == len(change.get("frames", [1, 2]))


def test_a_file_that_is_no_campaign_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "test.vtkhdf"
    with pytest.raises(fedic.FedicError, match="there is no such file"):
        fedic.load(path)
    path.write_bytes(b"something else")
    with pytest.raises(fedic.FedicError, match="this is not a file of results of a campaign, or it is damaged"):
        fedic.load(path)
    with h5py.File(path, "w") as file:
        file["data"] = 1
    with pytest.raises(fedic.FedicError, match="not written by a campaign of fedic"):
        fedic.load(path)
    assert path.exists()
    path.unlink()
    run(frame(0), frames(1), MESH, store=path)
    with h5py.File(path, "r+") as file:
        file["fedic"].attrs["format"] = 99
    with pytest.raises(
        fedic.FedicError, match=r"has version 99 of the format, written by fedic .*, which reads version 1"
    ):
        fedic.load(path)
    with pytest.raises(fedic.FedicError, match="version 99"):
        run(frame(0), frames(2), MESH, store=path)


def test_results_of_another_version_of_fedic_are_not_continued(tmp_path: Path) -> None:
    store = tmp_path / "test.vtkhdf"
    run(frame(0), frames(1), MESH, store=store)
    with h5py.File(store, "r+") as file:
        text = bytes(file["fedic/versions"][()]).replace(fedic.__version__.encode(), b"0.0.1")
        del file["fedic/versions"]
        file["fedic/versions"] = np.bytes_(text)
    with pytest.raises(fedic.FedicError, match=r"these results are of fedic 0\.0\.1"):
        run(frame(0), frames(2), MESH, store=store)
    assert len(fedic.load(store)) == 1


def test_a_disk_without_room_is_refused_before_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=1_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    with pytest.raises(fedic.FedicError, match=r"the frames take .* MB, and 1 MB are free on this disk"):
        run(frame(0), frames(2), MESH, store=tmp_path / "test.vtkhdf")
    assert not list(tmp_path.iterdir())


def test_a_disk_that_fills_up_loses_no_earlier_frame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = tmp_path / "test.vtkhdf"
    write = CampaignFile._write

    def full(self: CampaignFile, data: Any, seconds: float) -> None:
        if data.index == 2:
            raise OSError(errno.ENOSPC, "No space left on device")
        write(self, data, seconds)

    monkeypatch.setattr(CampaignFile, "_write", full)
    with pytest.raises(fedic.FedicError, match=r"a frame cannot be written .*No space left on device"):
        run(frame(0), frames(5), MESH, store=store)
    assert len(fedic.load(store)) == 2
    monkeypatch.undo()
    run(frame(0), frames(5), MESH, store=store)
    run(frame(0), frames(5), MESH, store=tmp_path / "whole.vtkhdf")
    assert differences(store, tmp_path / "whole.vtkhdf") == {"fedic/frames/seconds"}


def test_a_store_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fedic.FedicError, match="does not exist; make it first"):
        run(frame(0), frames(1), MESH, store=tmp_path / "none" / "test.vtkhdf")
    with pytest.raises(fedic.FedicError, match="/proc"):
        run(frame(0), frames(1), MESH, store="/proc/test.vtkhdf")
