"""Measure the scatter of displacement, strain and gauges against the prediction; for docs/uncertainty.md."""

import warnings
from typing import Any

import numpy as np

import fedic

_DRAWS, _NOISE, _SIDE = 300, 2.0, 300
_SHIFT = np.array([0.37, -0.21])
_CASES: tuple[tuple[str, float, dict[str, Any]], ...] = (
    ("triangle", 20.0, {}),
    ("triangle6", 40.0, {}),
    ("quad", 20.0, {}),
    ("quad8", 40.0, {}),
    ("quad9", 40.0, {}),
    ("quad", 20.0, {"smoothing": 0.0}),
    ("quad", 20.0, {"regularization_length": 80.0}),
    ("quad", 20.0, {"robust": "tukey"}),
)


def main() -> None:
    """Print measured over predicted standard deviations: inner nodes, border nodes, strains of cells, a gauge."""
    warnings.simplefilter("ignore")
    speckle = fedic.synthetic.Speckle(5.0, seed=3)
    v, u = np.mgrid[:_SIDE, :_SIDE]
    grid = np.stack([u, v], axis=-1).reshape(-1, 2).astype(float)
    scenes = [35 + 180 * speckle.values(grid - shift).reshape(_SIDE, _SIDE) for shift in (np.zeros(2), _SHIFT)]
    places = np.stack(np.meshgrid(*2 * [np.linspace(100, 190, 30)]), axis=-1).reshape(-1, 2)
    for cell, size, options in _CASES:
        mesh, rng = fedic.rectangle_mesh((20.3, 20.6, 280.0, 280.0), size, cell), np.random.default_rng(1)  # type: ignore[arg-type]
        start = np.tile(_SHIFT, (mesh.num_nodes, 1))
        fields, strains, gauges, covariance = [], [], [], None
        for _ in range(_DRAWS):
            images = [(scene + rng.normal(0, _NOISE, scene.shape)).astype(np.float32) for scene in scenes]
            result = fedic.correlate(images[0], images[1], mesh, initial=start, noise=_NOISE, **options)
            covariance = covariance or result.covariance()
            fields.append(result.unchecked_displacement)
            strains.append(mesh.strains(fields[-1]).components)
            gauges.append(mesh.strains(fields[-1], "green-lagrange", places).components.mean(axis=0))
        assert covariance is not None
        nodes = np.std(fields, axis=0, ddof=1) / covariance.standard_deviations
        low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
        border = np.any(np.isclose(mesh.points[:, :2], low) | np.isclose(mesh.points[:, :2], high), axis=1)
        of_cells = (np.std(strains, axis=0, ddof=1) / covariance.strain_deviations()).mean()
        of_gauge = np.std(gauges, axis=0, ddof=1) / np.sqrt(np.diag(covariance.gauge(places)))
        print(  # noqa: T201
            f"{cell:10}{options!s:32} inner {nodes[~border].mean():.3f}, border {nodes[border].mean():.3f}, "
            f"strain {of_cells:.3f}, gauge {np.round(of_gauge, 2)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
