"""Calibrate with points of a stretched target, with and without the stretch as an unknown; for docs/targets.md."""

import sys
import warnings
from pathlib import Path

import numpy as np

from fedic import BrownDistortion, CalibrationWarning
from fedic.calibration import Target, calibrate_points
from fedic.calibration._adjustment.fit import fit
from fedic.calibration.lenses import RADIAL
from fedic.calibration.observation import Observation

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

_NOISE_PX = 0.03


def main() -> None:
    """Print a row for each stretch."""
    from scenes.targets import CENTRE, FOCAL, SHAPE, poses

    board, lens = Target("chessboard", 11, 8, 8.0), BrownDistortion((-0.15, 0.0, 0.0))
    truth = np.array([*FOCAL, *CENTRE])
    for stretch in (0.0, 0.0025, 0.005, 0.01, 0.02):
        rng = np.random.default_rng(0)
        points = board.points * [1.0, 1.0 + stretch, 1.0]
        pixels = [
            camera.project(points) + rng.normal(0.0, _NOISE_PX, (len(points), 2)) for camera in poses(board, 12, lens)
        ]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", CalibrationWarning)
            found = calibrate_points([board.points] * 12, pixels, SHAPE[::-1])
        square = fit(RADIAL, [Observation(board.points, each) for each in pixels], SHAPE[::-1])
        value, deviation = found.target_shape.get("stretch", (0.0, 0.0))
        cells = [f"{100 * stretch:g} %", f"{100 * value:.3f} ± {100 * deviation:.3f} %" if deviation else "not freed"]
        for intrinsics in (np.array(list(found.parameters.values())), square.estimate.intrinsics):
            errors = intrinsics[:4] - truth
            cells += [f"{np.hypot(*errors[:2]) / np.sqrt(2.0):.2f} px, {np.hypot(*errors[2:]):.2f} px"]
        sys.stdout.write(f"| {' | '.join(cells)} |\n")


if __name__ == "__main__":
    main()
