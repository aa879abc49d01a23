"""Closures of the polar model: oracle, kinetic model, uniform states, growth, gauge, files, refusals."""

import json

import jax
import numpy as np
import pytest
from scipy.special import ive
from typer.testing import CliRunner

import closure_oracle
import cyclosis as cy
from cyclosis import config
from cyclosis.cli import app
from cyclosis.explorer import setup as explorer_setup
from cyclosis.figures import swept, theory
from cyclosis.model import closures
from cyclosis.model.definitions import TERM_NAMES
from cyclosis.model.precision import double
from cyclosis.models import of_tables, polar_model

NAMES = ("von_mises", "wrapped_normal", "weak")
GRID = cy.CylinderGrid(16, 12, 4.0)
GENERAL = cy.Parameters(
    alpha_p=0.7, alpha_u=0.6, kappa=0.3, epsilon=0.2, d_s=0.03, d_r=0.08, mu=0.07, repulsion_angle=0.4
)
ODD = cy.CylinderGrid(15, 11, 4.0)
"""A grid without Nyquist modes."""


def smooth(size=0.6, grid=GRID):
    """Return a state with |P| from nearly 0 to about 0.95."""
    theta, z = grid.theta[:, None], 2 * np.pi * grid.z[None, :] / grid.length
    return size * np.stack([0.6 * np.cos(theta - z) + 0.2 * np.sin(z), np.sin(theta) + 0.5 * np.cos(z + 0.3)])


def varied(grid=GRID):
    """Return parameters that vary over the surface."""
    shape = np.cos(grid.theta)[:, None] * np.sin(2 * np.pi * grid.z / grid.length)
    fields = {
        "alpha_p": 0.7 + 0.3 * shape, "alpha_u": 0.6 - 0.2 * shape, "kappa": 0.3 + 0.2 * shape,
        "repulsion_angle": 0.4 + 0.3 * shape,
    }  # fmt: skip
    return GENERAL.replace(**fields)


CASES = {
    "numbers": GENERAL,
    "no flux around": GENERAL.replace(zero_theta_flux=True),
    "another force": GENERAL.replace(force_exponent=1.0),
    "fields": varied(),
}


@pytest.mark.parametrize("closure", NAMES)
@pytest.mark.parametrize("case", CASES)
def test_one_right_hand_side_against_sums_over_angles(closure, case):
    params, P = CASES[case], smooth()
    found = cy.rate_of_change(params, GRID, P, closure=closure)
    expected = closure_oracle.rate(params, GRID.length, P, closure)
    assert np.abs(expected).max() > 0.1
    assert np.abs(found - expected).max() < 1e-10
    assert np.abs(found - cy.rate_of_change(params, GRID, P)).max() > 1e-2


@pytest.mark.parametrize("closure", NAMES)
def test_each_term_alone_and_their_sum(closure):
    P, expected = smooth(), closure_oracle.terms(GENERAL, GRID.length, smooth(), closure)
    total = np.zeros_like(P)
    for name, value in expected.items():
        found = cy.rate_of_change(GENERAL, GRID, P, terms=[name], closure=closure)
        assert np.abs(found - value).max() < 1e-10, name
        total += found
    assert np.abs(total - cy.rate_of_change(GENERAL, GRID, P, closure=closure)).max() < 1e-13
    work = cy.diagnose(GENERAL, GRID, P, closure=closure)["budget"]
    for name, value in expected.items():
        # The budget is taken before products are cut back to the modes of the state.
        assert work[name] == pytest.approx(np.mean(np.sum(P * value, axis=0)), abs=1e-10), name


def moments_of(closure, P):
    """Return the angular moments of the densities that a closure stands for, c = 1."""
    p = P[0] + 1j * P[1]
    if closure == "von_mises":
        return cy.kinetic.dressed(P, 8)
    n = np.arange(9)[:, None, None]
    return p**n * (np.abs(p) ** (n * n - n) if closure == "wrapped_normal" else 1.0)


@pytest.mark.parametrize("closure", NAMES)
def test_where_angles_have_its_density_a_closure_is_the_kinetic_model(closure):
    """But for advection: one carries P along as a flux, and this grid does not resolve all its products."""
    P, params = smooth(grid=ODD), varied(ODD)
    still = [name for name in TERM_NAMES if name != "advection"]
    m = moments_of(closure, P)
    kinetic = cy.models.kinetic
    system = kinetic.system(kinetic.problem(params, ODD, still, shape=m.shape), True)
    with double():
        exact = np.fft.ifft2(np.asarray(system.rate(system.at(kinetic.modes(system, m)))))[1]
    found = cy.rate_of_change(params, ODD, P, terms=still, closure=closure)
    assert np.abs(found - np.stack([exact.real, exact.imag])).max() < 1e-12


STATES = {
    (0.0, 0.1): (0.86602, 0.70711, 0.83146, 0.84090),
    (0.0, 0.25): (0.94868, 0.89443, 0.94554, 0.94574),
    (0.0, 1.0): (0.98742, 0.97468, 0.98725, 0.98726),
    (0.5, 0.05): (0.70711, 0.91287, 0.97530, 0.97535),
    (0.5, 0.1): (0.86602, 0.92582, 0.97762, 0.97765),
    (0.5, 0.25): (0.94868, 0.94868, 0.98248, 0.98249),
    (0.5, 1.0): (0.98742, 0.97980, 0.99151, 0.99151),
}
"""Uniform |P| along z by (κ, α_p): paper, weak, von Mises, wrapped normal; of another program."""


@pytest.mark.parametrize(("kappa", "alpha_p"), STATES)
def test_uniform_states(kappa, alpha_p):
    params, grid = cy.Parameters(kappa=kappa, alpha_p=alpha_p), cy.CylinderGrid(8, 8)
    names = ("paper", "weak", "von_mises", "wrapped_normal")
    for closure, known in zip(names, STATES[kappa, alpha_p], strict=True):
        rates = []
        for P in (known - 2e-5, known + 2e-5):
            state = cy.initial.unidirectional(grid, P)
            rates.append(cy.rate_of_change(params, grid, state, closure=closure)[1, 0, 0])
        assert rates[0] > 0 > rates[1], closure


def test_order_without_repulsion_is_exactly_that_of_von_mises():
    grid = cy.CylinderGrid(8, 8)
    for alpha_p, d_r in ((0.5, 0.05), (0.3, 0.1), (5.0, 0.01)):
        params = cy.Parameters(alpha_p=alpha_p, d_r=d_r, kappa=0.0)
        P = abs(cy.kinetic.uniform_state(params)[1])
        rate = cy.rate_of_change(params, grid, cy.initial.unidirectional(grid, P), closure="von_mises")
        assert np.abs(rate).max() < 1e-11


@pytest.mark.parametrize("closure", NAMES)
@pytest.mark.parametrize(("alpha_p", "across", "along"), [(1.0, 0.600, 0.350), (0.0, 0.100, -0.150)])
def test_growth_from_isotropy_spurious_without_bundling(closure, alpha_p, across, along):
    """At α_p = 0 order across d still grows at κ/4 - d_r, which filaments do not do."""
    params, grid = cy.Parameters(alpha_p=alpha_p, alpha_u=0.5), cy.CylinderGrid(8, 8)
    for direction, known in ((1, across), (0, along)):
        state = np.zeros((2, 8, 8))
        state[direction] = 1e-6
        rate = cy.rate_of_change(params, grid, state, closure=closure)[direction, 0, 0]
        assert rate / 1e-6 == pytest.approx(known, abs=1e-9)
    assert across == pytest.approx(alpha_p / 2 + params.kappa / 4 - params.d_r)


def test_a_torque_along_the_filament_does_nothing_but_in_the_paper_s_closure():
    """-κ (p·d) d - κ (p·e) e = -κ p for e across d: a torque along p."""
    P = smooth()

    def of_both(closure):
        return sum(
            cy.rate_of_change(
                GENERAL.replace(repulsion_angle=0.4 + turn), GRID, P, terms=["repulsion"], closure=closure
            )
            for turn in (0.0, np.pi / 2)
        )

    for closure in NAMES:
        assert np.abs(of_both(closure)).max() < 1e-14
    expected = -GENERAL.kappa * (1 - np.sum(P**2, axis=0)) * P
    expected = cy.interpolate(cy.interpolate(expected, (15, 11)), GRID.shape)  # without Nyquist modes
    assert np.abs(expected).max() > 0.05
    assert np.abs(of_both("paper") - expected).max() < 1e-14


def test_von_mises_moments_are_ratios_of_bessel_functions_from_no_order_to_full():
    x = np.concatenate([np.geomspace(1e-8, 0.1, 40), np.linspace(0.1, 60, 2000), np.geomspace(60, 1e8, 200)])
    first, second, third = (ive(n, x) / ive(0, x) for n in (1, 2, 3))
    with double():
        found = [np.asarray(item) for item in closures.von_mises(jax.numpy.asarray(first + 0j))]
    assert np.abs(found[0] - second).max() < 1e-12
    assert np.abs(found[1] - third).max() < 1e-12
    small = x < 0.1
    assert np.abs(found[0] / first**2 - second / first**2)[small].max() < 1e-11
    with double():
        inverse = closures.concentration(first[(x > 1e-3) & (x < 1e3)])
    assert inverse == pytest.approx(x[(x > 1e-3) & (x < 1e3)], rel=1e-9)


def test_von_mises_stays_smooth_and_finite_beyond_full_order():
    with double():
        P = np.concatenate([[0.0], 1 + np.linspace(-1e-4, 1e-4, 81), [1.01, 1.25]])
        for number in (0, 1):

            def one(magnitude, number=number):
                return closures.von_mises(jax.lax.complex(magnitude, 0.0 * magnitude))[number].real

            values = np.asarray(jax.vmap(one)(jax.numpy.asarray(P)))
            slopes = np.asarray(jax.vmap(jax.grad(one))(jax.numpy.asarray(P)))
            assert np.all(np.isfinite(values))
            assert np.all(np.isfinite(slopes))
            near = slice(1, 82)
            assert np.abs(np.diff(values[near])).max() < 3e-5
            assert np.abs(np.diff(slopes[near])).max() < 3e-4


def test_the_paper_s_closure_is_the_default():
    P = smooth()
    assert np.array_equal(
        cy.rate_of_change(GENERAL, GRID, P), cy.rate_of_change(GENERAL, GRID, P, closure="paper")
    )
    assert polar_model() is cy.models.polar
    assert polar_model(closure="weak") is polar_model("weak")


@pytest.mark.slow
def test_a_closure_is_traced_and_differentiated():
    grid = cy.CylinderGrid(8, 8)
    P = cy.initial.unidirectional(grid, 0.3)

    def rate(alpha_p):
        return cy.traced.rate_of_change(
            cy.Parameters(), grid, P, precision="float32", closure="wrapped_normal", alpha_p=alpha_p
        )[1].mean()

    assert float(jax.grad(rate)(1.0)) == pytest.approx(0.15 * (1 - 0.3**4), rel=1e-5)


PROTOCOL = cy.Protocol(
    cy.change(at=0.5, over=1.0, alpha_p=0.2, kappa=0.1, d_r=0.1),
    cy.noise(at=2.0, size=0.02),
    seed=3,
)


@pytest.mark.slow
@pytest.mark.parametrize("closure", NAMES)
def test_a_run_goes_on_bit_for_bit_through_a_file(tmp_path, closure):
    model, state = polar_model(closure), smooth()
    how = {"model": model, "protocol": PROTOCOL, "save_every": 0.5}
    whole = cy.simulate(varied(), GRID, state, 3.0, **how)
    path = cy.write(cy.simulate(varied(), GRID, state, 1.0, **how), tmp_path / "half.nc")
    cy.resume_file(path, 3.0)
    stored = cy.load(path)
    assert stored.model is model
    assert np.array_equal(stored.final_state, whole.final_state)
    assert all(np.array_equal(a, b) for a, b in zip(stored.frames, whole.frames, strict=True))
    paper = cy.simulate(varied(), GRID, state, 3.0, protocol=PROTOCOL)
    assert np.abs(paper.final_state - whole.final_state).max() > 1e-2
    with cy.open_dataset(path) as data:
        assert json.loads(data.attrs["configuration"])["model"] == {"kind": "polar", "closure": closure}
        assert np.abs(data["u"][0].values - cy.flow(varied(), GRID, state)).max() < 1e-13
    found = CliRunner().invoke(app, ["info", str(path)])
    assert f"kind = polar, closure = {closure}" in found.output


@pytest.mark.slow
def test_a_file_is_not_continued_by_another_closure(tmp_path):
    run = cy.simulate(GENERAL, GRID, smooth(), 0.5, model=polar_model("weak"))
    path = cy.write(run, tmp_path / "weak.nc")
    for other in (cy.models.polar, polar_model("von_mises")):
        with pytest.raises(cy.InputError, match="polar with closure = weak, as in the file"):
            cy.load(path, model=other)
    assert cy.load(path, model=polar_model("weak")).model is polar_model("weak")
    plain = cy.write(cy.simulate(GENERAL, GRID, smooth(), 0.5), tmp_path / "paper.nc")
    with pytest.raises(cy.InputError, match="polar, as in the file"):
        cy.load(plain, model=polar_model("weak"))


def test_fourth_order_in_time():
    def end(dt):
        how = {"model": polar_model("von_mises"), "stepper": "etdrk4", "dt": dt}
        return cy.simulate(GENERAL, GRID, smooth(0.5), 1.0, **how).final_state

    exact = end(0.005)
    coarse, fine = (np.abs(end(dt) - exact).max() for dt in (0.1, 0.05))
    assert np.log2(coarse / fine) == pytest.approx(4.0, abs=0.25)


def test_a_configuration_and_the_command_line_choose_a_closure(tmp_path):
    tables = config.check({"model": {"closure": "wrapped_normal"}, "grid": {"n_theta": 8, "n_z": 8}})
    assert config.setup(tables).model is polar_model("wrapped_normal")
    path = tmp_path / "run.nc"
    grid = ["--n-theta", "8", "--n-z", "8", "--t-end", "0.2", "--quiet", "--out", str(path)]
    found = CliRunner().invoke(app, ["run", "--closure", "weak", *grid])
    assert found.exit_code == 0, found.output
    assert cy.load(path).model is polar_model("weak")


@pytest.mark.slow
def test_members_of_an_ensemble_share_lanes_and_are_not_certified():
    grid, model = cy.CylinderGrid(8, 8), polar_model("von_mises")
    params = [cy.Parameters(d_s=0.1, alpha_p=a) for a in (0.3, 0.45, 0.6)]
    starts = [cy.initial.disordered(grid, seed=s) for s in range(3)]
    members = [
        cy.ensemble.Member(p, grid, lambda P=P: P, model=model) for p, P in zip(params, starts, strict=True)
    ]
    how = cy.ensemble.EnsembleSettings(t_end=20.0, finish="t_end", lanes=3)
    for member, found in zip(members, cy.ensemble.follow(members, how), strict=True):
        run = cy.simulate(member.params, grid, member.state(), 20.0, 20.0, model=model)
        assert found.status == "completed"
        assert np.abs(found.state - run.final_state).max() < 1e-3  # to the tolerance of the steps
        paper = cy.simulate(member.params, grid, member.state(), 20.0, 20.0)
        assert np.abs(found.state - paper.final_state).max() > 1e-2
    with pytest.raises(cy.InputError, match="t_end with the model polar with closure = von_mises"):
        cy.ensemble.follow(members, cy.ensemble.EnsembleSettings(t_end=20.0))


@pytest.mark.slow
def test_a_sweep_of_a_closure():
    from cyclosis.sweep.store.block import compute

    tables = {
        "model": {"closure": "von_mises"},
        "axes": {"alpha_p": {"values": [0.1, 0.25]}},
        "grid": {"n_theta": 8, "n_z": 8},
        "parameters": {"kappa": 0.0},
        "initial": {"kind": "unidirectional"},
        "run": {"t_end": 200.0},
    }
    sweep = cy.Sweep.from_tables(tables)
    assert sweep.settings.finish == "t_end"
    assert sweep.tables["model"] == {"kind": "polar", "closure": "von_mises"}
    assert compute(sweep, 0)["order"] == pytest.approx([0.83146, 0.94554], abs=1e-5)
    with pytest.raises(cy.InputError, match="t_end with the model polar with closure = von_mises"):
        cy.Sweep.from_tables(tables | {"run": {"finish": "certified"}})
    assert "model" not in cy.Sweep.from_tables(tables | {"model": {"closure": "paper"}}).tables


def test_no_stripes_of_the_paper_s_theory_are_drawn_over_a_run_of_a_closure():
    grid = cy.CylinderGrid(16, 16)
    for model, words in ((cy.models.polar, None), (polar_model("weak"), "no theory for this model")):
        run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 0.5, model=model)
        found = theory.expected(run.to_dataset())
        assert found == words if words else not isinstance(found, str)


def test_no_curve_of_the_paper_s_theory_is_drawn_over_a_sweep_of_a_closure():
    import xarray

    given = {"parameters": {}, "run": {}}
    for model, applies in ((None, True), ({"kind": "polar", "closure": "weak"}, False)):
        tables = given | ({"model": model} if model else {})
        data = xarray.Dataset(attrs={"configuration": json.dumps(tables)})
        assert (swept._parameters(data, {}) is not None) == applies


def test_regimes_are_judged_by_the_closure_s_own_rate():
    grid, params = cy.CylinderGrid(8, 8), cy.Parameters(kappa=0.5, alpha_p=0.1)
    state = cy.initial.unidirectional(grid, 0.97762)
    model = polar_model("von_mises")
    assert model.regime(model.problem(params, grid), state).settled
    assert not cy.regime(params, grid, state).settled
    assert cy.regime(params, grid, state, closure="von_mises").settled


def test_mistakes_are_refused_in_a_sentence():
    with pytest.raises(cy.InputError, match="one of paper, von_mises, wrapped_normal, weak"):
        polar_model(closure="vonmises")
    with pytest.raises(cy.InputError, match="one of paper, von_mises, wrapped_normal, weak"):
        cy.rate_of_change(GENERAL, GRID, smooth(), closure="strong")
    with pytest.raises(cy.InputError, match="closure = 'weak' cannot be used: it must be used only"):
        of_tables(config.check({"model": {"kind": "kinetic", "closure": "weak"}}))
    with pytest.raises(cy.InputError, match="left out in the explorer"):
        explorer_setup.from_tables({"model": {"closure": "weak"}})
    with pytest.raises(cy.InputError, match="left out in the explorer"):
        explorer_setup.from_tables({"model": {"kind": "kinetic"}})
    assert explorer_setup.from_tables({"model": {"closure": "paper"}})
