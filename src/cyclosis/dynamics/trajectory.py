"""The result of a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from ..contract.model import Array, Model
from ..display.notebook import text_tree, tree
from ..display.shown import shown
from ..model.doors import door
from ..model.units import of_table
from ..models import polar
from .course import Intervention
from .frames import Frames
from .protocol import Protocol
from .restart import Restart
from .schedule import Schedule
from .settings import Settings

if TYPE_CHECKING:
    import xarray

    from ..figures.plot import Plot
    from ..model.scales import Scales


class Status(StrEnum):
    """How a run ended: a text, with its `meaning`.

    Example:
        >>> import cyclosis as cy
        >>> cy.Status.COMPLETED == "completed", cy.Status.COMPLETED.meaning
        (True, 'the run reached t_end')
    """

    COMPLETED = "completed"
    STEADY = "steady"
    DIVERGED = "diverged"
    UNDERRESOLVED = "underresolved"
    INTERRUPTED = "interrupted"

    @property
    def meaning(self) -> str:
        """What the status says."""
        return _MEANING[self]


_MEANING = {
    Status.COMPLETED: "the run reached t_end",
    Status.STEADY: "for a time of 10 the rate of change stayed below steady_rate and did not grow",
    Status.DIVERGED: "|P| left its bound of 1 or no step was small enough; the last good state is kept",
    Status.UNDERRESOLVED: "the run reached its end but the grid was too coarse for it",
    Status.INTERRUPTED: "the run was stopped before t_end and can be resumed",
}


@shown
@dataclass(frozen=True)
class Effort:
    """What a run cost: right-hand sides evaluated, steps, and seconds on the clock."""

    evaluations: int
    accepted: int
    rejected: int
    wall_time: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One run: its input, its results, and how it ended.

    `times` (n,) and `frames` (n arrays P of shape (2, n_theta, n_z)) are the saved fields;
    `record_times` (k,) and `records` (arrays (k, ...) by name) the recorded quantities of
    `cyclosis.diagnostics.QUANTITIES`. `status` is a `Status`, reached at `status_time`, with a
    `message` that says what to do; `t_final` and `final_state` are where the run stopped, and
    `restart` is all that is needed to continue. `provenance` describes the origin of the initial state.
    `protocol` is what was to be done during the run, `params` are the parameters before it and
    `params_at(t)` those at a time. A frame or record at the time of a step is after it; `interventions`
    has the states just before and just after each time at which steps acted on the state. `model` is the
    physics. Everything is dimensionless.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> run.ok, run.message, len(run.frames), run.frames[-1].shape
        (True, 'Completed: reached t = 2.', 3, (2, 16, 16))
        >>> run.params_at(1.0) == params
        True
        >>> dict(run.to_dataset()["P"].sizes)
        {'time': 3, 'component': 2, 'theta': 16, 'z': 16}
    """

    params: Any
    grid: Any
    settings: Settings
    terms: tuple[Any, ...]
    times: Array
    frames: Frames
    record_times: Array
    records: dict[str, npt.NDArray[Any]]
    status: Status
    status_time: float
    message: str
    t_final: float
    final_state: Array
    restart: Restart
    effort: Effort
    provenance: dict[str, Any]
    protocol: Protocol = field(default_factory=Protocol)
    interventions: tuple[Intervention, ...] = ()
    model: Model = polar

    @door
    def params_at(self, t: float) -> Any:
        """Return the parameters at time t, after any steps of the protocol at that time."""
        return self._schedule.params_at(t)

    @property
    def scales(self) -> Scales | None:
        """The physical units in which the run is shown, or None; the run itself is dimensionless.

        Example:
            >>> import cyclosis as cy
            >>> grid, cell = cy.CylinderGrid(16, 16), cy.Scales(radius_um=500.0, speed_um_per_s=75.0)
            >>> run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), t_end=0.5, scales=cell)
            >>> round(run.scales.seconds(run.t_final), 2)
            3.33
        """
        return of_table(self.provenance.get("scales", {}))

    @cached_property
    def _schedule(self) -> Schedule:
        return Schedule(self.params, self.grid, self.protocol)

    @property
    def ok(self) -> bool:
        """Whether the run did what was requested: it completed, or became steady and was to stop there."""
        return self.status in (Status.COMPLETED, Status.STEADY)

    @property
    def plot(self) -> Plot:
        """Figures of the run: `run.plot()`, and `run.plot` has `snapshot`, `history`, `movie`.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), t_end=1.0)
            >>> type(run.plot.snapshot(1.0, view="map")).__name__
            'Figure'
        """
        from ..figures.plot import Plot

        return Plot(self)

    def to_dataset(self) -> xarray.Dataset:
        """Return the run as an `xarray.Dataset` in memory, as a file of it would be read."""
        from ..dataset import to_dataset

        return to_dataset(self)

    def _branches(self) -> tuple[str, list[tuple[str, str]]]:
        effort, began = self.effort, self.times[0] if self.times.size else 0
        return f"Trajectory: {self.status} at t = {self.status_time:g}", [
            ("grid", self.model.caption(self.grid)),
            (
                "frames",
                f"{len(self.frames)} fields, {self.record_times.size} records, "
                f"t = {began:g} to {self.t_final:g}",
            ),
            (
                "effort",
                f"{effort.evaluations} right-hand sides, {effort.accepted} steps, "
                f"{effort.rejected} rejected, {effort.wall_time:.2f} s",
            ),
            ("final", f"max |P| = {self.model.largest(self.final_state):.3f}"),
        ]

    def __repr__(self) -> str:
        return text_tree(*self._branches())

    def _repr_html_(self) -> str:
        return tree(*self._branches(), self.model.picture(self.grid, self.final_state))
