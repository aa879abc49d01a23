"""Members with a protocol in lanes of one compiled program, each on its way to its own next event.

A stage of a protocol may have a program of its own: with a ramp, or with a parameter that differs from place
to place. Members wait in one queue for each program. The lanes work at one queue at a time; a member whose
event leads to another program makes room for the next, and joins the other queue.
"""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..contract.members import Lanes
from ..dynamics.advance import NEVER, Control, StepperState, advance
from .lanes import CHECK_STEPS, stacked
from .members import EnsembleSettings, Member, Outcome
from .scheduled import ScheduledRun


class _Seat:
    """A member on its way, and its place in the order of members."""

    def __init__(self, index: int, member: Member, how: EnsembleSettings) -> None:
        self.index, self.run = index, ScheduledRun(member, how)
        self.seconds = clock.perf_counter() - self.run.began

    @property
    def program(self) -> Any:
        """What must be equal for members to share lanes: all of their systems but the values."""
        lanes = self.run.problem.model.lanes
        assert lanes is not None
        own = lanes.values(self.run.follower.system)
        shapes = tuple((np.shape(leaf), np.asarray(leaf).dtype.str) for leaf in jax.tree.leaves(own))
        shared = tuple(
            lanes.shared(end.params, end.grid) for end in self.run.course.ends(self.run.follower.done)
        )
        return shared, jax.tree.structure(self.run.follower.system), shapes


class ScheduledLanes:
    """Members of one model that have protocols, in a number of lanes."""

    def __init__(
        self, members: Sequence[Member], indices: Sequence[int], how: EnsembleSettings, lanes: int
    ) -> None:
        self.members, self.how, self.lanes = members, how, lanes
        self.waiting = deque(indices)
        self.queues: dict[Any, deque[_Seat]] = {}
        shares = members[indices[0]].model.lanes
        assert shares is not None
        self.shares: Lanes = shares

    def run(self) -> Iterator[tuple[int, Outcome]]:
        """Yield index and outcome of every member, as they end."""
        while self.waiting or any(self.queues.values()):
            yield from self._start()
            if not any(self.queues.values()):
                continue
            program = max(self.queues, key=lambda key: len(self.queues[key]))
            yield from self._batch(program)

    def _start(self) -> Iterator[tuple[int, Outcome]]:
        """Begin members until as many wait as there are lanes; yield those that are over at once."""
        while self.waiting and sum(map(len, self.queues.values())) < self.lanes:
            index = self.waiting.popleft()
            yield from self._enqueue(_Seat(index, self.members[index], self.how))

    def _enqueue(self, seat: _Seat) -> Iterator[tuple[int, Outcome]]:
        if seat.run.over:
            yield seat.index, seat.run.outcome(seat.seconds)
        else:
            self.queues.setdefault(seat.program, deque()).append(seat)

    def _batch(self, program: Any) -> Iterator[tuple[int, Outcome]]:
        """Integrate members of one program until none is left; yield those that end."""
        queue = self.queues[program]
        # A power of two if there are few members, so that few programs are compiled.
        width = min(self.lanes, 2 ** (len(queue) + len(self.waiting) - 1).bit_length())
        seats: list[_Seat | None] = [queue.popleft() if queue else None for _ in range(width)]
        first = seats[0]
        assert first is not None
        system = first.run.follower.system
        entered = [seat or first for seat in seats]
        values = stacked([self.shares.values(seat.run.follower.system) for seat in entered])
        nows = stacked([seat.run.follower.now for seat in entered])
        targets = np.array([seat.run.target for seat in entered])
        bounds = np.array([float(seat.run.follower.active.bound) for seat in entered])
        targets[[seat is None for seat in seats]] = NEVER  # a lane without a member has nothing to do
        control = Control.of(self.how.rtol, self.how.atol, 0.0)
        while any(seats):
            began = clock.perf_counter()
            systems = self.shares.with_values(system, values)
            nows, seen = _advance(systems, control._replace(bound=bounds), nows, targets, how=self.shares)
            signs, times, failed = jax.device_get((seen, nows.t, nows.failed))
            spent = (clock.perf_counter() - began) / sum(seat is not None for seat in seats)
            for lane, seat in enumerate(seats):
                if seat is None:
                    continue
                seat.seconds += spent
                run, t = seat.run, float(times[lane])
                run.look(t, jax.tree.map(lambda leaf, lane=lane: leaf[lane], signs), self.shares)
                if t < run.target and not failed[lane]:
                    continue
                began = clock.perf_counter()
                run.follower.now = _lane(nows, lane)
                run.arrive()
                seat.seconds += clock.perf_counter() - began
                taken: _Seat | None = seat
                if run.over or seat.program != program:
                    yield from self._enqueue(seat)
                    yield from self._start()
                    taken = queue.popleft() if queue else None
                seats[lane] = taken
                targets[lane] = NEVER if taken is None else taken.run.target
                if taken is not None:
                    follower = taken.run.follower
                    bounds[lane] = float(follower.active.bound)
                    own = self.shares.values(follower.system)
                    values, nows = _placed((values, nows), (own, follower.now), lane)


@partial(jax.jit, static_argnames="how", donate_argnames="nows")
def _advance(
    systems: Any, control: Control, nows: StepperState, targets: Any, *, how: Lanes
) -> tuple[StepperState, Any]:
    """Try `CHECK_STEPS` steps in every lane towards its target, and return the progress and the signs."""

    def one(values: Any, bound: Any, now: StepperState, target: Any) -> StepperState:
        own = control._replace(bound=bound)
        return advance(how.with_values(systems, values), own, now, target, np.int64(CHECK_STEPS))

    own = how.values(systems)
    new = jax.vmap(one)(own, control.bound, nows, targets)
    signs: Any = jax.vmap(lambda values, now: how.signs(how.with_values(systems, values), now.spectrum))
    return new, signs(own, new)


@jax.jit
def _lane(batch: Any, lane: Any) -> Any:
    """Return the values of one lane."""
    return jax.tree.map(lambda item: item[lane], batch)


@partial(jax.jit, donate_argnums=0)
def _placed(batch: Any, one: Any, lane: Any) -> Any:
    """Replace the values of one lane in a batch."""
    return jax.tree.map(lambda all_lanes, value: all_lanes.at[lane].set(jnp.asarray(value)), batch, one)
