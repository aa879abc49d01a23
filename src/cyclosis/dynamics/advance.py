"""Many steps in one compiled loop: step control, exact landing, and the reasons to stop.

Desired steps are on the ladder 2^{j/2}. The interval to a target time (such as that of a frame) is cut into
equal steps no longer than the rung, so that the target is hit exactly, the coefficients of a step are reused,
and the desired length is kept beyond the target.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..contract.system import System
from . import multistep
from .steppers import METHODS, Method

FIRST_RUNG, LOWEST_RUNG, HIGHEST_RUNG = -8, -46, 40
SAFETY = 0.9
MAX_RISE, MAX_FALL = 2, 8
USUAL_STEP = 0.1
"""Default step (R/U) of a fixed stepper without a limit of stability."""
NEVER = -1.0
"""A rate of change that no state falls below, not even a constant one."""
CALM = 10.0
"""Time (R/U) for which the relative rate of change must have stayed low and not grown for a steady run."""
RISE = 1.1
"""A rate has grown if it exceeds its least value by this factor: about e^(0.01 CALM), so that a
perturbation that grows at 0.01 or faster and makes up most of the rate is noticed."""
ROUNDING, SOLVING = 100.0, 10.0
"""Errors of a rate, in units of the precision of P and of `atol`: smaller increases do not count."""


class StepperState(NamedTuple):
    """The state of a run: all that is needed to continue it bit for bit.

    `calm_since` is the time since when the rate of change has stayed below `Control.steady_rate` and has not
    grown, infinite while it is above; `least_rate` is the least rate since then. `past` is what a multistep
    method remembers, None for others.
    """

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
    calm_since: Any = np.float64(np.inf)
    least_rate: Any = np.float64(np.inf)
    past: Any = None


class Control(NamedTuple):
    """What controls the steps.

    Tolerances, the fixed step `dt`, the relative rate below which a run may become steady, and the |P| beyond
    which it has diverged.
    """

    rtol: Any
    atol: Any
    dt: Any
    steady_rate: Any
    bound: Any

    @classmethod
    def of(
        cls, rtol: float, atol: float, bound: float, dt: float = USUAL_STEP, steady_rate: float = NEVER
    ) -> Control:
        """Return the control with these numbers, as arrays: changing them recompiles nothing."""
        return cls(np.float64(rtol), np.float64(atol), np.float64(dt), np.float64(steady_rate), bound)


@partial(jax.jit, static_argnames="method")
def start(system: System, spectrum: jax.Array, t: Any, method: Method = METHODS["adaptive"]) -> StepperState:
    """Return the `StepperState` of a run that begins at time t."""
    now = system.at(spectrum, t)
    nonlinear = system.nonlinear(now)
    zero = jnp.asarray(0, jnp.int64)
    return StepperState(
        t,
        spectrum,
        nonlinear,
        jnp.asarray(FIRST_RUNG, jnp.int64),
        jnp.asarray(0.0, jnp.float64),
        zero,
        zero + 1,
        zero,
        zero,
        jnp.sqrt(system.peak(now)).astype(jnp.float64),
        _relative_rate(system, system.linear(), spectrum, nonlinear),
        jnp.asarray(False),
        jnp.asarray(jnp.inf, jnp.float64),
        jnp.asarray(jnp.inf, jnp.float64),
        None if method.begin is None else method.begin(system, now, nonlinear),
    )


@partial(jax.jit, static_argnames="method")
def advance(
    system: System,
    control: Control,
    progress: StepperState,
    target: Any,
    max_steps: Any,
    method: Method = METHODS["adaptive"],
) -> StepperState:
    """Make steps until `target` is reached, the state is steady, a step fails, or `max_steps` are tried."""
    linear = system.linear()
    first = progress.accepted + progress.rejected

    def unfinished(carry: tuple[StepperState, Any, Any]) -> Any:
        return goes_on(carry[0], target, first + max_steps)

    def body(carry: tuple[StepperState, Any, Any]) -> tuple[StepperState, Any, Any]:
        now, tabulated, coefficients = carry
        now = aimed(now, control, target, method.adaptive)
        coefficients = jax.lax.cond(
            now.h == tabulated, lambda: coefficients, lambda: method.tableau(linear, now.h)
        )
        return one_step(system, control, now, target, linear, coefficients, method), now.h, coefficients

    shapes = jax.eval_shape(method.tableau, linear, progress.h)
    blank = jax.tree.map(lambda shape: jnp.zeros(shape.shape, shape.dtype), shapes)
    carry = (progress, jnp.asarray(-1.0, jnp.float64), blank)
    return jax.lax.while_loop(unfinished, body, carry)[0]


def goes_on(now: StepperState, target: Any, most: Any) -> Any:
    """Return whether more steps are to be made: `most` is the number of tried ones at which to stop."""
    tried = now.accepted + now.rejected
    return (now.t < target) & ~now.failed & ~is_steady(now) & (tried < most)


def is_steady(now: StepperState) -> Any:
    """Return whether the rate of change has stayed low, and has not grown, for the time `CALM`."""
    return now.t - now.calm_since >= CALM


def _calm(control: Control, now: StepperState, t: Any, rate: Any, noise: Any) -> tuple[Any, Any]:
    """Return `calm_since` and `least_rate` after a step to time t; `noise` is the error of the rate."""
    low = rate <= control.steady_rate
    grown = rate > RISE * now.least_rate + noise
    goes_on = low & ~grown & jnp.isfinite(now.calm_since)
    since = jnp.where(goes_on, now.calm_since, jnp.where(low, t, jnp.inf))
    least = jnp.where(goes_on, jnp.minimum(now.least_rate, rate), jnp.where(low, rate, jnp.inf))
    return since, least


def aimed(now: StepperState, control: Control, target: Any, adaptive: bool) -> StepperState:
    """Return a run with the interval to the target cut into equal steps, unless some are left."""
    wanted = length(now.rung) if adaptive else control.dt
    cut_short = False
    if now.past is not None:
        # After a step much shorter than its rung the next ones grow to it, each cut anew.
        cut_short = (now.left > 1) & (now.h < 0.5 * wanted)
        wanted = jnp.minimum(wanted, multistep.longest(now.past, now.t))
    left = jnp.maximum(jnp.ceil((target - now.t) / wanted - 1e-9), 1.0).astype(jnp.int64)
    h = (target - now.t) / left
    # A length that differs only by rounding is kept, so that its coefficients are reused.
    h = jnp.where(jnp.abs(h - now.h) < 1e-12 * h, now.h, h)
    fresh = (now.left == 0) | cut_short
    return now._replace(h=jnp.where(fresh, h, now.h), left=jnp.where(fresh, left, now.left))


def one_step(
    system: System,
    control: Control,
    now: StepperState,
    target: Any,
    linear: Any,
    c: Any,
    method: Method = METHODS["adaptive"],
) -> StepperState:
    """Try a step of length `now.h` with its coefficients, and choose the rung of the next."""
    remembered = () if now.past is None else (now.past,)
    result = method.step(system, c, now.t, now.h, now.spectrum, now.nonlinear, *remembered)
    rate = _relative_rate(system, linear, result.spectrum, result.nonlinear)
    bounded = (result.peak <= control.bound**2) & jnp.isfinite(rate)  # False for NaN as well
    if method.adaptive:
        error = system.size(result.error) / _tolerance(control, now, system.size(result.spectrum))
        good = bounded & (error <= 1.0)
        # h times `factor` would meet the tolerance, with some margin. The estimate is that of a solution of
        # one order less, so that it scales as h^order: hence the exponent -1/order.
        factor = jnp.where(bounded, SAFETY * jnp.maximum(error, 1e-12) ** (-1.0 / method.order), 0.0)
        fitting = jnp.floor(2.0 * jnp.log2(jnp.maximum(factor * now.h, 1e-30)) + 1e-9).astype(jnp.int64)
        rise = MAX_RISE if now.past is None else multistep.rise(now.past, now.t, now.h)
        # A step cut short by the target may be shorter than its rung: that alone does not lower the rung.
        kept = jnp.where(factor >= 1.0, jnp.maximum(fitting, now.rung), fitting)
        # A rejected step is followed by one at least a rung below the length that was tried.
        tried = jnp.floor(2.0 * jnp.log2(now.h) + 1e-9).astype(jnp.int64)
        rung = jnp.where(
            good,
            jnp.clip(kept, now.rung - MAX_FALL, now.rung + rise),
            jnp.clip(fitting, tried - MAX_FALL, tried - 1),
        )
        rung = jnp.minimum(rung, HIGHEST_RUNG)
        failed = rung < LOWEST_RUNG
    else:
        good, rung, failed = bounded, now.rung, ~bounded
    arrived = now.left <= 1
    t = jnp.where(good, jnp.where(arrived, target, now.t + now.h), now.t)
    onward = jnp.where(good, now.left - 1, now.left)
    noise = _rounding(result.spectrum)
    if method.adaptive:
        noise += SOLVING * control.atol / jnp.maximum(system.size(result.spectrum), 1e-300)
    calm_since, least_rate = _calm(control, now, t, rate, noise)

    def pick(new: Any, old: Any) -> Any:
        return jnp.where(good, new, old)

    return StepperState(
        t=t,
        spectrum=pick(result.spectrum, now.spectrum),
        nonlinear=pick(result.nonlinear, now.nonlinear),
        rung=rung,
        h=now.h,
        # Zero requests a new cut of the interval to the target.
        left=jnp.where((rung != now.rung) | ~good, 0, onward),
        evaluations=now.evaluations
        + (method.evaluations if result.evaluations is None else result.evaluations),
        accepted=now.accepted + good,
        rejected=now.rejected + ~good,
        peak=pick(jnp.maximum(jnp.sqrt(result.peak).astype(jnp.float64), now.peak), now.peak),
        rate=pick(rate, now.rate),
        failed=failed & ~good,
        calm_since=pick(calm_since, now.calm_since),
        least_rate=pick(least_rate, now.least_rate),
        past=jax.tree.map(pick, result.past, now.past),
    )


def _tolerance(control: Control, now: StepperState, size: Any) -> Any:
    """Return the error allowed in a step.

    If the run is to stop when steady, the error must also stay below a tenth of the change in the step:
    otherwise steps grow until their errors keep the state from settling, and hide growing perturbations.
    """
    allowed = control.atol + control.rtol * size
    change = now.h * jnp.maximum(now.rate, _rounding(now.spectrum)) * size
    return jnp.where(control.steady_rate > 0, jnp.minimum(allowed, control.atol + 0.1 * change), allowed)


def _rounding(spectrum: jax.Array) -> float:
    """Return the rounding error of a relative rate of change at the precision of P."""
    return ROUNDING * float(np.finfo(spectrum.dtype).eps)


def length(rung: Any) -> Any:
    """Return the length of a rung of the ladder of steps."""
    return 2.0 ** (0.5 * rung)


def _relative_rate(system: System, linear: Any, spectrum: jax.Array, nonlinear: jax.Array) -> Any:
    return system.size(linear * spectrum + nonlinear) / jnp.maximum(system.size(spectrum), 1e-300)
