"""Plots of meshes, displacements and residuals."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import fedic
from fedic.plotting import draw_nodal_field, plot_displacement, plot_mesh, plot_residual, save_figure

IMAGE = np.tile(np.arange(120, dtype=np.uint8), (90, 1))
CELLS = ("triangle", "triangle6", "quad", "quad8", "quad9")


def linear_result(cell: str) -> fedic.Result:
    mesh = fedic.rectangle_mesh((20, 30, 80, 70), size=10, cell=cell)  # type: ignore[arg-type]
    displacement = 0.01 * (mesh.points - (50, 50))
    return fedic.Result(
        mesh=mesh,
        camera=fedic.ImageFrame(),
        displacement=displacement,
        pixel_displacement=displacement,
        converged=True,
        error_left=0.0,
        iterations=1,
        history=[],
        num_points=100,
        residual_rms=1.0,
        cell_residuals=np.ones(mesh.num_cells),
        outside_cells=np.empty(0, dtype=np.int64),
        unchecked_displacement=displacement,
        quality=fedic.Quality.unknown(mesh, converged=True),
        start="given",
        unit="px",
    )


@pytest.mark.parametrize("cell", CELLS)
def test_a_linear_field_is_drawn_exactly(cell: str) -> None:
    from matplotlib.figure import Figure

    result = linear_result(cell)
    axes = Figure().add_subplot()
    drawn = draw_nodal_field(axes, result.mesh, result.mesh.points, result.displacement[:, 0])
    triangulation = drawn._triangulation  # type: ignore[attr-defined]
    corners = np.stack([triangulation.x, triangulation.y], axis=1)[triangulation.triangles]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    assert np.abs(ax * by - ay * bx).sum() / 2 == pytest.approx(60 * 40)
    np.testing.assert_allclose(drawn.get_array(), 0.01 * (triangulation.x - 50), atol=1e-12)


@pytest.mark.parametrize("cell", CELLS)
def test_plots_show_the_image_with_v_downwards(cell: str, tmp_path: Path) -> None:
    result = linear_result(cell)
    figure = plot_displacement(result, IMAGE, "x")
    axes, bar = figure.axes
    assert bar.get_ylabel() == "$U_x$ (px)"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("u (px)", "v (px)")
    bottom, top = axes.get_ylim()
    assert bottom > top
    left, right = axes.get_xlim()
    assert 10 < left < 20
    assert 80 < right < 90
    save_figure(figure, tmp_path / "displacement.png")
    save_figure(plot_mesh(result.mesh, result.camera, IMAGE), tmp_path / "mesh.png")
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["displacement.png", "mesh.png"]


def test_the_colour_scale_of_signed_fields_is_centred_on_zero() -> None:
    result = linear_result("quad")
    signed = plot_displacement(result, IMAGE, "x").axes[0].collections[0]
    assert signed.norm.vmin == -signed.norm.vmax  # type: ignore[operator]
    result = dataclasses.replace(result, displacement=result.displacement + 5.0)
    positive = plot_displacement(result, IMAGE, "x").axes[0].collections[0]
    assert positive.norm.vmin > 4.0  # type: ignore[operator]


def test_labels_state_the_unit_of_the_component() -> None:
    result = dataclasses.replace(linear_result("quad"), camera=fedic.FrontParallel(1.0, (0.0, 90.0)), unit="")
    assert plot_displacement(result, IMAGE, "y").axes[1].get_ylabel() == "$U_y$ (mesh unit)"
    assert plot_displacement(result, IMAGE, "v", on="reference").axes[1].get_ylabel() == "v (px)"


def test_residual_map_is_cropped_to_the_mesh() -> None:
    residual = np.full((90, 120), np.nan, dtype=np.float32)
    residual[30:70, 20:80] = np.random.default_rng(0).normal(0, 2, (40, 60))
    axes, _ = plot_residual(residual).axes
    assert 10 < axes.get_xlim()[0] < 20
    with pytest.raises(fedic.ImageError, match="no pixel inside"):
        plot_residual(np.full((9, 9), np.nan, dtype=np.float32))


def test_a_failed_plot_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(fedic.FedicError, match="does not exist"):
        save_figure(plot_mesh(linear_result("quad").mesh, fedic.ImageFrame(), IMAGE), tmp_path / "no" / "mesh.png")
    assert list(tmp_path.iterdir()) == []
