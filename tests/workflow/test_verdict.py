"""The verdict on a result: what is wrong is flagged, NaN or said, and good measurements are not."""

import json
import pickle
import warnings
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.starts.motion import moved
from scenes.moved_plate import motion, pair
from scenes.open_hole import open_hole_camera

Grey = NDArray[np.uint8]
Damage = Callable[[Grey, Grey], Grey]

SIDE = 300
MATRIX = motion(1.0, (1.01, 1.0), (1.7, -0.8), side=SIDE)
MESHES = {
    cell: fedic.rectangle_mesh((50, 50, 250, 250), size=size, cell=cell)
    for cell, size in (("quad", 20.0), ("triangle", 20.0), ("quad9", 40.0))
}
WRONG_PX = 0.3


@pytest.fixture(scope="module")
def images() -> tuple[Grey, Grey]:
    return pair(MATRIX, side=SIDE)


def measured(reference: Grey, deformed: Grey, mesh: fedic.Mesh, **options: object) -> fedic.Result | None:
    """Return the result without its warnings; None if the measurement is refused."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return fedic.correlate(reference, deformed, mesh, **options)  # type: ignore[arg-type]
        except fedic.SolveError:
            return None


def silent(result: fedic.Result, truth: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the nodes that are wrong by more than 0.3 px, not NaN, and not flagged."""
    error = np.linalg.norm(result.displacement - truth, axis=1)
    return np.flatnonzero((error > WRONG_PX) & (result.quality.node_flags == 0))


def occluded(share: float) -> Damage:
    side = round(np.sqrt(share) * 200)
    start = 130 - side // 2

    def cover(_: Grey, deformed: Grey) -> Grey:
        deformed[start : start + side, start + 10 : start + 10 + side] = 12
        return deformed

    return cover


def replaced(_: Grey, deformed: Grey) -> Grey:
    other = pair(motion(side=SIDE), side=SIDE, size=4.0)[0]
    deformed[110:190, 90:170] = other[10:90, 10:90]
    return deformed


def half_saturated(_: Grey, deformed: Grey) -> Grey:
    deformed[:, 150:] = 255
    return deformed


def reflecting(_: Grey, deformed: Grey) -> Grey:
    v, u = np.mgrid[0:SIDE, 0:SIDE]
    light = 300.0 * np.exp(-((u - 150.0) ** 2 + (v - 140.0) ** 2) / (2.0 * 40.0**2))
    return np.clip(deformed + light, 0, 255).astype(np.uint8)


def unrelated(reference: Grey, _: Grey) -> Grey:
    other = fedic.synthetic.Speckle(5.0, seed=77)
    return fedic.synthetic.render(other, fedic.ImageFrame(), (SIDE, SIDE), noise=1.0)  # type: ignore[return-value]


def shaded(_: Grey, deformed: Grey) -> Grey:
    deformed[:, 150:] //= 2
    return deformed


DAMAGES: dict[str, Damage] = {
    "occlusion of 1 %": occluded(0.01),
    "occlusion of 10 %": occluded(0.1),
    "occlusion of 30 %": occluded(0.3),
    "another texture": replaced,
    "half saturated": half_saturated,
    "reflection": reflecting,
    "flipped": lambda _, deformed: np.ascontiguousarray(deformed[:, ::-1]),
    "upside down": lambda _, deformed: np.ascontiguousarray(deformed[::-1]),
    "unrelated": unrelated,
    "negative": lambda _, deformed: 255 - deformed,
    "low byte of 10 bits": lambda _, deformed: (deformed.astype(np.uint16) * 4 % 256).astype(np.uint8),
    "shadow on one half": shaded,
}


@pytest.mark.parametrize("cell", MESHES)
@pytest.mark.parametrize("damage", DAMAGES)
def test_no_node_is_silently_wrong_in_a_damaged_image(damage: str, cell: str, images: tuple[Grey, Grey]) -> None:
    reference, deformed = images
    mesh = MESHES[cell]
    result = measured(reference, DAMAGES[damage](reference, deformed.copy()), mesh)
    if result is None:
        return
    assert not result.quality.is_good
    assert silent(result, moved(MATRIX, mesh.points) - mesh.points).size == 0


@pytest.mark.parametrize("opening", [3.0, 6.0])
@pytest.mark.parametrize("cell", MESHES)
def test_no_node_is_silently_wrong_beside_a_crack(cell: str, opening: float) -> None:
    reference = pair(motion(side=SIDE), side=SIDE)[0]
    v, u = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    width = opening * np.clip((u - 130) / 120, 0, None)
    from_v = np.where(v < 150, v + width / 2, v - width / 2)
    deformed = cv2.remap(reference, u, from_v.astype(np.float32), cv2.INTER_CUBIC)
    deformed[np.abs(v - 150) < width / 2] = 12
    mesh = MESHES[cell]
    result = measured(reference, deformed, mesh)
    assert result is not None
    assert not result.quality.is_good
    x, y = mesh.points.T
    truth = np.zeros((mesh.num_nodes, 2))
    truth[:, 1] = np.sign(y - 150) * opening * np.clip((x - 130) / 120, 0, None) / 2
    assert silent(result, truth).size == 0


@pytest.mark.parametrize("gap", [20, 120])
@pytest.mark.parametrize("cell", ["quad", "triangle"])
def test_no_node_is_silently_wrong_at_the_lips_of_a_crack_in_the_mesh(cell: str, gap: int) -> None:
    reference = pair(motion(side=SIDE), side=SIDE)[0]
    v, u = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    opening = 2.0
    from_v = np.where(v < 150, v + opening / 2, v - opening / 2)
    deformed = cv2.remap(reference, u, from_v.astype(np.float32), cv2.INTER_CUBIC)
    deformed[np.abs(v - 150) < opening / 2] = gap
    upper, lower = (
        fedic.rectangle_mesh((50, top, 250, top + 100), size=20, cell=cell)  # type: ignore[arg-type]
        for top in (50, 150)
    )
    mesh = fedic.Mesh(
        np.concatenate([upper.points, lower.points]),
        {cell: np.concatenate([upper.cells[cell], lower.cells[cell] + upper.num_nodes])},
    )
    result = measured(reference, deformed, mesh)
    assert result is not None
    truth = np.zeros((mesh.num_nodes, 2))
    truth[:, 1] = np.where(np.arange(mesh.num_nodes) < upper.num_nodes, -opening / 2, opening / 2)
    assert silent(result, truth).size == 0
    # Points beside the cut are left out: the opening is measured, whatever the grey level of the gap.
    lips = np.abs(mesh.points[:, 1] - 150) < 1
    error = np.linalg.norm(result.displacement[lips] - truth[lips], axis=1)
    assert error.max() < 0.015
    assert error.mean() < 0.005


@pytest.mark.parametrize("shift", [2.0, 5.0, 7.0, 14.0])
@pytest.mark.parametrize("start", ["auto", "pyramid", "fft"])
def test_periodic_textures_are_said_to_be_ambiguous(start: str, shift: float) -> None:
    v, u = np.mgrid[0:SIDE, 0:SIDE]

    def grid(by: float) -> Grey:
        wave = np.cos(2 * np.pi * (u - by) / 12) + np.cos(2 * np.pi * v / 12)
        return np.round(128 + 45 * wave).astype(np.uint8)

    mesh = MESHES["quad"]
    result = measured(grid(0), grid(shift), mesh, initial=start)
    assert result is not None
    assert np.abs(np.linalg.norm(result.quality.repeats, axis=1) - 12.0).min() < 0.5
    assert not result.quality.is_good
    assert silent(result, np.tile([shift, 0.0], (mesh.num_nodes, 1))).size == 0
    assert "repeats itself" in repr(result)


def test_random_textures_are_not_periodic(images: tuple[Grey, Grey]) -> None:
    for size in (3.0, 5.0, 9.0, 16.0):
        reference = pair(motion(side=SIDE), side=SIDE, size=size)[0]
        result = measured(reference, reference, MESHES["quad"])
        assert result is not None
        assert result.quality.repeats.size == 0


@pytest.mark.parametrize("noise", [0.5, 2.0, 6.0])
@pytest.mark.parametrize("cell", MESHES)
def test_good_measurements_are_not_flagged(cell: str, noise: float) -> None:
    flagged = cells = 0
    for draw in range(4):
        matrix = motion(0.4 * draw, (1 + 0.004 * draw, 1.0), (0.3 * draw, 0.7), side=SIDE)
        reference, deformed = (
            fedic.synthetic.add_noise(image, noise=noise, seed=10 * draw + index)
            for index, image in enumerate(pair(matrix, side=SIDE, noise=0.0))
        )
        result = fedic.correlate(reference, deformed, MESHES[cell])
        assert result.converged
        flagged += int((result.quality.cell_flags != 0).sum())
        cells += result.mesh.num_cells
    assert flagged <= 0.005 * cells


@pytest.mark.parametrize("frame", ["0054", "0062", "0070"])
def test_good_real_measurements_are_not_flagged(shared_data: Callable[[str], Path], frame: str) -> None:
    reference, deformed = (fedic.read_image(shared_data(f"openhole/zoom-{number}_1.tif")) for number in ("0053", frame))
    mesh = fedic.read_mesh(shared_data("openhole/gmsh_t3_mm.msh"))
    result = measured(reference, deformed, mesh, camera=open_hole_camera(1000.0))
    assert result is not None
    assert result.converged
    assert result.quality.flagged_share <= 0.005


def test_the_good_part_of_the_star_is_not_flagged(shared_data: Callable[[str], Path]) -> None:
    reference, deformed = (
        fedic.read_image(shared_data(f"star/DIC_Challenge_Star_Noise_{name}.tiff")) for name in ("Ref", "Def")
    )
    mesh = fedic.rectangle_mesh((1000, 30, 3960, 470), size=20)
    result = measured(reference, deformed, mesh)
    assert result is not None
    assert result.converged
    assert result.quality.flagged_share <= 0.005


def test_a_mesh_over_a_hole_is_flagged_there(shared_data: Callable[[str], Path]) -> None:
    reference, deformed = (
        fedic.read_image(shared_data(f"openhole/zoom-{number}_1.tif")) for number in ("0053", "0054")
    )
    with_hole = fedic.read_mesh(shared_data("openhole/abaqus_q4_m.inp"))
    camera = open_hole_camera()
    pixels = camera.project(with_hole.points[with_hole.used_nodes])
    (left, top), (right, bottom) = pixels.min(axis=0) + 4, pixels.max(axis=0) - 4
    mesh = fedic.rectangle_mesh((left, top, right, bottom), size=20)
    result = measured(reference, deformed, mesh)
    assert result is not None
    centres = mesh.points[mesh.cells["quad"]].mean(axis=1)
    covered = np.isfinite(
        with_hole.interpolate(np.zeros((with_hole.num_nodes, 2)), camera.unproject(centres, 0.0))
    ).all(axis=1)
    assert 20 < (~covered).sum() < 0.5 * mesh.num_cells
    inside = ~covered
    # Cells at the rim are partly textured.
    assert (~result.valid_cells[inside]).mean() > 0.4
    assert not result.quality.is_good
    assert result.valid_cells[covered].mean() > 0.95


def test_noise_is_estimated_or_taken(images: tuple[Grey, Grey]) -> None:
    for noise in (1.0, 3.0):
        reference, deformed = pair(MATRIX, side=SIDE, noise=noise)
        result = fedic.correlate(reference, deformed, MESHES["quad"])
        assert result.quality.noise == pytest.approx(noise, rel=0.1)
    given = measured(*images, MESHES["quad"], noise=0.1)
    assert given is not None
    assert given.quality.noise == 0.1
    np.testing.assert_allclose(
        given.quality.normalized_residual / given.quality.normalized_residual[0],
        fedic.correlate(*images, MESHES["quad"]).quality.normalized_residual
        / fedic.correlate(*images, MESHES["quad"]).quality.normalized_residual[0],
    )
    with pytest.raises(fedic.OptionError, match="noise must be"):
        fedic.correlate(*images, MESHES["quad"], noise=-1.0)


def test_node_deviations_are_near_the_predicted_ones(images: tuple[Grey, Grey]) -> None:
    result = fedic.correlate(*images, MESHES["quad"], smoothing=0.0)
    predicted = np.linalg.norm(result.standard_deviations(), axis=1) / np.sqrt(2.0)
    np.testing.assert_array_less(0.5, result.quality.standard_deviation / predicted)
    np.testing.assert_array_less(result.quality.standard_deviation / predicted, 2.0)
    np.testing.assert_allclose(result.standard_deviations(), result.standard_deviations(result.quality.noise))


def test_deviations_do_not_depend_on_the_unit_nor_on_the_quadrature(images: tuple[Grey, Grey]) -> None:
    camera = fedic.FrontParallel(10.0, (0.0, SIDE - 1.0))
    reference = fedic.rectangle_mesh((50, 50, 250, 250), size=20)
    turned_over = fedic.rectangle_mesh((5.0, (SIDE - 251.0) / 10, 25.0, (SIDE - 51.0) / 10), size=2)
    order = np.lexsort(camera.project(turned_over.points).round(6).T)
    expected = fedic.correlate(*images, reference).quality.standard_deviation[np.lexsort(reference.points.T)]
    for quadrature in (fedic.MeshQuadrature(), fedic.PixelQuadrature()):
        found = fedic.correlate(*images, turned_over, camera, quadrature=quadrature).quality.standard_deviation
        np.testing.assert_allclose(found[order], expected, rtol=0.12)


def test_stripes_leave_one_direction_uncertain() -> None:
    u = np.mgrid[0:SIDE, 0:SIDE][1]
    rng = np.random.default_rng(1)
    profile = np.convolve(rng.normal(size=SIDE + 40), np.hanning(9), mode="same")[:SIDE]
    stripes = 128 + 20 * profile[u]
    reference, deformed = (
        np.clip(np.round(stripes + rng.normal(0, 1, (SIDE, SIDE))), 0, 255).astype(np.uint8) for _ in range(2)
    )
    result = measured(reference, deformed, MESHES["quad"])
    assert result is not None
    assert result.quality.conditioning.max() < 0.2
    assert not result.quality.is_good


def test_flags_have_reasons_and_names() -> None:
    quality = fedic.Quality.unknown(MESHES["quad"], converged=True)
    assert quality.is_good
    assert repr(quality) == "Quality(good)"
    assert all(reason.endswith(".") for of in quality.flags.values() for reason in of.values())
    assert quality.cells("misfit").size == quality.nodes("uncertain").size == 0
    for name in ("mis-fit", ""):
        with pytest.raises(fedic.OptionError, match="must be one of"):
            quality.cells(name)


def test_doubt_is_in_the_warning_the_repr_and_every_file(images: tuple[Grey, Grey], tmp_path: Path) -> None:
    import meshio

    reference, deformed = images
    covered = occluded(0.08)(reference, deformed.copy())
    with pytest.warns((fedic.QualityWarning, fedic.ConvergenceWarning), match="cells are flagged"):
        result = fedic.correlate(reference, covered, MESHES["quad"])
    assert "doubtful" in repr(result)
    assert np.isnan(result.displacement[~result.valid_nodes]).all()
    assert np.isfinite(result.displacement[result.valid_nodes]).all()
    assert np.isfinite(result.unchecked_displacement).all()
    assert 0 < (~result.valid_nodes).sum() < 40
    strains = result.strains().components
    assert np.isnan(strains[~result.valid_cells]).all()

    for suffix in (".vtu", ".vtk", ".npz", ".json"):
        result.write(tmp_path / f"result{suffix}")
    grid = meshio.read(tmp_path / "result.vtu")
    np.testing.assert_array_equal(grid.point_data["flags"], result.quality.node_flags)
    np.testing.assert_array_equal(grid.cell_data["flags"][0], result.quality.cell_flags)
    assert b'Name="good"' in (tmp_path / "result.vtu").read_bytes()
    arrays = np.load(tmp_path / "result.npz")
    np.testing.assert_array_equal(arrays["valid_nodes"], result.valid_nodes)
    assert not arrays["good"]
    summary = json.loads((tmp_path / "result.json").read_text())["quality"]
    assert not summary["good"]
    assert any("uncorrelated" in reason for reason in summary["reasons"])
    title = result.plot("x").axes[0].get_title()
    assert "cells flagged" in title

    copy = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(copy.quality.cell_flags, result.quality.cell_flags)


def test_unconverged_measurements_warn_and_flag_every_node(images: tuple[Grey, Grey]) -> None:
    with pytest.warns(fedic.ConvergenceWarning, match="did not converge"):
        result = fedic.correlate(*images, MESHES["quad"], max_iterations=1, initial="zero")
    assert (result.quality.node_flags != 0).all()
    assert not result.quality.is_good
