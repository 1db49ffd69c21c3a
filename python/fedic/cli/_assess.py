"""``fedic assess``: deviations on static images and known rigid motions."""

from pathlib import Path
from typing import Annotated

import typer

from fedic.cli.common import OverwriteOption, check_output, reported_errors
from fedic.cli.exit_status import EXIT_DOUBTFUL, EXIT_EXCEEDED
from fedic.cli.progress import TerminalProgress
from fedic.cli.terminal import echo, print_table


def assess_command(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.toml", help="Configuration file; see docs/assess.md.")],
    limit_zd: Annotated[
        float | None, typer.Option("--limit-zd", help="Limit of the zero displacement deviation, in the mesh's unit.")
    ] = None,
    limit_zs: Annotated[float | None, typer.Option("--limit-zs", help="Limit of the zero strain deviation.")] = None,
    limit_d: Annotated[
        float | None, typer.Option("--limit-d", help="Limit of the displacement deviation, in the mesh's unit.")
    ] = None,
    limit_rotation: Annotated[
        float | None, typer.Option("--limit-rotation", help="Limit of the deviation of the rotation, in degrees.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", help="Tables in a .md or .json file.")] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Assess a measurement on static images and known rigid motions, after EN 4861 and VDI/VDE 2626.

    Exit status: 0 if all limits hold and nothing is doubtful, 4 if a limit is exceeded, 3 if a result is doubtful, 2
    after an error. No conformity with a standard is claimed.
    """
    with reported_errors():
        from fedic.assess import load_assess_config, measure_poses, write_assessment
        from fedic.assess.report import notes, tables

        settings = load_assess_config(config)
        inputs = [config, settings.images.reference, *(image for pose in settings.poses for image in pose.images)]
        check_output(output, [".md", ".json"], inputs, overwrite=overwrite)
        limits = {"zd": limit_zd, "zs": limit_zs, "d": limit_d, "rotation": limit_rotation}
        with TerminalProgress(config.name) as progress:
            found = measure_poses(
                settings,
                limits={name: limit for name, limit in limits.items() if limit is not None},
                progress=progress,
            )
        for title, columns, rows in tables(found):
            print_table(title, columns, rows, left=columns[:1])
        echo("After EN 4861 and VDI/VDE 2626 Part 1; no claim of conformity.")
        for sentence in notes(found):
            echo(sentence)
        if output is not None:
            setup = {
                "configuration": str(config),
                "reference image": str(settings.images.reference),
                "set displacements": settings.assessment.traceability or "traceability not given",
                "their standard uncertainty": f"{settings.assessment.set_uncertainty:g}",
            }
            write_assessment(found, output, setup)
            echo(f"Results written to {output}")
        if not found.within_limits:
            exceeded = ", ".join(check.name for check in found.checks if not check.holds)
            echo(f"A limit is exceeded: {exceeded}.", err=True)
            raise typer.Exit(EXIT_EXCEEDED)
        if found.doubtful:
            raise typer.Exit(EXIT_DOUBTFUL)
