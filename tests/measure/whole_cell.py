"""The whole cell's linearisation: closed forms, steady states, leading modes, rates seen in runs."""

from __future__ import annotations

import jax
import numpy as np

import cyclosis as cy
from cyclosis.model.spectral import unpack
from cyclosis.model.system import system
from cyclosis.stability import dispersion, uniform
from cyclosis.stability.equilibria import steady_state
from cyclosis.stability.reduced import reduced

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
    problem = reduced(params, grid, **options)
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


def growth(params, grid, found, index, time, dealias="none"):
    """The rate of one mode as a simulation shows it: complex, from how its real and imaginary parts mix.

    Half the difference of two runs of opposite perturbation cancels even orders; moving states are shifted.
    """
    mode = found.modes[index]
    base, small = found.base, 1e-5 * np.real(mode)
    ends = []
    for sign in (1, -1):
        run = cy.simulate(
            params, grid, base + sign * small, time, time, rtol=1e-11, atol=1e-14, dealias=dealias
        )
        assert run.ok, run.message
        ends.append(run.final_state)
    answer = shifted(grid, (ends[0] - ends[1]) / 2, -time * found.drift)
    parts = np.stack([np.real(mode).ravel(), -np.imag(mode).ravel()], axis=1)
    used = parts if np.abs(mode.imag).max() > 1e-8 else parts[:, :1]
    amounts = np.linalg.lstsq(used, answer.ravel(), rcond=None)[0] / 1e-5
    return np.log(amounts[0] + 1j * (amounts[1] if len(amounts) == 2 else 0.0)) / time


def shifted(grid, P, distance):
    """A field moved by a distance (theta, z)."""
    phase = np.exp(-1j * (grid.m[:, None] * distance[0] + grid.q * distance[1]))
    return np.fft.ifft2(np.fft.fft2(P) * phase).real
