"""Measure the stored images with pyvale (subsets of 21 px) and store the displacement at the centres of the subsets.

Run it in an environment of its own: pip install pyvale==2026.10.2
"""

import tempfile
from importlib.metadata import version
from pathlib import Path

import cv2
import numpy as np
import pyvale.dic as dic  # type: ignore[import-not-found]

FOLDER = Path(__file__).parent
SHAPE = (160, 200)
REGION = (46, 37, 155, 124)
SUBSET, STEP = 21, 6


def main() -> None:
    """Measure and store."""
    u0, v0, u1, v1 = REGION
    region = np.zeros(SHAPE, dtype=bool)
    region[v0:v1, u0:u1] = True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for image in ("reference", "deformed"):  # pyvale reads no PNG
            levels = cv2.imread(str(FOLDER / "images" / f"{image}.png"), cv2.IMREAD_UNCHANGED)
            cv2.imwrite(str(folder / f"{image}.tiff"), levels, [cv2.IMWRITE_TIFF_COMPRESSION, 1])
        dic.calculate_2d(
            reference=folder / "reference.tiff",
            deformed=[folder / "deformed.tiff"],
            roi_mask=region,
            seed=[(u0 + u1) // 2, (v0 + v1) // 2],
            subset_size=SUBSET,
            subset_step=STEP,
            shape_function="QUAD",
            output_basepath=folder,
            print_level=0,
        )
        (table,) = folder.glob("*.csv")
        found = dic.import_2d(table, delimiter=",", layout="column", print_level=0)
    columns = (found.ss_x, found.ss_y, found.u_px, found.v_px)
    u, v, along_u, along_v = (np.ravel(np.asarray(column, dtype=np.float64)) for column in columns)
    measured = np.isfinite(along_u)
    np.savez_compressed(
        FOLDER / "pyvale_results.npz",
        version=np.array(version("pyvale")),
        points=np.column_stack([u, v])[measured],
        displacement=np.column_stack([along_u, along_v])[measured],
    )


if __name__ == "__main__":
    main()
