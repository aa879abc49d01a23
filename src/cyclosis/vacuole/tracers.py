"""Tracers: points that the flow carries, and that diffusion may shake, followed by a fourth-order method."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, choice, number, whole
from ..model.grid import Array
from .flow import VacuoleFlow
from .points import checked_points
from .sampled import Sampled, beginning, instants, is_flow, peclet_number
from .unsteady import UnsteadyFlow

if TYPE_CHECKING:
    from .splines import Lattice

USUAL_STEP = 0.2
"""Step in R/U: with speeds of U a tracer moves by a fifth of a radius."""
ORDERS = (3, 5)
ORDER, POINTS = 3, 64
"""Order of the splines, and points over the diameter."""
MANY, BLOCK = 5000, 2500
"""Tracers from which on they are sorted by place and carried in blocks, which fit the processor's cache."""
TOGETHER = 25
"""Steps for which they stay sorted."""
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


@shown
@dataclass(frozen=True, eq=False)
class Paths:
    """Where tracers were: `xyz` (times, n, 3), Cartesian, at the times `t` (times,); z is not wrapped.

    Lengths are in R, times in R/U. `length` is the axial period.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> paths = cy.vacuole.trace(flow, [[0.5, 0.0, 0.0], [0.5, 1.5, 0.0]], t_end=2.0)
        >>> paths.cylindrical.shape, bool((paths.cylindrical[..., 0].round(4) == 0.5).all())
        ((11, 2, 3), True)
    """

    t: Array
    xyz: Array
    length: float

    @property
    def cylindrical(self) -> Array:
        """(r, θ, z) of every place, shape (times, n, 3); θ within -π to π, z not wrapped."""
        x, y, z = np.moveaxis(self.xyz, -1, 0)
        return np.stack([np.hypot(x, y), np.arctan2(y, x), z], axis=-1)


@door
def trace(
    flow: VacuoleFlow | UnsteadyFlow,
    starts: npt.ArrayLike,
    t_end: float,
    save_at: Sequence[float] | None = None,
    dt: float = USUAL_STEP,
    peclet: float | None = None,
    seed: int = 0,
    order: int = ORDER,
    refine: int | None = None,
    n_s: int = POINTS,
    precision: str = "float64",
) -> Paths:
    """Follow tracers from `starts` (n, 3), of (r, θ, z), until `t_end`.

    Runge and Kutta's method of fourth order in steps of at most `dt`; the places at `save_at` are kept, by
    default after every step. A flow of a run is followed from its first frame and is cubic in time between
    frames. Tracers never leave the vacuole: a step beyond the wall is reflected. With `peclet` each step adds
    Brownian motion, normal with variance 2 dt/Pe in each direction; `seed` chooses it. The velocity is
    interpolated with B-splines of `order` 3 or 5 on `n_s` points over the diameter and `refine` times the
    grid, by default 128 points around and along or twice the grid. Places then have the error of the usual
    step. With `precision` "float32" that table, but no place, is in single precision: half the memory.

    Dimensionless. Raises `InputError` for starts outside the vacuole and values out of range.

    Example: a tracer on the axis of two winding bands moves in a helix.
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> phase = grid.theta[:, None] - 2 * np.pi * grid.z / grid.length
        >>> flow = cy.vacuole.flow(grid, np.sin(phase) * np.array([0.78, 0.62])[:, None, None])
        >>> paths = cy.vacuole.trace(flow, [[0.3, 1.0, 0.0]], t_end=5.0, save_at=[0.0, 5.0], order=3)
        >>> paths.xyz.shape, bool(paths.cylindrical[-1, 0, 0] < 1)
        ((2, 1, 3), True)
    """
    from ..model.precision import double

    is_flow(flow)
    places = checked_points(starts)
    first, end = beginning(flow, t_end)
    longest = number("dt", dt, 1e-6, 1e3, "give a step in R/U")
    spread = 0.0 if peclet is None else np.sqrt(2 / peclet_number(peclet))
    seed = whole("seed", seed, 0, 2**63 - 1, "give a whole number")
    saved = _saved(save_at, first, end, longest)
    with double():
        carrier = Carrier(flow, longest, spread, seed, order, refine, n_s, precision)
        at, t, out = cartesian_places(places), first, []
        for instant in saved:
            at, t = carrier.carried(at, t, float(instant)), float(instant)
            out.append(at.T)
    return Paths(saved, np.stack(out), float(flow.grid.length))


def cartesian_places(places: Array) -> Array:
    """Return x, y and z (3, n) of places (n, 3) given by r, θ and z."""
    r, theta, z = places.T
    return np.stack([r * np.cos(theta), r * np.sin(theta), z])


def _saved(given: Any, first: float, end: float, longest: float) -> Array:
    steps = int(np.ceil((end - first) / longest - 1e-9))
    return instants("save_at", given, first, end, np.linspace(first, end, steps + 1))


class Carrier:
    """A flow prepared for carrying points: its splines, and the steps."""

    def __init__(
        self,
        flow: VacuoleFlow | UnsteadyFlow,
        longest: float,
        spread: float = 0.0,
        seed: int = 0,
        order: int = ORDER,
        refine: int | None = None,
        n_s: int = POINTS,
        precision: str = "float64",
    ) -> None:
        from jax import random

        from .splines import coefficients, lattice_of

        if order not in ORDERS:
            raise InputError("order", order, "3 or 5", "choose the order of the splines")
        if refine is not None:
            refine = whole("refine", refine, 1, 16, "give how many times finer than the grid the table is")
        n_s = 2 * (whole("n_s", n_s, 8, 1024, "give the points over the diameter") // 2)
        choice("precision", precision, ("float64", "float32"))
        self._lattice = lattice = lattice_of(flow, order, refine, n_s)
        self._sampled = Sampled(flow, lambda one: coefficients(one, lattice).astype(precision))
        self._longest, self._spread, self._key = longest, spread, random.key(seed)
        self._window: tuple[Any, Any, Any] | None = None

    def carried(self, xyz: Array, t: float, after: float) -> Array:
        """Return the places (3, n) at time `after` of points at places (3, n) at time t."""
        from jax import random

        at: Any = xyz
        for instant in (*self._sampled.breaks(t, after), after):
            if instant > t:
                frames, times = self._frames(t, float(instant))
                steps = int(np.ceil((instant - t) / self._longest - 1e-9))
                h = (instant - t) / steps
                for first in range(0, steps, TOGETHER):
                    self._key, own = random.split(self._key)
                    at = self._made(frames, times, at, t + first * h, h, min(TOGETHER, steps - first), own)
                t = float(instant)
        return np.asarray(at)

    def _frames(self, t: float, after: float) -> tuple[Any, Any]:
        """Return the components of the tables (frames, points) from t to `after`, and their times."""
        import jax.numpy as jnp

        tables, times = self._sampled.window(t, after)
        if self._window is None or self._window[0] is not tables:
            parts = [jnp.asarray(tables[:, k].reshape(len(times), -1)) for k in range(3)]
            self._window = (tables, parts, times)
        return self._window[1:]

    def _made(self, frames: Any, times: Any, at: Any, t: float, h: float, steps: int, own: Any) -> Any:
        """Return the places after some steps; many tracers are carried in blocks of neighbours."""
        from jax import default_backend, random

        from ..model.precision import double
        from .splines import cells

        loop, count = _loop(self._lattice, self._spread > 0), at.shape[1]
        if count < MANY or default_backend() != "cpu":
            return loop(frames, times, at, t, h, steps, self._spread, own)
        at = np.asarray(at)
        order = np.argsort(cells(at, self._lattice), kind="stable")
        filled = np.concatenate([order, np.repeat(order[-1:], -count % BLOCK)]).reshape(-1, BLOCK)
        out = np.empty_like(at)

        def block(k: int) -> None:
            with double():  # which holds in one thread
                key = random.fold_in(own, k)
                moved = np.asarray(loop(frames, times, at[:, filled[k]], t, h, steps, self._spread, key))
            kept = min(BLOCK, count - k * BLOCK)
            out[:, filled[k, :kept]] = moved[:, :kept]

        with ThreadPoolExecutor(CORES) as threads:
            list(threads.map(block, range(len(filled))))
        return out


@lru_cache(maxsize=16)
def _loop(lattice: Lattice, noisy: bool) -> Any:
    """Return the compiled function that makes a number of steps."""
    import jax
    import jax.numpy as jnp

    from .spectral_scalar import factors_at
    from .splines import velocity as interpolated
    from .splines import velocity_between

    def advanced(at: Any, t: Any, h: Any, velocity: Any) -> Any:
        # A loop over the four stages is compiled once; each slope leaves it for one use only, so that the
        # compiler neither computes it twice nor in parts.
        parts, shares = jnp.array([0.0, 0.5, 0.5, 1.0]), jnp.array([0.0, 1.0, 2.0, 2.0]) / 6

        def stage(k: Any, now: Any) -> Any:
            slope, total = now
            return velocity(t + parts[k] * h, at + parts[k] * h * slope), total + shares[k] * slope

        last, total = jax.lax.fori_loop(0, 4, stage, (jnp.zeros_like(at), jnp.zeros_like(at)))
        return at + h * (total + last / 6)

    @jax.jit
    def loop(frames: Any, times: Any, at: Any, t: Any, h: Any, steps: Any, spread: Any, key: Any) -> Any:
        # Outside the loop: a part of a table would be copied at every step.
        steady = [part.reshape(-1) for part in frames] if len(times) == 1 else None

        def velocity(when: Any, where: Any) -> Any:
            if steady:
                return interpolated(steady, where, lattice)
            return velocity_between(frames, factors_at(times, when)[1], where, lattice)

        def body(k: Any, now: Any) -> Any:
            after = advanced(now, t + k * h, h, velocity)
            if noisy:
                shake = jax.random.normal(jax.random.fold_in(key, k), after.shape, after.dtype)
                after = after + spread * jnp.sqrt(h) * shake
            return reflected(after)

        return jax.lax.fori_loop(0, steps, body, at)

    return loop


def reflected(xyz: Any) -> Any:
    """Return places (3, n), those at r beyond the wall moved to 2 - r, and to the axis from beyond r = 2."""
    import jax.numpy as jnp

    r = jnp.hypot(xyz[0], xyz[1])
    factor = jnp.where(r > 1, jnp.maximum(2 - r, 0.0) / jnp.maximum(r, 1.0), 1.0)
    return jnp.stack([xyz[0] * factor, xyz[1] * factor, xyz[2]])
