"""Exports of a series: long tables, arrays, and series of ParaView."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest
import scipy.io
from numpy.typing import NDArray

import fedic
from fedic.io.exports import arrays, export, tables
from scenes.fields import Fields, result_of

MESH = fedic.rectangle_mesh((0, 0, 30, 20), 10, "triangle")
FIELD = MESH.points @ np.array([[0.01, 0.02], [0.0, -0.01]]) + 1.0 / 3.0
TIMES = [0.1, 0.2, 1.0 / 3.0]


def series(times: Any = TIMES) -> Fields:
    moved = result_of(MESH, FIELD, damaged=[0, 1, 2, 3])
    return Fields(MESH, [result_of(MESH, 0 * FIELD), None, moved], times=times)


@pytest.fixture(scope="module")
def measured(speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> Fields:
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    return Fields(mesh, [fedic.correlate(*speckle_pair, mesh, noise=1.0)], times=[2.0])


def read(path: Path) -> pd.DataFrame:
    if path.suffix == ".csv":
        return pd.read_csv(path)
    return pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_excel(path)


def close(found: Any, expected: Any) -> None:
    """Check numbers; those of Excel have 16 digits."""
    np.testing.assert_allclose(found, expected, rtol=1e-14)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".xlsx"])
def test_nodes_are_rows_of_long_tables(tmp_path: Path, suffix: str) -> None:
    frames = series()
    path = export(frames, tmp_path / f"nodes{suffix}")
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    found = read(path)
    assert list(found.columns) == [
        *("frame", "time", "node", "x", "y", "displacement_x", "displacement_y"),
        *("displacement_std_x", "displacement_std_y", "displacement_u", "displacement_v"),
        *("green_lagrange_strain_xx", "green_lagrange_strain_yy", "green_lagrange_strain_xy", "valid", "flags"),
    ]
    assert list(found["frame"]) == [0] * MESH.num_nodes + [2] * MESH.num_nodes
    last = found[found["frame"] == 2]
    result = frames.result(2)
    close(last["time"], 1.0 / 3.0)
    np.testing.assert_array_equal(last["node"], np.arange(MESH.num_nodes))
    close(last[["x", "y"]], MESH.points)
    close(last[["displacement_x", "displacement_y"]], result.displacement)
    close(last[["displacement_u", "displacement_v"]], result.pixel_displacement)
    strains = [name for name in found if name.startswith("green_lagrange_strain")]
    close(last[strains], result.strains(at="nodes").components)
    np.testing.assert_array_equal(last["valid"], result.valid_nodes)
    flags = last["flags"].fillna("")
    np.testing.assert_array_equal(flags == "not-measured", ~result.valid_nodes)
    assert not result.valid_nodes.all()


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".xlsx"])
def test_cells_are_rows_of_long_tables_with_standard_deviations(tmp_path: Path, suffix: str, measured: Fields) -> None:
    found = read(export(measured, tmp_path / f"cells{suffix}", what="cells", measure="hencky"))
    result, mesh = measured.result(0), measured.mesh
    names = [f"hencky_strain_{component}" for component in ("xx", "yy", "xy")]
    deviations = [f"hencky_strain_std_{component}" for component in ("xx", "yy", "xy")]
    expected = ["frame", "time", "cell", "x", "y", *names, *deviations, "residual", "correlation", "valid", "flags"]
    assert list(found.columns) == expected
    np.testing.assert_allclose(found[["x", "y"]], mesh.points[mesh.cells["quad"]].mean(axis=1))
    close(found[names], result.strains("hencky").components)
    close(found[deviations], result.covariance().strain_deviations("hencky"))
    close(found["residual"], result.cell_residuals)
    nodes = read(export(measured, tmp_path / f"nodes{suffix}"))
    close(nodes[["displacement_std_x", "displacement_std_y"]], result.standard_deviations())


def test_labels_of_the_mesh_are_those_of_the_tables(tmp_path: Path) -> None:
    class Labelled:
        """A mesh with labels."""

        node_labels = np.arange(MESH.num_nodes) * 10 + 5
        cell_labels = np.arange(MESH.num_cells) + 1

        def __getattr__(self, name: str) -> Any:
            return getattr(MESH, name)

    frames = series()
    frames.mesh = Labelled()  # type: ignore[assignment]
    assert list(read(export(frames, tmp_path / "a.csv"))["node"][:3]) == [5, 15, 25]
    assert list(read(export(frames, tmp_path / "b.csv", what="cells"))["cell"][:3]) == [1, 2, 3]


def test_parquet_files_have_groups_of_frames_and_name_measure_and_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "_GROUP_ROWS", 2 * MESH.num_nodes)
    frames = Fields(MESH, [result_of(MESH, FIELD)] * 5)
    file = pyarrow.parquet.ParquetFile(export(frames, tmp_path / "nodes.parquet"))
    groups = [file.metadata.row_group(k).num_rows for k in range(file.num_row_groups)]
    assert groups == [2 * MESH.num_nodes, 2 * MESH.num_nodes, MESH.num_nodes]
    metadata = file.schema_arrow.metadata
    assert (metadata[b"fedic.strain_measure"], metadata[b"fedic.unit"]) == (b"green-lagrange", b"mm")


def test_tables_too_long_for_excel_are_refused_before_any_result_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = series()
    monkeypatch.setattr(tables, "EXCEL_ROWS", 2 * MESH.num_nodes)
    with pytest.raises(fedic.OptionError, match=r"has 25 rows, and a sheet of Excel at most 24; export"):
        export(frames, tmp_path / "nodes.xlsx")
    assert frames.read == []
    monkeypatch.setattr(tables, "EXCEL_ROWS", 2 * MESH.num_nodes + 1)
    export(frames, tmp_path / "nodes.xlsx")


@pytest.mark.parametrize("suffix", [".npz", ".mat"])
def test_arrays_hold_all_frames(tmp_path: Path, suffix: str) -> None:
    frames = series()
    path = export(frames, tmp_path / f"all{suffix}", measure="small")
    found: Any = np.load(path) if suffix == ".npz" else scipy.io.loadmat(path, squeeze_me=True)
    result = frames.result(2)
    np.testing.assert_array_equal(found["time"], TIMES)
    np.testing.assert_array_equal(found["displacement"][2], result.displacement)
    np.testing.assert_array_equal(found["strains"][2], result.strains("small").components)
    assert np.isnan(found["displacement"][1]).all()
    assert np.isnan(found["strain_standard_deviations"]).all()
    assert not found["valid_nodes"][1].any()
    np.testing.assert_array_equal(found["cell_flags"][2], result.quality.cell_flags)
    np.testing.assert_array_equal(found["cells_triangle"] - (suffix == ".mat"), MESH.cells["triangle"])
    assert [str(each) for each in found["error"]][1] == "no texture"
    assert str(found["strain_measure"]) == "small"


def test_arrays_too_large_for_matlab_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arrays, "_MATLAB_BYTES", 100)
    with pytest.raises(fedic.OptionError, match=r"hold 2 GiB at most; export the series as \.npz"):
        export(series(), tmp_path / "all.mat")


@pytest.mark.parametrize(("times", "expected"), [(TIMES, [0.1, 1.0 / 3.0]), ([0.0, 1.0, np.nan], [0.0, 2.0])])
def test_paraview_reads_the_frames_with_their_times(tmp_path: Path, times: Any, expected: list[float]) -> None:
    import pyvista

    frames = series(times)
    path = export(frames, tmp_path / "a & b.pvd")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a & b.pvd", "a & b_0000.vtu", "a & b_0002.vtu"]
    reader = pyvista.get_reader(path)
    assert reader.time_values == expected
    reader.set_active_time_value(expected[1])
    found = reader.read()[0]
    np.testing.assert_array_equal(found.point_data["displacement"][:, :2], frames.result(2).displacement)
    assert "green_lagrange_strain_xx" in found.cell_data


@pytest.mark.parametrize(
    ("name", "options", "error", "message"),
    [
        ("a.txt", {}, fedic.OptionError, r"cannot be exported as '\.txt'; choose \.pvd, \.npz, \.mat, \.csv"),
        ("a.csv", {"what": "edges"}, fedic.OptionError, "what must be one of"),
        ("a.csv", {"measure": "euler"}, fedic.OptionError, "measure must be one of"),
        ("none/a.csv", {}, fedic.FedicError, "the folder .* does not exist"),
        ("none/a.pvd", {}, fedic.FedicError, "the folder .* does not exist"),
        ("none/a.parquet", {}, fedic.FedicError, "the folder .* does not exist"),
        ("none/a.xlsx", {}, fedic.FedicError, "the folder .* does not exist"),
        ("none/a.mat", {}, fedic.FedicError, "the folder .* does not exist"),
    ],
)
def test_bad_arguments_are_refused(
    tmp_path: Path, name: str, options: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        export(series(), tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_series_without_a_measured_frame_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fedic.FedicError, match="no frame of the series was measured"):
        export(Fields(MESH, [None]), tmp_path / "a.csv")


@pytest.mark.parametrize(
    ("suffix", "module", "extra"),
    [
        (".csv", "pandas", "tables"),
        (".parquet", "pyarrow", "tables"),
        (".xlsx", "openpyxl", "tables"),
        (".mat", "scipy.io", "matlab"),
    ],
)
def test_missing_packages_are_named_with_their_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, module: str, extra: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(fedic.FedicError, match=rf"{module.split('.')[0]} is needed .* pip install 'fedic\[{extra}\]'"):
        export(series(), tmp_path / f"a{suffix}")


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".xlsx", ".npz", ".mat"])
def test_a_file_is_kept_if_a_frame_cannot_be_read(tmp_path: Path, suffix: str) -> None:
    class Broken(Fields):
        """A series whose last frame cannot be read."""

        def result(self, index: int) -> fedic.Result:
            if index == 2:
                raise fedic.FedicError("the store is damaged")
            return super().result(index)

    path = tmp_path / f"a{suffix}"
    path.write_bytes(b"earlier")
    with pytest.raises(fedic.FedicError, match="the store is damaged"):
        export(Broken(MESH, series().results, times=TIMES), path)
    assert path.read_bytes() == b"earlier"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
