"""One run: from an initial state to a trajectory with a status, and on from there."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.filaments import Term, TermLike, select_terms
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from .advance import DIVERGED
from .course import Course
from .protocol import Protocol, Step
from .run import Run, Snapshot
from .settings import Settings
from .steppers import METHODS
from .trajectory import Status, Trajectory

CHECKPOINT_SECONDS = 30.0


def simulate(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    t_end: float = 200.0,
    save_every: float = 1.0,
    *,
    protocol: Protocol | Iterable[Step] | None = None,
    terms: Iterable[TermLike] | None = None,
    progress: Callable[[Snapshot], None] | None = None,
    checkpoint: Callable[[Trajectory], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
    provenance: Mapping[str, Any] | None = None,
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

    `protocol` says what is done to the cell on its way (see `cyclosis.Protocol`); steps land on its times
    exactly, and what lies beyond `t_end` waits for `resume`. With a `steady_rate` the run stops as steady
    only once nothing more is to be done.

    `terms` selects terms by name and may hold the user's own, `term(t, P, u, params, grid)`. `progress`
    is called a few times a second. `checkpoint` gets the run so far at the start and then every
    `checkpoint_seconds`, which changes no step; a file writer for it is `cyclosis.RunWriter`.
    `provenance` is kept with the run; of it a file keeps `initial` alone. Ctrl-C ends the run with status
    "interrupted". Raises `InputError` for bad input; everything that happens later is a status of the
    `Trajectory`.

    Source: Woodhouse & Goldstein 2013; steppers see `cyclosis.dynamics.steppers`.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.unidirectional(grid, 0.1), t_end=40.0, save_every=10.0)
        >>> run.times
        array([ 0., 10., 20., 30., 40.])
        >>> run.records["order"].round(4)  # tends to (1 - d_r/α_p)^½
        array([0.1   , 0.9874, 0.9874, 0.9874, 0.9874])
    """
    how = Settings(t_end=t_end, save_every=save_every, **_known(settings))
    P = grid.check_state(state, "the initial state", bounded=True)
    course = _course(params, grid, _protocol(protocol), select_terms(terms), how)
    cell = course.system(0)
    spectrum = cell.spectrum(P)
    largest = float(np.max(np.hypot(*cell.state(spectrum))))
    if largest > DIVERGED:
        raise InputError(
            "max |P| of the initial state without Nyquist modes",
            float(f"{largest:.4g}"),
            "at most 1",
            "smooth the state, or use a finer grid",
        )
    origin = dict(provenance or {}) | {"initial_sha256": hashlib.sha256(P.tobytes()).hexdigest()}
    with double():
        run = Run(course, how, origin, progress, checkpoint, checkpoint_seconds)
        return run.go(run.begin(spectrum))


def resume(
    run: Trajectory,
    t_end: float | None = None,
    *,
    terms: Iterable[TermLike] | None = None,
    progress: Callable[[Snapshot], None] | None = None,
    checkpoint: Callable[[Trajectory], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
) -> Trajectory:
    """Continue a run to `t_end` (default: where it was to end), bitwise as if it had never stopped.

    Bitwise, that is, if the run stopped at one of the times that are saved on the way to the new end,
    or was interrupted. Returns the whole trajectory. `terms` are needed again if the user wrote some.
    Raises `InputError` for a run that has diverged or already reached `t_end`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> whole = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=4.0)
        >>> half = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> bool(np.array_equal(cy.resume(half, t_end=4.0).final_state, whole.final_state))
        True
    """
    end = run.settings.t_end if t_end is None else t_end
    how = dataclasses.replace(run.settings, t_end=end)
    if run.status in (Status.DIVERGED, Status.STEADY):
        remedy = "start a new run from one of its frames"
        raise InputError("status", str(run.status), "that of a run that can go on", remedy)
    finished = run.status is not Status.INTERRUPTED
    if (finished and end <= run.t_final) or end < run.t_final:
        raise InputError("t_end", end, f"later than the time reached, {run.t_final:g}", "raise it")
    chosen = run.terms if terms is None else select_terms(terms)
    course = _course(run.params, run.grid, run.protocol, chosen, how)
    with double():
        onward = Run(course, how, run.provenance, progress, checkpoint, checkpoint_seconds)
        return onward.go(onward.restore(run))


def _course(
    params: Parameters, grid: CylinderGrid, protocol: Protocol, terms: tuple[Term, ...], how: Settings
) -> Course:
    exact = METHODS[how.stepper].exact
    return Course(params, grid, protocol, terms, how.dealias, how.precision, split=exact)


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
