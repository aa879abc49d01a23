"""The regression on alternating frames, on rows with known coefficients and noise."""

import numpy as np
import pytest

from cyclosis.fitting.equation import solved
from cyclosis.fitting.weak import FILAMENTS, Rows

TRUTH = {
    "epsilon": 0.3,
    "d_s": 0.04,
    "d_r": 0.07,
    "alpha_p": 0.9,
    "alpha_u": 0.6,
    "kappa": 0.4,
    "mu": 0.08,
    "U": 1.3,
}


def halves(noise, count=20000):
    """Two sets of rows that obey the equations, each with noise of its own in all columns.

    Rates are in R/U, and the columns in the unit of the data's time, of which U is the speed.
    """
    rng = np.random.default_rng(0)
    sizes = [
        TRUTH[name] * (TRUTH["U"] if name in ("d_s", "d_r", "alpha_p", "kappa") else 1) for name in FILAMENTS
    ]
    columns = rng.normal(size=(count, 6))
    filaments = np.column_stack([columns @ sizes, columns])
    vorticity, force = rng.normal(size=(2, count))
    # ω - μ ∇²ω = U curl F, with the bumps' ω first and -(-∇²ω) second.
    flow = np.column_stack([vorticity, (vorticity - TRUTH["U"] * force) / TRUTH["mu"], force])
    scale = np.array([1.0, 1 / TRUTH["mu"], 1.0])
    return [
        Rows(
            filaments + noise * rng.normal(size=filaments.shape),
            flow + noise * scale * rng.normal(size=flow.shape),
        )
        for _ in range(2)
    ]


@pytest.mark.parametrize("fixed", [(), ("mu", "epsilon"), ("d_s", "kappa"), ("U",)])
@pytest.mark.parametrize(("noise", "near"), [(0.0, 1e-9), (0.4, 0.06)])
def test_noise_of_the_columns_does_not_bias(noise, near, fixed):
    """Least squares would lose 1/(1 + 0.4²) of every coefficient: 14 %."""
    found = solved(halves(noise), {name: TRUTH[name] for name in fixed}).values
    for name, truth in TRUTH.items():
        assert found[name] == pytest.approx(truth, rel=near, abs=0.02 * (noise > 0)), name
