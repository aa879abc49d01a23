"""One step in time: fourth-order exponential Runge-Kutta, and the classical method as its limit.

For dP/dt = L P + N(t, P) with a diagonal L, Krogstad's ETDRK4-B (J. Comput. Phys. 203 (2005) 72) is,
with z = h L and φ_k(z) = (φ_{k-1}(z) - 1/(k-1)!)/z, φ_0 = exp:

    P₂ = e^{z/2} P + h/2 φ₁(z/2) N₁
    P₃ = e^{z/2} P + h [φ₁(z/2)/2 - φ₂(z/2)] N₁ + h φ₂(z/2) N₂
    P₄ = e^z P + h [φ₁(z) - 2 φ₂(z)] N₁ + 2 h φ₂(z) N₃
    P' = e^z P + h [φ₁ - 3 φ₂ + 4 φ₃] N₁ + 2 h [φ₂ - 2 φ₃] (N₂ + N₃) + h [4 φ₃ - φ₂] N₄

A third-order solution with N(P') in place of N₄ gives the error estimate
h [4 φ₃ - φ₂] (N₄ - N(P')), as in Whalen, Brio & Moloney, J. Comput. Phys. 280 (2015) 579; N(P') is the
next step's N₁, so that the estimate costs nothing. With L = 0 this is the classical Runge-Kutta
method: the `rk4` stepper is the same code with every term taken as nonlinear.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..contract.system import LocalSystem, System
from .multistep import STRICTNESS, Past, advanced, begin, ready, shifted, stale


class Tableau(NamedTuple):
    """Coefficients of a step of length h, each a real field of the grid's shape."""

    full: Any
    half: Any
    a21: Any
    a31: Any
    a32: Any
    a41: Any
    a43: Any
    w1: Any
    w23: Any
    w4: Any


class Stepped(NamedTuple):
    """The result of a step: the new spectrum, its N, the error estimate, and the peak, max |P|².

    A multistep method adds its new `past`, and its number of right-hand sides where that is not always equal.
    """

    spectrum: Any
    nonlinear: Any
    error: Any
    peak: Any
    past: Any = None
    evaluations: Any = None


def phi(z: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return φ₁, φ₂, φ₃ of real z <= 0 to rounding: a Taylor series within |z| < 1, else the recurrence."""
    near = jnp.abs(z) < 1.0
    small, large = jnp.where(near, z, 0.0), jnp.where(near, -1.0, z)
    recurrence, out = jnp.exp(large), []
    for k in (1, 2, 3):
        recurrence = (recurrence - 1.0 / factorial(k - 1)) / large
        series = jnp.zeros_like(z)
        for j in reversed(range(18)):
            series = series * small + 1.0 / factorial(j + k)
        out.append(jnp.where(near, series, recurrence))
    return out[0], out[1], out[2]


def tableau(linear: jax.Array, h: Any) -> Tableau:
    """Return the coefficients of a step of length h for the linear symbol L."""
    h = jnp.asarray(h, linear.dtype)
    z = h * linear
    half1, half2, _ = phi(0.5 * z)
    full1, full2, full3 = phi(z)
    return Tableau(
        full=jnp.exp(z),
        half=jnp.exp(0.5 * z),
        a21=0.5 * h * half1,
        a31=h * (0.5 * half1 - half2),
        a32=h * half2,
        a41=h * (full1 - 2 * full2),
        a43=2 * h * full2,
        w1=h * (full1 - 3 * full2 + 4 * full3),
        w23=2 * h * (full2 - 2 * full3),
        w4=h * (4 * full3 - full2),
    )


def step(system: System, c: Tableau, t: Any, h: Any, Z: jax.Array, N1: jax.Array) -> Stepped:
    """Advance the packed spectrum Z by h; N1 is the nonlinear part at (t, Z)."""
    N2 = system.nonlinear(system.at(c.half * Z + c.a21 * N1, t + 0.5 * h))
    N3 = system.nonlinear(system.at(c.half * Z + c.a31 * N1 + c.a32 * N2, t + 0.5 * h))
    N4 = system.nonlinear(system.at(c.full * Z + c.a41 * N1 + c.a43 * N3, t + h))
    new = c.full * Z + c.w1 * N1 + c.w23 * (N2 + N3) + c.w4 * N4
    end = system.at(new, t + h)
    N5 = system.nonlinear(end)
    return Stepped(new, N5, c.w4 * (N4 - N5), system.peak(end))


def multistep(
    system: LocalSystem, linear: jax.Array, t: Any, h: Any, Z: jax.Array, N: jax.Array, past: Past
) -> Stepped:
    """Advance by the multistep method, see `multistep`, or by ETDRK4-B without a past that suits the step."""
    begins_anew = stale(past, t, h)

    def first() -> Stepped:
        now = jax.lax.cond(begins_anew, lambda: system.nonlinear(system.at(Z, t)), lambda: N)
        new, rest, error, peak, *_ = step(system, tableau(linear, h), t, h, Z, now)
        local = system.local(system.at(new, t + h))
        kept = past._replace(times=jnp.where(begins_anew, -jnp.inf, past.times))
        return Stepped(
            new, rest, error, peak, shifted(kept, t, Z, now, local), 4 + begins_anew.astype(jnp.int64)
        )

    def further() -> Stepped:
        new, rest, error, now, local = advanced(system, linear, t, h, Z, N, past)
        kept = shifted(past, t, Z, N, local)
        return Stepped(new, rest, STRICTNESS * error, system.peak(now), kept, jnp.asarray(1, jnp.int64))

    return jax.lax.cond(ready(past) & ~begins_anew, further, first)


@dataclass(frozen=True)
class Method:
    """A stepper: how it makes a step, and how its step length is chosen.

    `tableau(linear, h)` gives the coefficients of a step, any tree of arrays, and
    `step(system, coefficients, t, h, Z, N1)` a `Stepped`, with `evaluations` right-hand sides. `order` is
    that of the method. An `adaptive` one chooses h by its error estimate, others take `dt`. `exact` says that
    linear terms are kept separate from N; if not, `stability` is the largest h |λ| on the negative real axis,
    which bounds the default of `dt`. A multistep method has `begin(system, moment, N)`, the past of a run
    that begins, and gets the past as the last argument of `step`.
    """

    tableau: Callable[[jax.Array, Any], Any]
    step: Callable[..., Stepped]
    order: int
    evaluations: int
    adaptive: bool = False
    exact: bool = True
    stability: float = float("inf")
    begin: Callable[[Any, Any, jax.Array], Past] | None = None


METHODS = {
    "adaptive": Method(tableau, step, order=4, evaluations=4, adaptive=True),
    "multistep": Method(
        lambda linear, h: linear, multistep, order=4, evaluations=1, adaptive=True, begin=begin
    ),
    "etdrk4": Method(tableau, step, order=4, evaluations=4),
    "rk4": Method(tableau, step, order=4, evaluations=4, exact=False, stability=2.78),
}
"""The steppers by name."""
