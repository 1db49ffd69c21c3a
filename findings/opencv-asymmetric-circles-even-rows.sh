#!/usr/bin/env bash
# OpenCV 5.0.0: findCirclesGrid numbers an asymmetric grid with an even number of rows in a wrong order
#
# Behaviour: the centres of an asymmetric grid come row by row, at (2 j + i % 2, i) for place j of row i: so calibrations number the
#   target. With 4 x 7 circles they do. With 4 x 8, 4 x 10 and 4 x 12 each two rows are exchanged: the best homography from the target
#   to the centres is 38 px off on circles 30 px apart. The function returns true, and a calibration that trusts it is wrong.
# Expected: an order that a homography explains, for any number of rows.
# Output seen (opencv-python-headless 5.0.0.93, NumPy 2.4): misfit 0.0 px for 7 rows, 38.6 px for 8 and for 10
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check opencv-python-headless==5.0.0.93 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'PYTHON'
import cv2
import numpy as np


def misfit(rows: int) -> float:
    """Draw a grid of 4 x rows circles, and return how far its centres are from the target, in pixels."""
    target = np.array([[(2 * j + i % 2) * 30.0, i * 30.0] for i in range(rows) for j in range(4)])
    to_image = np.array([[1.0, 0.05, 80.0], [0.02, 1.0, 60.0], [2e-4, 1e-4, 1.0]])
    image = np.full((520, 520), 255, np.uint8)
    for u, v in cv2.perspectiveTransform(target[:, None], to_image).reshape(-1, 2):
        cv2.circle(image, (round(16 * u), round(16 * v)), 8 * 16, 0, -1, cv2.LINE_AA, 4)
    found, centres = cv2.findCirclesGrid(image, (4, rows), flags=cv2.CALIB_CB_ASYMMETRIC_GRID)
    assert found, f"no grid of {rows} rows is found"
    centres = np.reshape(centres, (-1, 2))
    homography, _ = cv2.findHomography(target, centres)
    explained = cv2.perspectiveTransform(target[:, None], homography).reshape(-1, 2)
    return float(np.sqrt(((explained - centres) ** 2).sum(axis=1).mean()))


found = {rows: misfit(rows) for rows in (7, 8, 10)}
print(*(f"{rows} rows: misfit {value:.1f} px" for rows, value in found.items()), sep="\n")
assert found[7] < 0.1, "the behaviour has changed"
assert min(found[8], found[10]) > 30.0, "the behaviour has changed"
PYTHON
