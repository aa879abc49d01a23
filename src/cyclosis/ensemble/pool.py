"""Members that share lanes: one leaves its lane when its regime is certain, and the next one takes it.

With adaptive axial resolution there are lanes for each number of axial points, and members wait in one queue
for each. The lanes work at one queue at a time.
"""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..contract.members import CertainEnd, Inquiry, Lanes, Look
from ..contract.model import Problem
from ..contract.system import System
from ..dynamics.advance import Control, StepperState, advance, start
from ..dynamics.watch import Watch
from .axial_lanes import fitted, run_axial_lanes
from .lanes import LaneState, run_lanes, stacked, tables
from .members import DISORDERED, EnsembleSettings, Member, Outcome, ended, uncertain

FEW_LANES = 64
"""Smallest number of lanes on an accelerator: at the usual sizes they cost no more than one."""
MOST_STEPS = 1_000_000


@dataclass
class _Seat:
    """A member on its way, and what has been recorded about it so far."""

    index: int
    system: System
    inquiry: Inquiry | None
    began: float
    watch: Watch
    levels: int
    looks: list[tuple[float, Look]] = field(default_factory=list)
    tail: float = 0.0


class _Entry(NamedTuple):
    """A member that is to take a lane: its seat, the values of its system, and its progress."""

    seat: _Seat
    values: Any
    state: StepperState


class Pool:
    """Members that share lanes."""

    def __init__(
        self, members: Sequence[Member], indices: list[int], how: EnsembleSettings, lanes: int
    ) -> None:
        self.members, self.waiting, self.how, self.lanes = members, deque(indices), how, lanes
        first = members[indices[0]]
        assert first.model.lanes is not None
        self.model, self.grid = first.model, first.grid
        self.shares: Lanes = first.model.lanes
        self.control = Control.of(how.rtol, how.atol, self.model.bound)
        self.t_end = np.float64(how.t_end)
        problem = how.problem(first)
        self.axial = self.shares.axial if how.axial_resolution == "adaptive" else None
        fewer = () if self.axial is None else self.axial.fewer(self.grid)
        self.points = () if self.axial is None else (self.grid.n_z, *fewer)
        problems = [problem]
        for n in fewer:
            problems.append(replace(problem, grid=self.grid.resized(self.grid.n_theta, n)))
        self.devices: list[System] = [jax.device_put(self.model.system(own, True)) for own in problems]
        self.tables = [tables(device) for device in self.devices]
        self.queues: list[deque[_Entry]] = [deque() for _ in problems]
        self.known: dict[Any, tuple[System, Callable[[], Inquiry] | None]] = {}

    def run(self) -> Iterator[tuple[int, Outcome]]:
        """Yield index and outcome of every member, as they end."""
        while self.waiting or any(self.queues):
            while self.waiting and self._queued < self.lanes:
                self.queues[0].append(self._enter())
            level = max(range(len(self.queues)), key=lambda level: len(self.queues[level]))
            yield from self._batch(level)

    @property
    def _queued(self) -> int:
        return sum(map(len, self.queues))

    def _batch(self, level: int) -> Iterator[tuple[int, Outcome]]:
        """Integrate the members at one number of axial points until none is left; yield those that end."""
        queue = self.queues[level]
        entries = [queue.popleft() if queue else None for _ in range(self.lanes)]
        seats = [None if entry is None else entry.seat for entry in entries]
        # Lanes without a member are idle: the compiled program always has `lanes` lanes.
        first = next(entry for entry in entries if entry is not None)
        values = stacked([(entry or first).values for entry in entries])
        batch = stacked([_idle(first.state) if entry is None else entry.state for entry in entries])
        while any(seats):
            batch, states = self._steps(level, values, batch)
            seen = jax.device_get(states)
            for lane, seat in enumerate(seats):
                if seat is None:
                    continue
                now: LaneState = jax.tree.map(lambda item, lane=lane: item[lane], seen)
                verdict = self._look(seat, now)
                ended = verdict is not None or bool(now.failed) or bool(now.waits)
                onward = min(int(now.level), seat.levels)
                if not ended and onward == level:
                    continue
                left = _lane(batch, lane)
                moved = self._moved(left, seat, level, 0 if ended else onward)
                seats[lane] = None
                if ended:
                    yield seat.index, self._leave(seat, moved, verdict)
                else:
                    self.queues[onward].append(_Entry(seat, self.shares.values(seat.system), moved))
                entry = self._next(level, sum(other is not None for other in seats))
                batch = _placed(batch, _idle(left) if entry is None else entry.state, lane)
                if entry is not None:
                    seats[lane], values = entry.seat, _placed(values, entry.values, lane)
            kept = _kept(seats)
            if kept is not None:
                seats = [seats[lane] for lane in kept]
                values, batch = _lane(values, kept), _lane(batch, kept)

    def _steps(self, level: int, values: Any, batch: StepperState) -> tuple[StepperState, LaneState]:
        """Try some steps in every lane."""
        systems = self.shares.with_values(self.devices[level], values)
        control, table, t_end, how = self.control, self.tables[level], self.t_end, self.shares
        if self.axial is None:
            return run_lanes(systems, control, table, batch, t_end, how=how)
        whole, points = self.devices[0], self.points
        return run_axial_lanes(
            systems, whole, control, table, batch, t_end, how=how, points=points, level=level
        )

    def _moved(self, now: StepperState, seat: _Seat, level: int, onward: int) -> StepperState:
        """Return the progress of a member on another number of axial points."""
        if onward == level:
            return now
        system = self.shares.with_values(self.devices[onward], self.shares.values(seat.system))
        return fitted(system, now, how=self.shares, n=self.points[onward])

    def _next(self, level: int, busy: int) -> _Entry | None:
        """Return the member that takes a free lane, or None if there is none."""
        if self.queues[level]:
            return self.queues[level].popleft()
        if level > 0 or not self.waiting or busy + self._queued >= self.lanes:
            return None
        return self._enter()

    def _enter(self) -> _Entry:
        """Prepare the next member: its seat, its couplings, and its state at t = 0."""
        index = self.waiting.popleft()
        member, began = self.members[index], clock.perf_counter()
        problem = self.how.problem(member)
        system, certain = self._point(problem)
        state = self.model.check_state(member.grid, member.state(), "the initial state")
        watch = Watch(problem, system, self.how.run)
        levels = 0 if self.axial is None else self.axial.usable(member.params, member.grid)
        seat = _Seat(index, system, None if certain is None else certain(), began, watch, levels)
        values = self.shares.values(system)
        running = self.shares.with_values(self.devices[0], values)
        return _Entry(seat, values, start(running, self.model.modes(system, state), np.float64(0.0)))

    def _point(self, problem: Problem) -> tuple[System, Callable[[], Inquiry] | None]:
        """Return what members with the same parameters share: their system, and how to certify them."""
        if problem.params not in self.known:
            judge = self.shares.certain if self.how.finish == "certified" else None
            certain = None if judge is None else judge(problem)
            self.known[problem.params] = (self.model.system(problem, True), certain)
            if len(self.known) > self.lanes + 1:  # members at one point follow one another
                self.known.pop(next(iter(self.known)))
        return self.known[problem.params]

    def _look(self, seat: _Seat, now: LaneState) -> CertainEnd | None:
        """Record the progress of a member, and return the verdict on it, or None."""
        t, tail = float(now.t), float(now.signs.tail)
        seat.looks.append((t, self.shares.look(now.signs)))
        if t >= seat.watch.patience:
            seat.tail = max(seat.tail, tail)
        seat.watch.look(t, {"spectral_tail": tail}, float(now.peak))
        return None if seat.inquiry is None else seat.inquiry.look(now.signs, t)

    def _leave(self, seat: _Seat, now: StepperState, verdict: CertainEnd | None) -> Outcome:
        """Return the outcome of a member whose regime is certain, or that has failed or reached its end."""
        status = "certified"
        if verdict is None:
            status = "diverged" if bool(now.failed) else "completed"
            if status == "completed":
                running = self.shares.with_values(self.devices[0], self.shares.values(seat.system))
                now = advance(running, self.control, now, self.t_end, np.int64(MOST_STEPS))
                status = "diverged" if bool(now.failed) else status
            state = self.model.state(self.grid, np.asarray(now.spectrum))
            found = ended(self.how.problem(self.members[seat.index]), state)
            verdict = CertainEnd(found.name, uncertain(status, found.rate), state, np.nan, 0.0)
        if status != "diverged" and seat.watch.time is not None:
            status = "underresolved"
        t = float(now.t)
        final = self.shares.look_of_state(verdict.state)
        since = final.since(seat.looks, t + verdict.relaxation) if verdict.regime != DISORDERED else np.nan
        return Outcome(
            regime=verdict.regime,
            status=status,
            reason=verdict.reason,
            t_final=t,
            t_order=since,
            state=verdict.state,
            eigenvalue=verdict.eigenvalue,
            tail=seat.tail,
            evaluations=int(now.evaluations),
            seconds=(clock.perf_counter() - seat.began) / self.lanes,
        )


def _kept(seats: list[_Seat | None]) -> npt.NDArray[np.intp] | None:
    """Return the lanes to keep once most are permanently idle; None if dropping lanes does not pay."""
    busy = np.array([seat is not None for seat in seats])
    count = int(busy.sum())
    if len(seats) <= FEW_LANES or count > len(seats) // 8:
        return None
    width = max(FEW_LANES, 2 ** (count - 1).bit_length())
    return np.argsort(~busy, kind="stable")[:width]


@jax.jit
def _lane(batch: Any, lane: Any) -> Any:
    """Return the values of one lane, or of several."""
    return jax.tree.map(lambda item: item[lane], batch)


def _idle(progress: StepperState) -> StepperState:
    """Return the state of a lane, marked as failed so that it stays unchanged."""
    return progress._replace(failed=jnp.asarray(True))


@partial(jax.jit, donate_argnums=0)
def _placed(batch: Any, one: Any, lane: Any) -> Any:
    """Replace the values of one lane in a batch."""
    return jax.tree.map(lambda all_lanes, value: all_lanes.at[lane].set(value), batch, one)
