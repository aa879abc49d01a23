"""The input and output of an ensemble: members, settings of their integration, and outcomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ..contract.model import Array, Model, Problem
from ..display.shown import shown
from ..dynamics.protocol import Protocol
from ..dynamics.schedule import Schedule
from ..dynamics.settings import Settings
from ..model.definitions import definition
from ..model.doors import door, required
from ..model.errors import InputError, choice, whole
from ..model.instants import instant
from ..models import polar

OUTCOMES = ("certified", "completed", "underresolved", "diverged")
"""How a member ended: regime certain, t_end reached, one of these on too coarse a grid, or diverged."""
FINISH = ("certified", "t_end")
"""When a member is done: once its final regime is certain (or at t_end), or always at t_end."""
AXIAL_RESOLUTION = ("fixed", "adaptive")
"""Whether members keep all axial points, or only as many as their state needs."""
UNCERTIFIED = "set it so: a final regime is not certain if the protocol may still change it"
"""The remedy if members with a protocol were to be certified."""
MAX_LANES = 1_048_576
DISORDERED = "disordered"
"""The regime that is never reached at a definite time: order decays forever."""


@shown
@dataclass(frozen=True)
class Member:
    """One cell: parameters, grid, a function that makes its initial state, its protocol, and its model.

    The state (2, n_theta, n_z), |P| <= 1, is made only when the member is started. Raises `InputError` if
    arguments are in the wrong order.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> member = cy.ensemble.Member(cy.Parameters(), grid, lambda: cy.initial.stripes(grid))
        >>> member.params_at(10.0).alpha_p, member.state().shape
        (1.0, (2, 16, 16))
    """

    params: Any
    grid: Any
    state: Callable[[], Array]
    protocol: Protocol = field(default_factory=Protocol)
    model: Model = polar

    def __post_init__(self) -> None:
        call = "write Member(params, grid, state), with a function that makes the state"
        required("params", self.params, call, self.model)
        required("grid", self.grid, call, self.model)
        if not callable(self.state):
            raise InputError(
                "state", self.state, "a function that makes the initial state", "write lambda: state"
            )

    @door
    def params_at(self, t: float) -> Any:
        """Return the parameters that are active at time t, after the protocol has acted."""
        return Schedule(self.params, self.grid, self.protocol).params_at(t) if self.protocol else self.params


@shown
@dataclass(frozen=True)
class EnsembleSettings:
    """How members are integrated; see `cyclosis.ensemble.follow`. Times are dimensionless (R/U).

    With `axial_resolution = "adaptive"` a member has at each time only as many points along the axis as its
    waves along it need, at most n_z, and one lane.

    Example:
        >>> import cyclosis as cy
        >>> how = cy.ensemble.EnsembleSettings(t_end=500.0, finish="t_end")
        >>> how.t_end, how.run.save_times()
        (500.0, array([  0., 500.]))
    """

    t_end: float = 2000.0
    finish: str = "certified"
    precision: str = "float64"
    rtol: float = 1e-4
    atol: float = 1e-10
    dealias: str = "none"
    terms: tuple[str, ...] | None = None
    lanes: int | None = None
    axial_resolution: str = "fixed"

    def __post_init__(self) -> None:
        object.__setattr__(self, "t_end", instant(definition("run", "t_end").check(self.t_end)))
        choice("finish", self.finish, FINISH)
        choice("axial_resolution", self.axial_resolution, AXIAL_RESOLUTION)
        if self.lanes is not None:
            whole("lanes", self.lanes, 1, MAX_LANES, "leave it out to suit the device")
        if self.axial_resolution == "adaptive":
            if self.lanes not in (None, 1):
                rule = "1 with adaptive axial resolution, where members have different numbers of points"
                raise InputError("lanes", self.lanes, rule, "leave it out")
            object.__setattr__(self, "lanes", 1)
        _ = self.run  # checks everything else
        if self.t_end == 0:
            raise InputError("t_end", self.t_end, "greater than 0", "raise it")

    @property
    def run(self) -> Settings:
        """The same settings for a single run that saves only its first and last state."""
        return Settings(
            t_end=self.t_end,
            save_every=max(self.t_end, 1e-6),
            precision=self.precision,
            rtol=self.rtol,
            atol=self.atol,
            dealias=self.dealias,
        )

    def problem(self, member: Member, shape: tuple[int, ...] | None = None) -> Problem:
        """Return the problem of a member, with its initial parameters and the shape of its state.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 16)
            >>> member = cy.ensemble.Member(cy.Parameters(), grid, lambda: cy.initial.stripes(grid))
            >>> cy.ensemble.EnsembleSettings().problem(member).model
            cyclosis.models.polar
        """
        terms, dealias, precision = self.terms, self.dealias, self.precision
        return member.model.problem(member.params, member.grid, terms, dealias, precision, shape)


@shown
@dataclass(frozen=True, eq=False)
class Outcome:
    """How one member ended; all numbers are dimensionless.

    `regime` is one of `REGIMES`, `status` one of `OUTCOMES`, `reason` says in a few words why the
    regime is certain, or why it is not. `t_final` is the time up to which the two-dimensional equations were
    integrated, `t_order` the time since which the state has looked like its final regime (NaN for disorder
    and if it never settled). `state` (2, n_theta, n_z) is the final state: the steady state itself if the
    member is certain to reach it. `eigenvalue` is the largest growth rate of perturbations of it (NaN if it
    was not computed), `tail` the largest spectral tail after the initial noise had decayed. `evaluations` of
    the right-hand side and `seconds` are the cost.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> weak = cy.Parameters(alpha_p=0.02, d_r=0.025)  # α_p < d_r: order can only decay
        >>> member = cy.ensemble.Member(weak, grid, lambda: cy.initial.disordered(grid))
        >>> [found] = cy.ensemble.follow([member])
        >>> found.regime, found.status, found.reason
        ('disordered', 'certified', 'alpha_p is at most d_r and the order too weak ever to grow')
        >>> found.state.shape, found.profile.shape
        ((2, 16, 16), (2, 16))
    """

    regime: str
    status: str
    reason: str
    t_final: float
    t_order: float
    state: Array
    eigenvalue: float
    tail: float
    evaluations: int
    seconds: float

    @property
    def profile(self) -> Array:
        """The axial mean of the final state, (2, n_theta)."""
        mean: Array = self.state.mean(axis=2)
        return mean


def refuse_adaptive(model: Model, protocol: bool) -> None:
    """Raise `InputError` if members of this model, or with a protocol, must keep all axial points."""
    name, remedy = "axial_resolution", "leave it out"
    if protocol:
        raise InputError(name, "adaptive", "fixed where there is a protocol, which may act anywhere", remedy)
    if model.lanes is None or model.lanes.axial is None:
        raise InputError(name, "adaptive", f"fixed with the model {model.wording}", remedy)


def ended(problem: Problem, state: Array) -> Any:
    """Return the regime of a member's final state; one without a name if its model has no regimes."""
    regime = problem.model.regime
    return NoRegime() if regime is None else regime(problem, state)


@dataclass(frozen=True)
class NoRegime:
    """The regime of a state of a model that has no regimes."""

    name: str = ""
    rate: float = float("nan")


def uncertain(status: str, rate: float) -> str:
    """Return why the regime of a member that has "diverged" or "completed" is not certain."""
    if status == "diverged":
        return "no step was small enough, or |P| exceeded its bound; the last good state is kept"
    return f"at t_end, where its relative rate of change was {rate:.1e}"
