"""A schedule made ready for computing: the right-hand side of every stage, and what an event does to a run.

Stages of one structure are one compiled program. A parameter that a step made a field stays one, and what is
on a ramp is known for each stage, so that the program of a stage depends on nothing that comes later.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from ..model import spectral
from ..model.filaments import TermLike, select_terms
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import System, ramped, system
from .advance import DIVERGED, FIRST_RUNG, Progress, start
from .protocol import Protocol
from .schedule import Schedule, Stage

SHARP = 1.25
"""Magnitude |P| beyond which a run whose states are cut has diverged: sharp edges overshoot on their way."""


@dataclass(frozen=True, eq=False)
class Intervention:
    """What was done to a state at a time: the state (2, n_theta, n_z) just before and after all of it."""

    time: float
    before: Array
    after: Array


class Course:
    """The stages of a cell under a protocol, as systems; an empty protocol has one stage."""

    def __init__(
        self,
        params: Parameters,
        grid: CylinderGrid,
        protocol: Protocol,
        terms: Iterable[TermLike] | None,
        dealias: str,
        precision: str,
        split: bool = True,
    ) -> None:
        self.params, self.grid, self.protocol = params, grid, protocol
        self.schedule = Schedule(params, grid, protocol)
        self.times = self.schedule.times
        self._terms, self._dealias, self._precision, self._split = (
            select_terms(terms),
            dealias,
            precision,
            split,
        )
        self._kept: tuple[int, System] | None = None

    def bound(self, done: int) -> float:
        """Return the magnitude |P| beyond which the run has diverged, once `done` events are done."""
        return SHARP if self.schedule.disturbed_by(done) else DIVERGED

    def system(self, done: int) -> System:
        """Return the system in force once `done` events are done."""
        if self._kept is None or self._kept[0] != done:
            stage = self.schedule.stages[done]
            first = self._placed(stage, stage.first)
            if stage.moving:
                first = ramped(first, self._placed(stage, stage.last), stage.moving)
            self._kept = (done, first)
        return self._kept[1]

    def intervene(self, now: Progress, event: int) -> tuple[Progress, Intervention | None]:
        """Return a run after an event at the time that it has reached, and what was done to its state, if so.

        The right-hand side is new, so that steps begin anew, from the length of a first step or shorter.
        """
        cell, note = self.system(event + 1), None
        spectrum = now.spectrum
        if self.schedule.disturbs(event):
            before = cell.state(np.asarray(spectrum))
            after = self.schedule.disturbed(event, before)
            note = Intervention(float(now.t), before, after)
            # Nyquist modes stay here, else all of the surface would change: they diffuse away.
            spectrum = np.fft.fft2(spectral.pack(after)).astype(cell.space.packed)
        fresh = start(cell, spectrum, now.t)
        return now._replace(
            spectrum=fresh.spectrum,
            nonlinear=fresh.nonlinear,
            rate=fresh.rate,
            peak=fresh.peak if note is not None else now.peak,
            rung=jnp.minimum(now.rung, FIRST_RUNG),
            left=jnp.zeros_like(now.left),
            evaluations=now.evaluations + 1,
        ), note

    def _placed(self, stage: Stage, params: Parameters) -> System:
        whole = {name: getattr(params, name) for name in stage.fields}
        spread = {name: np.broadcast_to(value, self.grid.shape).copy() for name, value in whole.items()}
        return system(
            params.replace(**spread),
            self.grid,
            self._terms,
            self._dealias,
            self._precision,
            self._split,
            cubic=stage.cubic,
        )
