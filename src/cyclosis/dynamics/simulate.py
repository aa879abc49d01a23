"""One run: from an initial state to a trajectory with a status."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..analysis.diagnostics import TAIL_FRACTION, measure
from ..model.errors import InputError
from ..model.filaments import TermLike, select_terms
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.system import System, system
from .advance import DIVERGED, Control, Progress, advance, start
from .frames import Frames
from .settings import Settings
from .steppers import RK4_STABILITY
from .trajectory import Effort, Status, Trajectory

UNDERRESOLVED_TAIL = 1e-2
"""Spectral tail (see the diagnostics) above which a run is marked underresolved."""
NOISE_DECAY = 1e-8
"""The tail is judged once diffusion alone has damped the initial noise in it by this factor."""
CHUNK_SECONDS = 0.2


@dataclass(frozen=True)
class Snapshot:
    """What a progress callback sees: the time reached, the end, the state, and the seconds spent."""

    t: float
    t_end: float
    state: Array
    wall_time: float


class _Watch:
    """Collects the signs of an under-resolved run: a heavy spectral tail or an overshoot of |P| = 1."""

    def __init__(self, cell: System, settings: Settings) -> None:
        k = TAIL_FRACTION * min(float(np.max(np.real(cell.space.K))), float(np.max(np.imag(cell.space.K))))
        damping = -float(np.max(np.asarray(_linear(cell.values, k))))
        self.patience = -np.log(NOISE_DECAY) / damping if damping > 0 else 0.0
        # Steps of finite accuracy may overshoot by about their tolerance; more is the grid's doing.
        self.overshoot = 1.0 + 1e-6 + (settings.rtol if settings.stepper == "adaptive" else 0.0)
        self.time: float | None = None
        self.sign = ""

    def look(self, t: float, tail: float, peak: float) -> None:
        if self.time is not None:
            return
        if t >= self.patience and tail > UNDERRESOLVED_TAIL:
            self.time, self.sign = t, f"the spectral tail is {tail:.1e} (limit {UNDERRESOLVED_TAIL:g})"
        elif peak > self.overshoot:
            self.time, self.sign = t, f"|P| overshoots 1 by {peak - 1:.1e}"


def _linear(values: Any, k: float) -> Any:
    return -values.d_s * k**2


def simulate(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    t_end: float = 200.0,
    save_every: float = 1.0,
    *,
    terms: Iterable[TermLike] | None = None,
    progress: Callable[[Snapshot], None] | None = None,
    **settings: Any,
) -> Trajectory:
    """Integrate the filament equation from `state` at t = 0 to `t_end`.

    state: P of shape (2, n_theta, n_z), |P| <= 1; its Nyquist modes are dropped. All times are
    dimensionless (R/U). Fields are saved every `save_every`, or at the times `save_at`, and quantities
    recorded there and every `record_every`; steps land on these times exactly. Further `settings`, with
    their defaults in `Settings`:

    * stepper: "adaptive" (exponential Runge-Kutta of order 4 with an embedded estimate, `rtol` and
      `atol` per step), "etdrk4" (the same with fixed `dt`) or "rk4" (the paper's; fixed `dt`).
    * dealias: "none", "quadratic", "cubic" or "full": how far products are padded; "full" removes all
      aliasing of this model's quartic terms.
    * precision: "float64" or "float32".
    * steady_rate: stop once <|dP/dt|²>^½ / <|P|²>^½ falls below it.

    `terms` selects terms by name and may hold the user's own, `term(t, P, u, params, grid)`. `progress`
    is called a few times a second. Ctrl-C ends the run with status "interrupted". Raises `InputError`
    for bad input; everything that happens later is a status of the `Trajectory`.

    Source: Woodhouse & Goldstein 2013; steppers see `cyclosis.dynamics.steppers`.
    """
    how = Settings(t_end=t_end, save_every=save_every, **_known(settings))
    P = grid.check_state(state, "the initial state", bounded=True)
    cell = system(params, grid, select_terms(terms), how.dealias, how.precision, split=how.stepper != "rk4")
    spectrum = cell.spectrum(P)
    largest = float(np.max(np.hypot(*cell.state(spectrum))))
    if largest > DIVERGED:
        raise InputError(
            "max |P| of the initial state without Nyquist modes",
            float(f"{largest:.4g}"),
            "at most 1",
            "smooth the state, or use a finer grid",
        )
    with double():
        return _Run(params, grid, how, cell, progress).go(spectrum)


def _known(settings: dict[str, Any]) -> dict[str, Any]:
    for name in settings:
        if name not in Settings.names():
            raise InputError("setting", name, "one of " + ", ".join(Settings.names()), "check the spelling")
    return settings


class _Run:
    """The state of one call of `simulate`."""

    def __init__(
        self,
        params: Parameters,
        grid: CylinderGrid,
        how: Settings,
        cell: System,
        progress: Callable[[Snapshot], None] | None,
    ) -> None:
        self.params, self.grid, self.how, self.cell, self.report = params, grid, how, cell, progress
        self.device_cell = jax.device_put(cell)
        self.began = clock.perf_counter()
        dtype = np.float32 if how.precision == "float32" else np.float64
        self.frames, self.times = Frames((2, *grid.shape), dtype), list[float]()
        self.record_times, self.records = list[float](), list[dict[str, Any]]()
        self.watch = _Watch(cell, how)
        self.control = Control(
            *(
                np.float64(x)
                for x in (how.rtol, how.atol, how.dt or _default_dt(how, cell), how.steady_rate or 0.0)
            )
        )

    def go(self, spectrum: npt.NDArray[Any]) -> Trajectory:
        """Integrate to the end and return the trajectory."""
        now = start(self.device_cell, spectrum, np.float64(0.0))
        save = set(self.how.save_times().tolist())
        status = Status.COMPLETED
        try:
            for target in self._targets():
                now = self._reach(now, target)
                t = float(now.t)
                if t < target:
                    status = Status.DIVERGED if bool(now.failed) else Status.STEADY
                    self._keep(now, save_field=True)
                    break
                self._keep(now, save_field=target in save)
        except _Interrupted as stop:
            status, now = Status.INTERRUPTED, stop.progress
            if not self.record_times or float(now.t) > self.record_times[-1]:
                self._keep(now, save_field=True)
        return self._trajectory(now, status)

    def _targets(self) -> list[float]:
        targets = self.how.record_times().tolist()
        return targets if targets[-1] == self.how.t_end else [*targets, self.how.t_end]

    def _reach(self, now: Progress, target: float) -> Progress:
        adaptive, steps = self.how.stepper == "adaptive", 8
        while float(now.t) < target:
            began = clock.perf_counter()
            try:
                now = advance(
                    self.device_cell, self.control, now, np.float64(target), np.int64(steps), adaptive
                )
                now.t.block_until_ready()
                if self.report is not None:
                    self.report(Snapshot(float(now.t), self.how.t_end, self._state(now), self._wall()))
            except KeyboardInterrupt:
                raise _Interrupted(now) from None
            if bool(now.failed) or float(now.rate) <= float(self.control.steady_rate):
                break
            spent = clock.perf_counter() - began
            steps = int(np.clip(steps * CHUNK_SECONDS / max(spent, 1e-9), 1, 4096))
        return now

    def _keep(self, now: Progress, save_field: bool) -> None:
        t = float(now.t)
        record = {name: np.asarray(v) for name, v in measure(self.device_cell, now.spectrum, now.t).items()}
        self.record_times.append(t)
        self.records.append(record)
        self.watch.look(t, float(record["spectral_tail"]), max(float(now.peak), float(record["max_P"])))
        if save_field:
            self.times.append(t)
            self.frames.append(self._state(now))

    def _state(self, now: Progress) -> Array:
        return self.cell.state(np.asarray(now.spectrum))

    def _wall(self) -> float:
        return clock.perf_counter() - self.began

    def _trajectory(self, now: Progress, status: Status) -> Trajectory:
        if status is Status.COMPLETED and self.watch.time is not None:
            status = Status.UNDERRESOLVED
        t = float(now.t)
        when = self.watch.time if status is Status.UNDERRESOLVED and self.watch.time is not None else t
        return Trajectory(
            params=self.params,
            grid=self.grid,
            settings=self.how,
            terms=self.cell.terms,
            times=np.array(self.times),
            frames=self.frames,
            record_times=np.array(self.record_times),
            records={name: np.stack([r[name] for r in self.records]) for name in self.records[0]}
            if self.records
            else {},
            status=status,
            status_time=when,
            message=_message(status, when, self.how, self.watch.sign),
            t_final=t,
            final_state=self._state(now),
            progress={name: np.asarray(value) for name, value in now._asdict().items()},
            effort=Effort(int(now.evaluations), int(now.accepted), int(now.rejected), self._wall()),
        )


class _Interrupted(Exception):
    """Carries the last good progress out of an interrupted run."""

    def __init__(self, progress: Progress) -> None:
        self.progress = progress


def _default_dt(how: Settings, cell: System) -> float:
    if how.stepper != "rk4":
        return 0.1
    stiffest = float(cell.values.d_s) * float(np.max(np.asarray(cell.space.k2))) + float(cell.values.d_r)
    # The local relaxation, about -2 alpha_p - alpha_u, adds to the stiffness of diffusion.
    local = 2 * float(np.max(cell.values.alpha_p)) + float(np.max(cell.values.alpha_u))
    return min(0.1, 0.9 * RK4_STABILITY / (stiffest + local + 1e-12))


def _message(status: Status, t: float, how: Settings, sign: str) -> str:
    if status is Status.COMPLETED:
        return f"Completed: reached t = {t:g}."
    if status is Status.STEADY:
        return f"Steady: at t = {t:g} the relative rate of change fell below {how.steady_rate:g}."
    if status is Status.INTERRUPTED:
        return f"Interrupted at t = {t:g}: what was saved until then is kept; start again to go on."
    if status is Status.UNDERRESOLVED:
        return f"Underresolved from t = {t:g}: {sign}; use more grid points, or dealias."
    cure = "use a smaller dt or the adaptive stepper" if how.stepper != "adaptive" else "use more grid points"
    return (
        f"Diverged after t = {t:g}: |P| would pass {DIVERGED:g} or no step is small enough; "
        f"the last good state is kept; {cure}, or lower epsilon."
    )
