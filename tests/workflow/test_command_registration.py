import subprocess
import sys
from importlib.metadata import entry_points

from typer.testing import CliRunner

from fedic.cli import app

RUNNER = CliRunner()


def test_the_help_lists_built_in_and_registered_commands() -> None:
    outcome = RUNNER.invoke(app, ["--help"])
    assert outcome.exit_code == 0
    for name in ("run", "calibrate", "register", "demo", "experiment"):
        assert f" {name} " in outcome.output


def test_the_experiment_command_is_registered_by_its_package() -> None:
    (point,) = entry_points(group="fedic.commands", name="experiment")
    assert point.value == "fedic.experiments.command:app"
    outcome = RUNNER.invoke(app, ["experiment", "--help"])
    assert outcome.exit_code == 0
    assert "--quick" in outcome.output


def test_an_unknown_command_is_an_error() -> None:
    outcome = RUNNER.invoke(app, ["experimnt"])
    assert outcome.exit_code == 2
    assert "No such command" in outcome.stderr


def test_other_commands_do_not_import_the_experiments() -> None:
    code = (
        "import sys; from typer.testing import CliRunner; from fedic.cli import app; "
        "CliRunner().invoke(app, ['calibrate', '--help']); "
        "print([name for name in sys.modules if name.startswith('fedic.experiments')])"
    )
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert outcome.stdout.strip() == "[]"
