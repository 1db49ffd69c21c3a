"""Results of fedic are the stored ones: a change of the code does not alter them."""

import numpy as np
import pytest

from golden.cases import CASES, FEDIC_RESULTS, Arrays, measure

TOLERANCE = 1e-9
"""Pixels."""


@pytest.fixture(scope="module")
def stored() -> Arrays:
    with np.load(FEDIC_RESULTS, allow_pickle=False) as arrays:
        return dict(arrays)


def test_every_stored_case_is_measured(stored: Arrays) -> None:
    assert {key.partition(":")[0] for key in stored} == set(CASES)


@pytest.mark.parametrize("name", CASES)
def test_the_stored_result_is_reproduced(name: str, stored: Arrays) -> None:
    case = CASES[name]
    pixels = np.abs(case.camera.jacobian(case.mesh.points)).max()  # per mesh unit
    expected = {key.partition(":")[2]: value for key, value in stored.items() if key.startswith(f"{name}:")}
    found = measure(case)
    assert found.keys() == expected.keys()
    np.testing.assert_allclose(
        pixels * found["displacement"], pixels * expected["displacement"], rtol=0, atol=TOLERANCE
    )
    if "standard_deviations" in expected:
        # A derivative by differences: rounding is 1e-16 of the inverse, divided by the step.
        np.testing.assert_allclose(found["standard_deviations"], expected["standard_deviations"], rtol=1e-6)
    for key in ("residual_rms", "cell_residuals"):
        np.testing.assert_allclose(found[key], expected[key], rtol=1e-9)
    assert found["num_points"] == expected["num_points"]
    assert found["iterations"] == expected["iterations"]
