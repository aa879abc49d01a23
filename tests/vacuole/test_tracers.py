"""Tracers: splines against the exact flow, order of the method, what is conserved, stretching."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.vacuole.splines import b_spline, coefficients, compiled_velocity, lattice_of
from cyclosis.vacuole.tracers import reflected
from measure.vacuole_flows import bands, stirred, stripes_profile

V = cy.vacuole


def places(count, seed=0, most=1.0):
    rng = np.random.default_rng(seed)
    return np.stack(
        [most * np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count), 5 * rng.random(count)], 1
    )


def exact_psi(flow, q, points):
    """The stream function of a helical flow: d_r psi = -(u_theta - q r u_z), and 0 at r = 1."""
    r, theta, z = points.T
    x, weights = np.polynomial.legendre.leggauss(24)
    total = np.zeros(r.size)
    for node, weight in zip(x, weights, strict=True):
        at = r + 0.5 * (1 - r) * (node + 1)
        v = flow.at(np.stack([at, theta, z], 1))
        total += 0.5 * weight * (1 - r) * (v[:, 1] - q * at * v[:, 2])
    return total


@pytest.mark.parametrize("order", [3, 5])
def test_splines_sum_to_one_and_match_at_knots(order):
    t = np.linspace(0, 1, 5)
    values = np.array(b_spline(t, order))
    assert values.sum(axis=0) == pytest.approx(np.ones(5))
    assert values[1:, -1] == pytest.approx(values[:-1, 0])


@pytest.mark.slow
@pytest.mark.parametrize(("order", "rate"), [(3, 4.0), (5, 6.0)])
def test_the_velocity_converges_everywhere(order, rate):
    flow, points = stirred(16), places(300)
    points[:3, 0] = 0.0, 1.0, 1e-7
    xyz = np.stack([points[:, 0] * np.cos(points[:, 1]), points[:, 0] * np.sin(points[:, 1]), points[:, 2]])
    exact, errors = flow.cartesian_at(points).T, []
    from cyclosis.model.precision import double

    for refine, n_s in ((1, 16), (2, 32), (4, 64)):
        lattice = lattice_of(flow, order, refine, n_s)
        with double():
            found = compiled_velocity(lattice)(coefficients(flow, lattice), xyz)
        errors.append(np.abs(np.asarray(found) - exact).max())
    assert np.log2(errors[1] / errors[2]) > rate - 0.6
    assert errors[2] < {3: 1e-4, 5: 3e-6}[order]


def test_fourth_order_in_time():
    flow, starts = bands(np.sin, 0.4 * np.pi, n=16), places(30, most=0.95)
    ends = [V.trace(flow, starts, 8.0, [8.0], dt=dt, order=3, n_s=32).xyz for dt in (0.4, 0.2, 0.1, 0.025)]
    errors = [np.abs(one - ends[-1]).max() for one in ends[:-1]]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 4) < 0.5)


@pytest.mark.slow
def test_the_stream_function_of_a_helix_is_conserved():
    q, starts = 0.4 * np.pi, places(60, most=0.95)
    flow = bands(np.sin, q, n=16)
    before = exact_psi(flow, q, starts)
    drift = []
    for dt in (0.4, 0.2):
        paths = V.trace(flow, starts, 40.0, [40.0], dt=dt, n_s=64)
        drift.append(np.abs(exact_psi(flow, q, paths.cylindrical[-1]) - before).max())
    assert drift[1] < 1e-5 * np.ptp(before) * 10
    assert drift[0] / drift[1] > 8
    # It would not be if the flow were a little less twisted than the function.
    assert (
        np.abs(exact_psi(bands(np.sin, 0.9 * q, n=16), q, paths.cylindrical[-1]) - before).max()
        > 100 * drift[1]
    )


def test_steps_beyond_the_wall_are_reflected_in_it():
    """A place and its image are as far from the wall, on one radius; those inside stay."""
    r, theta, z = np.array([0.0, 0.7, 1.0, 1.2, 1.9, 2.5]), 0.6, 3.0
    found = np.asarray(reflected(np.stack([r * np.cos(theta), r * np.sin(theta), z + 0 * r])))
    expected = np.array([0.0, 0.7, 1.0, 0.8, 0.1, 0.0])
    assert found == pytest.approx(
        np.stack([expected * np.cos(theta), expected * np.sin(theta), z + 0 * r]), abs=1e-6
    )


@pytest.mark.slow
@pytest.mark.parametrize("peclet", [None, 2.0])
def test_none_leaves(peclet):
    starts = places(500)
    starts[:50, 0] = 1.0
    paths = V.trace(stirred(16, seed=3), starts, 20.0, dt=0.2, peclet=peclet, order=3)
    assert paths.cylindrical[..., 0].max() <= 1.0
    assert np.isfinite(paths.xyz).all()


@pytest.mark.slow
def test_noise_alone_spreads_as_it_should_and_stays_uniform():
    still = bands(lambda phi: 0 * phi, n=16, n_z=8)
    starts = places(4000)
    paths = V.trace(still, starts, 4.0, [4.0], dt=0.02, peclet=10.0, seed=5, order=3, n_s=16)
    moved = paths.xyz[-1, :, 2] - starts[:, 2]
    assert moved.var() == pytest.approx(0.8, rel=4 * np.sqrt(2 / 4000))
    # Uniform in the section: r² is uniform from 0 to 1. Reflection in steps of 0.06 R leaves a small error.
    shares = np.histogram(paths.cylindrical[-1, :, 0] ** 2, bins=5, range=(0, 1))[0] / 4000
    assert shares == pytest.approx(np.full(5, 0.2), abs=0.03)
    again = V.trace(still, starts, 4.0, [4.0], dt=0.02, peclet=10.0, seed=5, order=3, n_s=16)
    assert np.array_equal(again.xyz, paths.xyz)


@pytest.mark.slow
def test_runs_carry_tracers_with_their_own_time():
    params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
    start = cy.initial.stripes(grid, magnitude=0.3)
    run = cy.simulate(params, grid, start, t_end=8.0, save_at=np.linspace(0, 8, 33))
    flow, r = V.flow(run), 0.5
    paths = V.trace(flow, [[r, np.pi / 2, 0.0], [r, -np.pi / 2, 0.0]], 8.0, [8.0], refine=2, n_s=48, dt=0.1)
    # The speed in the middle of a stripe over time, summed by the rule of Simpson.
    at = np.linspace(0, 8, 65)
    speed = [[flow.at_time(t).at([[r, s * np.pi / 2, 0.0]])[0, 2] for t in at] for s in (1, -1)]
    weights = np.array([1, *[4, 2] * 31, 4, 1]) / 3 * at[1]
    assert paths.xyz[-1, :, 2] == pytest.approx(np.array(speed) @ weights, abs=2e-4)
    with pytest.raises(cy.InputError, match="t_end"):
        V.trace(flow, [[0.0, 0.0, 0.0]], 9.0)


@pytest.mark.slow
def test_single_precision_of_the_table_changes_little():
    flow, starts = stirred(16), places(50)
    one, other = (V.trace(flow, starts, 2.0, [2.0], order=3, precision=p).xyz for p in ("float64", "float32"))
    assert 0 < np.abs(one - other).max() < 1e-5


@pytest.mark.parametrize("peclet", [None, 50.0])
@pytest.mark.slow
def test_many_tracers_move_as_few_do(peclet, monkeypatch):
    flow, starts = stirred(16), places(230)
    given = {"t_end": 7.0, "save_at": [7.0], "refine": 2, "n_s": 32, "peclet": peclet}
    few = V.trace(flow, starts, **given).xyz
    monkeypatch.setattr("cyclosis.vacuole.tracers.MANY", 200)
    monkeypatch.setattr("cyclosis.vacuole.tracers.BLOCK", 100)  # the last block is not full
    many, again = (V.trace(flow, starts, **given).xyz for _ in range(2))
    assert np.array_equal(many, again)
    if peclet is None:
        assert many == pytest.approx(few, abs=1e-10)
    else:  # other random numbers, which are those of no two tracers
        step = many - few
        assert np.abs(step).max() > 0
        assert len(np.unique(np.round(many[0, :, 0] - starts[:, 0] * np.cos(starts[:, 1]), 9))) == 230


@pytest.mark.slow
def test_frames_of_few_points_are_summed_as_those_of_many():
    import jax.numpy as jnp

    from cyclosis.model.precision import double
    from cyclosis.vacuole.splines import velocity_between

    lattice = lattice_of(stirred(16), 3, 1, 16)
    rng = np.random.default_rng(0)
    with double():
        frames = [jnp.asarray(rng.normal(size=(4, np.prod(lattice.stored)))) for _ in range(3)]
        xyz = jnp.asarray(rng.uniform(-0.6, 0.6, (3, 400)))
        factors = jnp.asarray([0.3, -0.2, 0.8, 0.1])
        assert 64 * 100 < frames[0].shape[1] < 64 * 400
        many = velocity_between(frames, factors, xyz, lattice)
        few = velocity_between(frames, factors, xyz[:, :100], lattice)
    assert np.asarray(few) == pytest.approx(np.asarray(many)[:, :100], abs=1e-12)


@pytest.mark.parametrize("flow", [stirred(16), bands(stripes_profile(), 0.4 * np.pi, n=32)])
@pytest.mark.slow
def test_usual_settings_have_the_error_of_their_step(flow):
    starts = places(100, most=0.98)
    fine = V.trace(flow, starts, 10.0, [10.0], dt=0.05, order=5, refine=4).xyz
    stepped, usual = (V.trace(flow, starts, 10.0, [10.0], refine=r).xyz - fine for r in (8, None))
    assert np.linalg.norm(usual, axis=-1).max() < 5e-4
    assert np.linalg.norm(usual, axis=-1).max() < 2 * np.linalg.norm(stepped, axis=-1).max() + 1e-4


def test_poincare_section_of_a_helix_lies_on_closed_curves():
    q = 0.4 * np.pi
    flow = bands(np.sin, q, n=16)
    paths = V.trace(flow, [[0.5, 0.3, 0.0], [0.7, 2.0, 0.0]], 150.0, order=3, n_s=48)
    found = V.poincare(paths)
    for k in (0, 1):
        x, y = found.xy[found.tracer == k].T
        assert x.size > 4
        psi = exact_psi(flow, q, np.stack([np.hypot(x, y), np.arctan2(y, x), np.zeros(x.size)], 1))
        assert np.ptp(psi) < 1e-5
    assert np.all(np.diff(found.t[found.tracer == 0]) > 0)


@pytest.mark.slow
def test_crossings_of_a_straight_flow_are_at_the_right_times():
    flow = bands(np.sin, n=16, n_z=8)
    paths = V.trace(flow, [[0.5, np.pi / 2, 1.0], [0.5, -np.pi / 2, 1.0]], 30.0, order=3)
    found = V.poincare(paths, z=2.0)
    assert found.t[found.tracer == 0] == pytest.approx([2.0, 12.0, 22.0], abs=2e-3)
    assert found.t[found.tracer == 1] == pytest.approx([8.0, 18.0, 28.0], abs=2e-3)
    assert list(found.forwards) == [True] * 3 + [False] * 3


def test_residence():
    flow = bands(np.sin, n=16, n_z=8)
    paths = V.trace(flow, [[0.5, np.pi / 2, 0.0], [0.0, 0.0, 2.0]], 25.0, dt=0.1, order=3)
    times = V.residence_times(paths, lambda r, theta, z: (z > 1.02) & (z < 2.02))
    assert times == pytest.approx([2.0] * 3, abs=1e-9)  # not of the one at rest, which never leaves
    with pytest.raises(cy.InputError, match="region"):
        V.residence_times(paths, lambda r, theta, z: z)


@pytest.mark.slow
def test_stretching():
    # In u_z = r sin(theta), a shear of rate 1, a distance grows as sqrt(1 + (t s)²): the exponent as ln(t)/t.
    flow, starts = bands(np.sin, n=16, n_z=8), places(60, most=0.8)
    found = V.stretching(flow, starts, 200.0, every=20.0, order=3)
    assert found.exponent.shape == (10, 60)
    expected = np.log(found.t) / found.t
    assert np.all(np.abs(found.median / expected - 1) < 0.35)
    assert found.median[-1] < found.median[0] / 3
    # What strains without turning back is seen: an exponential flow along z on the axis.
    with pytest.raises(cy.InputError, match="setting"):
        V.stretching(flow, starts, 20.0, peclet=3.0)


def test_a_strain_stretches_exponentially():
    grid = cy.CylinderGrid(16, 16, 5.0)
    q = 2 * np.pi / 5
    u = np.stack([np.zeros(grid.shape), np.sin(q * grid.z) * np.ones((16, 1))])  # not the flow of a layer
    flow = V.flow(grid, u)
    h = 1e-4
    rate = (flow.at([[0.0, 0.0, h]])[0, 2] - flow.at([[0.0, 0.0, -h]])[0, 2]) / (2 * h)
    # On the axis where fluid converges along z, distances across it grow at half of that rate.
    at = 2.5 if rate > 0 else 0.0
    found = V.stretching(flow, [[0.0, 0.0, at]], 40.0, every=2.0, order=3, n_s=48)
    assert found.exponent[-1, 0] == pytest.approx(abs(rate) / 2, rel=0.1)


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"starts": [[1.2, 0.0, 0.0]]}, "r"),
        ({"starts": [[0.5, 0.0]]}, "points"),
        ({"t_end": 0.0}, "t_end"),
        ({"dt": 0.0}, "dt"),
        ({"peclet": -1.0}, "peclet"),
        ({"order": 4}, "order"),
        ({"precision": "half"}, "precision"),
        ({"save_at": [0.5, 0.2]}, "save_at"),
        ({"n_s": 2}, "n_s"),
        ({"refine": 0}, "refine"),
        ({"flow": "flow"}, "flow"),
    ],
)
def test_bad_input_is_one_sentence(changed, named):
    given = {"flow": bands(np.sin, n=16, n_z=8), "starts": [[0.5, 0.0, 0.0]], "t_end": 1.0} | changed
    with pytest.raises(cy.InputError, match=named):
        V.trace(**given)


@pytest.mark.slow
def test_sections_need_places():
    paths = V.trace(bands(np.sin, n=16, n_z=8), [[0.5, 0.0, 0.0]], 1.0, [1.0], order=3)
    with pytest.raises(cy.InputError, match="paths"):
        V.poincare(paths)
