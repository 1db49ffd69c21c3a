"""The nonlinear least-squares engine against SciPy."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import least_squares

from fedic._internal.least_squares import DenseEquations, minimize
from fedic._internal.types import Floats

TIME = np.linspace(0.0, 3.0, 60)


def model(parameters: Floats) -> Floats:
    amplitude, rate, offset = parameters
    return amplitude * np.exp(-rate * TIME) + offset


@dataclass(frozen=True, eq=False)
class ExponentialDecay:
    data: Floats

    def linearize(self, estimate: Floats) -> DenseEquations:
        amplitude, rate, _ = estimate
        decay = np.exp(-rate * TIME)
        jacobian = np.column_stack([decay, -amplitude * TIME * decay, np.ones_like(TIME)])
        return DenseEquations(jacobian, self.residuals(estimate))

    def residuals(self, estimate: Floats) -> Floats:
        return self.data - model(estimate)

    def cost(self, estimate: Floats) -> float:
        residuals = self.residuals(estimate)
        return float(residuals @ residuals)

    def move(self, estimate: Floats, step: Floats) -> Floats:
        return estimate + step


@pytest.mark.parametrize("misfit", [0.0, 1.0, 1e2, 1e4])
@pytest.mark.parametrize("seed", range(5))
def test_minimum_is_found_whatever_the_misfit(misfit: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    scale = max(misfit, 1.0)
    data = model(np.array([3.0 * scale, 1.2, 0.5])) + misfit * rng.normal(0.0, 0.3, TIME.size)
    problem, start = ExponentialDecay(data), np.array([2.0 * scale, 1.0, 0.0])
    found = minimize(problem, start, tolerance=1e-9, immaterial=1e-6, noise=1.0, max_iterations=200)
    expected = least_squares(lambda x: data - model(x), start, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert found.converged
    assert problem.cost(found.estimate) <= 2.0 * expected.cost * (1.0 + 1e-12) + 1e-20
