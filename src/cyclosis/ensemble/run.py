"""Running an ensemble: a member leaves its lane when its regime is certain, and the next one takes it."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..contract.members import CertainEnd, Inquiry, Look
from ..contract.model import Problem
from ..contract.system import System
from ..dynamics.advance import Control, StepperState, advance, start
from ..dynamics.watch import Watch
from ..model.devices import require_devices
from ..model.doors import door
from ..model.errors import InputError
from ..model.precision import double
from ..model.reporting import Progress, counted, reported
from .axial_lanes import levels, run_axial_lane
from .lanes import LaneState, lane_state, run_lanes, stacked, tables
from .members import (
    DISORDERED,
    UNCERTIFIED,
    EnsembleSettings,
    Member,
    Outcome,
    ended,
    refuse_adaptive,
    uncertain,
)
from .packing import Packing
from .scheduled import follow_scheduled
from .scheduled_lanes import ScheduledLanes

CPU_LANES = 1
"""Lanes on a CPU: with more, the working set does not fit into the fast cache."""
ACCELERATOR_BYTES = 8 * 2**30
"""Memory that lanes may use on an accelerator, by default."""
FIELDS_PER_LANE = 64
"""Approximate number of complex fields that a lane needs."""
FEW_LANES = 64
"""Smallest number of lanes on an accelerator: at the usual sizes they cost no more than one."""
MOST_STEPS = 1_000_000


@door
def follow(
    members: Sequence[Member], how: EnsembleSettings | None = None, *, progress: Progress = None
) -> list[Outcome]:
    """Integrate every member until its final regime is certain, or to t_end, and return outcomes in order.

    With `finish = "certified"` a member ends as soon as its final regime is certain (see
    `cyclosis.ensemble.certainty`); with "t_end" all are integrated to t_end. Each member has its own adaptive
    step from the ladder 2^{j/2}; its outcome does not depend on the other members. Members may differ in
    everything; those with the same grid, diffusion and flow operator share lanes. `lanes` sets how many run
    at once, by default one on a CPU and as many as fit into 8 GiB on an accelerator. Members with a protocol
    share lanes too, whatever the times and values of its steps. `progress` shows a bar in a terminal or a
    notebook unless it is False; a function is called with the numbers of members done and in all.

    Raises `InputError` for states that do not fit their grid, for a protocol if `finish` is "certified" or
    `axial_resolution` "adaptive", and for models that do not allow these; problems that occur later are
    outcomes.

    Example:
        >>> import cyclosis as cy
        >>> grid, params = cy.CylinderGrid(16, 16), cy.Parameters(alpha_p=0.5, d_s=0.1)
        >>> starts = [cy.initial.stripes(grid, magnitude=0.9), cy.initial.unidirectional(grid, 0.9)]
        >>> members = [cy.ensemble.Member(params, grid, lambda P=P: P) for P in starts]
        >>> [(found.regime, found.status) for found in cy.ensemble.follow(members)]  # both are stable
        [('cyclosis', 'certified'), ('unidirectional', 'certified')]
    """
    how = how or EnsembleSettings()
    outcomes: list[Outcome | None] = [None] * len(members)
    alone: list[int] = []
    pools: dict[Any, list[int]] = {}
    scheduled: dict[tuple[Any, int], list[int]] = {}
    for index, member in enumerate(members):
        lanes = member.model.lanes
        if how.finish == "certified" and member.protocol:
            raise InputError("finish", how.finish, "t_end where there is a protocol", UNCERTIFIED)
        if how.axial_resolution == "adaptive":
            refuse_adaptive(member.model, bool(member.protocol))
        if how.finish == "certified" and not member.model.certifies:
            rule = f"t_end with the model {member.model.wording}, whose final regimes cannot be certified"
            raise InputError("finish", how.finish, rule, "set it so")
        if lanes is not None and member.protocol:
            width = how.lanes or default_lanes(member.grid, how.precision)
            scheduled.setdefault((member.model, width), []).append(index)
        elif lanes is None:
            alone.append(index)
        else:
            pools.setdefault((member.model, lanes.shared(member.params, member.grid)), []).append(index)

    def singly(indices: Sequence[int]) -> Iterator[tuple[int, Outcome]]:
        return ((index, follow_scheduled(members[index], how)) for index in indices)

    with double(), reported(progress, "follow", counted) as report:
        parts = [singly(alone)]
        for (_, width), indices in scheduled.items():
            # One lane needs no stacking: its member is integrated like a single run.
            lanes_of = ScheduledLanes(members, indices, how, width)
            parts.append(singly(indices) if width == 1 else lanes_of.run())
        parts += [_Pool(members, indices, how).run() for indices in pools.values()]
        for done, (index, outcome) in enumerate(chain.from_iterable(parts), 1):
            outcomes[index] = outcome
            if report is not None:
                report(done, len(members))
    return [outcome for outcome in outcomes if outcome is not None]


@door
def default_lanes(grid: Any, precision: str) -> int:
    """Return how many lanes suit the device that JAX uses: one on a CPU, else as many as fit into 8 GiB.

    Example:
        >>> import cyclosis as cy
        >>> cy.ensemble.default_lanes(cy.CylinderGrid(48, 48), "float64") >= 1
        True
    """
    require_devices()
    if jax.default_backend() == "cpu":
        return CPU_LANES
    each = FIELDS_PER_LANE * int(np.prod(grid.shape)) * (16 if precision == "float64" else 8)
    return int(max(1, ACCELERATOR_BYTES // each))


@dataclass
class _Seat:
    """The member in a lane, and what has been recorded about it so far.

    `usable`, `place` and `last_place` are those of its axial points, see `run_axial_lane`.
    """

    index: int
    system: System
    inquiry: Inquiry | None
    began: float
    watch: Watch
    usable: int
    looks: list[tuple[float, Look]] = field(default_factory=list)
    tail: float = 0.0
    place: int = 0
    last_place: int = 0


class _Entry(NamedTuple):
    """The start of a member in a lane: its seat, the values of its system, and its state at t = 0."""

    seat: _Seat
    values: Any
    state: StepperState


class _Pool:
    """Members that share lanes."""

    def __init__(self, members: Sequence[Member], indices: list[int], how: EnsembleSettings) -> None:
        self.members, self.waiting, self.how = members, iter(indices), how
        first = members[indices[0]]
        assert first.model.lanes is not None
        self.model, self.grid, self.shares = first.model, first.grid, first.model.lanes
        # A power of two if there are few members, so that few programs are compiled.
        self.lanes = how.lanes or min(
            default_lanes(self.grid, how.precision), 2 ** (len(indices) - 1).bit_length()
        )
        self.device: System = jax.device_put(self.model.system(how.problem(first), True))
        self.control: Control = jax.device_put(Control.of(how.rtol, how.atol, self.model.bound))
        self.table = tables(self.device)
        self.t_end = np.float64(how.t_end)
        self.axial = self.shares.axial if how.axial_resolution == "adaptive" else None
        self.levels = () if self.axial is None else levels(how.problem(first), self.axial)
        self.axial_points = () if self.axial is None else (self.grid.n_z, *self.axial.fewer(self.grid))
        self.points: dict[Any, tuple[System, Callable[[], Inquiry] | None]] = {}

    def run(self) -> Iterator[tuple[int, Outcome]]:
        """Yield index and outcome of every member, as they end."""
        entries = [self._enter() for _ in range(self.lanes)]
        seats = [None if entry is None else entry.seat for entry in entries]
        # Lanes without a member are idle: the compiled program always has `lanes` lanes.
        first = next(entry for entry in entries if entry is not None)
        values = stacked([(entry or first).values for entry in entries])
        batch = stacked([_idle(first.state) if entry is None else entry.state for entry in entries])
        shapes: Any = lane_state
        packing = Packing(shapes.eval_shape(self.device, first.state, self.t_end, how=self.shares))
        while any(seats):
            batch, states = self._steps(seats, values, batch)
            seen = np.asarray(states)
            for lane, seat in enumerate(seats):
                if seat is None:
                    continue
                now: LaneState = packing.unpacked(seen[lane])
                verdict = self._look(seat, now)
                if verdict is None and not now.failed and not now.waits:
                    continue
                left = _lane(batch, lane)
                yield seat.index, self._leave(seat, left, verdict)
                entry = self._enter()
                seats[lane] = None if entry is None else entry.seat
                batch = _placed(batch, _idle(left) if entry is None else entry.state, lane)
                values = values if entry is None else _placed(values, entry.values, lane)
            kept = _kept(seats)
            if kept is not None:
                seats = [seats[lane] for lane in kept]
                values, batch = _lane(values, kept), _lane(batch, kept)

    def _steps(
        self, seats: list[_Seat | None], values: Any, batch: StepperState
    ) -> tuple[StepperState, jax.Array]:
        """Try some steps in every lane."""
        control, t_end, how = self.control, self.t_end, self.shares
        seat = seats[0]
        if self.axial is None or seat is None:
            systems = self.shares.with_values(self.device, values)
            return run_lanes(systems, control, self.table, batch, t_end, how=how)
        level, changed, usable = self.levels[seat.place], seat.place != seat.last_place, seat.usable
        seat.last_place = seat.place
        return run_axial_lane(
            level,
            self.device,
            values,
            control,
            batch,
            changed,
            usable,
            t_end,
            how=how,
            points=self.axial_points,
            place=seat.place,
        )

    def _enter(self) -> _Entry | None:
        """Prepare the next member: its seat, its couplings, and its state at t = 0."""
        index = next(self.waiting, None)
        if index is None:
            return None
        member, began = self.members[index], clock.perf_counter()
        problem = self.how.problem(member)
        system, certain = self._point(problem)
        state = self.model.check_state(member.grid, member.state(), "the initial state")
        watch = Watch(problem, system, self.how.run)
        usable = 0 if self.axial is None else self.axial.usable(member.params, member.grid)
        seat = _Seat(index, system, None if certain is None else certain(), began, watch, usable)
        values = self.shares.values(system)
        running = self.shares.with_values(self.device, values)
        return _Entry(seat, values, start(running, self.model.modes(system, state), np.float64(0.0)))

    def _point(self, problem: Problem) -> tuple[System, Callable[[], Inquiry] | None]:
        """Return what members with the same parameters share: their system, and how to certify them."""
        if problem.params not in self.points:
            judge = self.shares.certain if self.how.finish == "certified" else None
            certain = None if judge is None else judge(problem)
            self.points[problem.params] = (self.model.system(problem, True), certain)
            if len(self.points) > self.lanes + 1:  # members at one point follow one another
                self.points.pop(next(iter(self.points)))
        return self.points[problem.params]

    def _look(self, seat: _Seat, now: LaneState) -> CertainEnd | None:
        """Record the progress of a member, and return the verdict on it, or None."""
        t, tail = float(now.t), float(now.signs.tail)
        seat.place = int(now.level)
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
                running = self.shares.with_values(self.device, self.shares.values(seat.system))
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
    if len(seats) <= FEW_LANES:
        return None
    busy = np.array([seat is not None for seat in seats])
    count = int(busy.sum())
    if count > len(seats) // 8:
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
