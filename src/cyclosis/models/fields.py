"""Functions of one state on any grid: those of the cylinder, and the same on a closed surface."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from ..analysis import diagnostics, regimes
from ..analysis.plain import plain
from ..closed.grid import Array, ClosedGrid
from ..contract.model import Problem
from ..model import system as cylinder
from ..model.errors import number
from ..model.filaments import TermLike
from ..model.parameters import Parameters
from ..model.precision import double
from .closed.model import closed
from .closed.states import ClosedRegime

Function = TypeVar("Function", bound=Callable[..., Any])


def _on_any(of_closed: Callable[..., Any], of_cylinder: Function) -> Function:
    """Return a function that is `of_closed` on a closed surface and `of_cylinder` elsewhere."""

    @functools.wraps(of_cylinder)
    def chosen(params: Any, grid: Any, *args: Any, **kwargs: Any) -> Any:
        if isinstance(grid, ClosedGrid):
            return of_closed(params, grid, *args, **kwargs)
        return of_cylinder(params, grid, *args, **kwargs)

    return chosen  # type: ignore[return-value]


def _problem(params: Parameters, grid: ClosedGrid, terms: Iterable[TermLike] | None = None) -> Problem:
    return closed.problem(params, grid, terms)


def _flow(params: Parameters, grid: ClosedGrid, state: npt.ArrayLike) -> Array:
    system: Any = closed.system(_problem(params, grid), True)
    assert closed.flow is not None
    with double():
        return closed.flow(system, system.spectrum(grid.check_state(state)), np.float64(0.0))


def _rate_of_change(
    params: Parameters,
    grid: ClosedGrid,
    state: npt.ArrayLike,
    time: float = 0.0,
    terms: Iterable[TermLike] | None = None,
) -> Array:
    system: Any = closed.system(_problem(params, grid, terms), True)
    now = number("time", time, -1e12, 1e12, "the default is 0")
    with double():
        rate: Array = system.state(
            cylinder.rate_spectrum(system, system.spectrum(grid.check_state(state)), now)
        )
    return rate


def _regime(
    params: Parameters,
    grid: ClosedGrid,
    state: npt.ArrayLike,
    terms: Iterable[TermLike] | None = None,
) -> ClosedRegime:
    assert closed.regime is not None
    found: ClosedRegime = closed.regime(_problem(params, grid, terms), grid.check_state(state))
    return found


def _diagnose(
    params: Parameters,
    grid: ClosedGrid,
    state: npt.ArrayLike,
    time: float = 0.0,
    terms: Iterable[TermLike] | None = None,
) -> dict[str, Any]:
    system: Any = closed.system(_problem(params, grid, terms), True)
    now = number("time", time, -1e12, 1e12, "the default is 0")
    with double():
        values = closed.measure(system, system.spectrum(grid.check_state(state)), now)
    return plain(system, values)


flow = _on_any(_flow, cylinder.flow)
rate_of_change = _on_any(_rate_of_change, cylinder.rate_of_change)
regime = _on_any(_regime, regimes.regime)
diagnose = _on_any(_diagnose, diagnostics.diagnose)
