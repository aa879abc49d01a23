"""Many steps in one compiled loop: step control, exact landing, and the reasons to stop.

Desired steps come from the ladder 2^{j/2}. Towards a target time (a frame to be saved, say) the
remaining interval is cut into equal steps no longer than the rung, so that it is hit exactly, the
coefficients of a step are reused, and the length wanted next is not forgotten.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..model.system import System
from .steppers import METHODS, Method

FIRST_RUNG, LOWEST_RUNG, HIGHEST_RUNG = -8, -46, 40
SAFETY = 0.9
MAX_RISE, MAX_FALL = 2, 8
DIVERGED = 1.0 + 1e-2
"""Magnitude |P| beyond which a run has diverged: |P| <= 1 is invariant in the exact dynamics."""


class Progress(NamedTuple):
    """Where a run stands: all that is needed to go on bitwise the same."""

    t: Any
    spectrum: Any
    nonlinear: Any
    rung: Any
    h: Any
    left: Any
    evaluations: Any
    accepted: Any
    rejected: Any
    peak: Any
    rate: Any
    failed: Any


class Control(NamedTuple):
    """What steers the steps.

    Tolerances, the fixed step `dt`, the relative rate that counts as steady, and the |P| beyond which a run
    has diverged.
    """

    rtol: Any
    atol: Any
    dt: Any
    steady_rate: Any
    bound: Any = DIVERGED


@jax.jit
def start(system: System, spectrum: jax.Array, t: Any) -> Progress:
    """Return the `Progress` of a run that begins at time t."""
    now = system.at(spectrum, t)
    nonlinear = system.nonlinear(now)
    zero = jnp.asarray(0, jnp.int64)
    return Progress(
        t,
        spectrum,
        nonlinear,
        jnp.asarray(FIRST_RUNG, jnp.int64),
        jnp.asarray(0.0, jnp.float64),
        zero,
        zero + 1,
        zero,
        zero,
        jnp.max(jnp.abs(now.p)).astype(jnp.float64),
        _relative_rate(system.linear(), spectrum, nonlinear),
        jnp.asarray(False),
    )


@partial(jax.jit, static_argnames="method")
def advance(
    system: System,
    control: Control,
    progress: Progress,
    target: Any,
    max_steps: Any,
    method: Method = METHODS["adaptive"],
) -> Progress:
    """Step on until `target` is reached, the state is steady, a step fails, or `max_steps` are tried."""
    linear = system.linear()
    first = progress.accepted + progress.rejected

    def unfinished(carry: tuple[Progress, Any, Any]) -> Any:
        now = carry[0]
        tried = now.accepted + now.rejected - first
        moving = (now.rate > control.steady_rate) | (now.accepted == 0)
        return (now.t < target) & ~now.failed & moving & (tried < max_steps)

    def body(carry: tuple[Progress, Any, Any]) -> tuple[Progress, Any, Any]:
        now, tabulated, coefficients = carry
        now = _aim(now, control, target, method.adaptive)
        coefficients = jax.lax.cond(
            now.h == tabulated, lambda: coefficients, lambda: method.tableau(linear, now.h)
        )
        return one_step(system, control, now, target, linear, coefficients, method), now.h, coefficients

    shapes = jax.eval_shape(method.tableau, linear, progress.h)
    blank = jax.tree.map(lambda shape: jnp.zeros(shape.shape, shape.dtype), shapes)
    carry = (progress, jnp.asarray(-1.0, jnp.float64), blank)
    return jax.lax.while_loop(unfinished, body, carry)[0]


def _aim(now: Progress, control: Control, target: Any, adaptive: bool) -> Progress:
    """Cut the way to the target into equal steps, where the run has no steps left on such a way."""
    wanted = length(now.rung) if adaptive else control.dt
    left = jnp.maximum(jnp.ceil((target - now.t) / wanted - 1e-9), 1.0).astype(jnp.int64)
    h = (target - now.t) / left
    h = jnp.where(jnp.abs(h - now.h) < 1e-12 * h, now.h, h)
    fresh = now.left == 0
    return now._replace(h=jnp.where(fresh, h, now.h), left=jnp.where(fresh, left, now.left))


def one_step(
    system: System,
    control: Control,
    now: Progress,
    target: Any,
    linear: Any,
    c: Any,
    method: Method = METHODS["adaptive"],
) -> Progress:
    """Try a step of length `now.h` with its coefficients, and choose the rung of the next."""
    result = method.step(system, c, now.t, now.h, now.spectrum, now.nonlinear)
    rate = _relative_rate(linear, result.spectrum, result.nonlinear)
    bounded = (result.peak <= control.bound**2) & jnp.isfinite(rate)  # False for NaN as well
    if method.adaptive:
        error = _rms(result.error) / _tolerance(control, now, _rms(result.spectrum))
        good = bounded & (error <= 1.0)
        # The length that would just meet the tolerance; a clipped step says nothing against its rung.
        factor = jnp.where(bounded, SAFETY * jnp.maximum(error, 1e-12) ** (-1.0 / method.order), 0.0)
        fitting = jnp.floor(2.0 * jnp.log2(jnp.maximum(factor * now.h, 1e-30)) + 1e-9).astype(jnp.int64)
        kept = jnp.where(factor >= 1.0, jnp.maximum(fitting, now.rung), fitting)
        tried = jnp.floor(2.0 * jnp.log2(now.h) + 1e-9).astype(jnp.int64)
        rung = jnp.where(
            good,
            jnp.clip(kept, now.rung - MAX_FALL, now.rung + MAX_RISE),
            jnp.clip(fitting, tried - MAX_FALL, tried - 1),
        )
        rung = jnp.minimum(rung, HIGHEST_RUNG)
        failed = rung < LOWEST_RUNG
    else:
        good, rung, failed = bounded, now.rung, ~bounded
    arrived = now.left <= 1
    t = jnp.where(good, jnp.where(arrived, target, now.t + now.h), now.t)
    onward = jnp.where(good, now.left - 1, now.left)

    def pick(new: Any, old: Any) -> Any:
        return jnp.where(good, new, old)

    return Progress(
        t=t,
        spectrum=pick(result.spectrum, now.spectrum),
        nonlinear=pick(result.nonlinear, now.nonlinear),
        rung=rung,
        h=now.h,
        # Zero asks for a new cut of the way to the target.
        left=jnp.where((rung != now.rung) | ~good, 0, onward),
        evaluations=now.evaluations + method.evaluations,
        accepted=now.accepted + good,
        rejected=now.rejected + ~good,
        peak=pick(jnp.maximum(jnp.sqrt(result.peak).astype(jnp.float64), now.peak), now.peak),
        rate=pick(rate, now.rate),
        failed=failed & ~good,
    )


def _tolerance(control: Control, now: Progress, size: Any) -> Any:
    """Return the error allowed in a step.

    Where a steady state is sought, the error must also stay below a tenth of the step's own change:
    otherwise steps grow until their errors keep the state from settling.
    """
    allowed = control.atol + control.rtol * size
    change = now.h * jnp.maximum(now.rate, control.steady_rate) * size
    return jnp.where(control.steady_rate > 0, jnp.minimum(allowed, control.atol + 0.1 * change), allowed)


def length(rung: Any) -> Any:
    """Return the length of a rung of the ladder of steps."""
    return 2.0 ** (0.5 * rung)


def _rms(spectrum: jax.Array) -> Any:
    """Root mean square of |P| from its packed spectrum (Parseval)."""
    return jnp.sqrt(jnp.sum(jnp.abs(spectrum) ** 2, dtype=jnp.float64)) / spectrum.size


def _relative_rate(linear: Any, spectrum: jax.Array, nonlinear: jax.Array) -> Any:
    return _rms(linear * spectrum + nonlinear) / jnp.maximum(_rms(spectrum), 1e-300)
