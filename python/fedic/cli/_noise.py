"""``fedic noise``: the noise of a camera, and the noise floor of a measurement."""

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fedic.cli.common import OverwriteOption, check_output, check_picture, reported_errors
from fedic.cli.exit_status import EXIT_DOUBTFUL
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table
from fedic.errors import OptionError, QualityWarning

if TYPE_CHECKING:
    from fedic.noise import CameraNoise, NoiseFloor


def noise_command(
    images: Annotated[
        list[Path], typer.Argument(metavar="IMAGES...", help="Two or more images of one scene at rest, as taken.")
    ],
    config: Annotated[
        Path | None,
        typer.Option("--config", help="Configuration of fedic run: the noise floor with its mesh, camera and options."),
    ] = None,
    mesh: Annotated[
        Path | None, typer.Option("--mesh", help="Mesh file: the noise floor with this mesh and the default options.")
    ] = None,
    camera: Annotated[
        Path | None, typer.Option("--camera", help="Camera file for --mesh; by default the mesh is drawn in pixels.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", help="Results in a .json file.")] = None,
    picture: Annotated[Path | None, typer.Option("--picture", help="Variance against grey level, a .png file.")] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Measure the noise of a camera, in grey levels, and with a mesh the noise floor of displacement and strain.

    Exit status: 0 if nothing is doubtful, 3 if something is, such as images that moved, 2 after an error.
    """
    with reported_errors():
        from fedic.io.atomic import write_json
        from fedic.noise import camera_noise
        from fedic.plotting import save_figure

        if mesh is not None and config is not None:
            raise OptionError("Give --config or --mesh, not both.", "mesh")
        if camera is not None and mesh is None:
            raise OptionError("--camera needs --mesh.", "camera")
        check_output(output, [".json"], images, overwrite=overwrite)
        check_picture(picture, images, overwrite=overwrite)
        setup = _setup(config, mesh, camera)
        with TerminalProgress("noise") as progress:
            with warnings.catch_warnings():
                # The doubts are part of the result.
                warnings.simplefilter("ignore", QualityWarning)
                noise = camera_noise([*images], progress=progress)
            _print_noise(noise)
            floor = None if setup is None else _floor(images, setup, noise, progress)
        doubts = [*noise.doubts]
        if floor is not None:
            _print_floor(floor)
            if floor.doubtful:
                doubts.append(f"{floor.doubtful} of {floor.num_images} static images were measured with doubts")
        if output is not None:
            content = {"camera_noise": noise.summary()}
            write_json(output, content if floor is None else {**content, "noise_floor": floor.summary()})
            echo(f"Results written to {output}")
        if picture is not None:
            save_figure(noise.plot().figure, picture)  # type: ignore[arg-type]
            echo(f"Picture written to {picture}")
        for sentence in doubts:
            echo(f"Doubtful: {sentence}.", err=True)
        if doubts:
            raise typer.Exit(EXIT_DOUBTFUL)


def _setup(config: Path | None, mesh: Path | None, camera: Path | None) -> dict[str, Any] | None:
    """Return the mesh, the camera and the options of the noise floor, read before any long work."""
    from fedic._core import ImageFrame

    if config is not None:
        from fedic.campaign import load_config

        settings = load_config(config)
        return {
            "mesh": settings.mesh.build(),
            "camera": settings.camera.build(),
            "unit": settings.mesh.unit,
            "measure": settings.output.strain_measure,
            **settings.correlation.options(),
        }
    if mesh is None:
        return None
    from fedic.cameras.files import read_camera
    from fedic.io.meshes import read_mesh

    return {"mesh": read_mesh(mesh), "camera": ImageFrame() if camera is None else read_camera(camera)}


def _floor(images: list[Path], setup: dict[str, Any], noise: "CameraNoise", progress: TerminalProgress) -> "NoiseFloor":
    from fedic.noise import noise_floor

    if setup.get("noise") is None and math.isfinite(noise.std):
        setup["noise"] = noise.std
    return noise_floor([*images], progress=progress, **setup)


def _print_noise(noise: "CameraNoise") -> None:
    rows = [
        ("noise of one image", _number(noise.std), _number(noise.standard_error, 2), "grey levels"),
        ("as read, with the motion", _number(noise.raw_std), "", "grey levels"),
    ]
    if math.isfinite(noise.slope):
        rows += [
            ("variance, slope", _number(noise.slope), _number(noise.slope_error, 2), "grey levels"),
            (
                "variance, intercept",
                _number(noise.intercept),
                _number(noise.intercept_error, 2),
                "grey levels^2",
            ),
        ]
    for direction, value in zip("uv", noise.correlation, strict=True):
        rows.append((f"neighbours correlated along {direction}", f"{value:.3f}", "", ""))
    print_table(
        f"Noise of the camera, {noise.num_images} images, {noise.used_share:.0%} of the pixels",
        ("", "value", "standard error", "unit"),
        rows,
        left=("", "unit"),
    )
    print_table(
        "Motion from image to image, in pixels",
        ("images", "u", "v", "error", "rms motion", "noise too high by"),
        [
            (
                f"{pair + 1} to {pair + 2}",
                *(_fixed(value) for value in noise.shift[pair]),
                _number(float(noise.shift_error[pair].max()), 2),
                _fixed(noise.motion[pair]),
                f"{noise.excess[pair]:.1%}" if math.isfinite(noise.excess[pair]) else "not known",
            )
            for pair in range(noise.num_images - 1)
        ],
        left=("images",),
    )


def _print_floor(floor: "NoiseFloor") -> None:
    from fedic.noise.floor import COMPONENTS

    unit = f" ({floor.unit})" if floor.unit else ""
    names = [f"displacement {name}{unit}" for name in COMPONENTS[:2]]
    names += [f"{floor.measure} strain {name}" for name in COMPONENTS[2:]]
    values = zip(names, floor.bias, floor.std, floor.predicted, strict=True)
    left_out = f", {floor.not_measured} nodes not measured" if floor.not_measured else ""
    print_table(
        f"Noise floor: mean and standard deviation of {floor.num_images} static images against the first, "
        f"{floor.num_nodes} nodes{left_out}",
        ("quantity", "bias", "noise floor", "predicted"),
        [(name, *(_number(value, 3) for value in each)) for name, *each in values],
        left=("quantity",),
    )


def _number(value: float, digits: int = 4) -> str:
    return f"{value:.{digits}g}" if math.isfinite(value) else "not known"


def _fixed(value: float) -> str:
    return f"{value:.4f}" if math.isfinite(value) else "not known"
