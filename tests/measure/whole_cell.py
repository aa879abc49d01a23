"""The whole cell's linearisation: closed forms, steady states, leading modes, rates seen in runs."""

from __future__ import annotations

import jax
import numpy as np

import cyclosis as cy
from cyclosis.model.spectral import unpack
from cyclosis.model.system import system
from cyclosis.models import polar
from cyclosis.stability.cell.equilibria import steady_state
from cyclosis.stability.cell.modes import leading_modes
from cyclosis.stability.profiles.reduced import reduced_of
from cyclosis.stability.uniform import dispersion, uniform

from . import Row


@jax.jit
def _answer(cell, base, direction):
    def rate(P):
        return unpack(jax.numpy.fft.ifft2(cell.rate(cell.at(jax.numpy.fft.fft2(jax.lax.complex(*P))))))

    return jax.jvp(rate, (base,), (direction,))[1]


def wave_matrix(params, grid, base, m, j):
    """The 2 x 2 matrix of one mode, from the derivative of the whole model about a uniform state."""
    phase = m * grid.theta[:, None] + 2 * np.pi * j / grid.length * grid.z
    cell = system(params, grid)
    with jax.enable_x64(True):
        columns = []
        for component in (0, 1):
            answer = 0
            # The derivative is real and linear, so that a complex wave takes two of them.
            for wave, unit in ((np.cos(phase), 1), (np.sin(phase), 1j)):
                direction = np.zeros((2, *grid.shape))
                direction[component] = wave
                answer = answer + unit * np.asarray(_answer(cell, base, direction))
            columns.append(np.mean(answer * np.exp(-1j * phase), axis=(1, 2)))
    return np.stack(columns, axis=1)


def uniform_state(params, base, root, grid):
    """A uniform state as an array (2, n_theta, n_z)."""
    found = uniform.uniform(params, base, root)
    P = np.zeros((2, *grid.shape))
    P[found.axis] = found.order
    return P


def closed_forms(count=400):
    """Matrices of random waves about uniform states of random cells, against automatic differentiation."""
    rng, worst, done = np.random.default_rng(0), {}, dict.fromkeys(uniform.BASES, 0)
    while min(done.values()) < count:
        params = cy.Parameters(
            alpha_p=rng.uniform(0, 2),
            alpha_u=rng.uniform(0, 3),
            epsilon=rng.uniform(0, 2),
            d_s=rng.uniform(0, 0.5),
            d_r=rng.uniform(0, 0.5),
            kappa=rng.uniform(0, 1.5),
            mu=rng.uniform(0, 2),
            repulsion_angle=rng.choice([0.0, np.pi / 2]),
            zero_theta_flux=bool(rng.integers(2)),
            force_exponent=rng.choice([2.0, 2.0, 0.0, 1.0, rng.uniform(0.5, 6.0)]),
        )
        grid = cy.CylinderGrid(16, 12, rng.uniform(0.5, 20))
        m, j = int(rng.integers(-7, 8)), int(rng.integers(-5, 6))
        for base in uniform.BASES:
            for root in range(uniform.orders(params, base).size):
                exact = wave_matrix(params, grid, uniform_state(params, base, root, grid), m, j)
                found = dispersion.growth_matrix(params, base, m, 2 * np.pi * j / grid.length, root)
                worst[base] = max(worst.get(base, 0.0), float(np.abs(found - exact).max()))
                done[base] += 1
    return [
        Row(
            "growth about uniform states",
            f"{base}, {done[base]} random waves, largest error",
            worst[base],
            1e-9,
        )
        for base in uniform.BASES
    ]


def stripes(params, grid, P_theta=0.0, **options):
    """The state of two stripes, steady or moving."""
    guess = np.zeros((2, *grid.shape))
    guess[0] = P_theta
    guess[1] = 0.8 * np.tanh(3 * np.sin(grid.theta))[:, None]
    return steady_state(params, grid, guess, **options)


def blocks(params, grid, state, waves, **options):
    """Every eigenvalue about a state uniform along z with up to so many waves along z, leading ones first."""
    problem = reduced_of(polar.problem(params, grid, **options))
    y = state.state[:, :, 0].ravel()
    moved = state.drift[0] * problem.derivative
    values = [np.linalg.eigvals(problem.jacobian(y) + moved)]
    for j in range(1, waves + 1):
        each = np.linalg.eigvals(problem.waves(y, j) + moved)
        values += [each, each.conj()]
    return ordered(np.concatenate(values))


def ordered(values):
    """Eigenvalues by real part, then by imaginary part, equal up to rounding."""
    return values[np.lexsort((-np.round(values.imag, 9), -np.round(values.real, 9)))]


def growth(params, state, found, index):
    """The rate of one mode as a simulation shows it: complex, from how its real and imaginary parts mix.

    Half the difference of two runs of opposite perturbation cancels even orders; what moves is shifted back.
    """
    grid, mode, time = state.grid, found.modes[index], min(5.0, 2 / abs(found.eigenvalues[index]))
    ends = []
    for sign in (1e-5, -1e-5):
        P = state.state + sign * np.real(mode)
        run = cy.simulate(params, grid, P, time, time, stepper="etdrk4", dt=0.01)
        assert run.ok, run.message
        ends.append(run.final_state)
    answer = shifted(grid, (ends[0] - ends[1]) / 2e-5, -time * state.drift)
    parts = np.stack([np.real(mode).ravel(), -np.imag(mode).ravel()], axis=1)
    used = parts if np.abs(mode.imag).max() > 1e-8 else parts[:, :1]
    amounts = np.linalg.lstsq(used, answer.ravel(), rcond=None)[0]
    return np.log(amounts[0] + 1j * (amounts[1] if len(amounts) == 2 else 0.0)) / time


def shifted(grid, P, distance):
    """A field moved by a distance (theta, z)."""
    phase = np.exp(-1j * (grid.m[:, None] * distance[0] + grid.q * distance[1]))
    return np.fft.ifft2(np.fft.fft2(P) * phase).real


def distinct(found, turning):
    """Indices of modes of different eigenvalues: real ones, or complex ones (Im > 0) with j > 0."""
    indices = []
    for i, value in enumerate(found.eigenvalues):
        new = all(abs(value - found.eigenvalues[k]) > 1e-7 for k in indices)
        wanted = value.imag > 1e-3 and axial(found.modes[i]) > 0 if turning else abs(value.imag) < 1e-9
        if new and wanted and found.shifts[i] < 0.5:
            indices.append(i)
    return indices


def axial(mode):
    """The axial wave number j that holds most of a mode."""
    energy = np.sum(np.abs(np.fft.fft(mode, axis=2)) ** 2, axis=(0, 1))
    j = int(np.argmax(energy))
    return min(j, energy.size - j)


def same(eigenvalues, others):
    """The largest distance of an eigenvalue from the nearest of the others."""
    return float(max(np.abs(others - value).min() for value in eigenvalues))


CYCLOSIS = cy.Parameters(epsilon=0.3)
ROTATING = cy.Parameters(kappa=0.1)
AROUND = cy.Parameters(kappa=0.05)


def rates_of(name):
    """Rates in simulations against `leading_modes`, and those against the other ways to have them."""
    grid = cy.CylinderGrid(64, 16, 5.0)
    if name == "cyclosis":
        params, state = CYCLOSIS, stripes(CYCLOSIS, grid)
        found = leading_modes(params, grid, state, 44)
        exact, way = blocks(params, grid, state, 7), "one wave at a time"
        real = distinct(found, False)[:4]
        turning = distinct(found, True)[:2]
    elif name == "rotating stripes":
        params, state = ROTATING, stripes(ROTATING, grid, 0.5)
        found = leading_modes(params, grid, state, 12)
        exact, way = blocks(params, grid, state, 7), "one wave at a time"
        real = distinct(found, False)[:2]
        turning = distinct(found, True)[:2]
    else:
        params = AROUND
        state = steady_state(params, grid, cy.initial.circumferential(grid, 0.95))
        found = leading_modes(params, grid, state, 8)
        m, q = grid.m[:, None], grid.q
        exact, way = dispersion.growth_rates(params, "circumferential", m, q).ravel(), "closed form"
        real, turning = [], distinct(found, True)[:2]
    law = f"modes of {name}, {grid.n_theta} x {grid.n_z}"
    rows = [
        Row(
            law, f"{found.eigenvalues.size} eigenvalues against {way}", same(found.eigenvalues, exact), 1e-10
        ),
        Row(law, "largest residual", float(found.residuals.max()), 1e-10),
    ]
    for i in real + turning:
        value, seen = found.eigenvalues[i], growth(params, state, found, i)
        sign = "+" if value.imag > 1e-9 else ""
        shown = f"{value.real:.6f}" + (f" {sign} {value.imag:.6f}i" if sign else "")
        text = f"rate {shown} (j = {axial(found.modes[i])}) in a simulation, relative error"
        rows.append(Row(law, text, float(abs(seen / value - 1)), 1e-5))
    return rows


CASES = ("cyclosis", "rotating stripes", "circumferential order")


def shifts():
    """The neutral mode of a rotation: as good as the grid, and exact where nothing is aliased."""
    rows = []
    for n, dealias, bound in (
        (48, "none", None),
        (64, "none", None),
        (128, "none", 1e-10),
        (48, "full", 1e-10),
    ):
        grid = cy.CylinderGrid(n, 8, 5.0)
        state = stripes(cy.Parameters(), grid, dealias=dealias)
        found = leading_modes(cy.Parameters(), grid, state, 3, dealias=dealias)
        at = int(np.argmax(found.shifts))
        law = f"shift of cyclosis, n_theta = {n}, dealias {dealias}"
        rows.append(Row(law, "|eigenvalue|", float(abs(found.eigenvalues[at])), bound))
        rows.append(
            Row(law, "share of the mode that is a shift - 1", abs(float(found.shifts[at]) - 1), bound)
        )
    return rows


def bent():
    """Stripes that bend along the cell: steady, varying in both directions, with two neutral modes."""
    params, grid = cy.Parameters(epsilon=0.5), cy.CylinderGrid(32, 32, 5.0)
    guess = np.zeros((2, *grid.shape))
    guess[1] = 0.8 * np.tanh(3 * np.sin(grid.theta[:, None] + 0.4 * np.sin(2 * np.pi * grid.z / grid.length)))
    run = cy.simulate(params, grid, guess, 150.0, 150.0, dealias="full")
    state = steady_state(params, grid, run.final_state, dealias="full")
    found = leading_modes(params, grid, state, 4, dealias="full")
    neutral = np.sort(np.abs(found.eigenvalues))[:2]
    law = "stripes that bend along the cell, epsilon = 0.5, 32 x 32, dealias full"
    return [
        Row(law, "variation along z", float(np.ptp(state.state, axis=2).max()), None, 0.5),
        Row(law, "residual", state.residual, 1e-11),
        Row(law, "two neutral eigenvalues, larger", float(neutral[1]), 1e-10),
        Row(law, "largest residual of 4 modes", float(found.residuals.max()), 1e-10),
        Row(law, "largest growth rate beside shifts", float(np.sort(found.eigenvalues.real)[-3]), 0.0),
    ]


def rows():
    """Return every row of this comparison."""
    return closed_forms() + [row for name in CASES for row in rates_of(name)] + shifts() + bent()
