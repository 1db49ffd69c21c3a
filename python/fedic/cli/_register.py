"""``fedic register``: the pose of a mesh in an image."""

import warnings
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
from fedic.cli.exit_status import EXIT_DOUBTFUL
from fedic.cli.terminal import echo, print_table
from fedic.errors import QualityWarning

if TYPE_CHECKING:
    from fedic.registration import Registration


def register_command(
    mesh: Annotated[Path, typer.Argument(metavar="MESH", help="Mesh file, or a part of it: plate.msh#SKIN.")],
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="Reference image of the specimen.")],
    camera: Annotated[Path, typer.Argument(metavar="CAMERA", help="Camera file, with a rough pose.")],
    feature: Annotated[
        list[str] | None,
        typer.Option("--feature", help="Part of the mesh's boundary, such as 'left' or 'hole 0'; may be repeated."),
    ] = None,
    points: Annotated[
        Path | None, typer.Option("--points", help="Table of point pairs, one per line: X Y u v or X Y Z u v.")
    ] = None,
    target: Annotated[
        str | None, typer.Option("--target", help="Target on the specimen, such as chessboard:7x4:2.")
    ] = None,
    target_origin: Annotated[
        tuple[float, float] | None, typer.Option("--target-origin", help="Origin of the target on the mesh.")
    ] = None,
    target_angle: Annotated[
        float | None, typer.Option("--target-angle", help="Angle of its X axis on the mesh, in radians.")
    ] = None,
    target_thickness: Annotated[
        float, typer.Option("--target-thickness", help="Height of its face above the mesh.")
    ] = 0.0,
    free: Annotated[
        list[str] | None, typer.Option("--free", help="Parameter to estimate; may be repeated. By default all.")
    ] = None,
    search: Annotated[float, typer.Option("--search", help="Search distance of the features, in pixels.")] = 60.0,
    output: CameraOption = Path("registered.toml"),
    picture: PictureOption = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Place a mesh in an image by its edges, by points, or by a target on the specimen.

    Exit status: 0 if nothing is doubtful, 3 if the camera is written but something is doubtful, 2 after an error.
    """
    with reported_errors():
        from fedic.cameras.files import check_writable, read_camera
        from fedic.io.images import read_image
        from fedic.io.meshes import read_mesh
        from fedic.registration import check_format, read_pairs, register

        check_writable(output, overwrite=overwrite)
        check_picture(picture, [image], overwrite=overwrite)
        start = read_camera(camera)
        check_format(start, output)
        with warnings.catch_warnings():
            # The doubts are part of the result.
            warnings.simplefilter("ignore", QualityWarning)
            registration = register(
                read_mesh(mesh),
                read_image(image),
                start,
                points=None if points is None else read_pairs(points),
                features=feature or (),
                target=target,
                target_origin=target_origin,
                target_angle=target_angle,
                target_thickness=target_thickness,
                free=free,
                search=search,
            )
        _print_registration(registration)
        registration.write(output, overwrite=overwrite)
        if picture is not None:
            registration.plot(picture)
        echo(f"Camera written to {output}")
        for sentence in registration.doubts:
            echo(f"Doubtful: {sentence}", err=True)
        if registration.doubts:
            raise typer.Exit(EXIT_DOUBTFUL)


def _print_registration(registration: "Registration") -> None:
    if registration.features:
        rows = []
        for name, found in registration.features.items():
            counts = f"{found.used.sum()}/{len(found.used)}"
            rows.append((name, counts, f"{found.median:.2f}", f"{found.rms:.2f}"))
        print_table(
            "Distances of the edges in the image from the features of the mesh, in pixels",
            ("feature", "pieces", "median", "rms"),
            rows,
            left=("feature",),
        )
    if len(registration.residuals):
        lengths = (registration.residuals**2).sum(axis=1) ** 0.5
        echo(f"{len(lengths)} points: {lengths.mean():.3f} px on average, {lengths.max():.3f} px at most")
    deviations = registration.standard_deviations.items()
    print_table("Pose", ("parameter", "standard deviation"), [(name, f"{value:.2g}") for name, value in deviations])
