"""Quick versions of the experiments: results, files and the report."""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

import fedic
from fedic.cli import app
from fedic.experiments import Claim, Outcome, Request, run_experiment, write_outcome, write_report

RUNNER = CliRunner(env={"COLUMNS": "200"})
Shared = Callable[[str], Path]


def verdicts(outcome: Outcome) -> dict[str, bool]:
    return {claim.text: claim.holds for claim in outcome.claims}


def pick(outcome: Outcome, **wanted: Any) -> list[dict[str, Any]]:
    return [row for row in outcome.rows if all(row[key] == value for key, value in wanted.items())]


def test_fig7_on_the_synthetic_image(gmsh: Any) -> None:
    states: list[fedic.Progress] = []
    outcome = run_experiment("fig7", Request(quick=True, progress=states.append))
    done = [state.fraction or 0.0 for state in states]
    assert done == sorted(done)
    assert done[-1] == 1.0
    assert len(outcome.rows) == 2 * 2 * 4 * 2
    assert all(verdicts(outcome).values()), verdicts(outcome)
    for row in pick(outcome, setting="paper", quadrature="pixel"):
        assert 3e-3 < row["bias_px"] < 6e-3
    for row in pick(outcome, setting="default", quadrature="mesh"):
        assert row["bias_px"] < 1e-5
        assert row["std_px"] < 2e-4


def test_fig7_on_the_open_hole(gmsh: Any, shared_data: Shared) -> None:
    image = fedic.read_image(shared_data("openhole/zoom-0053_1.tif"))
    outcome = run_experiment("fig7", Request(quick=True, image=image))
    assert all(verdicts(outcome).values()), verdicts(outcome)
    # The reference measured 1.4e-2 and 1.7e-3 px with quads of 20 px.
    (pixel,) = pick(outcome, image="real", setting="paper", quadrature="pixel", cell="quad", size_px=20)
    (mesh,) = pick(outcome, image="real", setting="paper", quadrature="mesh", cell="quad", size_px=20)
    assert 0.012 < pixel["bias_px"] < 0.016
    assert 0.0014 < mesh["bias_px"] < 0.002


def test_fig8_noise_against_density(gmsh: Any) -> None:
    outcome = run_experiment("fig8", Request(quick=True))
    for rule in ("edges", "rotated"):
        (half,), (one,), (twice,) = (
            pick(outcome, setting="unfiltered", cell="quad", rule=rule, density=d) for d in (0.5, 1.0, 2.0)
        )
        assert 0.45 < half["points_per_pixel"] < 0.55
        assert 0.95 < one["noise_over_bound"] < 1.05
        assert 1.03 < half["noise_over_bound"] / one["noise_over_bound"] < 1.12
        assert 0.98 < twice["noise_over_bound"] / one["noise_over_bound"] < 1.01


def test_measured_noise_agrees_with_the_prediction() -> None:
    outcome = run_experiment("noise", Request(quick=True))
    for row in pick(outcome, cell="quad"):
        assert row["draws"] >= 200
        assert abs(row["measured_over_predicted"] - 1.0) < 0.05
        assert row["mean_error_in_uncertainties"] < 3.0
        assert row["as_a_user_px"] == pytest.approx(row["predicted_px"], rel=0.05)
    assert {row["cell"] for row in outcome.rows} == {"triangle", "triangle6", "quad", "quad8", "quad9"}


def test_interpolation_experiment_supports_the_defaults(gmsh: Any) -> None:
    outcome = run_experiment("interpolation", Request(quick=True))
    assert all(verdicts(outcome).values()), verdicts(outcome)
    rows = pick(outcome, mesh="unstructured", rule="rotated", interpolation="bspline5")
    bare, chosen = (next(row for row in rows if row["smoothing"] == p) for p in (0.0, 0.8))
    assert chosen["noise_over_bound"] < 1.06
    # Both images are smoothed by the same filter on the material.
    assert chosen["stretch_error_px"] < bare["stretch_error_px"]


def test_strain_does_not_add_to_the_error() -> None:
    outcome = run_experiment("strain", Request(quick=True))
    # Quadratic cells at a strain of 20 % need two quadrature points per pixel.
    missed = {claim.text for claim in outcome.claims if not claim.holds}
    assert all(text.startswith("quad9 cells of 32 px") and "two quadrature points" not in text for text in missed), (
        missed
    )
    for row in pick(outcome, setting="unfiltered"):
        (at_rest,) = pick(outcome, setting="unfiltered", cell=row["cell"], angle_deg=row["angle_deg"], strain_percent=0)
        assert row["rms_px"] < 1.6 * at_rest["rms_px"]
    assert all(row["converged"] for row in outcome.rows)


def test_too_small_images_are_refused(gmsh: Any) -> None:
    with pytest.raises(fedic.ImageError, match=r"at least 300 x 401 px \(columns x rows\), .* this one has 200 x 160"):
        run_experiment("fig7", Request(quick=True, image=np.zeros((160, 200), dtype=np.uint8)))


def test_unknown_experiments_are_refused() -> None:
    outcome = RUNNER.invoke(app, ["experiment", "fig9"])
    assert outcome.exit_code == 2
    assert "no experiment 'fig9'; choose one of fig7, fig8" in outcome.stderr


def outcome_of(name: str, holds: bool) -> Outcome:
    rows = [
        {"cell": "quad", "bias_px": 1e-5, "converged": True},
        {"cell": "quad", "bias_px": np.nan, "converged": False},
    ]
    figure = Figure()
    figure.add_subplot().plot([0, 1])
    return Outcome(
        name, f"Title of {name}", "What was done.", rows, [Claim("a | b", "1", holds)], {"": figure, "map": figure}
    )


def test_the_files_of_an_outcome_and_the_page(tmp_path: Path) -> None:
    write_outcome(outcome_of("fig8", True), tmp_path, quick=True, seconds=1.26)
    write_outcome(outcome_of("fig7", False), tmp_path, quick=False, seconds=70.0)
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert {path.name for path in tmp_path.iterdir()} == {
        "report.md", *(f"{name}{end}" for name in ("fig7", "fig8") for end in (".csv", ".json", ".png", "-map.png"))
    }  # fmt: skip
    content = json.loads((tmp_path / "fig8.json").read_text())
    assert content["rows"][1] == {"cell": "quad", "bias_px": None, "converged": False}
    assert content["quick"]
    with (tmp_path / "fig8.csv").open(newline="") as file:
        assert next(csv.DictReader(file)) == {"cell": "quad", "bias_px": "1e-05", "converged": "True"}
    assert page.index("## Title of fig7") < page.index("## Title of fig8")
    assert "| a \\| b | 1 | **no** |" in page
    assert "| [Title of fig8](#fig8) | 1 of 1 | " in page
    assert "![Title of fig7](fig7-map.png)" in page


def test_the_command_prints_verdicts_and_writes_the_page(gmsh: Any, tmp_path: Path) -> None:
    outcome = RUNNER.invoke(app, ["experiment", "fig7", "--quick", "--output", str(tmp_path / "out")])
    assert outcome.exit_code == 0, outcome.output
    assert "bias at most 0.0001 px at every size from 10 px" in outcome.stdout
    assert (tmp_path / "out" / "report.md").exists()
    assert (tmp_path / "out" / "fig7.png").stat().st_size > 20_000
