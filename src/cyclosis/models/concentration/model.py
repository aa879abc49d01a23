"""The polar model with a concentration as one value."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ...analysis.appearance import Look
from ...analysis.regimes import Regime, judged
from ...contract.members import Lanes
from ...contract.model import Model, Problem, Times
from ...display.notebook import map_of
from ...model.actions import act
from ...model.errors import InputError
from ...model.grid import Array, CylinderGrid, resolved
from ...model.spectral import pack
from ..on_polar import flow, member_row, rate_modes
from ..polar_cylinder import polar
from . import quantities, stored
from .starts import starts_of
from .system import UnevenSystem


def _of(base: Any, problem: Problem) -> UnevenSystem:
    return UnevenSystem(base, problem.model.options["force_density"] == "power")


def _system(problem: Problem, split: bool) -> UnevenSystem:
    return _of(polar.system(problem, split), problem)


def _ramped(first: Problem, last: Problem, times: Times, split: bool) -> UnevenSystem:
    return _of(polar.ramped(first, last, times, split), first)


def _whole_modes(system: UnevenSystem, state: Array) -> npt.NDArray[Any]:
    return np.fft.fft2(np.stack([pack(state), state[2]])).astype(system.space.packed)


def _modes(system: UnevenSystem, state: Array) -> npt.NDArray[Any]:
    return _whole_modes(system, state) * np.asarray(system.space.keep)


def _state(grid: CylinderGrid, spectrum: Any) -> Array:
    p, c = np.fft.ifft2(np.asarray(spectrum, dtype=np.complex128))
    return np.stack([p.real, p.imag, c.real])


def _check_state(grid: CylinderGrid, state: Any, name: str) -> Array:
    given = np.asarray(state)
    if given.shape != (3, *grid.shape) or given.dtype.kind not in "iuf":
        rule = f"an array of real numbers of shape {(3, *grid.shape)}: P_theta, P_z and the concentration"
        remedy = "make it with cyclosis.initial.with_concentration"
        raise InputError(name, given, rule, remedy)
    P = grid.check_state(given[:2], name, bounded=True)
    c = np.asarray(given[2], dtype=np.float64)
    if not np.all(np.isfinite(c)) or c.min() <= 0:
        raise InputError(f"concentration of {name}", c, "finite and above 0 everywhere", "raise it")
    return np.stack([*P, c])


def _act(step: Any, state: Array, grid: CylinderGrid, seed: int) -> Array:
    """Return a state after a step of a protocol, which acts on P alone."""
    return np.concatenate([act(step, state[:2], grid, seed), state[2:]])


def _regime(problem: Problem, state: Array) -> Regime:
    change = _state(problem.grid, rate_modes(problem, state))
    return judged(problem.grid, resolved(state[:2]), change[:2])


def uneven(base: Model, force_density: str) -> Model:
    """Return the polar model of a closure with a concentration, and a force linear in it or a power of it."""
    assert base.lanes is not None
    assert base.starts is not None
    lanes: Lanes = replace(
        base.lanes,
        signs=quantities.signs,
        look_of_state=lambda state: Look.of_state(state[:2]),
        values=lambda system: system.base.varying,
        with_values=lambda system, values: replace(system, base=system.base.with_varying(values)),
        certain=None,
        axial=None,
    )
    return replace(
        base,
        options={"closure": "paper"}
        | dict(base.options)
        | {"concentration": True, "force_density": force_density},
        system=_system,
        ramped=_ramped,
        modes=_modes,
        whole_modes=_whole_modes,
        state=_state,
        check_state=_check_state,
        act=_act,
        largest=lambda state: float(np.hypot(*resolved(state[:2])).max()),
        stiffness=lambda system: base.stiffness(system.base),
        quantities=quantities.QUANTITIES,
        measure=quantities.measure,
        decay_time=lambda system: base.decay_time(system.base),
        stored=stored.STORED,
        coordinates=stored.coordinates,
        derive=stored.derive,
        regime=_regime,
        lanes=lanes,
        starts=starts_of(base.starts),
        member_row=member_row(lambda state: state[:2]),
        flow=flow,
        picture=lambda grid, state: map_of(state[:2], grid.length),
    )
