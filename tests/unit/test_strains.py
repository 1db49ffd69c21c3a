"""Strains: measures, positions, axes, principal values, and the files and pictures that hold them."""

import json
from pathlib import Path
from typing import get_args

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic._core import CELL_TYPES, STRAIN_MEASURES
from fedic.plotting import plot_strain
from fedic.results import StrainMeasure

Floats = NDArray[np.float64]
FINITE = ("green-lagrange", "hencky")


def turn(angle: float) -> Floats:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def mapped_mesh(cell: str) -> fedic.Mesh:
    """Return a mesh of curved cells that is 100 wide and 80 high."""
    flat = fedic.rectangle_mesh((0, 0, 100, 80), 10, cell)
    x, y = flat.points.T
    return fedic.Mesh(np.column_stack([x + 3 * np.sin(y / 20), y + 0.1 * x + 2 * np.sin(x / 15)]), flat.cells)


def moved(mesh: fedic.Mesh, deformation: Floats) -> Floats:
    return np.asarray(mesh.points @ deformation.T - mesh.points)


def positions(mesh: fedic.Mesh) -> list[object]:
    return ["cells", "nodes", mesh.points.mean(axis=0) + np.random.default_rng(0).uniform(-20, 20, (50, 2))]


def test_the_names_of_the_measures_are_those_of_the_core() -> None:
    assert get_args(StrainMeasure) == STRAIN_MEASURES


@pytest.mark.parametrize("angle", [10.0, 45.0, 90.0, 180.0])
@pytest.mark.parametrize("cell", CELL_TYPES)
def test_finite_strains_of_a_rigid_rotation_are_zero(cell: str, angle: float) -> None:
    mesh = mapped_mesh(cell)
    displacement = moved(mesh, turn(np.radians(angle))) + np.array([12.0, -7.0])
    for at in positions(mesh):
        for measure in FINITE:
            strains = mesh.strains(displacement, measure, at)  # type: ignore[arg-type]
            np.testing.assert_allclose(strains, 0.0, atol=1e-12)
        small = mesh.strains(displacement, "small", at)  # type: ignore[arg-type]
        np.testing.assert_allclose(small.exx, np.cos(np.radians(angle)) - 1.0, atol=1e-12)


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_strains_of_a_uniform_deformation_are_exact_everywhere(cell: str) -> None:
    mesh = mapped_mesh(cell)
    stretch = turn(0.4) @ np.diag([1.5, 0.8]) @ turn(-0.4)
    deformation = turn(2.0) @ stretch
    exact = {
        "green-lagrange": turn(0.4) @ np.diag([0.5 * (1.5**2 - 1), 0.5 * (0.8**2 - 1)]) @ turn(-0.4),
        "hencky": turn(0.4) @ np.diag(np.log([1.5, 0.8])) @ turn(-0.4),
        "small": 0.5 * (deformation + deformation.T) - np.eye(2),
    }
    for measure, tensor in exact.items():
        for at in positions(mesh):
            strains = mesh.strains(moved(mesh, deformation), measure, at)  # type: ignore[arg-type]
            np.testing.assert_allclose(strains.values, np.broadcast_to(tensor, strains.values.shape), atol=1e-12)
            assert strains.measure == measure


def test_principal_strains_and_directions() -> None:
    mesh = mapped_mesh("quad")
    displacement = moved(mesh, turn(1.0) @ turn(0.4) @ np.diag([1.2, 0.9]) @ turn(-0.4))
    for axes in (None, 0.7, "cylindrical"):
        strains = mesh.strains(displacement, "hencky", axes=axes)  # type: ignore[arg-type]
        np.testing.assert_allclose(strains.principal, np.broadcast_to(np.log([1.2, 0.9]), (80, 2)), atol=1e-12)
        along = np.abs(strains.directions @ turn(0.4))
        np.testing.assert_allclose(along, np.broadcast_to(np.eye(2), (80, 2, 2)), atol=1e-12)


def test_principal_values_agree_with_an_eigenvalue_solver() -> None:
    random = np.random.default_rng(3)
    mesh = mapped_mesh("quad8")
    strains = mesh.strains(random.uniform(-1, 1, mesh.points.shape), at="nodes")
    values, vectors = np.linalg.eigh(strains.values)
    np.testing.assert_allclose(strains.principal, values[:, ::-1], atol=1e-13)
    cosines = np.einsum("nka,nak->nk", strains.directions, vectors[:, :, ::-1])
    np.testing.assert_allclose(np.abs(cosines), 1.0, atol=1e-9)


def test_von_mises_strain_is_the_axial_strain_of_an_incompressible_bar() -> None:
    mesh = mapped_mesh("triangle")
    bar = mesh.strains(moved(mesh, np.diag([1.3, 1.3**-0.5])), "hencky")
    np.testing.assert_allclose(bar.von_mises, np.log(1.3), atol=1e-12)
    shear = mesh.strains(moved(mesh, np.array([[1.0, 0.02], [0.0, 1.0]])), "small")
    np.testing.assert_allclose(shear.exy, 0.01, atol=1e-13)
    np.testing.assert_allclose(shear.von_mises, 0.02 / np.sqrt(3.0), atol=1e-12)


@pytest.mark.parametrize("measure", STRAIN_MEASURES)
def test_turned_axes_rotate_the_tensor(measure: StrainMeasure) -> None:
    mesh = mapped_mesh("triangle6")
    displacement = np.random.default_rng(1).uniform(-0.5, 0.5, mesh.points.shape)
    for at in positions(mesh):
        plain = mesh.strains(displacement, measure, at)  # type: ignore[arg-type]
        turned = mesh.strains(displacement, measure, at, 0.3)  # type: ignore[arg-type]
        np.testing.assert_allclose(turned.values, turn(0.3).T @ plain.values @ turn(0.3), atol=1e-13)
        np.testing.assert_allclose(turned.axes, np.broadcast_to(turn(0.3).T, turned.axes.shape), atol=1e-15)
        np.testing.assert_array_equal(turned.positions, plain.positions)


def test_cylindrical_strains_of_an_expanding_ring() -> None:
    """``u_r = a r + b / r`` about a centre: radial strain ``a - b / r^2``, circumferential ``a + b / r^2``."""
    a, b, centre = 0.01, 4.0, np.array([-20.0, 15.0])
    for given, origin in ((centre, centre), (None, np.zeros(2))):
        grid = fedic.rectangle_mesh((30.0, 0.0, 60.0, 30.0), 1.5, "quad9")
        r, angle = grid.points.T
        outward = np.column_stack([np.cos(angle / 20), np.sin(angle / 20)])
        mesh = fedic.Mesh(origin + r[:, np.newaxis] * outward, grid.cells)
        displacement = (a * r + b / r)[:, np.newaxis] * outward
        for at in ("cells", "nodes"):
            strains = mesh.strains(displacement, "small", at, "cylindrical", centre=given)  # type: ignore[arg-type]
            radius = np.linalg.norm(strains.positions - origin, axis=1)
            np.testing.assert_allclose(strains.exx, a - b / radius**2, atol=5e-5)
            np.testing.assert_allclose(strains.eyy, a + b / radius**2, atol=5e-5)
            np.testing.assert_allclose(strains.exy, 0.0, atol=5e-5)
            np.testing.assert_allclose(strains.axes[:, 0], (strains.positions - origin) / radius[:, np.newaxis])


def test_points_outside_the_mesh_are_nan_and_a_third_coordinate_is_ignored() -> None:
    mesh = fedic.rectangle_mesh((0, 0, 4, 3), 1)
    displacement = moved(mesh, np.diag([1.1, 1.0]))
    strains = mesh.strains(displacement, at=[[1.3, 2.2], [5.0, 1.0], [4.0, 3.0]])
    np.testing.assert_allclose(strains.exx, [0.105, np.nan, 0.105], atol=1e-14)
    np.testing.assert_array_equal(strains.positions, [[1.3, 2.2], [5.0, 1.0], [4.0, 3.0]])
    deep = mesh.strains(displacement, at=[[1.3, 2.2, 7.0]])
    np.testing.assert_array_equal(deep.components, strains.components[:1])


@pytest.mark.parametrize("cell", CELL_TYPES)
def test_nodes_not_measured_give_nan_in_their_cells_only(cell: str) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 6, 4), 1, cell)
    displacement = moved(mesh, np.array([[1.1, 0.05], [0.0, 0.9]]))
    missing = np.flatnonzero((mesh.points == (3.0, 2.0)).all(axis=1))
    displacement[missing] = np.nan
    (cells,) = mesh.cells.values()
    holed = (cells == missing).any(axis=1)
    known = np.zeros(mesh.num_nodes, dtype=bool)
    known[cells[~holed]] = True
    exact = [0.105, 0.5 * (0.05**2 + 0.81 - 1.0), 0.5 * 1.1 * 0.05]
    for at, valid in (("cells", ~holed), ("nodes", known)):
        strains = mesh.strains(displacement, at=at)  # type: ignore[arg-type]
        np.testing.assert_allclose(strains[valid], np.tile(exact, (valid.sum(), 1)), atol=1e-13)
        assert np.isnan(strains[~valid]).all()
        assert not valid.all()


def test_cells_that_are_not_valid_are_left_out() -> None:
    mesh = fedic.rectangle_mesh((0, 0, 4, 1), 1)
    displacement = np.where(mesh.points[:, :1] > 1.5, [[0.5, 0.0]], 0.0)
    valid = np.array([True, False, True, True])
    np.testing.assert_allclose(mesh.strains(displacement, valid_cells=valid).exx, [0, np.nan, 0, 0], atol=1e-15)
    np.testing.assert_allclose(mesh.strains(displacement, at="nodes", valid_cells=valid), 0.0, atol=1e-15)
    point = [[1.5, 0.5]]
    assert mesh.strains(displacement, at=point).exx[0] > 0.5
    assert np.isnan(mesh.strains(displacement, at=point, valid_cells=valid).exx).all()


def test_strains_on_a_surface_in_space_do_not_change_with_a_rigid_motion() -> None:
    flat = fedic.rectangle_mesh((0, 0, 10, 8), 1, "quad8")
    x, y = flat.points.T
    mesh = fedic.Mesh(np.column_stack([x, y, 0.05 * x * y]), flat.cells)
    displacement = mesh.rotated((0.3, -0.5, np.pi / 2)).points - mesh.points
    for at in ("cells", "nodes", [[5.0, 4.0], [2.2, 3.1]]):
        for measure in FINITE:
            strains = mesh.strains(displacement, measure, at)  # type: ignore[arg-type]
            np.testing.assert_allclose(strains, 0.0, atol=1e-12)
            assert strains.positions.shape == (len(strains), 3)
            assert strains.directions.shape == (len(strains), 2, 3)
            np.testing.assert_allclose(np.linalg.norm(strains.directions, axis=2), 1.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"measure": "engineering"}, 'unknown strain measure "engineering"; choose one of "green-lagrange", "hencky"'),
        ({"at": "corners"}, 'at must be "cells", "nodes" or an array of points .* got "corners"'),
        ({"at": [1.0, 2.0]}, "at must be a 2-dimensional array"),
        ({"axes": "polar"}, "axes must be a finite angle in radians, \"cylindrical\" or None, got 'polar'"),
        ({"axes": np.inf}, "axes must be a finite angle"),
        ({"centre": (1.0, 2.0)}, 'centre needs axes="cylindrical"'),
        ({"axes": "cylindrical", "centre": (1.0, 2.0, 3.0)}, "centre must be two finite numbers"),
        ({"valid_cells": [True]}, "valid_cells must be an array of 4 bool"),
        ({"valid_cells": np.ones(3, dtype=bool)}, "valid_cells must be an array of 4 bool"),
    ],
)
def test_bad_arguments_are_refused(arguments: dict[str, object], message: str) -> None:
    mesh = fedic.rectangle_mesh((0, 0, 2, 2), 1)
    with pytest.raises(fedic.OptionError, match=message) as caught:
        mesh.strains(np.zeros((9, 2)), **arguments)  # type: ignore[arg-type]
    assert caught.value.option in arguments


def test_numpy_takes_strains_as_their_components(result: fedic.Result) -> None:
    strains = result.strains()
    assert repr(strains) == "Strains(green-lagrange, 35 positions)"
    assert strains.shape == np.asarray(strains).shape == (35, 3)
    np.testing.assert_array_equal(strains[:, 1], strains.eyy)
    np.testing.assert_array_equal(strains.mean(0), np.mean(strains, axis=0))  # type: ignore[call-overload]
    np.testing.assert_array_equal(np.abs(strains), np.abs(strains.components))  # type: ignore[call-overload]


@pytest.mark.parametrize("measure", STRAIN_MEASURES)
@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".npz", ".json"])
def test_files_name_the_measure_of_their_strains(
    result: fedic.Result, tmp_path: Path, suffix: str, measure: StrainMeasure
) -> None:
    path = result.write(tmp_path / f"result{suffix}", measure=measure)
    if suffix == ".json":
        assert json.loads(path.read_text())["strain_measure"] == measure
    elif suffix == ".npz":
        with np.load(path) as arrays:
            assert arrays["strain_measure"] == measure
            np.testing.assert_array_equal(arrays["strains"], result.strains(measure))
    else:
        fields = meshio.read(path).cell_data
        name = measure.replace("-", "_")
        for component, values in zip(("xx", "yy", "xy"), result.strains(measure).components.T, strict=True):
            np.testing.assert_array_equal(fields[f"{name}_strain_{component}"][0], values)
        deviations = result.covariance().strain_deviations(measure)
        for component, values in zip(("xx", "yy", "xy"), deviations.T, strict=True):
            np.testing.assert_allclose(fields[f"{name}_strain_std_{component}"][0], values)
        assert sum("strain" in field for field in fields) == 6


def test_an_unknown_measure_writes_no_file(result: fedic.Result, tmp_path: Path) -> None:
    with pytest.raises(fedic.OptionError, match="unknown strain measure"):
        result.write(tmp_path / "result.json", measure="engineering")  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("field", ["exx", "eyy", "exy", "e1", "e2", "von_mises"])
@pytest.mark.parametrize(("measure", "name"), [("green-lagrange", "Green-Lagrange"), ("hencky", "Hencky")])
def test_pictures_name_the_measure(result: fedic.Result, field: str, measure: StrainMeasure, name: str) -> None:
    axes, bar = result.plot(field, measure=measure).axes  # type: ignore[arg-type]
    assert bar.get_ylabel().endswith(f"({name} strain)")
    drawn = axes.collections[0].get_array()
    assert drawn is not None
    strains = result.strains(measure, at="nodes")
    e1, e2 = strains.principal.T
    values = {"exx": strains.exx, "eyy": strains.eyy, "exy": strains.exy, "von_mises": strains.von_mises}
    values |= {"e1": e1, "e2": e2}
    np.testing.assert_array_equal(np.asarray(drawn)[: len(strains)], values[field])


def test_plot_draws_displacements_too(result: fedic.Result) -> None:
    assert result.plot("u", on="reference").axes[1].get_ylabel() == "u (px)"
    with pytest.raises(fedic.OptionError, match='field must be one of "exx"'):
        result.plot("ezz")  # type: ignore[arg-type]


def test_cells_that_are_not_measured_are_left_blank(result: fedic.Result) -> None:
    from dataclasses import replace

    displacement = result.displacement.copy()
    displacement[10] = np.nan
    holed = replace(result, displacement=displacement)
    image = np.zeros((160, 200), dtype=np.uint8)
    full, part = (plot_strain(each, image, on="reference").axes[0].collections[0] for each in (result, holed))
    counts = [len(each._triangulation.triangles) for each in (full, part)]  # type: ignore[attr-defined]
    cells = (result.mesh.cells["quad"] == 10).any(axis=1).sum()
    assert counts[0] - counts[1] == 4 * cells > 0
