"""The application: its commands, and those that other packages register.

An entry point of the group ``fedic.commands`` names a `typer.Typer` with one command. It is imported when its command
is run or when the help lists it, so that the application does not depend on it.
"""

from importlib.metadata import EntryPoint, entry_points
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from fedic._core import __version__
from fedic.cli import _advise, _assess, _calibrate, _demo, _noise, _register, _run

__all__ = ["app"]


def _plugins() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group="fedic.commands")}


class _Commands(TyperGroup):
    def list_commands(self, ctx: Any) -> list[str]:
        return [*super().list_commands(ctx), *sorted(_plugins())]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        command = super().get_command(ctx, cmd_name)
        if command is None and (plugin := _plugins().get(cmd_name)) is not None:
            command = typer.main.get_command(plugin.load())
            command.name = cmd_name
        return command


app = typer.Typer(
    cls=_Commands,
    help="Finite-element digital image correlation written in the physical space.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
app.command("run")(_run.run_command)
app.command("calibrate")(_calibrate.calibrate_command)
app.command("register")(_register.register_command)
app.command("noise")(_noise.noise_command)
app.command("assess")(_assess.assess_command)
app.command("advise")(_advise.advise_command)
app.command("demo")(_demo.demo_command)


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
