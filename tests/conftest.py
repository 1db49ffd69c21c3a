from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic

REPOSITORY = Path(__file__).resolve().parents[1]
SHARED = REPOSITORY.parent / "shared"


def _finder(folder: Path) -> Callable[[str], Path]:
    def find(name: str) -> Path:
        path = folder / name
        if not path.exists():
            pytest.skip(f"needs {name}, which is not in {folder}")
        return path

    return find


@pytest.fixture(scope="session")
def repository() -> Path:
    """Return the root of the repository."""
    return REPOSITORY


@pytest.fixture(scope="session")
def shared_data() -> Callable[[str], Path]:
    """Return a function that finds a file of real images and meshes, or skips the test if it is absent."""
    return _finder(SHARED / "data")


@pytest.fixture(scope="session")
def shared_reference() -> Callable[[str], Path]:
    """Return a function that finds a file of reference results, or skips the test if it is absent."""
    return _finder(SHARED / "reference")


@pytest.fixture(scope="session")
def gmsh() -> Any:
    try:
        import gmsh
    except (ImportError, OSError) as error:
        pytest.skip(f"gmsh or one of its system libraries is not on this machine: {error}")
    return gmsh


@pytest.fixture(scope="session")
def speckle_pair() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return two 160 x 200 images, the material of the second moved by (1.3, -0.6) px."""
    texture = fedic.synthetic.Speckle(4.0, seed=1)
    camera = fedic.ImageFrame()
    reference = fedic.synthetic.render(texture, camera, (160, 200))
    deformed = fedic.synthetic.render(texture, camera, (160, 200), displacement=(1.3, -0.6))
    assert reference.dtype == deformed.dtype == np.uint8
    return reference, deformed  # type: ignore[return-value]


@pytest.fixture(scope="session")
def result(speckle_pair: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> fedic.Result:
    return fedic.correlate(*speckle_pair, fedic.rectangle_mesh((30, 30, 170, 130), size=20))
