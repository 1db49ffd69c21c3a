"""``fedic advise``: the size of elements that an image and its noise allow."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import OverwriteOption, check_output, check_picture, reported_errors
from fedic.cli.exit_status import EXIT_DOUBTFUL
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table
from fedic.errors import OptionError

if TYPE_CHECKING:
    from fedic._internal.types import Image
    from fedic.advise import Advice


def advise_command(
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="Reference image of the specimen.")],
    noise: Annotated[
        float, typer.Option("--noise", help="Standard deviation of the noise in grey levels; fedic noise measures it.")
    ],
    region: Annotated[
        tuple[int, int, int, int] | None,
        typer.Option("--region", help="Part of the image: first column and row, and those after the last."),
    ] = None,
    mesh: Annotated[
        Path | None, typer.Option("--mesh", help="Mesh file; the region is the box around it in the image.")
    ] = None,
    camera: Annotated[
        Path | None, typer.Option("--camera", help="Camera file for --mesh; by default the mesh is drawn in pixels.")
    ] = None,
    cell: Annotated[str, typer.Option("--cell", help="Type of the elements: quad, triangle, quad8, ...")] = "quad",
    size: Annotated[
        list[float] | None, typer.Option("--size", help="Size in pixels to try; may be repeated. 8 to 64 by default.")
    ] = None,
    target: Annotated[
        float, typer.Option("--target", help="Largest standard deviation of the displacement, in pixels.")
    ] = 0.02,
    strain_target: Annotated[
        float | None, typer.Option("--strain-target", help="Largest standard deviation of the strains.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", help="Results in a .json file.")] = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", help="Standard deviations against size, a .png file.")
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Predict noise against element size, and recommend the smallest size that meets the targets.

    Exit status: 0 if nothing is doubtful, 3 if something is, such as no size that meets the targets, 2 after an error.
    """
    with reported_errors():
        from fedic.advise import SIZES, advise_element_size
        from fedic.io.atomic import write_json
        from fedic.io.images import read_image
        from fedic.plotting import save_figure

        if region is not None and mesh is not None:
            raise OptionError("Give --region or --mesh, not both.", "region")
        if camera is not None and mesh is None:
            raise OptionError("--camera needs --mesh.", "camera")
        check_output(output, [".json"], [image], overwrite=overwrite)
        check_picture(picture, [image], overwrite=overwrite)
        read = read_image(image)
        with TerminalProgress(image.name) as progress:
            advice = advise_element_size(
                read,
                noise,
                sizes=SIZES if size is None else size,
                cell=cell,
                region=region if mesh is None else _box(mesh, camera, read),
                displacement_target=target,
                strain_target=strain_target,
                progress=progress,
            )
        _print_advice(advice)
        if output is not None:
            write_json(output, advice.summary())
            echo(f"Results written to {output}")
        if picture is not None:
            save_figure(advice.plot(), picture)
            echo(f"Picture written to {picture}")
        for sentence in advice.doubts:
            echo(f"Doubtful: {sentence}.", err=True)
        if advice.doubts:
            raise typer.Exit(EXIT_DOUBTFUL)


def _box(mesh: Path, camera: Path | None, image: "Image") -> tuple[int, int, int, int]:
    """Return the box around a mesh in the image."""
    import numpy as np

    from fedic._core import ImageFrame
    from fedic.cameras.files import read_camera
    from fedic.errors import MeshError
    from fedic.io.meshes import read_mesh

    found = read_mesh(mesh)
    pixels = (ImageFrame() if camera is None else read_camera(camera)).project(found.points[found.used_nodes])
    seen = pixels[np.isfinite(pixels).all(axis=1)]
    height, width = image.shape
    if len(seen):
        left, top = np.maximum(np.floor(seen.min(axis=0)), 0).astype(int)
        right, bottom = np.minimum(np.ceil(seen.max(axis=0)) + 1, (width, height)).astype(int)
        if left < right and top < bottom:
            return int(left), int(top), int(right), int(bottom)
    raise MeshError(f"{mesh}: the mesh lies outside the image; check the camera.")


def _print_advice(advice: "Advice") -> None:
    texture = advice.texture
    left, top, right, bottom = advice.region
    share = f"{texture.saturated_share:.2%}"
    print_table(
        f"Texture of columns {left} to {right}, rows {top} to {bottom}; noise {advice.noise:g} grey levels",
        ("quantity", "value", "unit"),
        [
            ("speckle size along u, v", ", ".join(f"{width:.1f}" for width in texture.speckle_size), "px"),
            ("contrast (standard deviation)", f"{texture.contrast:.1f}", "grey levels"),
            ("grey levels, 1 % to 99 %", f"{texture.grey_range[0]:g} to {texture.grey_range[1]:g}", "grey levels"),
            ("gradient along u, v (rms)", ", ".join(f"{g:.1f}" for g in texture.gradient), "grey levels/px"),
            ("saturated pixels", share, ""),
        ],
        left=("quantity", "unit"),
    )
    rows = []
    for k, size in enumerate(advice.sizes):
        numbers = (*advice.displacement[k], advice.border[k].max(), *advice.strain[k])
        mark = "recommended" if size == advice.recommended else ""
        rows.append((f"{size:g}", *(f"{each:.2g}" if math.isfinite(each) else "not known" for each in numbers), mark))
    print_table(
        f"Predicted standard deviations, {advice.cell}: displacement in pixels, strain",
        ("size", "x", "y", "border", "exx", "eyy", "exy", ""),
        rows,
        left=("",),
    )
    if math.isfinite(advice.recommended):
        echo(f"Recommended: elements of {advice.recommended:g} px, the smallest with {advice.criterion}.")
    else:
        echo(f"No size has {advice.criterion}.")
