"""Correlations of one pair: starts, options, progress, and the files a result is written to."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.fft import initial_translation

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]
MOTION = (1.3, -0.6)


@pytest.mark.parametrize("quadrature", [fedic.MeshQuadrature(), fedic.PixelQuadrature()])
@pytest.mark.parametrize("initial", ["zero", "pyramid", "fft"])
def test_a_known_motion_is_measured(speckle_pair: Pair, quadrature: object, initial: str) -> None:
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    result = fedic.correlate(*speckle_pair, mesh, quadrature=quadrature, initial=initial)  # type: ignore[arg-type]
    assert result.converged
    np.testing.assert_allclose(result.displacement, np.tile(MOTION, (mesh.num_nodes, 1)), atol=0.05)


def test_the_displacement_is_in_the_unit_of_the_mesh(speckle_pair: Pair) -> None:
    camera = fedic.FrontParallel(10.0, (0.0, 160.0))
    mesh = fedic.rectangle_mesh((3, 3, 17, 13), size=2)
    result = fedic.correlate(*speckle_pair, mesh, camera, initial="fft")
    np.testing.assert_allclose(result.displacement.mean(axis=0), (0.13, 0.06), atol=0.002)
    np.testing.assert_allclose(result.pixel_displacement.mean(axis=0), MOTION, atol=0.02)


def test_a_correlator_measures_several_frames(speckle_pair: Pair) -> None:
    reference, deformed = speckle_pair
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    correlator = fedic.Correlator(reference, mesh, initial="pyramid")
    first = correlator.correlate(deformed)
    again = correlator.correlate(deformed, initial=first.displacement)
    assert again.iterations <= first.iterations
    np.testing.assert_allclose(again.displacement, first.displacement, atol=5e-3)
    residual = correlator.residual_map(deformed, first.displacement)
    assert residual.shape == reference.shape
    inside = np.zeros(reference.shape, dtype=bool)
    inside[30:131, 30:171] = True
    assert np.isnan(residual[~inside]).all()
    assert np.isfinite(residual[31:130, 31:170]).all()
    assert np.sqrt(np.nanmean(residual**2)) == pytest.approx(first.residual_rms, rel=0.02)


@pytest.mark.parametrize("initial", ["zero", "pyramid"])
def test_progress_reports_every_iteration_of_the_history(speckle_pair: Pair, initial: str) -> None:
    prepared: list[fedic.Progress] = []
    states: list[fedic.Progress] = []
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    correlator = fedic.Correlator(speckle_pair[0], mesh, initial=initial, progress=prepared.append)
    assert [(state.stage, state.level, state.iteration) for state in prepared] == [("prepare", 0, 0)]
    result = correlator.correlate(speckle_pair[1], progress=states.append)
    iterations = [(each.level, each.iteration, each.correction, each.residual_rms) for each in states]
    assert iterations == [tuple(entry) for entry in result.history]
    assert [each.stage for each in states] == ["pyramid" if each.level else "solve" for each in states]
    levels = [entry.level for entry in result.history]
    assert levels == sorted(levels, reverse=True)
    assert levels[0] == {"zero": 0, "pyramid": 4}[initial]
    finest = [entry for entry in result.history if entry.level == 0]
    assert [entry.iteration for entry in finest] == list(range(1, result.iterations + 1))
    assert finest[-1].correction < 1e-3 <= finest[-2].correction
    assert finest[-1].residual_rms == result.residual_rms


def test_unused_nodes_are_nan_in_results_and_allowed_in_starts(speckle_pair: Pair) -> None:
    grid = fedic.rectangle_mesh((30, 30, 170, 130), size=20)
    mesh = fedic.Mesh(np.vstack([grid.points, [[0.0, 0.0]]]), grid.cells)
    correlator = fedic.Correlator(speckle_pair[0], mesh)
    result = correlator.correlate(speckle_pair[1])
    assert np.isnan(result.displacement[-1]).all()
    assert np.isfinite(result.displacement[:-1]).all()
    assert correlator.correlate(speckle_pair[1], initial=result.displacement).converged


@pytest.mark.parametrize(
    ("image", "message"),
    [
        ([[1, 2], [3, 4]], "deformed image is a list"),
        (np.zeros((160, 200, 3), dtype=np.uint8), r"shape \(160, 200, 3\)"),
        (np.zeros((160, 200), dtype=np.int32), "holds int32 values"),
        (np.zeros((200, 160), dtype=np.uint8), "160 x 200 px .* reference image is 200 x 160 px"),
    ],
)
def test_bad_images_are_refused(speckle_pair: Pair, image: object, message: str) -> None:
    with pytest.raises(fedic.ImageError, match=message):
        fedic.correlate(speckle_pair[0], image, fedic.rectangle_mesh((30, 30, 170, 130), 20))  # type: ignore[arg-type]


def test_float64_and_views_are_accepted(speckle_pair: Pair) -> None:
    reference, deformed = (image.astype(np.float64)[:, ::-1] for image in speckle_pair)
    result = fedic.correlate(reference, deformed, fedic.rectangle_mesh((30, 30, 170, 130), 20))  # type: ignore[arg-type]
    np.testing.assert_allclose(result.displacement.mean(axis=0), (-1.3, -0.6), atol=0.02)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"initial": "fourier"}, '"flow", an array of nodal displacements or a result, got .fourier.'),
        ({"initial": np.zeros((3, 2))}, r"shape \(3, 2\); give one displacement per node, shape \(48, 2\)"),
        ({"initial": np.full((48, 2), np.nan)}, "not finite at 48 nodes"),
        ({"quadrature": "edges"}, r"a fedic\.MeshQuadrature or a fedic\.PixelQuadrature, got 'edges'"),
    ],
)
def test_bad_options_are_refused(speckle_pair: Pair, options: dict, message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        fedic.correlate(*speckle_pair, fedic.rectangle_mesh((30, 30, 170, 130), 20), **options)


@pytest.mark.parametrize("options", [{"density": 0.0}, {"density": float("nan")}, {"rule": "gauss"}])
def test_bad_quadratures_are_refused(options: dict) -> None:
    with pytest.raises(fedic.OptionError, match=r"(density|rule) must be"):
        fedic.MeshQuadrature(**options)


@pytest.mark.parametrize("shape", [(300, 400), (900, 2100)], ids=["fine", "coarse-then-fine"])
@pytest.mark.parametrize("extent", [0.3, 0.9])
def test_fft_start_finds_a_large_motion(shape: tuple[int, int], extent: float) -> None:
    height, width = shape
    rng = np.random.default_rng(0)
    noise = rng.integers(0, 256, (height // 2, width // 2)).astype(np.uint8)
    reference = np.kron(noise, np.ones((2, 2), dtype=np.uint8))
    shift_u, shift_v = (37, -21) if extent < 0.5 else (5, -3)
    deformed = np.roll(reference, (shift_v, shift_u), axis=(0, 1))
    camera = fedic.FrontParallel(4.0, (width / 2, height / 2))
    half = np.array([width, height]) * extent / 8.0
    mesh = fedic.rectangle_mesh((-half[0], -half[1], half[0], half[1]), size=float(half[0]))
    start = initial_translation(reference, deformed, mesh, camera)
    np.testing.assert_allclose(start, np.tile((shift_u / 4.0, -shift_v / 4.0), (mesh.num_nodes, 1)), atol=1e-9)


def test_fft_start_ignores_unused_nodes(speckle_pair: Pair) -> None:
    """An unused node far outside the range of the lens, where no pixel can be unprojected."""
    lens = fedic.BrownDistortion((-1.0, 0.0, 0.0))
    camera = fedic.Pinhole((1000, 1000), (100, 80), translation=(0, 0, 1.0), distortion=lens)
    mesh = fedic.rectangle_mesh((-0.05, -0.04, 0.05, 0.04), 0.02)
    far = fedic.Mesh(np.vstack([mesh.points, [[5.0, 5.0]]]), mesh.cells)
    start = initial_translation(*speckle_pair, far, camera)
    np.testing.assert_array_equal(start[:-1], initial_translation(*speckle_pair, mesh, camera))
    np.testing.assert_array_equal(start[-1], 0.0)


def test_fft_start_refuses_flat_images_and_small_regions() -> None:
    flat = np.zeros((100, 100), dtype=np.uint8)
    with pytest.raises(fedic.SolveError, match="no texture"):
        initial_translation(flat, flat, fedic.rectangle_mesh((20, 20, 60, 60), 20), fedic.ImageFrame())
    with pytest.raises(fedic.SolveError, match="covers only 5 x 5 px"):
        initial_translation(flat, flat, fedic.rectangle_mesh((20, 20, 24, 24), size=2), fedic.ImageFrame())


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
def test_mesh_files_contain_the_fields(result: fedic.Result, tmp_path: Path, suffix: str) -> None:
    path = result.write(tmp_path / f"result{suffix}")
    read = meshio.read(path)
    np.testing.assert_array_equal(read.points[:, :2], result.mesh.points)
    np.testing.assert_array_equal(read.cells_dict["quad"], result.mesh.cells["quad"])
    for name, field in (("displacement", result.displacement), ("displacement_px", result.pixel_displacement)):
        np.testing.assert_array_equal(read.point_data[name][:, :2], field)
        np.testing.assert_array_equal(read.point_data[name][:, 2], 0.0)
    for name, field in zip(("xx", "yy", "xy"), result.strains().components.T, strict=True):
        np.testing.assert_array_equal(read.cell_data[f"green_lagrange_strain_{name}"][0], field)
    np.testing.assert_array_equal(read.cell_data["residual"][0], result.cell_residuals)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_arrays_load_with_plain_numpy(result: fedic.Result, tmp_path: Path) -> None:
    with np.load(result.write(tmp_path / "result.npz"), allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["displacement"], result.displacement)
        np.testing.assert_array_equal(arrays["cells_quad"], result.mesh.cells["quad"])
        np.testing.assert_array_equal(arrays["strains"], result.strains())
        np.testing.assert_array_equal(arrays["history"], np.array(result.history))
        assert arrays["converged"] == result.converged


def test_summary_is_plain_json(result: fedic.Result, tmp_path: Path) -> None:
    content = json.loads(result.write(tmp_path / "result.json").read_text())
    assert content["converged"] is True
    assert content["num_nodes"] == result.mesh.num_nodes
    assert len(content["history"]) == len(result.history)


def test_unknown_suffix_and_missing_folder_are_refused(result: fedic.Result, tmp_path: Path) -> None:
    with pytest.raises(fedic.OptionError, match=r"'\.xls'; choose \.vtu, \.vtk, \.npz, \.json"):
        result.write(tmp_path / "result.xls")
    with pytest.raises(fedic.FedicError, match="does not exist; make it first"):
        result.write(tmp_path / "no" / "result.vtu")


def test_a_failed_write_keeps_the_existing_file(
    result: fedic.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "result.npz"
    path.write_text("old")
    monkeypatch.setattr(np, "savez", lambda *_, **__: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(fedic.FedicError, match="No space left on device"):
        result.write(path)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["result.npz"]


def test_displacement_at_points_and_strains_of_cells(result: fedic.Result) -> None:
    np.testing.assert_allclose(result.at([[100.0, 80.0]]), [MOTION], atol=0.05)
    assert np.isnan(result.at([[0.0, 0.0]])).all()
    assert result.strains().shape == (result.mesh.num_cells, 3)
    np.testing.assert_allclose(result.strains(), 0.0, atol=5e-3)
