"""Many members at once, each with a step of its own: lanes of one compiled program.

Every lane takes steps from the ladder 2^{j/2}, whose coefficients are tabulated once: they depend on
diffusion alone, so that all lanes share the table whatever their couplings. A lane waits, unchanged,
when its next step would pass its end or when it has failed. Lanes never mix: what a member does
does not depend on who is beside it.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..analysis.diagnostics import tail
from ..dynamics.advance import Control, Progress, length, one_step
from ..dynamics.steppers import Tableau, tableau
from ..model.spectral import dot
from ..model.system import System

LOWEST, HIGHEST = -16, 10
"""Rungs that are tabulated: steps of 1/256 to 32. A member that needs shorter ones has diverged."""
CHECK_STEPS = 8
"""Steps between two looks at a member."""


class Signs(NamedTuple):
    """What is looked at of a member: small numbers, and its means along either axis as packed spectra.

    `largest` is max |P|, `order` <|P|²>^½, `around` <P_theta²>^½, `unevenness` <|P - <P>|²>^½; `vary_theta`
    and `vary_z` are the root mean squares of what varies along either axis; `low` and `high` the fewest and
    the most sign changes of P_z around a circle z = const. `t` is the time reached, `waits` whether the next
    step would pass the end, `failed` whether none was short enough, `peak` the largest |P| so far.
    """

    largest: Any
    order: Any
    around: Any
    unevenness: Any
    vary_theta: Any
    vary_z: Any
    tail: Any
    low: Any
    high: Any
    mean_along_z: Any
    mean_along_theta: Any
    t: Any
    waits: Any
    failed: Any
    peak: Any


@jax.jit
def tables(cell: System) -> Tableau:
    """Return the coefficients of every rung, stacked along a first dimension."""
    linear = cell.linear()
    return jax.vmap(lambda rung: tableau(linear, length(rung)))(jnp.arange(LOWEST, HIGHEST + 1))


@partial(jax.jit, donate_argnums=3)
def run_lanes(
    cells: System, control: Control, table: Tableau, lanes: Progress, t_end: Any
) -> tuple[Progress, Signs]:
    """Try `CHECK_STEPS` steps in every lane, and look at them.

    `cells.values` and every leaf of `lanes` have a first dimension, the lanes; all else is shared.
    """

    def one(values: Any, now: Progress) -> tuple[Progress, Signs]:
        cell = cells.with_values(values)
        now = jax.lax.fori_loop(0, CHECK_STEPS, lambda _, at: _try(cell, control, table, at, t_end), now)
        return now, _signs(cell, now, t_end)

    return jax.vmap(one)(cells.values, lanes)


def _waits(now: Progress, t_end: Any) -> Any:
    return now.t + _next(now) > t_end


def _next(now: Progress) -> Any:
    return length(jnp.clip(now.rung, LOWEST, HIGHEST))


def _try(cell: System, control: Control, table: Tableau, now: Progress, t_end: Any) -> Progress:
    h = _next(now)
    rung = jnp.clip(now.rung, LOWEST, HIGHEST)
    coefficients = Tableau(*(values[rung - LOWEST] for values in table))
    aimed = now._replace(rung=rung, h=h, left=jnp.ones_like(now.left))
    new = one_step(cell, control, aimed, now.t + h, cell.linear(), coefficients)
    new = new._replace(failed=new.failed | (new.rung < LOWEST))
    waits = now.failed | _waits(now, t_end)
    return jax.tree.map(lambda a, b: jnp.where(waits, a, b), now, new)


@jax.jit
def signs(cell: System, now: Progress, t_end: Any) -> Signs:
    """Return what is looked at of one member."""
    return _signs(cell, now, t_end)


def _signs(cell: System, now: Progress, t_end: Any) -> Signs:
    spectrum = now.spectrum
    energy = (spectrum.real**2 + spectrum.imag**2) / spectrum.size**2
    p = jnp.fft.ifft2(spectrum)
    up = p.imag > 0
    changes = jnp.sum(up != jnp.roll(up, 1, axis=0), axis=0)

    def root(values: Any) -> Any:
        return jnp.sqrt(jnp.sum(values, dtype=jnp.float64))

    return Signs(
        largest=jnp.sqrt(jnp.max(dot(p, p))),
        order=root(energy),
        around=jnp.sqrt(jnp.mean(p.real**2, dtype=jnp.float64)),
        unevenness=root(energy.at[0, 0].set(0.0)),
        vary_theta=root(energy[1:]),
        vary_z=root(energy[:, 1:]),
        tail=tail(cell, energy),
        low=jnp.min(changes),
        high=jnp.max(changes),
        mean_along_z=spectrum[:, 0] / spectrum.shape[1],
        mean_along_theta=spectrum[0] / spectrum.shape[0],
        t=now.t,
        waits=_waits(now, t_end),
        failed=now.failed,
        peak=now.peak,
    )
