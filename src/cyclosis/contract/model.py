"""A model as one value: its equation prepared for the stepper, and the meaning of its states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from ..display.shown import shown

if TYPE_CHECKING:
    from .members import Lanes, Starts, Variable
    from .system import System

Array = npt.NDArray[Any]
Times = Mapping[str, tuple[float, float]]
"""The beginning and the end of every ramp, by the name of the parameter."""
TermLike = Any
"""A term as a user gives it: a name, a term of the model, or a custom function."""


@shown
@dataclass(frozen=True)
class Quantity:
    """One number of a state: its name, symbol, further dimensions, unit, meaning, and function.

    Example:
        >>> import cyclosis as cy
        >>> for item in cy.diagnostics.QUANTITIES[7:10]:
        ...     print(f"{item.name} = {item.symbol}: {item.meaning}")
        power_input = <F·u>: power that the filaments' force puts into the flow
        viscous_dissipation = μ <|∇u|²>: power dissipated by viscosity
        friction_dissipation = <|u|²>: power dissipated by friction with the wall
    """

    name: str
    symbol: str
    dims: tuple[str, ...]
    unit: str
    meaning: str
    compute: Callable[[Any, Any], Any]


FIELD = "field"
"""Type of variables that are stored as the fields of a run: in its precision, frame by frame."""


@dataclass(frozen=True)
class Stored:
    """What is stored of every frame: its name, the dimensions beyond time, meaning and type.

    The type is `FIELD`, or that of small numbers, "float64" or "int64".
    """

    name: str
    dims: tuple[str, ...]
    meaning: str
    dtype: str = FIELD


@shown
@dataclass(frozen=True)
class Coordinate:
    """The values along a dimension of what is stored, and their meaning."""

    values: npt.NDArray[Any]
    meaning: str


@dataclass(frozen=True)
class Geometry:
    """Something that follows from a grid and is stored once: its dimensions, values and meaning."""

    dims: tuple[str, ...]
    values: npt.NDArray[Any]
    meaning: str


def fields_of(grid: Any) -> dict[str, Any]:
    """Return the fields of a grid by name: its [grid] table, for grids that are made of numbers alone."""
    return {item.name: getattr(grid, item.name) for item in fields(grid)}


@dataclass(frozen=True)
class Problem:
    """What defines a right-hand side: parameters on a grid, active terms, dealiasing and precision.

    `shape` is that of the state, where it does not follow from the grid.
    """

    model: Model
    params: Any
    grid: Any
    terms: tuple[Any, ...]
    dealias: str = "none"
    precision: str = "float64"
    shape: tuple[int, ...] | None = None

    def at(self, params: Any) -> Problem:
        """Return the same problem at other parameters."""
        return replace(self, params=params)


@shown
@dataclass(frozen=True, eq=False)
class Model:
    """One physics: data, and functions of a `Problem`. `cyclosis.models` lists those there are.

    `parameters` and `grid` are the classes of its arguments; `grid_of(**table)` makes a grid of a [grid]
    table, by default its class, and `table_of` gives that table. Parameters have `items()`,
    `replace(**values)` and `require_grid(grid)`, and can be compared; a grid is a frozen dataclass with a
    `shape`.

    The equation. `terms` selects the terms that act. `system` prepares a problem for a stepper, with its
    linear terms separate from the rest or not; `ramped` does so for parameters that change from those of one
    problem to those of another. `modes` gives the modes of a state, without those that the model leaves out;
    `whole_modes` gives all of them, for the state after an intervention; `state` is the state of modes on a
    grid. A run has diverged when max |P| exceeds `bound`, or `sharp_bound` once an intervention has cut its
    state. `stiffness` is about the largest |eigenvalue| of the right-hand side.

    States. `check_state` returns a state as an array or refuses it. `largest` is max |P| of the part of a
    state that the model represents. `act` applies a step of a protocol to a state, given the seed of the
    protocol. `measure` returns all `quantities` of modes at a time. `tails` names those that show that a
    resolution is too coarse, with their limits, judged once `decay_time` has passed, and `remedies` what some
    of them call for; `peak` names max |P|. `finer` says in words which grid is fine enough. `flow` gives the
    flow that modes drive, if the model has any. `regime` returns the regime of a state, with its `name`, one
    of `regimes`, its relative `rate` of change, and `details` in words. With `lanes` the members of an
    ensemble are integrated together, without them one by one. `starts` makes initial states for
    configurations. A sweep stores `member_variables`, of which `member_row(member, outcome)` gives those that
    are not quantities of the final state.

    Files. `stored` lists what is stored of every frame, first the state itself (complex ones as pairs along a
    first dimension); `coordinates(grid, shape)` has the values along its dimensions, given the shape of a
    state, or None where that follows from the grid. `derive` returns a function of (params, state) that gives
    the rest of `stored` by name. `options` are what a [model] table says of the model. `attributes` are
    further ones of a file, and `geometry` is what it stores of the grid; `title` and `source` name what is in
    it. `caption` describes a grid, and `picture` draws a state for a notebook.
    """

    name: str
    title: str
    source: str
    parameters: type[Any]
    grid: type[Any]
    terms: Callable[[Iterable[TermLike] | None], tuple[Any, ...]]
    system: Callable[[Problem, bool], System]
    ramped: Callable[[Problem, Problem, Times, bool], System]
    modes: Callable[[Any, Array], Array]
    whole_modes: Callable[[Any, Array], Array]
    state: Callable[[Any, npt.ArrayLike], Array]
    check_state: Callable[[Any, Any, str], Array]
    act: Callable[[Any, Array, Any, int], Array]
    largest: Callable[[Array], float]
    bound: float
    sharp_bound: float
    stiffness: Callable[[Any], float]
    quantities: tuple[Quantity, ...]
    measure: Callable[[Any, Any, Any], dict[str, Any]]
    tails: dict[str, float]
    peak: str
    decay_time: Callable[[Any], float]
    finer: Callable[[Any, Any], str]
    stored: tuple[Stored, ...]
    coordinates: Callable[[Any, tuple[int, ...] | None], dict[str, Coordinate]]
    derive: Callable[[Problem], Callable[[Any, Array], dict[str, Any]]]
    remedies: Mapping[str, str] = field(default_factory=dict)
    regimes: tuple[str, ...] = ()
    regime: Callable[[Problem, Array], Any] | None = None
    lanes: Lanes | None = None
    starts: Starts | None = None
    member_variables: tuple[Variable, ...] = ()
    member_row: Callable[[Any, Any], dict[str, Any]] = field(default=lambda member, outcome: {})
    flow: Callable[[Any, Any, Any], Array] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    attributes: Callable[[Any], dict[str, Any]] = field(default=lambda grid: {})
    geometry: Callable[[Any], dict[str, Geometry]] = field(default=lambda grid: {})
    grid_of: Callable[..., Any] | None = None
    table_of: Callable[[Any], dict[str, Any]] = field(default=fields_of)
    caption: Callable[[Any], str] = field(default=str)
    picture: Callable[[Any, Array], str] = field(default=lambda grid, state: "")

    def __repr__(self) -> str:
        return f"cyclosis.models.{self.name}"

    def problem(
        self,
        params: Any,
        grid: Any,
        terms: Iterable[TermLike] | None = None,
        dealias: str = "none",
        precision: str = "float64",
        shape: tuple[int, ...] | None = None,
    ) -> Problem:
        """Return a problem of this model. Raises `InputError` for terms that it does not have."""
        return Problem(self, params, grid, self.terms(terms), dealias, precision, shape)

    def grid_from(self, table: Mapping[str, Any]) -> Any:
        """Return the grid of a [grid] table. Raises `InputError` for what it cannot have."""
        return (self.grid_of or self.grid)(**table)

    @property
    def certifies(self) -> bool:
        """Whether there is a theory by which final regimes can be certified."""
        return self.lanes is not None and self.lanes.certain is not None

    @property
    def wording(self) -> str:
        """The model and its options in words."""
        if not self.options:
            return self.name
        settings = {n: str(v).lower() if isinstance(v, bool) else v for n, v in self.options.items()}
        return f"{self.name} with " + ", ".join(f"{n} = {v}" for n, v in settings.items())

    @property
    def state_name(self) -> str:
        """The name under which states are stored."""
        return self.stored[0].name
