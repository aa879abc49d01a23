"""One run: integrated to its saved times in stretches, with checks of resolution, signals and checkpoints."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contract.model import Array
from ..display.shown import shown
from ..model.instants import instant
from ..model.precision import dtypes
from .advance import NEVER, USUAL_STEP, Control
from .course import Course, Intervention
from .follow import Follower
from .frames import Frames
from .interrupts import Interrupts
from .restart import Restart
from .settings import Settings
from .steppers import METHODS, Method
from .trajectory import Effort, Status, Trajectory
from .verdicts import message
from .watch import Watch

CHUNK_SECONDS = 0.2


@shown
@dataclass(frozen=True)
class Snapshot:
    """What a progress callback gets: the time reached, the end, the state, and the seconds spent.

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
        self.interventions = list[Intervention]()
        self.checkpoint, self.checkpoint_seconds = checkpoint, checkpoint_seconds
        self.began = self.last_checkpoint = clock.perf_counter()
        self.spent = 0.0
        self.times = list[float]()
        self.record_times, self.records = list[float](), list[dict[str, Any]]()
        self.watch = Watch(course.problem, course.system(0), how)
        method = METHODS[how.stepper]
        rate = NEVER if how.steady_rate is None else how.steady_rate
        dt = how.dt or default_dt(method, course)
        control = Control.of(how.rtol, how.atol, course.bound(0), dt, rate)
        self.follower = Follower(course, control, method, seconds=CHUNK_SECONDS)

    def begin(self, state: Array) -> Trajectory:
        """Begin a new run at t = 0, and integrate it as `go` does."""
        model = self.course.problem.model
        self.frames = Frames(state.shape, dtypes(self.how.precision)[np.iscomplexobj(state)])
        self.follower.begin(model.modes(self.course.system(0), state))
        return self.go()

    def restore(self, run: Trajectory) -> Trajectory:
        """Take over what an earlier run saved, and continue from there as `go` does."""
        self.times, self.record_times = run.times.tolist(), run.record_times.tolist()
        self.frames = run.frames.copy()
        self.records = [{n: v[i] for n, v in run.records.items()} for i in range(run.record_times.size)]
        self.watch.time, self.watch.sign = run.restart.sign_time, run.restart.sign
        self.spent = run.restart.wall_time
        self.interventions = list(run.interventions)
        self.follower.take_up(run.restart.to_stepper_state(), run.restart.done)
        if self.interventions:
            self.follower.note = self.interventions[-1]
        for number in range(run.restart.done):
            if self.course.schedule.disturbs(number):
                self.watch.disturbed(self.course.times[number], self.course.system(number + 1))
        return self.go()

    def go(self) -> Trajectory:
        """Integrate to the end and return the trajectory. Raises KeyboardInterrupt for Ctrl-C."""
        save, record = set(self.how.save_times().tolist()), set(self.how.record_times().tolist())
        status = Status.COMPLETED
        self._save()
        with Interrupts() as interrupts:
            for target in self._targets():
                self._reach(target, interrupts)
                if self.follower.t < target:
                    status = Status.DIVERGED if self.follower.failed else Status.STEADY
                    self._keep(save_field=True)
                    break
                self._intervene()
                if target in record:
                    self._keep(save_field=target in save)
            run = self.trajectory(status)
            if interrupts.asked:
                self._save_and_deliver(run, interrupts)
        return run

    def _targets(self) -> list[float]:
        """Times still to be reached."""
        times = np.union1d(self.how.record_times(), [self.how.t_end]).tolist()
        # Times that an earlier version stored may not be rounded yet.
        last = instant(self.record_times[-1]) if self.record_times else -1.0
        now = self.follower
        events = [t for t in self.course.times[now.done :] if t <= self.how.t_end]
        return sorted({t for t in times if t > last and t >= instant(now.t)}.union(events))

    def _intervene(self) -> None:
        """Do what the protocol does at the time reached."""
        note = self.follower.intervene()
        if note is not None:
            self.interventions.append(note)
            self.watch.disturbed(note.time, self.follower.system)

    def _reach(self, target: float, interrupts: Interrupts) -> None:
        now = self.follower
        while now.can_go(target):
            if interrupts.asked:
                self._save_and_deliver(self.trajectory(Status.INTERRUPTED), interrupts)
            now.advance(target)
            try:
                if self.report is not None:
                    self.report(Snapshot(now.t, self.how.t_end, now.state, self._wall()))
            except KeyboardInterrupt as stop:
                interrupts.wait(stop)
            due = clock.perf_counter() - self.last_checkpoint >= self.checkpoint_seconds
            if due and not now.ended:
                self._save()

    def _save_and_deliver(self, run: Trajectory, interrupts: Interrupts) -> None:
        """Save, and deliver the deferred signal: a handler of the user may return."""
        if self.checkpoint is not None:
            self.checkpoint(run)
        interrupts.deliver(run)

    def _keep(self, save_field: bool) -> None:
        now, t = self.follower.now, self.follower.t
        if self.record_times[-1:] != [t]:  # a run may stop at a time that was just recorded
            model = self.course.problem.model
            found = model.measure(self.follower.system, now.spectrum, now.t)
            record = {name: np.asarray(value) for name, value in found.items()}
            self.record_times.append(t)
            self.records.append(record)
            peak = float(record[model.peak])
            if not self.interventions:  # after one, the largest |P| so far may be that of a sharp edge
                peak = max(peak, float(now.peak))
            self.watch.look(t, record, peak)
        if save_field and self.times[-1:] != [t]:
            self.times.append(t)
            self.frames.append(self.follower.state)

    def _save(self) -> None:
        """Pass the run so far to the checkpoint, as an interrupted one."""
        if self.checkpoint is not None:
            self.checkpoint(self.trajectory(Status.INTERRUPTED))
        self.last_checkpoint = clock.perf_counter()

    def _wall(self) -> float:
        return self.spent + clock.perf_counter() - self.began

    def trajectory(self, status: Status) -> Trajectory:
        """Return the run so far."""
        now = self.follower.now
        if status in (Status.COMPLETED, Status.STEADY) and self.watch.time is not None:
            status = Status.UNDERRESOLVED
        t = float(now.t)
        when = self.watch.time if status is Status.UNDERRESOLVED and self.watch.time is not None else t
        names = self.records[0] if self.records else {}
        problem = self.course.problem
        return Trajectory(
            model=problem.model,
            params=problem.params,
            grid=problem.grid,
            settings=self.how,
            terms=problem.terms,
            times=np.array(self.times),
            frames=self.frames,
            record_times=np.array(self.record_times),
            records={name: np.stack([record[name] for record in self.records]) for name in names},
            status=status,
            status_time=when,
            message=message(status, when, self.how, self.course, self.follower.done, self.watch.sign),
            t_final=t,
            final_state=self.follower.state,
            restart=Restart.of(now, self.watch.time, self.watch.sign, self._wall(), self.follower.done),
            effort=Effort(int(now.evaluations), int(now.accepted), int(now.rejected), self._wall()),
            provenance=self.provenance,
            protocol=self.course.protocol,
            interventions=tuple(self.interventions),
        )


def default_dt(method: Method, course: Course) -> float:
    """Return the default step of a fixed stepper: one that is stable in all stages."""
    if method.exact:
        return USUAL_STEP
    stiffness = course.problem.model.stiffness
    stages = range(len(course.times) + 1)
    return min(
        min(USUAL_STEP, 0.9 * method.stability / (stiffness(course.system(k)) + 1e-12)) for k in stages
    )
