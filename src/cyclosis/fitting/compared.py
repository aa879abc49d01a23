"""A run beside a film: what a run gives of the flow through its windows, of the order, and of the angles.

The unknowns are the logarithms of the parameters and the coefficients of the waves of P at the first frame.
What is compiled depends on the `Layout` alone, so that films of the same shape share it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from .. import traced
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters

PLAIN = Parameters()
FAINT = 0.2
"""|P| around and below which the angle of a run counts less. With a small one the search is caught where P
vanishes, because a defect of the angles cannot move without misfit."""


@dataclass(frozen=True)
class Layout:
    """What a compiled comparison depends on: grid, `free` and `fixed` parameters, times, and the fields."""

    grid: CylinderGrid
    free: tuple[str, ...]
    fixed: tuple[str, ...]
    times: tuple[float, ...]
    fields: tuple[str, ...]


class Arrays(NamedTuple):
    """The numbers of a comparison.

    `fixed` are the values of the fixed parameters, `waves` the cosines and sines of the initial state on the
    grid and `kept` which of them are used. `windows` (2, n_theta, m, q), `around` (n_theta, m) and `along`
    (n_z, q) take waves of the grid, q not negative, to the film's points. `data` and `sigma` have the
    measured values of each field and their standard deviations, and `at` their places among all points and
    times.
    """

    fixed: Any
    waves: tuple[Any, Any]
    kept: tuple[Any, Any]
    windows: Any
    around: Any
    along: Any
    data: dict[str, Any]
    sigma: dict[str, Any]
    at: dict[str, Any]


def initial(arrays: Arrays, coefficients: Any) -> Any:
    """Return P (2, n_theta, n_z) at the first frame."""
    shape = (2, arrays.waves[0].shape[1], arrays.waves[1].shape[1])
    full = (
        jnp.zeros(shape, coefficients.dtype)
        .at[:, arrays.kept[0], arrays.kept[1]]
        .set(coefficients.reshape(2, -1))
    )
    return jnp.einsum("am,cmn,bn->cab", arrays.waves[0], full, arrays.waves[1])


def values(layout: Layout, arrays: Arrays, logs: Any) -> dict[str, Any]:
    """Return the parameters by name, the rates in units of the data's time."""
    given: dict[str, Any] = dict(zip(layout.fixed, arrays.fixed, strict=True))
    given |= {name: jnp.exp(logs[k]) for k, name in enumerate(layout.free)}
    unit = given.pop("U")
    kept: dict[str, Any] = {name: given.pop(name) for name in ("mu", "repulsion_angle") if name in given}
    # u in units of the data is U u: all terms but those of μ become U times as fast.
    return {"U": unit, **kept, **{name: value * unit for name, value in given.items()}}


@partial(jax.jit, static_argnames=("layout", "dt", "precision"))
def fields(layout: Layout, arrays: Arrays, unknowns: Any, dt: float, precision: str) -> tuple[Any, Any]:
    """Return P and u (n, 2, n_theta, n_z) on the grid at the film's times."""
    n = len(layout.free)
    named = values(layout, arrays, unknowns[:n])
    unit = named.pop("U")
    start = initial(arrays, unknowns[n:])
    P = traced.rollout(PLAIN, layout.grid, start, layout.times, dt, precision=precision, **named)

    def flow(p: Any) -> Any:
        return traced.flow(PLAIN, layout.grid, p, precision=precision, mu=named["mu"])

    return P, unit * jax.vmap(flow)(P)


def waves(field: Any) -> Any:
    """Return the waves of a real field; those of positive order along z count for their conjugates too."""
    wave = jnp.fft.fftn(jnp.fft.rfft(field, axis=-1, norm="forward"), axes=(-2,), norm="forward")
    return wave * jnp.where(jnp.arange(wave.shape[-1]) % (field.shape[-1] / 2) == 0, 1, 2)


@partial(jax.jit, static_argnames=("layout", "dt", "precision"))
def misfit(layout: Layout, arrays: Arrays, unknowns: Any, dt: float, precision: str) -> Any:
    """Return (model - data)/σ of everything that was measured, as one vector."""
    P, u = fields(layout, arrays, unknowns, dt, precision)
    left = []
    if "u" in layout.fields:
        there = jnp.einsum("camn,tcmn,bn->tcab", arrays.windows, waves(u), arrays.along).real
        left.append(there.ravel()[arrays.at["u"]] - arrays.data["u"])
    if {"P", "angle"} & set(layout.fields):
        order = jnp.einsum("am,tcmn,bn->tcab", arrays.around, waves(P), arrays.along).real
        if "P" in layout.fields:
            left.append(order.ravel()[arrays.at["P"]] - arrays.data["P"])
        if "angle" in layout.fields:
            across, ahead = order[:, 0].ravel()[arrays.at["angle"]], order[:, 1].ravel()[arrays.at["angle"]]
            c, s = jnp.cos(arrays.data["angle"]), jnp.sin(arrays.data["angle"])
            # sin and cos of the angle between the filaments and the run's P: half the sine of twice it.
            turned = (across * c - ahead * s) * (across * s + ahead * c)
            left.append(turned / (across**2 + ahead**2 + FAINT**2))
    return jnp.concatenate(
        [part / arrays.sigma[name] for part, name in zip(left, layout.fields, strict=True)]
    )


@partial(jax.jit, static_argnames=("layout", "dt", "precision"))
def columns(layout: Layout, arrays: Arrays, unknowns: Any, ways: Any, dt: float, precision: str) -> Any:
    """Return the slopes of the misfit along some ways (n, unknowns)."""
    tangent = jax.linearize(lambda x: misfit(layout, arrays, x, dt, precision), unknowns)[1]
    return jax.vmap(tangent)(ways)
