"""A linearly implicit multistep method of fourth order: one right-hand side a step.

With f = L P + N and variable steps, let E_k P be the polynomial through the last k states at the new time,
and

    B_k P' = [ℓ_k P' + Σ_j w_kj P_j] / h

the derivative at the new time of the polynomial through the new state P' and the last k (the backward
differentiation formula of order k). A is L, diagonal in Fourier space, plus D, the decaying part of the local
Jacobian (`cyclosis.model.relaxation`). 1 - τ A is replaced by its factors (1 - τ D)(1 - τ L), whose inverses
cost two transforms. A step predicts, evaluates N once, and corrects:

    P* = E₃P + (1 - τ₃ A)⁻¹ [h (E₃N + L E₃P) - h B₃ E₃P] / ℓ₃,       τ_k = h / ℓ_k
    P' = P* + δ,    δ = (1 - τ₄ A)⁻¹ [h f(P*) - h B₄ P*] / ℓ₄
    N' = B₄ P' - L P'

P* is of third order and P' of fourth, whatever A is: what A misses of the Jacobian J enters as h (J - A)
times the error that is corrected. A only has to be near J for long steps to be stable. δ estimates the error
of P*.
N' differs from N(P') by the error of a derivative, and is exact in a steady state.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..contract.system import LocalSystem

KEPT = 3
"""Number of earlier states that a step needs besides the present one."""
GROWTH = 1.5
"""A step may be longer than the last by this factor: backward differentiation needs even steps."""

SHRINKAGE = 8.0
"""A step shorter than the last by more than this factor begins anew: N' has the error of the longer steps."""
STRICTNESS = 1.5
"""The estimate is multiplied by this: steps are shorter than those of ETDRK4, and their errors more."""


class Past(NamedTuple):
    """What is remembered of earlier steps.

    `times` (3,) are those of the last states before the present one, -inf for those that are missing;
    `modes` (5, ...) these states and, of the last two, N; `local` is D at the present state.
    """

    times: Any
    modes: Any
    local: Any


def begin(system: LocalSystem, now: Any, nonlinear: jax.Array) -> Past:
    """Return the past of a run that begins at a moment: nothing but D."""
    times = jnp.full(KEPT, -jnp.inf, jnp.float64)
    return Past(times, jnp.zeros((2 * KEPT - 1, *nonlinear.shape), nonlinear.dtype), system.local(now))


def forget(past: Past | None) -> Past | None:
    """Return a past without earlier states, for a right-hand side or a state that is new."""
    return None if past is None else past._replace(times=jnp.full_like(past.times, -jnp.inf))


def ready(past: Past) -> Any:
    """Return whether there are as many earlier states as a step needs."""
    return jnp.all(jnp.isfinite(past.times))


def stale(past: Past, t: Any, h: Any) -> Any:
    """Return whether a step of length h from time t is too short for what is remembered."""
    return jnp.isfinite(past.times[0]) & (h < (t - past.times[0]) / SHRINKAGE)


def longest(past: Past, t: Any) -> Any:
    """Return how long a step from time t may be (infinite without earlier states)."""
    return jnp.where(jnp.isfinite(past.times[0]), GROWTH * (t - past.times[0]), jnp.inf)


def rise(past: Past, t: Any, h: Any) -> Any:
    """Return how many rungs a step may rise above one of length h from time t: one after even steps."""
    shortest = jnp.min(jnp.concatenate([t - past.times[:1], past.times[:-1] - past.times[1:]]))
    return jnp.where(ready(past) & (shortest < 0.99 * h), 0, 1)


def shifted(past: Past, t: Any, Z: jax.Array, N: jax.Array, local: jax.Array) -> Past:
    """Return the past after a step from the state Z with its N at time t, to a state with this D."""
    times = jnp.concatenate([jnp.reshape(t, 1), past.times[:-1]])
    earlier = past.modes
    modes = jnp.concatenate([Z[None], earlier[: KEPT - 1], N[None], earlier[KEPT:-1]])
    return Past(times, modes, local)


def weights(x: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return ℓ, w and the weights of E for states at the times x < 0 before the new one, in units of h."""
    apart = x[:, None] - x[None, :] + jnp.eye(x.size)
    others = jnp.where(jnp.eye(x.size, dtype=bool), 1.0, -x[None, :])
    extrapolated = jnp.prod(others / apart, axis=1)
    return -jnp.sum(1.0 / x), extrapolated / x, extrapolated


def advanced(
    system: LocalSystem, linear: jax.Array, t: Any, h: Any, Z: jax.Array, N: jax.Array, past: Past
) -> tuple[jax.Array, jax.Array, jax.Array, Any, jax.Array]:
    """Return P', N', δ, the moment of P* and D there, from the state Z with its N at time t."""
    real = linear.dtype
    x = (jnp.concatenate([jnp.reshape(t, 1), past.times]) - (t + h)) / h
    states, rests = (Z, *past.modes[:KEPT]), (N, *past.modes[KEPT:])
    h = jnp.asarray(h, real)
    lead, earlier, ahead = (item.astype(real) for item in weights(x[:KEPT]))
    guess = _combined(ahead, states)
    rest = h * (_combined(ahead, rests) + linear * guess) - lead * guess - _combined(earlier, states)
    predicted = guess + (1.0 / lead) * system.relaxed(rest, past.local, h / lead)
    now = system.at(predicted, t + h)
    local = system.local(now)
    lead, earlier, _ = (item.astype(real) for item in weights(x))
    before = _combined(earlier, states)
    rest = h * (system.nonlinear(now) + linear * predicted) - lead * predicted - before
    change = (1.0 / lead) * system.relaxed(rest, local, h / lead)
    new = predicted + change
    return new, (1.0 / h) * (lead * new + before) - linear * new, change, now, local


def _combined(weights: jax.Array, arrays: tuple[jax.Array, ...]) -> jax.Array:
    """Return the sum of arrays, as many as there are weights: written out, so that it joins other loops."""
    total: jax.Array = sum(weights[i] * arrays[i] for i in range(1, weights.size)) + weights[0] * arrays[0]
    return total
