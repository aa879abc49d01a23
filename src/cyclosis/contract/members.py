"""What an ensemble needs to know about a model to integrate many of its members together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from .model import Problem


@dataclass(frozen=True)
class Variable:
    """One variable of the members: name, dimensions besides that of members, type, missing value, meaning.

    `codes` are the meanings of the integers 0, 1, ... of a coded variable.
    """

    name: str
    dims: tuple[str, ...]
    dtype: str
    missing: float
    meaning: str
    codes: tuple[str, ...] = ()

    def empty(self, shape: tuple[int, ...]) -> npt.NDArray[Any]:
        """Return an array of this variable without any value."""
        return np.full(shape, self.missing, self.dtype)


@dataclass(frozen=True, eq=False)
class Starts:
    """Initial states as the [initial] table of a configuration describes them.

    `make(given, grid)` returns the state of a run. For sweeps, `filled(given, ends)` completes the table,
    without what is swept between `ends`; `noisy` returns whether states differ from seed to seed;
    `refuse_impossible` raises `InputError` if some of them cannot be made on some of the grids;
    `seeded(given, seed, grid)` returns the state of a seed.
    """

    make: Callable[[Any, Any], Any]
    filled: Callable[[Any, Any], dict[str, Any]]
    noisy: Callable[[Any, Any], bool]
    refuse_impossible: Callable[[Any, Any, int, Any, bool], None]
    seeded: Callable[[Any, int, Any], Any]


class Doubt(Enum):
    """Why nothing is certain about a member: not yet, or the simpler equation has not settled either."""

    YET = "not yet"
    LASTING = "the one-dimensional equation has not settled either"


@dataclass(frozen=True, eq=False)
class CertainEnd:
    """What is certain about a member: the regime, the reason, and the final state.

    `eigenvalue` is the largest growth rate of perturbations of that state, `relaxation` the time in which a
    simpler equation than the model's reached it; both dimensionless.
    """

    regime: str
    reason: str
    state: npt.NDArray[Any]
    eigenvalue: float
    relaxation: float


class Look(Protocol):
    """What a state looks like, in a few numbers."""

    def since(self, looks: Sequence[tuple[float, Any]], otherwise: float) -> float:
        """Return the first of the times from which on all looks equal this one."""
        ...


class Inquiry(Protocol):
    """The test of what is certain about the end of one member."""

    def look(self, signs: Any, t: float) -> CertainEnd | None:
        """Return what is certain of a member with these signs at a time, or None."""
        ...


@dataclass(frozen=True, eq=False)
class AxialPoints:
    """How a member goes on with fewer points along its axis while it has no short waves along it.

    `fewer(grid)` returns the numbers of points that may be used instead of the grid's, from most to fewest,
    and `usable(params, grid)` how many of these. `on_few(system)` returns a system in the form that takes the
    least time on few points. `fitted(modes, n)` puts the modes of a state on n points,
    `tails(modes, numbers)` returns the shares of its amplitude that so many points hold badly or not at all.
    These two are traceable.
    """

    fewer: Callable[[Any], tuple[int, ...]]
    usable: Callable[[Any, Any], int]
    on_few: Callable[[Any], Any]
    fitted: Callable[[Any, int], Any]
    tails: Callable[[Any, tuple[int, ...]], Any]


@dataclass(frozen=True, eq=False)
class Lanes:
    """How members share the lanes of one compiled program.

    `signs(system, modes)` is traceable and returns a named tuple of what is measured of a member, including
    its `largest` |P| and its spectral `tail`; `look` makes a `Look` of it, `look_of_state` one of a state.
    Members with the same `shared(params, grid)` may share lanes: their systems differ only in `values`, and
    `with_values` replaces these. `certain(problem)` returns a function that begins an `Inquiry`; members at
    the same parameters share it. Without it no final regime can be certified. Without `axial` all points are
    kept.
    """

    signs: Callable[[Any, Any], Any]
    look: Callable[[Any], Look]
    look_of_state: Callable[[Any], Look]
    shared: Callable[[Any, Any], Any]
    values: Callable[[Any], Any]
    with_values: Callable[[Any, Any], Any]
    certain: Callable[[Problem], Callable[[], Inquiry]] | None
    axial: AxialPoints | None = None
