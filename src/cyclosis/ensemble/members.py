"""What goes into an ensemble and what comes out: members, how they are followed, outcomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ..dynamics.protocol import Protocol
from ..dynamics.schedule import Schedule
from ..dynamics.settings import Settings
from ..model.definitions import definition
from ..model.errors import InputError, choice, whole
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters

OUTCOMES = ("certified", "completed", "underresolved", "diverged")
"""How a member ended: regime certain, t_end reached, either of them on too coarse a grid, or diverged."""
FINISH = ("certified", "t_end")
"""When a member is done: once its final regime is certain (or at t_end), or always at t_end."""
UNCERTIFIED = "set it so: what is certain of a cell is no longer so once something is done to it"
"""What to do where members with a protocol were to be certified."""
MAX_LANES = 1_048_576


@dataclass(frozen=True)
class Member:
    """One cell to follow: parameters, grid, a function that makes its initial state, and its protocol.

    The state (2, n_theta, n_z), |P| <= 1, is made only when the member's turn comes.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> member = cy.ensemble.Member(cy.Parameters(), grid, lambda: cy.initial.stripes(grid))
        >>> member.params_at(10.0).alpha_p, member.state().shape
        (1.0, (2, 16, 16))
    """

    params: Parameters
    grid: CylinderGrid
    state: Callable[[], Array]
    protocol: Protocol = field(default_factory=Protocol)

    def params_at(self, t: float) -> Parameters:
        """Return the parameters in force at time t, after whatever the protocol does then."""
        return Schedule(self.params, self.grid, self.protocol).params_at(t) if self.protocol else self.params


@dataclass(frozen=True)
class EnsembleSettings:
    """How members are followed; see `cyclosis.ensemble.follow`. Times are dimensionless (R/U).

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

    def __post_init__(self) -> None:
        object.__setattr__(self, "t_end", definition("run", "t_end").check(self.t_end))
        choice("finish", self.finish, FINISH)
        if self.lanes is not None:
            whole("lanes", self.lanes, 1, MAX_LANES, "leave it out to suit the device")
        _ = self.run  # checks all else
        if self.t_end == 0:
            raise InputError("t_end", self.t_end, "longer than no time", "raise it")

    @property
    def run(self) -> Settings:
        """The same as settings of a single run that saves nothing on its way."""
        return Settings(
            t_end=self.t_end,
            save_every=max(self.t_end, 1e-6),
            precision=self.precision,
            rtol=self.rtol,
            atol=self.atol,
            dealias=self.dealias,
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """How one member ended; all numbers are dimensionless.

    `regime` is one of `REGIMES`, `status` one of `OUTCOMES`, `reason` says in a few words what makes the
    regime certain, or why it is not. `t_final` is the time up to which the two-dimensional equations were
    integrated, `t_order` the time since which the state has looked like its final regime (NaN for disorder
    and where it never settled). `state` (2, n_theta, n_z) is the final state: the steady state itself where
    that is what is certain. `eigenvalue` is the largest growth rate of perturbations of it (NaN where none
    was computed), `tail` the largest spectral tail met after the initial noise had decayed. `evaluations`
    of the right-hand side and `seconds` say what it cost.

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


def uncertain(status: str, rate: float) -> str:
    """Return why nothing is certain of a member that has "diverged" or "completed"."""
    if status == "diverged":
        return "no step was small enough, or |P| passed its bound; the last good state is kept"
    return f"at t_end, where its relative rate of change was {rate:.1e}"
