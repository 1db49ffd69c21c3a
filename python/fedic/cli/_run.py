"""``fedic run``: measure a series of images."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import reported_errors
from fedic.cli.progress import TerminalProgress

if TYPE_CHECKING:
    from fedic.campaign.series import Frame


def run_command(
    config: Annotated[
        Path, typer.Argument(metavar="CONFIG.toml", help="Configuration file; see examples/openhole.toml.")
    ],
) -> None:
    """Measure a series of images described by a configuration file."""
    with reported_errors():
        from fedic.campaign import load_config, measure_series

        settings = load_config(config)
        with TerminalProgress(config.name) as progress:
            for frame in measure_series(settings, progress=progress):
                _print_frame(frame)
        typer.echo(f"Results in {settings.output.folder}")


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
