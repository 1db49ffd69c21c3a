"""``fedic experiment``: the command, registered as an entry point of the group ``fedic.commands``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import reported_errors
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table

if TYPE_CHECKING:
    from fedic.experiments.outcome import Outcome

__all__ = ["app"]

app = typer.Typer()


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
    """Run an experiment and check its claims."""
    with reported_errors():
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
                outcome = run_experiment(each, Request(quick, real, pair, progress))
            write_outcome(outcome, output, quick=quick, seconds=time.perf_counter() - start)
            _print_outcome(outcome)
        echo(f"Numbers, pictures and {write_report(output).name} in {output}")


def _print_outcome(outcome: "Outcome") -> None:
    rows = [(claim.text, claim.measured, "yes" if claim.holds else "NO") for claim in outcome.claims]
    columns = ("claim", "measured", "holds")
    print_table(f"{outcome.name}: {outcome.title}", columns, rows, left=columns[:2])
