"""One run: from an initial state to a trajectory with a status, and its continuation."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy.typing as npt

from ..contract.model import Model, TermLike
from ..contract.system import LocalSystem
from ..model.doors import door
from ..model.errors import InputError
from ..model.instants import instant
from ..model.precision import double
from ..model.reporting import Progress, reported
from ..model.scales import Scales
from ..model.units import table_of
from ..model.wording import beside
from ..models import of_grid
from .course import Course
from .protocol import Protocol, Step
from .run import Run, Snapshot
from .settings import Settings
from .steppers import METHODS
from .trajectory import Status, Trajectory

CHECKPOINT_SECONDS = 30.0


@door
def simulate(
    params: Any,
    grid: Any,
    state: npt.ArrayLike,
    t_end: float = 200.0,
    save_every: float = 1.0,
    *,
    model: Model | None = None,
    protocol: Protocol | Iterable[Step] | None = None,
    terms: Iterable[TermLike] | None = None,
    progress: Progress = None,
    checkpoint: Callable[[Trajectory], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
    provenance: Mapping[str, Any] | None = None,
    scales: Scales | None = None,
    **settings: Any,
) -> Trajectory:
    """Integrate the equation of a model from `state` at t = 0 to `t_end`: by default the filament equation.

    Without a `model` it is that of the grid: `cyclosis.models.polar`, or `closed` for a `ClosedGrid`.

    state: P of shape (2, n_theta, n_z), |P| <= 1; its Nyquist modes are dropped. All times are
    dimensionless (R/U) and rounded to 12 significant digits, so that times that mean the same are equal.
    Fields are saved every `save_every`, or at the times `save_at`, and quantities recorded there and every
    `record_every`; steps land on these times exactly. Further `settings`, with their defaults in `Settings`:

    * stepper: "adaptive" (exponential Runge-Kutta of order 4 with an embedded estimate, `rtol` and
      `atol` per step), "multistep" (linearly implicit, one right-hand side per step, with `rtol` and `atol`
      too: a third of the right-hand sides for a run to t = 200, see `docs/numerics.md`), "etdrk4" (the first
      with fixed `dt`) or "rk4" (the paper's; fixed `dt`).
    * dealias: "none", "quadratic", "cubic" or "full": how far products are padded; "full" removes all
      aliasing of this model's quartic terms.
    * precision: "float64" or "float32".
    * steady_rate: stop once <|dP/dt|²>^½ / <|P|²>^½ has stayed below it for a time of 10 without rising more
      than a tenth above its least value. That does not show that the state is stable: what grows may still
      be too small to be seen in the rate.

    `protocol` says what is done to the cell during the run (see `cyclosis.Protocol`); steps land on its times
    exactly, and its steps after `t_end` wait for `resume`. With a `steady_rate` the run stops as steady
    only once the protocol is finished.

    `terms` selects terms by name and may contain custom ones, `term(t, P, u, params, grid)`, or
    `term(t, m, u, params, grid)` of the moments in the kinetic model. `progress` shows a bar
    in a terminal or a notebook unless it is False; a function is called with a `Snapshot` a few times a
    second. Neither changes a result. `checkpoint` gets the run so far at the start and then every
    `checkpoint_seconds`, which changes no step; a file writer for it is `cyclosis.RunWriter`. `provenance` is
    kept with the run; a file keeps only its `initial`. `scales` are kept too, so that figures, summaries and
    exports of the run are in micrometres and seconds; they change no result.

    Ctrl-C, or a KeyboardInterrupt raised by `progress`, stops the run at its next safe point: `checkpoint`
    gets the run so far, and KeyboardInterrupt is raised with that run as its attribute `run`, of status
    "interrupted". SIGTERM, and signals with a custom handler, act after such a checkpoint as they would
    without it; if a handler returns, the run continues. A second signal acts at once. Raises `InputError`
    for bad input; any other outcome is a status of the `Trajectory`.

    Source: Woodhouse & Goldstein 2013; steppers see `cyclosis.dynamics.steppers`.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.unidirectional(grid, 0.1), t_end=40.0, save_every=10.0)
        >>> run.times
        array([ 0., 10., 20., 30., 40.])
        >>> run.records["order"].round(4)  # tends to (1 - d_r/α_p)^½
        array([0.1   , 0.9874, 0.9874, 0.9874, 0.9874])

        >>> def stop(now):
        ...     raise KeyboardInterrupt  # as Ctrl-C does
        >>> try:
        ...     run = cy.simulate(params, grid, run.frames[0], t_end=40.0, progress=stop)
        ... except KeyboardInterrupt as stopped:
        ...     run = stopped.run
        >>> print(run.status, cy.resume(run).status)
        interrupted completed
    """
    how = Settings(t_end=t_end, save_every=save_every, **_known(settings))
    model = of_grid(grid) if model is None else model
    P = model.check_state(grid, state, "the initial state")
    course = _course(model, params, grid, terms, how, _protocol(protocol), P.shape)
    largest = model.largest(P)
    if largest > model.bound:
        raise InputError(
            "max |P| of the initial state without Nyquist modes",
            float(beside(largest, 1.0, 4)),
            "at most 1",
            "smooth the state, or use a finer grid",
        )
    origin = dict(provenance or {}) | {"initial_sha256": hashlib.sha256(P.tobytes()).hexdigest()}
    if scales is not None:
        origin["scales"] = table_of(scales)
    with double(), reported(progress, "simulate", _told) as report:
        return Run(course, how, origin, report, checkpoint, checkpoint_seconds).begin(P)


@door
def resume(
    run: Trajectory,
    t_end: float | None = None,
    *,
    terms: Iterable[TermLike] | None = None,
    progress: Progress = None,
    checkpoint: Callable[[Trajectory], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
) -> Trajectory:
    """Continue a run to `t_end` (default: its planned end), bit for bit as if it had never stopped.

    That is exact if the run stopped at one of the times that are saved on the way to the new end, or was
    interrupted. Returns the whole trajectory. `terms` are needed again if some are custom.
    Raises `InputError` for other terms, and for a run that has diverged or already reached `t_end`, and
    KeyboardInterrupt as `simulate`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> whole = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=4.0)
        >>> half = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> bool(np.array_equal(cy.resume(half, t_end=4.0).final_state, whole.final_state))
        True
    """
    how = dataclasses.replace(run.settings, t_end=run.settings.t_end if t_end is None else t_end)
    end, reached = how.t_end, instant(run.t_final)
    if run.status in (Status.DIVERGED, Status.STEADY):
        remedy = "start a new run from one of its frames"
        raise InputError("status", str(run.status), "that of a run that can continue", remedy)
    finished = run.status is not Status.INTERRUPTED
    if (finished and end <= reached) or end < reached:
        raise InputError("t_end", end, f"later than the time reached, {beside(reached, end)}", "raise it")
    chosen = run.terms if terms is None else _same(run, run.model.terms(terms))
    shape = run.final_state.shape
    course = _course(run.model, run.params, run.grid, chosen, how, run.protocol, shape)
    with double(), reported(progress, "resume", _told) as report:
        return Run(course, how, run.provenance, report, checkpoint, checkpoint_seconds).restore(run)


def _told(now: Snapshot) -> tuple[float, str]:
    """Return the share of a run that is done, and the time reached."""
    return now.t / now.t_end if now.t_end else 1.0, f"t = {now.t:.1f} of {now.t_end:g}"


def _course(
    model: Model,
    params: Any,
    grid: Any,
    terms: Iterable[TermLike] | None,
    how: Settings,
    protocol: Protocol,
    shape: tuple[int, ...],
) -> Course:
    problem = model.problem(params, grid, terms, how.dealias, how.precision, shape)
    method = METHODS[how.stepper]
    course = Course(problem, protocol, split=method.exact)
    if method.begin is not None and not isinstance(course.system(0), LocalSystem):
        others = ", ".join(name for name, other in METHODS.items() if other.begin is None)
        rule = f"for this model ({model.wording}) one of {others}"
        raise InputError("stepper", how.stepper, rule, "leave it out for the adaptive one")
    return course


def _same(run: Trajectory, chosen: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the terms to continue with, whose names must be those of the run."""
    own, found = ([term.name for term in terms] for terms in (run.terms, chosen))
    if found != own:
        rule = "those of the run: " + ", ".join(own)
        raise InputError("terms", found, rule, "give the same terms in this order, or begin a new run")
    return chosen


def _protocol(given: Protocol | Iterable[Step] | None) -> Protocol:
    if given is None:
        return Protocol()
    if isinstance(given, Protocol):
        return given
    if not isinstance(given, Iterable) or isinstance(given, str):
        raise InputError(
            "protocol", given, "a Protocol", "write cyclosis.Protocol(cyclosis.change(...), ...)"
        )
    return Protocol(*given)


def _known(settings: dict[str, Any]) -> dict[str, Any]:
    for name in settings:
        if name not in Settings.names():
            raise InputError("setting", name, "one of " + ", ".join(Settings.names()), "check the spelling")
    return settings
