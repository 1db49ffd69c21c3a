"""The command line: ``fedic run``, ``calibrate``, ``register``, ``demo`` and ``experiment``."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic._core import __version__
from fedic._internal.progress import TerminalProgress
from fedic.errors import CameraError, FedicError

if TYPE_CHECKING:
    from fedic.calibration import Calibration
    from fedic.campaign.series import Frame
    from fedic.demo import Demo
    from fedic.experiments import Outcome
    from fedic.registration import Registration

__all__ = ["app"]

_EXIT_FAULT = 2
_EXIT_INTERRUPTED = 130

app = typer.Typer(
    help="Finite-element digital image correlation written in the physical space.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)


@contextmanager
def _faults_reported() -> Iterator[None]:
    try:
        yield
    except FedicError as error:
        typer.echo(f"fedic: {error}", err=True)
        raise typer.Exit(_EXIT_FAULT) from None
    except KeyboardInterrupt:
        typer.echo("fedic: interrupted", err=True)
        raise typer.Exit(_EXIT_INTERRUPTED) from None


def _check_picture(picture: Path | None, images: Iterable[Path], *, overwrite: bool) -> None:
    """Check, before any long work, that a picture replaces no file that is to be kept."""
    from fedic.plotting.figures import check_picture_path

    if picture is None:
        return
    check_picture_path(picture)
    if not picture.parent.is_dir():
        raise FedicError(f"{picture}: the folder {picture.parent} does not exist; make it first.")
    if not picture.exists():
        return
    if any(image.exists() and picture.samefile(image) for image in images):
        raise FedicError(f"{picture}: the picture would replace an image that is read; give it another name.")
    if not overwrite:
        raise FedicError(f"{picture}: this file exists and was left as it is; --overwrite replaces it by the picture.")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"fedic {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None: ...


@app.command("run")
def run_command(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.toml", help="What to measure; see examples/openhole.toml.")],
) -> None:
    """Measure a series of images as a configuration file says."""
    with _faults_reported():
        from fedic.campaign.config import load_config
        from fedic.campaign.series import run

        settings = load_config(config)
        with TerminalProgress(config.name) as progress:
            folder = run(settings, progress=progress.iteration, on_frame=_print_frame)
        typer.echo(f"Results in {folder}")


@app.command("calibrate")
def calibrate_command(
    images: Annotated[list[Path], typer.Argument(metavar="IMAGES...", help="Views of the target; 10 to 20 of them.")],
    target: Annotated[
        str,
        typer.Option(
            "--target",
            help="chessboard:11x7:8 (inner corners, square), circles:9x7:10, asymmetric-circles:4x11:10 or "
            "charuco:12x8:10:7:DICT_5X5_100; its unit of length becomes the world's.",
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
    output: Annotated[Path, typer.Option("--output", help=".toml, or .yml, .yaml, .xml for OpenCV.")] = Path(
        "camera.toml"
    ),
    picture: Annotated[
        Path | None, typer.Option("--picture", help="Residual vectors over the image and coverage, a .png file.")
    ] = None,
    view: Annotated[
        str | None, typer.Option("--view", help="Image whose pose the camera takes; the first accepted if left out.")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the output file and the picture if they exist.")
    ] = False,
) -> None:
    """Calibrate a camera from images of a flat target."""
    with _faults_reported():
        from fedic.calibration import calibrate
        from fedic.calibration.lenses import parse_lens
        from fedic.cameras.files import check_writable

        check_writable(output, overwrite=overwrite)
        if isinstance(parse_lens(distortion), str) and output.suffix.lower() != ".toml":
            raise CameraError(f"{output}: only a .toml file holds a lens made of a spline; give --output camera.toml.")
        _check_picture(picture, images, overwrite=overwrite)
        with TerminalProgress("calibration") as progress:
            calibration = calibrate([*images], target, distortion, view=view, progress=progress.fraction)
        _print_calibration(calibration)
        existed = output.exists()
        calibration.write(output, overwrite=overwrite)
        if picture is not None:
            calibration.plot(picture)
        typer.echo(f"Camera {'replaced in' if existed else 'written to'} {output}")


@app.command("register")
def register_command(
    mesh: Annotated[Path, typer.Argument(metavar="MESH", help="The mesh.")],
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="The specimen, as in the reference image.")],
    camera: Annotated[Path, typer.Argument(metavar="CAMERA", help="The rough start, a file as fedic writes it.")],
    feature: Annotated[
        list[str] | None,
        typer.Option("--feature", help="A piece of the mesh's boundary, such as 'left' or 'hole 0'; may be repeated."),
    ] = None,
    points: Annotated[
        Path | None, typer.Option("--points", help="Text file of pairs, a line each: X Y u v or X Y Z u v.")
    ] = None,
    target: Annotated[str | None, typer.Option("--target", help="On the specimen, such as chessboard:7x4:2.")] = None,
    target_origin: Annotated[
        tuple[float, float] | None, typer.Option("--target-origin", help="Where its origin is on the mesh.")
    ] = None,
    target_angle: Annotated[
        float | None, typer.Option("--target-angle", help="Of its X axis on the mesh, in radians.")
    ] = None,
    target_thickness: Annotated[
        float, typer.Option("--target-thickness", help="Height of its face above the mesh.")
    ] = 0.0,
    free: Annotated[
        list[str] | None, typer.Option("--free", help="A parameter to find; may be repeated. All if left out.")
    ] = None,
    search: Annotated[float, typer.Option("--search", help="How far to look for the features, in pixels.")] = 60.0,
    output: Annotated[Path, typer.Option("--output", help=".toml, or .yml, .yaml, .xml for OpenCV.")] = Path(
        "registered.toml"
    ),
    picture: Annotated[
        Path | None, typer.Option("--picture", help="The mesh over the image with the edges found, a .png file.")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the output file and the picture if they exist.")
    ] = False,
) -> None:
    """Place a mesh in an image by its edges, by points, or by a target on the specimen."""
    with _faults_reported():
        from fedic.cameras.files import check_writable, read_camera
        from fedic.io.images import read_image
        from fedic.io.meshes import read_mesh
        from fedic.registration import read_pairs, register
        from fedic.registration._result import check_format

        check_writable(output, overwrite=overwrite)
        _check_picture(picture, [image], overwrite=overwrite)
        start = read_camera(camera)
        check_format(start, output)
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
        typer.echo(f"Camera written to {output}")


@app.command("demo")
def demo_command(
    output: Annotated[Path, typer.Option("--output", help="Folder of the results.")] = Path("fedic-demo"),
) -> None:
    """Measure a large shift through a distorting lens, with and without its model."""
    with _faults_reported():
        from fedic.demo import measure, write_demo
        from fedic.io.atomic import make_folder

        make_folder(output)
        with TerminalProgress("demo") as progress:
            demo = measure(progress=progress.iteration, on_render=progress.fraction)
        write_demo(demo, output)
        _print_demo(demo)
        typer.echo(f"Images, results and error-maps.png in {output}")


@app.command("experiment")
def experiment_command(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="fig7, fig8, fig14, fig15, fig16, noise, interpolation, ... or all.")
    ],
    output: Annotated[Path, typer.Option("--output", help="Folder of the results.")] = Path("fedic-experiments"),
    image: Annotated[
        Path | None,
        typer.Option(
            "--image",
            help="A real reference image, measured too by fig7, fig8, interpolation and convergence.",
        ),
    ] = None,
    star: Annotated[
        tuple[Path, Path] | None,
        typer.Option("--star", help="Reference and deformed noisy star of the DIC Challenge 2.0, for resolution."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer sizes and draws, under a minute each.")] = False,
) -> None:
    """Run an experiment that a claim stands on, and say whether the claim holds."""
    with _faults_reported():
        import time

        from fedic.experiments import EXPERIMENTS, Request, run_experiment, write_outcome, write_report
        from fedic.io.atomic import make_folder
        from fedic.io.images import read_image

        real = None if image is None else read_image(image)
        pair = None if star is None else (read_image(star[0]), read_image(star[1]))
        make_folder(output)
        for each in EXPERIMENTS if name == "all" else (name,):
            start = time.perf_counter()
            with TerminalProgress(each) as progress:
                outcome = run_experiment(each, Request(quick, real, pair, progress.fraction))
            write_outcome(outcome, output, quick=quick, seconds=time.perf_counter() - start)
            _print_outcome(outcome)
        typer.echo(f"Numbers, pictures and {write_report(output).name} in {output}")


def _print_outcome(outcome: "Outcome") -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title=f"{outcome.name}: {outcome.title}")
    table.add_column("claim")
    table.add_column("measured")
    table.add_column("holds", no_wrap=True)
    for claim in outcome.claims:
        table.add_row(claim.text, claim.measured, "yes" if claim.holds else "NO")
    Console().print(table)


def _print_frame(frame: "Frame") -> None:
    outcome = frame.outcome
    if frame.error is not None:
        typer.echo(f"{frame.image.name}: failed: {frame.error}", err=True)
        return
    state = "converged" if outcome["converged"] else "NOT CONVERGED"
    outside = f", {len(outcome['outside_cells'])} cells partly out of the image" if outcome["outside_cells"] else ""
    typer.echo(
        f"{frame.image.name}: {state} in {outcome['iterations']} iterations, residual {outcome['residual_rms']:.3g} "
        f"grey levels{outside} ({frame.seconds:.1f} s)"
    )


def _print_calibration(calibration: "Calibration") -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console()
    table = Table(title=f"Views ({calibration.distortion}): distance of seen and projected points, in pixels")
    table.add_column("view", overflow="fold")
    for heading in ("points", "initial", "final"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", overflow="fold")
    for view in calibration.views:
        counts = f"{view.used.sum()}/{len(view.used)}" if view.found else ""
        errors = [f"{error:.3f}" if view.found else "" for error in (view.initial_error, view.final_error)]
        table.add_row(Path(view.name).name, counts, *errors, "" if view.accepted else f"rejected: {view.reason}")
    console.print(table)
    table = Table(title=f"Camera: {calibration.reprojection_error:.4f} px rms")
    for heading in ("parameter", "value", "standard deviation"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, value in calibration.parameters.items():
        table.add_row(name, f"{value:.6g}", f"{calibration.standard_deviations[name]:.2g}")
    console.print(table)
    for sentence in calibration.advice:
        console.print(f"Advice: {sentence}", highlight=False, markup=False)


def _print_registration(registration: "Registration") -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console()
    if registration.features:
        table = Table(title="Edges in the image from the features of the mesh, in pixels")
        for heading in ("feature", "pieces", "median", "rms"):
            table.add_column(heading, justify="left" if heading == "feature" else "right", no_wrap=True)
        for name, found in registration.features.items():
            counts = f"{found.used.sum()}/{len(found.used)}"
            table.add_row(name, counts, f"{found.median:.2f}", f"{found.rms:.2f}")
        console.print(table)
    if len(registration.residuals):
        lengths = (registration.residuals**2).sum(axis=1) ** 0.5
        console.print(f"{len(lengths)} points: {lengths.mean():.3f} px on average, {lengths.max():.3f} px at most")
    table = Table(title="Pose")
    for heading in ("parameter", "standard deviation"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, deviation in registration.standard_deviations.items():
        table.add_row(name, f"{deviation:.2g}")
    console.print(table)


def _print_demo(demo: "Demo") -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Error of the measured displacement, in pixels")
    table.add_column("", no_wrap=True)
    for heading in ("bias u", "bias v", "std u", "std v", "seconds"):
        table.add_column(heading, justify="right", no_wrap=True)
    for case in (demo.with_lens, demo.without_lens):
        errors = [f"{value:+.5f}" for value in case.bias] + [f"{value:.5f}" for value in case.std]
        table.add_row(case.name, *errors, f"{case.seconds:.2f}")
    Console().print(table)
