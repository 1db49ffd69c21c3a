"""``fedic run``: measure a series of images."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import EXIT_DOUBTFUL, reported_errors
from fedic.cli.progress import TerminalProgress

if TYPE_CHECKING:
    from fedic.campaign.series import Frame


def run_command(
    config: Annotated[
        Path, typer.Argument(metavar="CONFIG.toml", help="Configuration file; see examples/openhole.toml.")
    ],
) -> None:
    """Measure a series of images described by a configuration file.

    Exit status: 0 if every frame is measured and nothing is doubtful, 3 if some result is doubtful or did not converge,
    2 after an error.
    """
    with reported_errors():
        from fedic.campaign import load_config, measure_series

        settings = load_config(config)
        with TerminalProgress(config.name) as progress:
            frames = []
            for frame in measure_series(settings, progress=progress):
                _print_frame(frame)
                frames.append(frame)
        typer.echo(f"Results in {settings.output.folder}")
        doubtful = [frame for frame in frames if not frame.is_good]
        if doubtful:
            typer.echo(
                f"{len(doubtful)} of {len(frames)} frames did not converge or are doubtful, the first being "
                f"{doubtful[0].image.name}; summary.json and the other files mark what.",
                err=True,
            )
            raise typer.Exit(EXIT_DOUBTFUL)


def _print_frame(frame: "Frame") -> None:
    outcome = frame.outcome
    if frame.error is not None:
        typer.echo(f"{frame.image.name}: failed: {frame.error}", err=True)
        return
    unit = "iteration" if outcome["iterations"] == 1 else "iterations"
    state = "converged" if outcome["converged"] else "NOT CONVERGED"
    outside = f", {len(outcome['outside_cells'])} cells partly out of the image" if outcome["outside_cells"] else ""
    typer.echo(
        f"{frame.image.name}: {state} in {outcome['iterations']} {unit}, residual {outcome['residual_rms']:.3g} "
        f"grey levels{outside} ({frame.seconds:.1f} s)"
    )
    for reason in outcome["quality"]["reasons"]:
        typer.echo(f"  {reason}", err=True)
