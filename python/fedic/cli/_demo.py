"""``fedic demo``: a large shift through a distorting lens."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fedic.cli.common import reported_errors
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table

if TYPE_CHECKING:
    from fedic.demo import Demo


def demo_command(
    output: Annotated[Path, typer.Option("--output", help="Folder of the results.")] = Path("fedic-demo"),
) -> None:
    """Measure a large shift through a distorting lens, with and without its model."""
    with reported_errors():
        from fedic.demo import measure, write_demo
        from fedic.io.atomic import make_folder

        make_folder(output)
        with TerminalProgress("demo") as progress:
            demo = measure(progress=progress)
        write_demo(demo, output)
        _print_demo(demo)
        echo(f"Images, results and error-maps.png in {output}")


def _print_demo(demo: "Demo") -> None:
    rows = []
    for case in (demo.with_lens, demo.without_lens):
        errors = [f"{value:+.5f}" for value in case.bias] + [f"{value:.5f}" for value in case.std]
        rows.append([case.name, *errors, f"{case.seconds:.2f}"])
    print_table(
        "Error of the measured displacement, in pixels",
        ("", "bias u", "bias v", "std u", "std v", "seconds"),
        rows,
        left=("",),
    )
