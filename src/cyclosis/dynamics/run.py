"""The course of one run: towards its saved times, chunk by chunk, watching for trouble."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import TAIL_FRACTION, measure
from ..model.grid import Array
from ..model.spectral import dtypes
from ..model.system import System
from .advance import Control, Progress, advance, start
from .course import Course, Intervention
from .frames import Frames
from .interrupts import Interrupts
from .restart import Restart
from .settings import Settings
from .steppers import METHODS
from .trajectory import Effort, Status, Trajectory

UNDERRESOLVED_TAIL = 1e-2
"""Spectral tail (see the diagnostics) above which a run is marked underresolved."""
NOISE_DECAY = 1e-8
"""The tail is judged once diffusion alone has damped the initial noise in it by this factor."""
CHUNK_SECONDS = 0.2
NEVER = -1.0
"""A rate that no state falls below, not even one that does not change at all."""


@dataclass(frozen=True)
class Snapshot:
    """What a progress callback sees: the time reached, the end, the state, and the seconds spent.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> seen = []
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0, progress=seen.append)
        >>> seen[-1].t, seen[-1].t_end, seen[-1].state.shape
        (1.0, 1.0, (2, 16, 16))
    """

    t: float
    t_end: float
    state: Array
    wall_time: float


class Watch:
    """The first sign of an under-resolved run: a heavy spectral tail or an overshoot of |P| = 1."""

    def __init__(self, cell: System, settings: Settings) -> None:
        self.patience = _decay_time(cell)
        self.blind_until = 0.0
        # Steps of finite accuracy may overshoot by about their tolerance; more is the grid's doing.
        self.overshoot = 1.0 + 1e-6 + (settings.rtol if METHODS[settings.stepper].adaptive else 0.0)
        self.time: float | None = None
        self.sign = ""

    def disturbed(self, t: float, cell: System) -> None:
        """Look away until what an intervention has left of noise and sharp edges has diffused."""
        self.blind_until = self.patience = t + _decay_time(cell)

    def look(self, t: float, tail: float, peak: float) -> None:
        """Take note of a recorded instant."""
        if self.time is not None or t < self.blind_until:
            return
        if t >= self.patience and tail > UNDERRESOLVED_TAIL:
            self.time, self.sign = t, f"the spectral tail is {tail:.1e} (limit {UNDERRESOLVED_TAIL:g})"
        elif peak > self.overshoot:
            self.time, self.sign = t, f"|P| overshoots 1 by {peak - 1:.1e}"


def _decay_time(cell: System) -> float:
    """Return the time in which diffusion alone damps noise in the spectral tail."""
    k = TAIL_FRACTION * min(float(np.max(cell.space.m)), float(np.max(cell.space.q)))
    diffuses = any(term.name == "diffusion" for term in cell.terms)
    damping = float(cell.values.d_s) * k**2 if diffuses else 0.0
    return -np.log(NOISE_DECAY) / damping if damping > 0 else 0.0


class Run:
    """One call of `simulate` or `resume`: begin or restore, then go."""

    def __init__(
        self,
        course: Course,
        how: Settings,
        provenance: dict[str, Any],
        report: Callable[[Snapshot], None] | None,
        checkpoint: Callable[[Trajectory], None] | None,
        checkpoint_seconds: float,
    ) -> None:
        self.course, self.how, self.provenance, self.report = course, how, provenance, report
        self.done, self.interventions = 0, list[Intervention]()
        cell = course.system(0)
        self.cell: System = jax.device_put(cell)
        self.checkpoint, self.checkpoint_seconds = checkpoint, checkpoint_seconds
        self.began = self.last_checkpoint = clock.perf_counter()
        self.spent = 0.0
        self.frames, self.times = Frames((2, *course.grid.shape), dtypes(how.precision)[0]), list[float]()
        self.record_times, self.records = list[float](), list[dict[str, Any]]()
        self.watch = Watch(cell, how)
        stages = (0,) if METHODS[how.stepper].exact else range(len(course.times) + 1)
        dt = how.dt or min(default_dt(how, course.system(k)) for k in stages)
        numbers = (np.float64(x) for x in (how.rtol, how.atol, dt, NEVER))
        self.control = Control(*numbers)

    def begin(self, spectrum: npt.NDArray[Any]) -> Progress:
        """Return the start of a new run at t = 0."""
        return start(self.cell, spectrum, np.float64(0.0))

    def restore(self, run: Trajectory) -> Progress:
        """Take over what an earlier run saved, and return where it stood."""
        self.times, self.record_times = run.times.tolist(), run.record_times.tolist()
        self.frames = run.frames.copy()
        self.records = [{n: v[i] for n, v in run.records.items()} for i in range(run.record_times.size)]
        self.watch.time, self.watch.sign = run.restart.sign_time, run.restart.sign
        self.spent = run.restart.wall_time
        self.done, self.interventions = run.restart.done, list(run.interventions)
        self.cell = jax.device_put(self.course.system(self.done))
        for number in range(self.done):
            if self.course.schedule.disturbs(number):
                self.watch.disturbed(self.course.times[number], self.course.system(number + 1))
        return run.restart.to_progress()

    def go(self, now: Progress) -> Trajectory:
        """Integrate to the end and return the trajectory."""
        save, record = set(self.how.save_times().tolist()), set(self.how.record_times().tolist())
        status = Status.COMPLETED
        self._save(now)
        with Interrupts() as interrupts:
            for target in self._targets(now):
                now = self._reach(now, target, interrupts)
                if float(now.t) < target:
                    status = self._why(now)
                    if status is not Status.INTERRUPTED:
                        self._keep(now, save_field=True)
                    break
                now = self._intervene(now)
                if target in record:
                    self._keep(now, save_field=target in save)
        return self.trajectory(now, status)

    def _targets(self, now: Progress) -> list[float]:
        """Times to reach, less those that are behind."""
        times = np.union1d(self.how.record_times(), [self.how.t_end]).tolist()
        last = self.record_times[-1] if self.record_times else -1.0
        events = [t for t in self.course.times[self.done :] if t <= self.how.t_end]
        return sorted({t for t in times if t > last and t >= float(now.t)}.union(events))

    def _intervene(self, now: Progress) -> Progress:
        """Do what the protocol does at the time that is reached."""
        while self.done < len(self.course.times) and self.course.times[self.done] == float(now.t):
            now, note = self.course.intervene(now, self.done)
            self.done += 1
            self.cell = jax.device_put(self.course.system(self.done))
            if note is not None:
                self.interventions.append(note)
                self.watch.disturbed(note.time, self.cell)
        return now

    def _reach(self, now: Progress, target: float, interrupts: Interrupts) -> Progress:
        method, steps = METHODS[self.how.stepper], 8
        steady = self.how.steady_rate if self._may_settle() else None
        control = self.control._replace(
            steady_rate=np.float64(NEVER if steady is None else steady), bound=self.course.bound(self.done)
        )
        while float(now.t) < target and not interrupts.asked:
            began = clock.perf_counter()
            now = advance(self.cell, control, now, np.float64(target), np.int64(steps), method)
            now.t.block_until_ready()
            steps = int(np.clip(steps * CHUNK_SECONDS / (clock.perf_counter() - began), 1, 4096))
            try:
                if self.report is not None:
                    self.report(Snapshot(float(now.t), self.how.t_end, self._state(now), self._wall()))
            except KeyboardInterrupt:
                interrupts.asked = True
            if bool(now.failed) or self._steady(now):
                break
            if clock.perf_counter() - self.last_checkpoint >= self.checkpoint_seconds:
                self._save(now)
        return now

    def _steady(self, now: Progress) -> bool:
        rate = self.how.steady_rate
        return rate is not None and self._may_settle() and float(now.rate) <= rate

    def _may_settle(self) -> bool:
        """Whether nothing more is to be done: until then no state is the last."""
        return self.done == len(self.course.times)

    def _why(self, now: Progress) -> Status:
        if bool(now.failed):
            return Status.DIVERGED
        return Status.STEADY if self._steady(now) else Status.INTERRUPTED

    def _keep(self, now: Progress, save_field: bool) -> None:
        t = float(now.t)
        if self.record_times[-1:] != [t]:  # a run may stop where it has just been recorded
            record = {name: np.asarray(v) for name, v in measure(self.cell, now.spectrum, now.t).items()}
            self.record_times.append(t)
            self.records.append(record)
            peak = float(record["max_P"])
            if not self.interventions:  # after one, the largest |P| so far may be that of a sharp edge
                peak = max(peak, float(now.peak))
            self.watch.look(t, float(record["spectral_tail"]), peak)
        if save_field and self.times[-1:] != [t]:
            self.times.append(t)
            self.frames.append(self._state(now))

    def _save(self, now: Progress) -> None:
        """Hand the run so far to the checkpoint; a run found there was interrupted."""
        if self.checkpoint is not None:
            self.checkpoint(self.trajectory(now, Status.INTERRUPTED))
        self.last_checkpoint = clock.perf_counter()

    def _state(self, now: Progress) -> Array:
        """Return the state that is reached, to the bit as an intervention left it."""
        if self.interventions and self.interventions[-1].time == float(now.t):
            return self.interventions[-1].after
        return self.cell.state(np.asarray(now.spectrum))

    def _wall(self) -> float:
        return self.spent + clock.perf_counter() - self.began

    def trajectory(self, now: Progress, status: Status) -> Trajectory:
        """Return what the run has come to."""
        if status in (Status.COMPLETED, Status.STEADY) and self.watch.time is not None:
            status = Status.UNDERRESOLVED
        t = float(now.t)
        when = self.watch.time if status is Status.UNDERRESOLVED and self.watch.time is not None else t
        names = self.records[0] if self.records else {}
        return Trajectory(
            params=self.course.params,
            grid=self.course.grid,
            settings=self.how,
            terms=self.cell.terms,
            times=np.array(self.times),
            frames=self.frames,
            record_times=np.array(self.record_times),
            records={name: np.stack([record[name] for record in self.records]) for name in names},
            status=status,
            status_time=when,
            message=_message(status, when, self.how, self.watch.sign, self.course.bound(self.done)),
            t_final=t,
            final_state=self._state(now),
            restart=Restart.of(now, self.watch.time, self.watch.sign, self._wall(), self.done),
            effort=Effort(int(now.evaluations), int(now.accepted), int(now.rejected), self._wall()),
            provenance=self.provenance,
            protocol=self.course.protocol,
            interventions=tuple(self.interventions),
        )


def default_dt(how: Settings, cell: System) -> float:
    """Return the step of a fixed stepper that was given none."""
    method = METHODS[how.stepper]
    if method.exact:
        return 0.1
    stiffest = float(cell.values.d_s) * float(np.max(np.asarray(cell.space.k2))) + float(cell.values.d_r)
    # The local relaxation, about -2 alpha_p - alpha_u - kappa, adds to the stiffness of diffusion.
    values = cell.values
    local = sum(float(np.max(value)) for value in (2 * values.alpha_p, values.alpha_u, values.kappa))
    return min(0.1, 0.9 * method.stability / (stiffest + local + 1e-12))


def _message(status: Status, t: float, how: Settings, sign: str, bound: float) -> str:
    if status is Status.COMPLETED:
        return f"Completed: reached t = {t:g}."
    if status is Status.STEADY:
        return f"Steady: at t = {t:g} the relative rate of change fell below {how.steady_rate:g}."
    if status is Status.INTERRUPTED:
        return f"Interrupted at t = {t:g}: what was saved until then is kept; resume to go on."
    if status is Status.UNDERRESOLVED:
        return f"Underresolved from t = {t:g}: {sign}; use more grid points, or dealias."
    adaptive = METHODS[how.stepper].adaptive
    cure = "use more grid points" if adaptive else "use a smaller dt or the adaptive stepper"
    return (
        f"Diverged after t = {t:g}: |P| would pass {bound:g} or no step is small enough; "
        f"the last good state is kept; {cure}, or lower epsilon."
    )
