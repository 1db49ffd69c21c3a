"""Bad input raises a typed error that says what is wrong, where, and what to do."""

import numpy as np
import pytest

import fedic

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return fedic.synthetic.render(fedic.synthetic.Speckle(4.0), fedic.ImageFrame(), (100, 120))


@pytest.mark.parametrize(
    ("points", "cells", "message", "at"),
    [
        ([[0, 0], [1, 0], [float("nan"), 1]], {"triangle": [[0, 1, 2]]}, "node 2 has a coordinate that is", ([], [2])),
        (SQUARE, {"quad": [[0, 1, 2, 4]]}, r"cell 0 \(quad\) refers to node 4, but the nodes are 0 to 3", ([0], [])),
        (SQUARE, {"quad": [[0, 1, 2, -1]]}, "refers to node -1", ([0], [])),
        (SQUARE, {"quad": [[0, 1, 2]]}, "cells of type quad need 4 nodes each, but 3 were given", ([], [])),
        (SQUARE, {"hexahedron": [[0, 1, 2, 3]]}, 'unknown cell type "hexahedron"', ([], [])),
        (SQUARE, {"quad": [[0, 1, 3, 2]]}, "cell 0 has zero area or a Jacobian that changes sign", ([0], [])),
        (SQUARE, {"triangle": [[0, 1, 2], [0, 1, 1]]}, "cell 1 has zero area", ([1], [])),
        (SQUARE, {"quad": [[0, 1, 2, 2.5]]}, r'cells\["quad"\] must be a 2-dimensional array of integers', ([], [])),
        (SQUARE, {}, "no surface cells", ([], [])),
        ([[0, 0, 0, 0]], {"quad": [[0, 1, 2, 3]]}, r"points must have shape \(n, 2\) or .* got \[1, 4\]", ([], [])),
        ("abc", {"quad": [[0, 1, 2, 3]]}, "points must be a 2-dimensional array of real numbers, got str", ([], [])),
        (SQUARE, [[0, 1, 2, 3]], "cells must be a mapping", ([], [])),
    ],
)
def test_bad_meshes_are_refused_with_cells_and_nodes(
    points: object, cells: object, message: str, at: tuple[list[int], list[int]]
) -> None:
    with pytest.raises(fedic.MeshError, match=message) as error:
        fedic.Mesh(points, cells)  # type: ignore[arg-type]
    assert (error.value.cells, error.value.nodes) == at


def test_clockwise_cells_are_reversed() -> None:
    mesh = fedic.Mesh(SQUARE, {"quad": [[0, 3, 2, 1]]})
    np.testing.assert_array_equal(mesh.flipped_cells, [0])
    np.testing.assert_array_equal(mesh.cells["quad"], [[0, 1, 2, 3]])
    np.testing.assert_array_equal(mesh.areas(), [1.0])


def test_cells_outside_the_image_are_named(image: np.ndarray) -> None:
    with pytest.raises(
        fedic.MeshError, match=r"the whole mesh lies outside the reference image of 120 x 100 pixels"
    ) as all_cells:
        fedic.correlate(image, image, fedic.rectangle_mesh((500, 500, 560, 540), 20))
    assert all_cells.value.cells == list(range(6))
    with pytest.raises(
        fedic.MeshError, match=r"2 of 8 cells lie at least partly outside .* cells 3, 7; check the camera"
    ) as some:
        fedic.correlate(image, image, fedic.rectangle_mesh((50, 20, 130, 60), 20))
    assert some.value.cells == [3, 7]
    # A camera in the wrong unit is refused before billions of quadrature points are created.
    with pytest.raises(fedic.MeshError, match=r"cells lie at least partly outside|the whole mesh lies outside"):
        fedic.correlate(image, image, fedic.rectangle_mesh((20, 20, 100, 80), 20), fedic.FrontParallel(1e6))


def test_a_mesh_behind_the_camera_is_refused(image: np.ndarray) -> None:
    behind = fedic.Pinhole((1000, 1000), (60, 50), translation=(0, 0, -1.0))
    with pytest.raises(fedic.MeshError, match="the whole mesh lies outside"):
        fedic.correlate(image, image, fedic.rectangle_mesh((-0.01, -0.01, 0.01, 0.01), 0.01), behind)


@pytest.mark.parametrize("cell", ["triangle", "quad9"])
def test_images_without_texture_are_refused(image: np.ndarray, cell: str) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 100, 80), 20, cell)  # type: ignore[arg-type]
    flat = np.full_like(image, 80)
    with pytest.raises(fedic.ImageError, match="the reference image is flat where the mesh lies"):
        fedic.correlate(flat, image, mesh)
    with pytest.raises(fedic.ImageError, match="the deformed image is flat where the mesh lies"):
        fedic.correlate(image, flat, mesh)
    with pytest.raises(fedic.ImageError, match="flat"):
        fedic.correlate(image, flat, mesh, initial="pyramid")


def test_nodes_in_a_region_without_texture_are_named(image: np.ndarray) -> None:
    image = image.copy()
    image[:45, :45] = 100
    with pytest.raises(fedic.SolveError, match="the images do not determine the displacement of node") as error:
        fedic.correlate(image, image, fedic.rectangle_mesh((20, 20, 100, 80), 10))
    corner = fedic.rectangle_mesh((20, 20, 100, 80), 10).points[error.value.nodes]
    assert len(corner) > 0
    assert (corner <= 40).all()


def test_elements_with_too_few_quadrature_points_are_refused(image: np.ndarray) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 100, 80), 1.5)
    with pytest.raises(
        fedic.SolveError, match="holds 1 quadrature points for 8 unknowns; use larger elements"
    ) as error:
        fedic.correlate(image, image, mesh)
    assert error.value.nodes
    with pytest.raises(fedic.SolveError, match="holds 0 quadrature points"):
        fedic.correlate(image, image, fedic.rectangle_mesh((20, 20, 100, 80), 0.3), quadrature=fedic.PixelQuadrature())
    # The same mesh is measured once it is regularised.
    assert fedic.correlate(image, image, mesh, regularization_length=20.0).converged


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (lambda image: image[:-1], r"The deformed image is 120 x 99 px .* the reference image is 120 x 100 px"),
        (lambda image: image[0], r"The deformed image has shape \(120,\); give a grey image of shape"),
        (
            lambda image: image.astype(np.complex64),
            "The deformed image holds complex64 values; convert it to uint8, uint16 or float32",
        ),
        (
            lambda image: np.where(image > 200, np.nan, image).astype(np.float32),
            r"the deformed image: the grey level of pixel \(u = \d+, v = 0\) is not a finite number",
        ),
    ],
)
def test_bad_image_arrays_are_refused(image: np.ndarray, bad: object, message: str) -> None:
    with pytest.raises(fedic.ImageError, match=message):
        fedic.correlate(image, bad(image), fedic.rectangle_mesh((20, 20, 100, 80), 20))  # type: ignore[operator]


def test_divergence_is_reported(image: np.ndarray) -> None:
    """Uncorrelated images: the iterations end without convergence, or diverge and name the node."""
    other = fedic.synthetic.render(fedic.synthetic.Speckle(4.0, seed=99), fedic.ImageFrame(), (100, 120))
    mesh = fedic.rectangle_mesh((20, 20, 100, 80), 20)
    assert not fedic.correlate(image, other, mesh, max_iterations=8).converged
    fine = fedic.rectangle_mesh((20, 20, 100, 80), 2.0)
    with pytest.raises(fedic.SolveError, match=r"diverged at iteration .* moved by .* pixels in one step") as error:
        fedic.correlate(image, other, fine, max_iterations=200, initial="zero")
    assert error.value.nodes


def test_cells_that_leave_the_deformed_image_are_reported(image: np.ndarray) -> None:
    deformed = fedic.synthetic.render(
        fedic.synthetic.Speckle(4.0), fedic.ImageFrame(), (100, 120), displacement=(15.0, 0.0)
    )
    mesh = fedic.rectangle_mesh((16, 20, 116, 80), 20)
    result = fedic.correlate(image, deformed, mesh, initial=np.full((mesh.num_nodes, 2), (15.0, 0.0)))
    np.testing.assert_array_equal(result.outside_cells, [4, 9, 14])
    still_inside = mesh.points[:, 0] < 95
    np.testing.assert_allclose(
        result.displacement[still_inside], np.tile([15.0, 0.0], (still_inside.sum(), 1)), atol=0.03
    )
