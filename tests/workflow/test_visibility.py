"""Surfaces in space that one camera sees from the front, from behind, or along."""

import numpy as np
import pytest

import fedic


def cylinder(half_angle: float, cells: int = 24) -> fedic.Mesh:
    """Return a part of a cylinder about a vertical axis; the middle of the part is nearest to the camera."""
    angles, heights = np.meshgrid(np.linspace(-half_angle, half_angle, cells + 1), np.linspace(40.0, 160.0, 7))
    points = np.column_stack([(100.0 + 70.0 * np.sin(angles)).ravel(), heights.ravel(), -70.0 * np.cos(angles).ravel()])
    lower = (np.arange(6)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    quads = np.column_stack([lower, lower + 1, lower + cells + 2, lower + cells + 1])
    return fedic.Mesh(points, {"quad": quads})


def plane(normal: str) -> fedic.Mesh:
    flat = fedic.rectangle_mesh((20, 20, 180, 180), 20)
    first, second = flat.points.T
    level = np.full_like(first, 100.0)
    columns = {"x": (level, first, second), "y": (first, level, second), "z": (first, second, level)}[normal]
    return fedic.Mesh(np.column_stack(columns), flat.cells)


@pytest.fixture(scope="module")
def images() -> tuple[np.ndarray, np.ndarray]:
    texture = fedic.synthetic.Speckle(5.0, seed=3)
    render = fedic.synthetic.render
    return render(texture, fedic.ImageFrame(), (200, 200)), render(
        texture, fedic.ImageFrame(), (200, 200), displacement=(0.4, -0.3)
    )


def test_a_surface_that_faces_the_camera_is_measured(images: tuple[np.ndarray, np.ndarray]) -> None:
    result = fedic.correlate(*images, cylinder(1.2), initial="zero")
    assert np.abs(result.displacement - (0.4, -0.3)).max() < 0.02


def test_a_plane_at_any_height_is_measured(images: tuple[np.ndarray, np.ndarray]) -> None:
    result = fedic.correlate(*images, plane("z"), initial="zero")
    assert np.abs(result.displacement - (0.4, -0.3)).max() < 0.01


@pytest.mark.parametrize(("half_angle", "hidden"), [(2.2, 6), (np.pi, 12)])
def test_cells_behind_the_specimen_are_refused(
    images: tuple[np.ndarray, np.ndarray], half_angle: float, hidden: int
) -> None:
    mesh = cylinder(half_angle)
    with pytest.raises(fedic.MeshError, match="cells face away from the camera") as refused:
        fedic.correlate(*images, mesh)
    centres = mesh.points[mesh.cells["quad"][refused.value.cells]].mean(axis=1)
    assert len(refused.value.cells) == 6 * hidden
    assert (centres[:, 2] > 0.0).all()


@pytest.mark.parametrize("normal", ["x", "y"])
def test_a_plane_seen_along_its_surface_is_refused_with_the_remedy(
    images: tuple[np.ndarray, np.ndarray], normal: str
) -> None:
    with pytest.raises(fedic.MeshError, match=r"parallel to the z axis; one camera measures .*mesh\.rotated"):
        fedic.correlate(*images, plane(normal))


def test_a_plane_is_measured_once_it_is_turned_with_the_camera(images: tuple[np.ndarray, np.ndarray]) -> None:
    about_x = (np.pi / 2.0, 0.0, 0.0)
    turned = plane("y").rotated(about_x)
    result = fedic.correlate(*images, turned.scaled(1.0).translated((0.0, 200.0, 0.0)), initial="zero")
    assert np.abs(result.displacement - (0.4, -0.3)).max() < 0.01
