"""``fedic run``: measure a series of images."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import reported_errors
from fedic.cli.exit_status import EXIT_DOUBTFUL
from fedic.cli.terminal import echo, shown

if TYPE_CHECKING:
    from fedic.campaign.series import Frame


def run_command(
    config: Annotated[
        Path, typer.Argument(metavar="CONFIG.toml", help="Configuration file; see examples/openhole.toml.")
    ],
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Remove the results of an earlier run in the output folder first.")
    ] = False,
    dask: Annotated[
        str | None,
        typer.Option(
            "--dask",
            metavar="CLUSTER",
            help="Measure on Dask workers: local:4 for four processes on this machine, or the address of a scheduler "
            "such as tcp://host:8786.",
        ),
    ] = None,
) -> None:
    """Measure a series of images described by a configuration file; go on where an interrupted run has stopped.

    Exit status: 0 if every frame is measured and nothing is doubtful, 3 if some result is doubtful or did not converge,
    2 after an error.
    """
    with reported_errors():
        from fedic.campaign import load_config, measure_series
        from fedic.campaign.progress_bar import progress_bar

        settings = load_config(config)
        if settings.left_out:
            echo(f"{shown(settings.images.reference.name)}: the reference image, left out of images.deformed", err=True)
        frames = []
        with progress_bar(None, len(settings.images.deformed)) as progress:
            for frame in measure_series(settings, overwrite=overwrite, progress=progress, cluster=dask):
                if frame.is_new:
                    _print_frame(frame)
                frames.append(frame)
        earlier = sum(not frame.is_new for frame in frames)
        if earlier:
            echo(f"{earlier} of {len(frames)} frames had been measured before; --overwrite measures them again")
        echo(f"Results in {settings.output.folder}")
        doubtful = [frame for frame in frames if not frame.is_good]
        if doubtful:
            echo(
                f"{len(doubtful)} of {len(frames)} frames did not converge or are doubtful, the first being "
                f"{shown(doubtful[0].image.name)}; summary.json and the other files mark what.",
                err=True,
            )
            raise typer.Exit(EXIT_DOUBTFUL)


def _print_frame(frame: "Frame") -> None:
    outcome = frame.outcome
    title = shown(frame.image.name) + ("" if frame.name == frame.image.stem else f" (as {shown(frame.name)})")
    if frame.error is not None:
        echo(f"{title}: failed: {frame.error}", err=True)
        return
    unit = "iteration" if outcome["iterations"] == 1 else "iterations"
    state = "converged" if outcome["converged"] else "NOT CONVERGED"
    outside = f", {len(outcome['outside_cells'])} cells partly out of the image" if outcome["outside_cells"] else ""
    echo(
        f"{title}: {state} in {outcome['iterations']} {unit}, residual {outcome['residual_rms']:.3g} "
        f"grey levels{outside} ({frame.seconds:.1f} s)"
    )
    for reason in outcome["quality"]["reasons"]:
        echo(f"  {reason}", err=True)
