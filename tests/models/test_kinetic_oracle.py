"""The oracle of the kinetic model obeys the laws of the model, and the closed forms agree with it."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import iv

import kinetic_oracle as oracle
import kinetic_theory as theory

LENGTH = 3.0
VALUES = {
    "epsilon": 0.2, "d_s": 0.03, "d_r": 0.08, "alpha_p": 0.7, "alpha_u": 0.6, "kappa": 0.3,
    "repulsion_angle": 0.4, "mu": 0.07, "zero_theta_flux": False, "force_exponent": 2.0,
}  # fmt: skip


def points(n_theta, n_z, n_phi):
    """Return θ, 2πz/l and φ, each to broadcast over the grid."""
    theta, wave = (2 * np.pi * np.arange(n) / n for n in (n_theta, n_z))
    return theta[:, None, None], wave[None, :, None], oracle.angles(n_phi)[None, None, :]


def smooth(n_theta=12, n_z=10, n_phi=24, uneven=0.3):
    """Return a positive density of few modes in θ and z; c is uniform if `uneven` is zero."""
    theta, wave, phi = points(n_theta, n_z, n_phi)
    towards = 0.5 * np.cos(theta) + 0.4 * np.sin(wave) * np.cos(phi - theta + 0.3)
    Psi = 1 + towards * np.cos(phi) + 0.3 * np.cos(wave - theta) * np.sin(2 * phi) + 0.2 * np.sin(phi)
    Psi = Psi / oracle.concentration(Psi)[..., None]
    return Psi * (1 + uneven * np.cos(theta) * np.cos(wave - 0.5))


def rough(seed=0, shape=(8, 6, 12)):
    return np.random.default_rng(seed).uniform(0.2, 1.0, shape)


def uniform(density):
    """Return a density on angles as a field on a small grid."""
    return np.broadcast_to(density, (2, 2, len(density))).copy()


def varied(shape):
    """Return the values with coefficients that depend on the place."""
    theta, wave, _ = points(*shape)
    field = np.sin(theta[..., 0]) * np.cos(wave[..., 0])
    return VALUES | {"alpha_p": 0.7 + 0.3 * field, "alpha_u": 0.6 - 0.2 * field, "kappa": 0.3 * (1 + field)}


@pytest.mark.parametrize("density", [smooth(), rough(), rough(1, (7, 5, 9))])
def test_filaments_are_conserved_even_where_nothing_is_resolved(density):
    rate = oracle.rate(density, varied(density.shape), LENGTH)
    assert abs(rate.sum()) < 1e-13 * np.abs(rate).sum()


def test_the_concentration_is_only_carried_and_spread():
    Psi = smooth()
    c, u = oracle.concentration(Psi), oracle.flow(Psi, VALUES, LENGTH)
    slopes = oracle.derivative(c, 0, 2 * np.pi), oracle.derivative(c, 1, LENGTH)
    spread = oracle.derivative(c, 0, 2 * np.pi, 2) + oracle.derivative(c, 1, LENGTH, 2)
    expected = VALUES["d_s"] * spread - VALUES["epsilon"] * (u[0] * slopes[0] + u[1] * slopes[1])
    found = oracle.concentration(oracle.rate(Psi, varied(Psi.shape), LENGTH))
    assert np.abs(expected).max() > 1e-2
    assert np.abs(found - expected).max() < 1e-14
    ended = oracle.integrated(smooth(uneven=0.0), VALUES, LENGTH, 0.2, 0.05)
    assert np.abs(oracle.concentration(ended) - 1).max() < 1e-14


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_mode_that_nothing_turns_decays_at_its_rate(n):
    theta, wave, phi = points(8, 8, 12)
    values = VALUES | {"alpha_p": 0.0, "alpha_u": 0.0, "kappa": 0.0, "epsilon": 0.0}
    shape = np.cos(n * phi - 0.2) * np.cos(2 * theta + wave)
    decay = VALUES["d_r"] * n**2 + VALUES["d_s"] * (2**2 + (2 * np.pi / LENGTH) ** 2)
    ended = oracle.integrated((1 + 0.5 * shape) / (2 * np.pi), values, LENGTH, 1.0, 0.05)
    expected = (1 + 0.5 * np.exp(-decay) * shape) / (2 * np.pi)
    assert np.abs(ended - expected).max() < 1e-8
    h = 0.05  # and the steps are those of Runge and Kutta exactly
    one = 1 - h * decay + (h * decay) ** 2 / 2 - (h * decay) ** 3 / 6 + (h * decay) ** 4 / 24
    assert np.abs(ended - (1 + 0.5 * one**20 * shape) / (2 * np.pi)).max() < 1e-14


@pytest.mark.parametrize("zero_theta_flux", [False, True])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0])
def test_the_flow_balances_the_force_up_to_a_pressure(zero_theta_flux, exponent):
    Psi = smooth(32, 32, 12)
    values = VALUES | {"zero_theta_flux": zero_theta_flux, "force_exponent": exponent}
    u, (c, first) = oracle.flow(Psi, values, LENGTH), oracle.moments(Psi, 1)
    F = np.stack([first.real, first.imag]) * np.abs(first / c) ** exponent

    def slope(f, axis, order=1):
        return oracle.derivative(f, axis, (2 * np.pi, LENGTH)[axis], order)

    rest = F - u + VALUES["mu"] * np.stack([slope(v, 0, 2) + slope(v, 1, 2) for v in u])
    assert np.abs(slope(u[0], 0) + slope(u[1], 1)).max() < 1e-14
    curl = slope(rest[1], 0) - slope(rest[0], 1)
    assert np.abs(curl).max() < (1e-5 if exponent == 1 else 1e-9)  # |P| has more modes than its square
    assert abs(u[1].mean()) < 1e-16
    assert u[0].mean() == pytest.approx(0.0 if zero_theta_flux else F[0].mean(), abs=1e-16)
    assert np.abs(u).max() > 1e-3


def test_the_moments_of_the_rate_obey_the_hierarchy():
    """ω = ε w/2 + Im(H exp(-iφ)) + Im(S exp(-2iφ)); ∫exp(inφ) of each term, by parts in φ."""
    Psi = smooth(12, 10, 24)
    values = varied(Psi.shape)
    m = oracle.moments(Psi, 8)
    u = oracle.flow(Psi, values, LENGTH)

    def slope(f, axis, order=1):
        parts = [oracle.derivative(g, axis, (2 * np.pi, LENGTH)[axis], order) for g in (f.real, f.imag)]
        return parts[0] + 1j * parts[1]

    H = values["alpha_p"] * m[1] / m[0] + values["alpha_u"] * (u[0] + 1j * u[1])
    tt, tz, zt = slope(u[0], 0).real, slope(u[0], 1).real, slope(u[1], 0).real
    S = VALUES["epsilon"] * (tt + 0.5j * (tz + zt)) - values["kappa"] / 2 * np.exp(0.8j)
    found = oracle.moments(oracle.rate(Psi, values, LENGTH), 5)

    def at(n):
        return m[n] if n >= 0 else m[-n].conj()

    for n in range(6):
        turned = H * at(n - 1) - H.conj() * at(n + 1) + S * at(n - 2) - S.conj() * at(n + 2)
        expected = (
            n / 2 * turned
            + 0.5j * n * VALUES["epsilon"] * (zt - tz) * m[n]
            - VALUES["d_r"] * n**2 * m[n]
            + VALUES["d_s"] * (slope(m[n], 0, 2) + slope(m[n], 1, 2))
            - VALUES["epsilon"] * (u[0] * slope(m[n], 0) + u[1] * slope(m[n], 1))
        )
        assert np.abs(found[n] - expected).max() < 1e-13


def test_a_place_shifted_or_mirrored_is_a_solution_too():
    for Psi in (smooth(), rough(2, (8, 6, 12))):
        rate = oracle.rate(Psi, VALUES, LENGTH)
        shifted = oracle.rate(np.roll(Psi, (3, 2), axis=(0, 1)), VALUES, LENGTH)
        assert np.abs(shifted - np.roll(rate, (3, 2), axis=(0, 1))).max() < 1e-12

        def mirrored(f):  # z -> -z, so φ -> -φ
            n_z, n_phi = f.shape[1:]
            return f[:, -np.arange(n_z) % n_z][:, :, -np.arange(n_phi) % n_phi]

        other = oracle.rate(mirrored(Psi), VALUES | {"repulsion_angle": -0.4}, LENGTH)
        assert np.abs(other - mirrored(rate)).max() < 1e-12


def test_a_torque_along_the_filament_does_nothing():
    """-κ (p·d) d and +κ (p·e) e with e across d differ by κ p."""
    Psi = smooth()
    across = VALUES | {"kappa": -0.3, "repulsion_angle": 0.4 + np.pi / 2}
    assert np.abs(oracle.rate(Psi, VALUES, LENGTH) - oracle.rate(Psi, across, LENGTH)).max() < 1e-13


def test_values_may_be_an_object_and_two_of_them_left_out():
    Psi = smooth()
    few = {name: VALUES[name] for name in VALUES if name not in ("zero_theta_flux", "force_exponent")}
    expected = oracle.rate(Psi, VALUES, LENGTH)
    assert np.array_equal(oracle.rate(Psi, few, LENGTH), expected)
    assert np.array_equal(oracle.rate(Psi, SimpleNamespace(**few), LENGTH), expected)


def test_steps_converge_at_the_fourth_order():
    Psi = smooth(6, 6, 16)
    ends = [oracle.integrated(Psi, VALUES, LENGTH, 1.0, dt) for dt in (0.1, 0.05, 0.025)]
    changes = [np.abs(b - a).max() for a, b in itertools.pairwise(ends)]
    assert np.log2(changes[0] / changes[1]) == pytest.approx(4, abs=0.2)


def test_the_free_energy_of_a_uniform_state_falls_at_its_rate():
    values = VALUES | {"alpha_u": 0.0}
    phi = oracle.angles(48)
    density = np.exp(0.8 * np.cos(phi - 1.0) + 0.3 * np.sin(2 * phi))
    density = density * 48 / (2 * np.pi * density.sum())
    repulsion = 0.3 / 2 * np.cos(phi - 0.4) ** 2

    def energy(f):
        P = oracle.order(uniform(f))[:, 0, 0]
        return 2 * np.pi * np.mean(0.08 * f * np.log(f) + repulsion * f) - 0.7 / 2 * (P @ P)

    P = oracle.order(uniform(density))[:, 0, 0]
    potential = 0.08 * np.log(density) + repulsion - 0.7 * (P[0] * np.cos(phi) + P[1] * np.sin(phi))
    loss = 2 * np.pi * np.mean(density * oracle.derivative(potential, 0, 2 * np.pi) ** 2)
    rate = oracle.rate(uniform(density), values, LENGTH)[0, 0]
    h = 1e-4
    change = (energy(density + h * rate) - energy(density - h * rate)) / (2 * h)
    assert change == pytest.approx(-loss, rel=1e-6)


@pytest.mark.parametrize(("alpha_p", "d_r"), [(0.5, 0.05), (0.3, 0.1)])
def test_without_repulsion_uniform_order_is_a_ratio_of_bessel_functions(alpha_p, d_r):
    P = theory.polar_order(alpha_p, d_r)
    assert iv(1, alpha_p * P / d_r) / iv(0, alpha_p * P / d_r) == pytest.approx(P, abs=1e-13)
    assert theory.threshold(d_r, 0.0) == pytest.approx(2 * d_r, rel=1e-13)
    values = VALUES | {"alpha_p": alpha_p, "d_r": d_r, "kappa": 0.0}
    Psi = uniform(theory.equilibrium((0.0, P), values, 64))
    assert np.abs(oracle.flow(Psi, values, LENGTH)).max() < 1e-15
    assert np.abs(oracle.rate(Psi, values, LENGTH)).max() < 1e-13
    assert oracle.order(Psi)[1] == pytest.approx(P, abs=1e-14)


def test_uniform_order_relaxes_to_its_steady_value():
    values = VALUES | {"alpha_p": 0.5, "alpha_u": 0.0, "d_r": 0.05, "kappa": 0.0}
    start = uniform(theory.equilibrium((0.0, 0.93), values, 32))
    found = oracle.order(oracle.integrated(start, values, LENGTH, 18.0, 0.15))[1]
    assert np.abs(oracle.order(start)[1] - found).max() > 5e-4
    assert found == pytest.approx(0.945542186423298, abs=3e-6)


@pytest.mark.parametrize("zero_theta_flux", [False, True])
def test_repelled_polar_states_are_steady(zero_theta_flux):
    values = VALUES | {"zero_theta_flux": zero_theta_flux}
    straight = values | {"repulsion_angle": 0.0}
    P = theory.polar_order(0.7, 0.08, 0.3)
    across, Psi = theory.uniform_state(straight | {"alpha_u": 0.0}, (0.0, 0.9), 80)
    assert across == pytest.approx([0.0, P], abs=1e-13)
    assert np.abs(oracle.rate(uniform(Psi), straight, LENGTH)).max() < 1e-12
    tilted, Psi = theory.uniform_state(values, (-0.4, 0.8), 80)
    assert abs(tilted[0]) > 0.3
    assert np.abs(oracle.rate(uniform(Psi), values, LENGTH)).max() < 1e-12


@pytest.mark.parametrize("along_d", [False, True])
def test_growth_about_the_nematic_vanishes_at_the_threshold_and_is_that_of_the_rate(along_d):
    at = theory.threshold(0.025, 0.5, along_d)
    assert at == pytest.approx(0.468969 if along_d else 0.0264078, rel=2e-6)
    assert abs(theory.nematic_growth(at, 0.025, 0.5, along_d)) < 1e-12
    values = VALUES | {"repulsion_angle": 0.0}
    growth = theory.nematic_growth(0.7, 0.08, 0.3, along_d, 24)
    base = theory.equilibrium((0.0, 0.0), values, 24)
    waves = theory.wave_growth(base, values, 0, 0)[:2]  # along d is the faster of the two here
    assert growth == pytest.approx(waves[0 if along_d else 1].real, abs=1e-10)

    bent = base * np.sin(oracle.angles(24) + (np.pi / 2 if along_d else 0.0))
    early = oracle.integrated(uniform(base + 1e-6 * bent), values, LENGTH, 10.0, 0.2)
    late = oracle.integrated(early, values, LENGTH, 1.0, 0.2)
    polarity = [oracle.order(Psi)[0 if along_d else 1, 0, 0] for Psi in (early, late)]
    assert np.log(polarity[1] / polarity[0]) == pytest.approx(growth, abs=1e-5)


def test_waves_about_the_nematic_grow_as_uniform_order_does_but_for_diffusion():
    base = theory.equilibrium((0.0, 0.0), VALUES, 48)
    still = theory.wave_growth(base, VALUES, 0, 0)[:2]
    waves = theory.wave_growth(base, VALUES, 1, 2.0)[:2]
    assert still - waves == pytest.approx(0.03 * 5.0, abs=1e-11)


@pytest.mark.parametrize("zero_theta_flux", [False, True])
@pytest.mark.parametrize("exponent", [1.0, 2.0])
@pytest.mark.parametrize("mode", [(0, 0), (1, 0), (0, 1), (1, -1)])
def test_the_operator_of_waves_is_the_linear_part_of_the_rate(mode, exponent, zero_theta_flux):
    values = VALUES | {"zero_theta_flux": zero_theta_flux, "force_exponent": exponent}
    n_phi = 48
    _, base = theory.uniform_state(values, (-0.4, 0.8), n_phi)
    m, q = mode[0], mode[1] * 2 * np.pi / LENGTH
    theta, wave, phi = points(8, 8, n_phi)
    at = np.exp(1j * (mode[0] * theta + mode[1] * wave))
    f = base * np.exp(1j * np.sin(phi - 0.7)) * (0.6 - np.cos(phi))[0, 0]
    if mode == (0, 0):
        f = f.real + 0j

    def change(h):
        bend = (f * at).real
        up, down = (oracle.rate(base + s * bend, values, LENGTH) for s in (h, -h))
        return (up - down) / (2 * h)

    found = (4 * change(1e-3) - change(2e-3)) / 3
    linear = theory.wave_operator(base, values, m, q) @ f[0, 0]
    assert np.abs(found - (linear * at).real).max() < 1e-9 * np.abs(linear).max() + 1e-10


def test_a_wave_grows_and_moves_as_its_eigenvalue_says():
    """The number was found apart from this file, from the moments."""
    values = VALUES | {"repulsion_angle": 0.0}
    P, base = theory.uniform_state(values | {"alpha_u": 0.0}, (0.0, 0.9), 48)
    assert P[1] == pytest.approx(0.955868048501592, abs=1e-13)
    found = theory.wave_growth(base, values, 1, 2 * np.pi / LENGTH)
    assert found[0] == pytest.approx(-0.1139235278 + 0.2081354159j, abs=1e-9)
    everything = theory.wave_growth(base, values, 1, 2 * np.pi / LENGTH, uniform_concentration=False)
    mass = -0.03 * (1 + (2 * np.pi / LENGTH) ** 2)
    assert np.abs(everything - mass).min() < 1e-10
    assert len(everything) == len(found) + 1


def test_the_polar_state_tilts_where_its_own_flow_outweighs_repulsion():
    values = VALUES | {"repulsion_angle": 0.0}
    _, base = theory.uniform_state(values | {"alpha_u": 0.0}, (0.0, 0.9), 64)
    at = theory.tilt_threshold(0.7, 0.08, 0.3)
    growth = theory.wave_growth(base, values | {"alpha_u": at}, 0, 0)
    assert abs(growth[0]) < 1e-10
    held = theory.wave_growth(base, values | {"alpha_u": 2 * at, "zero_theta_flux": True}, 0, 0)
    assert held[0].real < -0.05
