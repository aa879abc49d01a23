"""A scalar over time: what is conserved, closed forms, manufactured solutions, orders, and refusals."""

import numpy as np
import pytest
from scipy.special import ive, j0, jn_zeros, jv

import cyclosis as cy
from cyclosis.vacuole.radial import radial_basis
from measure.vacuole_flows import bands, stirred

V = cy.vacuole


def lump(r, theta, z):
    x, y = r * np.cos(theta), r * np.sin(theta)
    return np.exp(-8 * ((x - 0.3) ** 2 + y**2) - 4 * np.sin(np.pi * (z - 2.5) / 5) ** 2)


@pytest.mark.parametrize("m", [0, 1, 4])
def test_radial_functions_are_those_of_bessel(m):
    sealed, absorbing = (radial_basis(6, 32, 24, biot) for biot in (0.0, np.inf))
    zeros = jn_zeros(m, 3)
    assert absorbing.rates[m, :3] == pytest.approx(zeros**2, abs=1e-9)
    f, exact = absorbing.value[m, :, 1], jv(m, zeros[1] * absorbing.r)
    assert np.abs(f * exact[3] - exact * f[3]).max() < 1e-9
    for one in (sealed, absorbing):
        products = one.value[m].T @ (one.weights[:, None] * one.value[m])
        assert np.abs(products[: one.count[m], : one.count[m]] - np.eye(one.count[m])).max() < 1e-12
        assert one.at(m, one.r)[:, : one.count[m]] == pytest.approx(
            one.value[m][:, : one.count[m]], abs=1e-10
        )
    assert np.abs(sealed.wall_slope[m, :3]).max() < 1e-7


def test_a_sealed_vacuole_keeps_the_amount_and_loses_variance_as_it_must():
    flow, peclet = stirred(), 50.0
    run = V.transport(
        flow, peclet, start=lump, t_end=4.0, times=np.linspace(0, 4, 161), n_r=16, shape=(32, 32)
    )
    assert np.abs(run.mean / run.mean[0] - 1).max() < 1e-12
    v = run.variance
    rate = (v[:-4] - 8 * v[1:-3] + 8 * v[3:-1] - v[4:]) / (12 * run.t[1])
    # Fourth-order differences over 1/40 R/U are too coarse for the first, fastest decay.
    assert np.allclose(rate[20:], -2 / peclet * run.gradient[22:-2], rtol=1e-6, atol=0)
    assert run.wall_flux == pytest.approx(np.zeros(161), abs=1e-12)
    assert np.all(np.isnan(run.sherwood) | (run.sherwood == 0))


def test_extremes_do_not_grow():
    run = V.transport(stirred(), 20.0, start=lump, t_end=4.0, n_r=16, shape=(32, 32))
    size = run.maximum[0] - run.minimum[0]
    assert run.unresolved.max() < 1e-4
    assert run.maximum.max() < run.maximum[0] + 1e-3 * size
    assert run.minimum.min() > run.minimum[0] - 1e-3 * size


def test_the_amount_that_leaves_passes_through_the_wall():
    for wall in (V.Absorbing(), V.Exchange(2.0, 0.25)):
        run = V.transport(stirred(), 20.0, wall, 1.0, t_end=4.0, times=np.linspace(0, 4, 81), n_r=24)
        m = run.mean
        rate = (m[:-4] - 8 * m[1:-3] + 8 * m[3:-1] - m[4:]) / (12 * run.t[1])
        late = slice(20, None)  # at first c jumps at the wall
        assert np.allclose(rate[late], -2 / 20.0 * run.wall_flux[2:-2][late], rtol=2e-4, atol=0)


def test_diffusion_alone_follows_bessel_functions():
    still = bands(lambda phi: 0 * phi, n=16, n_z=8)
    k, q = jn_zeros(0, 2)[1], 2 * np.pi / 5
    shape = lambda r, theta, z: j0(k * r) * np.cos(q * z) + 0 * theta  # noqa: E731
    run = V.transport(still, 10.0, V.Absorbing(), shape, t_end=1.0, n_r=24)
    exact = np.exp(-(k**2 + q**2) / 10.0) * shape(run.r[:, None, None], run.theta[:, None], run.z)
    assert np.abs(run.frames[0] - exact).max() < 1e-9


@pytest.mark.slow
def test_a_uniform_wall_does_not_feel_a_straight_flow():
    run = V.transport(bands(np.sin, n=16, n_z=8), 20.0, V.Absorbing(), 1.0, t_end=40.0, n_r=16)
    assert run.sherwood[-1] == pytest.approx(jn_zeros(0, 1)[0] ** 2, abs=1e-8)


@pytest.mark.slow
def test_uptake_over_time_is_the_rate_of_the_slowest_mode():
    flow = bands(np.sin, 0.4 * np.pi, n=24)
    run = V.transport(flow, 200.0, V.Absorbing(), 1.0, t_end=150.0, n_r=24)
    assert run.sherwood[-1] == pytest.approx(V.uptake(flow, 200.0), rel=1e-5)


def test_a_held_pattern_is_reached():
    q = 2 * np.pi / 5
    wall = V.Held(lambda theta, z: np.cos(q * z + theta))
    run = V.transport(bands(lambda phi: 0 * phi, n=16), 1.0, wall, 0.0, t_end=5.0, n_r=12)
    r = run.r[:, None, None]
    exact = ive(1, q * r) / ive(1, q) * np.exp(q * (r - 1)) * np.cos(q * run.z + run.theta[:, None])
    assert np.abs(run.frames[0] - exact).max() < 1e-10


def manufactured(n_r, shape, dt=None, t_end=0.5):
    """The error of a scalar that rotates with the vacuole, along a wall that slides: an exact solution.

    u = e_theta at the wall turns the whole vacuole; a lump of a wave of diffusion turns with it and decays.
    """
    grid = cy.CylinderGrid(*shape)
    flow = V.flow(grid, np.stack([np.ones(grid.shape), np.zeros(grid.shape)]))
    k, q, peclet = jn_zeros(3, 1)[0], 2 * np.pi / grid.length, 20.0

    def exact(t):
        decay = np.exp(-(k**2 + q**2) * t / peclet)
        return lambda r, theta, z: decay * jv(3, k * r) * np.cos(3 * (theta - t)) * np.cos(q * z)

    run = V.transport(flow, peclet, V.Absorbing(), exact(0.0), t_end, [t_end], n_r=n_r, dt=dt)
    return np.abs(run.frames[0] - exact(t_end)(run.r[:, None, None], run.theta[:, None], run.z)).max()


@pytest.mark.slow
def test_convergence_is_spectral_in_the_radius():
    errors = [manufactured(n_r, (16, 8), dt=0.01) for n_r in (4, 6, 8, 12)]
    assert errors[0] > 0.01
    assert errors[1] < errors[0] / 4
    assert errors[2] < errors[1] / 8
    assert errors[3] < errors[2] / 1000


@pytest.mark.slow
def test_fourth_order_in_time():
    errors = [manufactured(14, (16, 8), dt=dt, t_end=2.0) for dt in (0.2, 0.1, 0.05)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 4) < 0.3)


@pytest.mark.slow
def test_resolutions_agree_on_a_flow_without_symmetry():
    coarse, fine = (
        V.transport(stirred(), 30.0, V.Absorbing(), lump, 3.0, n_r=n_r, shape=(n, n))
        for n_r, n in ((14, 24), (24, 40))
    )
    # The start is not 0 at the wall: its projections differ.
    assert coarse.mean[1:] == pytest.approx(fine.mean[1:], rel=2e-5)
    assert coarse.variance[1:] == pytest.approx(fine.variance[1:], rel=2e-4)


def test_runs_carry_with_their_own_time():
    params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
    start = cy.initial.stripes(grid, magnitude=0.3)
    run = cy.simulate(params, grid, start, t_end=4.0, save_at=np.linspace(0, 4, 17))
    flow = V.flow(run)
    whole = V.transport(flow, 20.0, start=lump, t_end=4.0, n_r=12, times=[2.0, 4.0], frames=[2.0, 4.0])
    assert np.abs(whole.mean - whole.mean[0]).max() < 1e-12
    # The flow grows sixfold: that of the end carries further. Shorter steps change nothing.
    frozen = V.transport(V.flow(run, t=4.0), 20.0, start=lump, t_end=4.0, n_r=12)
    assert np.abs(frozen.frames[0] - whole.frames[1]).max() > 0.01
    finer = V.transport(flow, 20.0, start=lump, t_end=4.0, n_r=12, dt=0.02, times=[4.0])
    assert np.abs(finer.frames[0] - whole.frames[1]).max() < 1e-4


def test_datasets():
    run = V.transport(bands(np.sin, n=16, n_z=8), 10.0, start=lump, t_end=1.0, n_r=8, times=[0.0, 1.0])
    data = run.to_dataset()
    assert data.c.dims == ("frame", "r", "theta", "z")
    assert float((data.c.mean(("theta", "z")) @ data.weights)[0]) == pytest.approx(run.mean[-1])


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"peclet": 0.0}, "peclet"),
        ({"peclet": float("inf")}, "peclet"),
        ({"wall": "sealed"}, "wall"),
        ({"wall": V.Held(np.zeros((3, 3)))}, "pattern"),
        ({"wall": V.Held(np.nan)}, "pattern"),
        ({"start": np.ones((2, 2, 2))}, "start"),
        ({"start": np.nan}, "start"),
        ({"t_end": -1.0}, "t_end"),
        ({"times": [2.0, 1.0]}, "times"),
        ({"frames": [11.0]}, "frames"),
        ({"n_r": 2}, "n_r"),
        ({"flow": np.zeros((2, 16, 16))}, "flow"),
        ({"dt": 5.0, "t_end": 2000.0, "times": [2000.0], "peclet": 1e6}, "dt"),
    ],
)
def test_bad_input_is_one_sentence(changed, named):
    given = {"flow": stirred(), "peclet": 1e4, "t_end": 1.0, "start": lump, "n_r": 8} | changed
    with pytest.raises(cy.InputError, match=named):
        V.transport(**given)


def test_a_run_is_not_followed_beyond_its_frames():
    params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
    run = cy.simulate(params, grid, cy.initial.disordered(grid, seed=1), t_end=2.0)
    with pytest.raises(cy.InputError, match="t_end"):
        V.transport(V.flow(run), 20.0, t_end=3.0)
