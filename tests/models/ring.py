"""A small model that lives in the tests: angles of filaments on a ring, without any space.

    dψ/dt = -d/dφ [ψ α_p |P| sin(φ_P - φ)] + d⁽ʳ⁾ d²ψ/dφ²,     P = ∫ ψ (cos φ, sin φ) dφ,

with the density ψ of angles. With a_n = ∫ ψ e^{-inφ} dφ, of which a_0 = 1, this is

    da_n/dt = n α_p/2 (a_1 a_{n-1} - a_1* a_{n+1}) - n² d⁽ʳ⁾ a_n.

About disorder a_1 grows at α_p/2 - d⁽ʳ⁾. The order that lasts is a von Mises distribution of concentration
k = α_p |P|/d⁽ʳ⁾, in which |P| = I_1(k)/I_0(k).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import jax
import jax.numpy as jnp
import numpy as np

from cyclosis.contract.model import Coordinate, Model, Quantity, Stored
from cyclosis.model.errors import InputError
from cyclosis.model.precision import dtypes


@dataclass(frozen=True)
class Alignment:
    """Parameters of the ring."""

    alpha_p: float = 1.0
    d_r: float = 0.1

    def items(self):
        return [(item.name, getattr(self, item.name)) for item in fields(self)]

    def replace(self, **changes):
        return replace(self, **changes)

    def require_grid(self, grid):
        """Nothing to check: all parameters are numbers."""


@dataclass(frozen=True)
class Ring:
    """Evenly spaced angles."""

    n_phi: int = 64

    @property
    def shape(self):
        return (self.n_phi,)

    @property
    def phi(self):
        return 2 * np.pi / self.n_phi * np.arange(self.n_phi)


@dataclass(frozen=True)
class RingSystem:
    """The right-hand side in the modes a_0, ..., a_{n/2 - 1}."""

    alpha_p: jax.Array
    d_r: jax.Array
    n: jax.Array
    split: bool
    ramp: tuple | None = None  # begin, end, and the alpha_p that is reached then

    def linear(self):
        return (-(self.n**2) if self.split else 0.0 * self.n) * self.d_r

    def at(self, spectrum, time=0.0):
        if self.ramp is None:
            return spectrum, self.alpha_p
        begin, end, target = self.ramp
        return spectrum, self.alpha_p + (time - begin) / (end - begin) * (target - self.alpha_p)

    def nonlinear(self, now):
        a, alpha_p = now
        before = jnp.concatenate([jnp.zeros_like(a[:1]), a[:-1]])
        after = jnp.concatenate([a[1:], jnp.zeros_like(a[:1])])
        rate = 0.5 * alpha_p * self.n * (a[1] * before - jnp.conj(a[1]) * after)
        return rate if self.split else rate - self.d_r * self.n**2 * a

    def size(self, spectrum):
        return jnp.sqrt(jnp.sum(jnp.abs(spectrum[1:]) ** 2, dtype=jnp.float64))

    def peak(self, now):
        return jnp.abs(now[0][1]) ** 2


jax.tree_util.register_dataclass(
    RingSystem, data_fields=["alpha_p", "d_r", "n", "ramp"], meta_fields=["split"]
)


def terms(chosen):
    if chosen is not None and not all(isinstance(item, Named) for item in chosen):
        chosen = [Named(name) for name in chosen]
    return tuple(chosen or (Named("alignment"), Named("rotational_diffusion")))


@dataclass(frozen=True)
class Named:
    name: str


def system(problem, split):
    real = dtypes(problem.precision)[0]
    numbers = (real(value) for _, value in problem.params.items())
    return RingSystem(*numbers, np.arange(problem.grid.n_phi // 2, dtype=real), split)


def ramped(first, last, times, split):
    assert list(times) == ["alpha_p"]
    (begin, end), target = times["alpha_p"], last.params.alpha_p
    return replace(system(first, split), ramp=tuple(np.float64(x) for x in (begin, end, target)))


def modes(system, state):
    spectrum = np.fft.rfft(state)[: system.n.size] * (2 * np.pi / len(state))
    return spectrum.astype(np.result_type(system.n.dtype, np.complex64))


def state(grid, spectrum):
    padded = np.append(np.asarray(spectrum, dtype=np.complex128), 0.0)
    return np.fft.irfft(padded, grid.n_phi) * grid.n_phi / (2 * np.pi)


def check_state(grid, given, name):
    density = np.asarray(given, dtype=np.float64)
    if density.shape != grid.shape or abs(density.mean() * 2 * np.pi - 1) > 1e-9:
        raise InputError(name, density.shape, f"a density of shape {grid.shape} and integral 1", "scale it")
    return density


def act(step, density, grid, seed):
    assert step.action == "depolymerise"  # what is left is kept, what grows anew has any direction
    return step.keep * density + (1 - step.keep) / (2 * np.pi)


def mean(system, now):
    return jnp.stack([now[0][1].real, -now[0][1].imag])


def order(system, now):
    return jnp.abs(now[0][1])


def tail(system, now):
    a = now[0]
    return system.size(jnp.where(system.n > 2 / 3 * system.n[-1], a, 0.0)) / system.size(a)


QUANTITIES = (
    Quantity("mean_P", "P", ("component",), "1", "mean direction", mean),
    Quantity("order", "|P|", (), "1", "length of the mean direction", order),
    Quantity("spectral_tail", "-", (), "1", "share of modes beyond two thirds of those resolved", tail),
)


@jax.jit
def measure(system, spectrum, time):
    now = system.at(spectrum, time)
    return {item.name: item.compute(system, now) for item in QUANTITIES}


def derive(problem):
    phi = problem.grid.phi
    return lambda params, density: {
        "P": 2 * np.pi * np.mean(density * np.array([np.cos(phi), np.sin(phi)]), 1)
    }


ring = Model(
    name="ring",
    title="Angles of filaments that align",
    source="Moments of a Smoluchowski equation without space",
    parameters=Alignment,
    grid=Ring,
    terms=terms,
    system=system,
    ramped=ramped,
    modes=modes,
    whole_modes=modes,
    state=state,
    check_state=check_state,
    act=act,
    largest=lambda density: float(np.abs(np.fft.rfft(density)[1]) * 2 * np.pi / len(density)),
    bound=1.01,
    sharp_bound=1.25,
    stiffness=lambda system: float(system.d_r * system.n[-1] ** 2 + system.alpha_p * system.n[-1]),
    quantities=QUANTITIES,
    measure=measure,
    tails={"spectral_tail": 1e-2},
    peak="order",
    decay_time=lambda system: float(18.4 / (system.d_r * (2 / 3 * system.n[-1]) ** 2)),
    finer=lambda params, grid: f"use more angles: {2 * grid.n_phi} should do",
    stored=(
        Stored("psi", ("phi",), "density of the angles of filaments"),
        Stored("P", ("component",), "mean direction", "float64"),
    ),
    coordinates=lambda grid, shape: {
        "component": Coordinate(np.array(["x", "y"], dtype=object), "vector component"),
        "phi": Coordinate(grid.phi, "angle of a filament in radians"),
    },
    derive=derive,
)
