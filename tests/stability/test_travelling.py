import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.profiles.travelling import drifting

N = 64


@pytest.mark.slow
@pytest.mark.parametrize(("kappa", "drift"), [(0.1, 0.00540121), (0.15, 0.00148087), (0.2, -0.00243321)])
def test_tilted_stripes_drift_as_they_do_in_a_simulation(kappa, drift):
    params, grid = cy.Parameters(kappa=kappa), cy.CylinderGrid(N, 8, 5.0)
    found = drifting(params, N)
    assert found.drift == pytest.approx(drift, abs=1e-8)
    assert found.residual < 1e-5
    assert found.P[0].mean() > 0.4
    P = found.state(grid)
    assert cy.flow(params, grid, P)[:, :, 0] == pytest.approx(found.u, abs=1e-12)
    run = cy.simulate(params, grid, P, 50.0, 50.0, rtol=1e-8)
    before, after = (np.fft.fft(state[1].mean(axis=1))[1] for state in (P, run.final_state))
    assert -np.angle(after / before) / 50.0 == pytest.approx(found.drift, rel=1e-4)


def test_the_mirror_image_drifts_the_other_way():
    right, left = (drifting(cy.Parameters(kappa=0.15), N, hand=hand) for hand in ("right", "left"))
    assert left.drift == pytest.approx(-right.drift, abs=1e-11)
    assert left.P[0].mean() == pytest.approx(-right.P[0].mean(), abs=1e-11)
    assert np.hypot(*left.P).max() == pytest.approx(np.hypot(*right.P).max(), abs=1e-4)


@pytest.mark.parametrize(
    ("changes", "arguments", "match"),
    [
        ({"kappa": 0.6}, {}, "straighten and stop"),
        ({"kappa": 0.02}, {}, "relax to a uniform state"),
        ({"kappa": 0.1}, {"hand": "up"}, "hand"),
        ({"kappa": 0.1}, {"duration": -1.0}, "duration"),
        ({"kappa": 0.1}, {"n_theta": 4}, "n_theta"),
        ({"kappa": np.ones((8, 8))}, {}, "one number"),
        ({"kappa": 0.3, "d_s": 2e-3}, {"n_theta": 32}, "n_theta"),
    ],
)
def test_what_cannot_be_is_refused(changes, arguments, match):
    with pytest.raises(cy.InputError, match=match):
        drifting(cy.Parameters(**changes), **({"n_theta": N} | arguments))
