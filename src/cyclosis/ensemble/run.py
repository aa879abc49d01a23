"""An ensemble: a member leaves its lane when its regime is certain, and the next one takes its place."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..analysis.regimes import regime
from ..dynamics.advance import Control, Progress, advance, start
from ..dynamics.run import NEVER, Watch
from ..model.errors import InputError
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import System, system
from .certainty import UNEVEN, Certainty, Doubt, Verdict
from .lanes import Signs, run_lanes, tables
from .looks import Look
from .members import UNCERTIFIED, EnsembleSettings, Member, Outcome, uncertain
from .scheduled import follow_scheduled

CPU_LANES = 1
"""Lanes on a CPU: with more, the working set leaves the fast cache."""
ACCELERATOR_BYTES = 8 * 2**30
"""Memory that lanes may take on an accelerator, by default."""
FIELDS_PER_LANE = 64
"""Complex fields that a lane keeps at work, roughly."""
FEW_LANES = 64
"""Lanes that an accelerator takes for the price of one at the usual sizes: no number of lanes falls below."""
ASK_AGAIN = 0.7
"""What was not certain is asked about again once its remnant has fallen, or t risen, by this factor."""
MOST_STEPS = 1_000_000


def follow(members: Sequence[Member], how: EnsembleSettings | None = None) -> list[Outcome]:
    """Follow every member to its certain final regime, or to t_end, and return their outcomes in order.

    With `finish = "certified"` a member leaves as soon as its final regime is certain (see
    `cyclosis.ensemble.certainty`); with "t_end" all are followed to t_end. Each member has its own adaptive
    step from the ladder 2^{j/2}; its outcome does not depend on the other members. Members may differ in
    everything; those that share grid, diffusion and flow operator share lanes. `lanes` sets how many run at
    once, by default one on a CPU and as many as 8 GiB hold on an accelerator. Members with a protocol are
    followed one by one.

    Raises `InputError` for states that do not fit their grid, and for a protocol where `finish` is
    "certified"; all that happens later is an outcome.

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
    pools: dict[Any, list[int]] = {}
    for index, member in enumerate(members):
        if not member.protocol:
            pools.setdefault(_shared(member.params, member.grid), []).append(index)
        elif how.finish == "certified":
            raise InputError("finish", how.finish, "t_end where there is a protocol", UNCERTIFIED)
    with double():
        for index, member in enumerate(members):
            if member.protocol:
                outcomes[index] = follow_scheduled(member, how)
        for indices in pools.values():
            for index, outcome in _Pool(members, indices, how).run():
                outcomes[index] = outcome
    return [outcome for outcome in outcomes if outcome is not None]


def default_lanes(grid: CylinderGrid, precision: str) -> int:
    """Return how many lanes suit the device that JAX computes on: one on a CPU, else what 8 GiB hold.

    Example:
        >>> import cyclosis as cy
        >>> cy.ensemble.default_lanes(cy.CylinderGrid(48, 48), "float64") >= 1
        True
    """
    if jax.default_backend() == "cpu":
        return CPU_LANES
    each = FIELDS_PER_LANE * grid.n_theta * grid.n_z * (16 if precision == "float64" else 8)
    return int(max(1, ACCELERATOR_BYTES // each))


def _shared(params: Parameters, grid: CylinderGrid) -> Any:
    """Return what members must have in common to share lanes."""
    built_in = (params.d_s, params.d_r, params.mu, params.zero_theta_flux, params.force_exponent == 2)
    fields = tuple(name for name, value in params.items() if isinstance(value, np.ndarray))
    # Fields are too large to be copied for every lane: only members with equal ones go together.
    return (grid, built_in, tuple((name, getattr(params, name).tobytes()) for name in fields))


@dataclass
class _Seat:
    """A member in a lane: what has been seen of it so far."""

    index: int
    cell: System
    certainty: Certainty | None
    began: float
    watch: Watch
    looks: list[tuple[float, Look]] = field(default_factory=list)
    ask_below: float = UNEVEN
    ask_after: float = np.inf
    remnant: float = np.inf
    tail: float = 0.0


class _Pool:
    """Members that share lanes."""

    def __init__(self, members: Sequence[Member], indices: list[int], how: EnsembleSettings) -> None:
        self.members, self.waiting, self.how = members, iter(indices), how
        self.grid = members[indices[0]].grid
        # A power of two where members are few, so that few programs are compiled.
        self.lanes = how.lanes or min(
            default_lanes(self.grid, how.precision), 2 ** (len(indices) - 1).bit_length()
        )
        self.device: System = jax.device_put(self._system(members[indices[0]].params))
        self.control = Control(*(np.float64(x) for x in (how.rtol, how.atol, 0.1, NEVER)))
        self.table = tables(self.device)
        self.t_end = np.float64(how.t_end)
        self.points: dict[Parameters, tuple[System, Certainty | None]] = {}

    def run(self) -> Iterator[tuple[int, Outcome]]:
        """Yield index and outcome of every member, as they end."""
        entries = [self._enter() for _ in range(self.lanes)]
        seats = [entry and entry[0] for entry in entries]
        # Lanes that nobody needs stand still: the compiled program is that of `lanes` all the same.
        first = next(entry for entry in entries if entry is not None)
        values = _stacked([(entry or first)[1] for entry in entries])
        batch = _stacked([entry[2] if entry else _idle(first[2]) for entry in entries])
        while any(seats):
            batch, signs = run_lanes(
                self.device.with_values(values), self.control, self.table, batch, self.t_end
            )
            seen = jax.device_get(signs)
            for lane, seat in enumerate(seats):
                if seat is None:
                    continue
                now = Signs(*(item[lane] for item in seen))
                verdict = self._look(seat, now)
                if verdict is None and not now.failed and not now.waits:
                    continue
                left = _lane(batch, lane)
                yield seat.index, self._leave(seat, left, verdict)
                entry = self._enter()
                seats[lane] = entry and entry[0]
                batch = _placed(batch, entry[2] if entry else _idle(left), lane)
                values = _placed(values, entry[1], lane) if entry else values
            kept = _kept(seats)
            if kept is not None:
                seats = [seats[lane] for lane in kept]
                values, batch = _lane(values, kept), _lane(batch, kept)

    def _enter(self) -> tuple[_Seat, Any, Progress] | None:
        """Make the next member ready: its seat, its couplings, and its state at t = 0."""
        index = next(self.waiting, None)
        if index is None:
            return None
        member, began = self.members[index], clock.perf_counter()
        cell, certainty = self._point(member.params)
        state = member.grid.check_state(member.state(), "the initial state", bounded=True)
        seat = _Seat(index, cell, certainty, began, Watch(cell, self.how.run))
        running = self.device.with_values(cell.values)
        return seat, cell.values, start(running, cell.spectrum(state), np.float64(0.0))

    def _point(self, params: Parameters) -> tuple[System, Certainty | None]:
        """Return what members at the same parameters share."""
        if params not in self.points:
            certainty = None
            if self.how.finish == "certified":
                certainty = Certainty(params, self.grid, terms=self.how.terms, dealias=self.how.dealias)
            self.points[params] = (self._system(params), certainty)
            if len(self.points) > self.lanes + 1:  # members at one point come one after another
                self.points.pop(next(iter(self.points)))
        return self.points[params]

    def _system(self, params: Parameters) -> System:
        return system(params, self.grid, self.how.terms, self.how.dealias, self.how.precision)

    def _look(self, seat: _Seat, now: Signs) -> Verdict | None:
        """Take note of a member, and return what is certain of it."""
        t = float(now.t)
        seat.looks.append((t, Look.of_signs(now)))
        if t >= seat.watch.patience:
            seat.tail = max(seat.tail, float(now.tail))
        seat.watch.look(t, float(now.tail), float(now.peak))
        certainty = seat.certainty
        if certainty is None:
            return None
        verdict = certainty.disordered(now)
        remnant = certainty.remnant(now)
        if remnant > UNEVEN:
            seat.ask_below, seat.ask_after = UNEVEN, np.inf
        elif verdict is None and (remnant <= seat.ask_below or t >= seat.ask_after):
            found = certainty.judge(now, fading=remnant < seat.remnant)
            verdict = found if isinstance(found, Verdict) else None
            lasting = found is Doubt.LASTING
            seat.ask_below = 0.0 if lasting else ASK_AGAIN * remnant
            seat.ask_after = np.inf if lasting else t / ASK_AGAIN
        seat.remnant = remnant
        return verdict

    def _leave(self, seat: _Seat, now: Progress, verdict: Verdict | None) -> Outcome:
        """Return the outcome of a member whose regime is certain, or which has failed or come to its end."""
        status = "certified"
        if verdict is None:
            status = "diverged" if bool(now.failed) else "completed"
            if status == "completed":
                running = self.device.with_values(seat.cell.values)
                now = advance(running, self.control, now, self.t_end, np.int64(MOST_STEPS))
                status = "diverged" if bool(now.failed) else status
            state = seat.cell.state(np.asarray(now.spectrum))
            found = regime(self.members[seat.index].params, self.grid, state, self.how.terms)
            verdict = Verdict(found.name, uncertain(status, found.rate), state, np.nan, 0.0)
        if status != "diverged" and seat.watch.time is not None:
            status = "underresolved"
        t = float(now.t)
        final = Look.of_state(verdict.state)
        since = final.since(seat.looks, t + verdict.relaxation) if verdict.regime != "disordered" else np.nan
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


def _stacked(items: list[Any]) -> Any:
    # On the host: a program that joins thousands of arrays takes minutes to compile.
    return jax.tree.map(lambda *leaves: jnp.asarray(np.stack([np.asarray(leaf) for leaf in leaves])), *items)


def _kept(seats: list[_Seat | None]) -> npt.NDArray[np.intp] | None:
    """Return the lanes to go on with once most stand still for good; None if not worth it."""
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


def _idle(progress: Progress) -> Progress:
    """Return a lane's progress, marked so that it stands still."""
    return progress._replace(failed=jnp.asarray(True))


@partial(jax.jit, donate_argnums=0)
def _placed(batch: Any, one: Any, lane: Any) -> Any:
    """Put one lane's values in their place."""
    return jax.tree.map(lambda all_lanes, value: all_lanes.at[lane].set(value), batch, one)
