"""``fedic calibrate``: a camera from images of a flat target."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import (
    CameraOption,
    OverwriteOption,
    PictureOption,
    check_picture,
    reported_errors,
)
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table
from fedic.errors import CameraError

if TYPE_CHECKING:
    from fedic.calibration import Calibration


def calibrate_command(
    images: Annotated[list[Path], typer.Argument(metavar="IMAGES...", help="Views of the target; 10 to 20 of them.")],
    target: Annotated[
        str,
        typer.Option(
            "--target",
            help="chessboard:11x7:8 (inner corners, square), circles:9x7:10, asymmetric-circles:4x11:10, "
            "ring-dots:14x10:10:3x2:8x6 (dots, pitch, dots left of and below the ring at the origin, steps to the "
            "other two) or charuco:12x8:10:7:DICT_5X5_100; two pitches as 8x8.04; its unit of length becomes the "
            "world's.",
        ),
    ],
    distortion: Annotated[
        str,
        typer.Option(
            "--distortion",
            help="none, radial1, radial2, radial3, decentering, prism, brown, or several joined by +; spline or "
            "inverse-spline for a lens of any shape.",
        ),
    ] = "radial1",
    output: CameraOption = Path("camera.toml"),
    picture: PictureOption = None,
    view: Annotated[
        str | None, typer.Option("--view", help="Image whose pose the camera takes; by default the first accepted.")
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Calibrate a camera from images of a flat target."""
    with reported_errors():
        from fedic.calibration import calibrate
        from fedic.calibration.lenses import parse_lens
        from fedic.cameras.files import check_writable

        check_writable(output, overwrite=overwrite)
        if isinstance(parse_lens(distortion), str) and output.suffix.lower() != ".toml":
            raise CameraError(f"{output}: only a .toml file can hold a spline lens; give --output camera.toml.")
        check_picture(picture, images, overwrite=overwrite)
        with TerminalProgress("calibration") as progress:
            calibration = calibrate([*images], target, distortion, view=view, progress=progress)
        _print_calibration(calibration)
        existed = output.exists()
        calibration.write(output, overwrite=overwrite)
        if picture is not None:
            calibration.plot(picture)
        echo(f"Camera {'replaced in' if existed else 'written to'} {output}")


def _print_calibration(calibration: "Calibration") -> None:
    rows = []
    for view in calibration.views:
        counts = f"{view.used.sum()}/{len(view.used)}" if view.found else ""
        errors = [f"{error:.3f}" if view.found else "" for error in (view.initial_error, view.final_error)]
        rows.append([Path(view.name).name, counts, *errors, "" if view.accepted else f"rejected: {view.reason}"])
    print_table(
        f"Views ({calibration.distortion}): distance of measured and projected points, in pixels",
        ("view", "points", "initial", "final", ""),
        rows,
        left=("view", ""),
    )
    print_table(
        f"Camera: {calibration.reprojection_error:.4f} px rms",
        ("parameter", "value", "standard deviation"),
        [
            (name, f"{value:.6g}", f"{calibration.standard_deviations[name]:.2g}")
            for name, value in calibration.parameters.items()
        ]
        + [
            (f"target {name}", f"{value:.6g}", f"{deviation:.2g}")
            for name, (value, deviation) in calibration.target_shape.items()
        ],
    )
    for sentence in calibration.advice:
        echo(f"Advice: {sentence}")
