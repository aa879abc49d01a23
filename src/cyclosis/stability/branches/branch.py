"""A branch of states over one parameter, and what happens along it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ...display.shown import shown
from ...model.errors import InputError, number
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ..profiles.slowest import Vector
from ..profiles.steady import UNIFORM, rms
from ..profiles.travelling import LENGTH, Drifting, drifting_state
from .curve import Curve
from .events import varying
from .switching import other_branch, symmetric_branch

if TYPE_CHECKING:
    import xarray


MEASURES = ("max_P", "max_u", "mean_P_theta", "mean_P_z", "rms_P", "rms_u", "drift")
"""Numbers of every state of a branch: `Branch.measures`, and its drift."""


@shown
@dataclass(frozen=True, eq=False)
class SpecialPoint:
    """Something that happens on a branch.

    `kind` is "fold", "branch point", "Hopf point" or "end"; `value` the parameter there and `index` the
    point of the branch; `sentence` says what happens. `axial_mode` is the wavenumber along the cell of the
    perturbation concerned, 0 for one that does not vary along it; `frequency` its angular frequency in a
    frame that drifts with the state; `ends` says whether the branch stops here. Dimensionless.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(kappa=0.5), n_theta=64)
        >>> branch = cy.stability.continue_branch(state, "kappa", (0.4, 0.6), length=None, longest=0.1)
        >>> [(point.kind, round(point.value, 3), point.ends) for point in branch.points]
        [('end', 0.4, True), ('branch point', 0.471, False), ('end', 0.6, True)]
    """

    kind: str
    value: float
    index: int
    sentence: str
    axial_mode: int = 0
    frequency: float = 0.0
    ends: bool = False


@shown
@dataclass(frozen=True, eq=False)
class Branch:
    """Steady and drifting states over one parameter, in order along the branch, dimensionless.

    `parameter` (points,) are the values of the parameter called `name`, within `bounds`, all others as in
    `params`; `states` (points, 2, n_theta) is P on the angles `theta`; `drift` (points,) the speed about the
    axis. `eigenvalues` (points, count) are the growth rates of perturbations that do not vary along the
    cell, the largest real part first and the neutral shift left out; `across` (points, waves) the leading
    one at each axial wavenumber 2πj/`length`, j = 1, 2, ..., NaN where all are certain to decay (no columns
    if `length` is None). `stable` (points,) says where all of these decay faster than 1e-10; smaller rates
    cannot be distinguished from zero. `unstable` (points,) counts those of the first kind that grow.
    `residual` (points,) is the largest |dP/dt + c P'| between grid points. `measures` holds numbers (points,)
    of each state. `points` lists what happens along the branch, and `start` is the index of its first state.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(kappa=0.5), n_theta=64)
        >>> branch = cy.stability.continue_branch(state, "kappa", (0.4, 0.6), length=None, longest=0.1)
        >>> [point] = branch.of("branch point")
        >>> round(point.value, 3), bool(branch.stable[0]), bool(branch.stable[-1])  # filaments tilt below it
        (0.471, False, True)
        >>> branch.holds(branch.state(0)), branch.states.shape[1:], branch.to_dataset().sizes["special"]
        (True, (2, 64), 3)
    """

    name: str
    parameter: Array
    theta: Array
    states: Array
    drift: Array
    eigenvalues: Vector
    across: Vector
    stable: npt.NDArray[np.bool_]
    unstable: npt.NDArray[np.int64]
    residual: Array
    measures: dict[str, Array]
    points: list[SpecialPoint]
    start: int
    params: Parameters
    bounds: tuple[float, float]
    length: float | None

    def of(self, kind: str, axial_mode: int | None = None) -> list[SpecialPoint]:
        """Return the special points of a kind, of all axial modes or of one."""
        return [p for p in self.points if p.kind == kind and axial_mode in (None, p.axial_mode)]

    def state(self, index: int) -> Drifting:
        """Return the state at a point of the branch, with its parameters."""
        X = self._point(index)
        return self._state(self._curve(_varies(X)), X)

    def switch(self, point: SpecialPoint, size: float = 0.02) -> Drifting:
        """Return a state on the branch that meets this one at a branch point or Hopf point.

        `size` is the distance from this branch, root mean square of P; its sign selects the direction. Where
        this branch ends in a more symmetric state, the result is such a state at a parameter value `size`
        times the width of the bounds away. Raises `InputError` for other points, for waves along the cell
        and oscillations, whose states are not one-dimensional and steady, and where nothing is found.

        Example:
            >>> import cyclosis as cy
            >>> state = cy.stability.cyclosis(cy.Parameters(kappa=0.5), n_theta=64)
            >>> branch = cy.stability.continue_branch(state, "kappa", (0.4, 0.6), length=None, longest=0.1)
            >>> tilted = branch.switch(branch.of("branch point")[0])
            >>> bool(abs(tilted.P[0].mean()) > 1e-3), branch.holds(tilted)
            (True, False)
        """
        size = number("size", size, -1.0, 1.0, "the default is 0.02")
        X = self._point(point.index)
        varies = _varies(X)
        curve = self._curve(varies)
        field, rule = "point", "a branch point, or a Hopf point of a uniform state"
        if point.kind not in ("branch point", "Hopf point"):
            raise InputError(field, point.kind, rule, "choose one of branch.of('branch point')")
        if point.axial_mode:
            raise InputError(
                field, point.sentence, rule + " that keep all along the cell the same", "simulate"
            )
        if point.ends:
            return self._state(curve, symmetric_branch(curve, X, size))
        if point.kind == "Hopf point" and varies:
            raise InputError(field, point.sentence, rule, "simulate the oscillation from a perturbed state")
        low, high = max(point.index - 1, 0), min(point.index + 1, self.parameter.size - 1)
        along = self._point(high) - self._point(low)
        along = along / curve.length(along)
        return self._state(curve, other_branch(curve, X, along, point.kind == "Hopf point", size))

    def holds(self, state: Drifting, within: float = 1e-3) -> bool:
        """Return whether a state lies on the branch, up to a rotation, to `within`, rms of P."""
        value = float(getattr(state.params, self.name))
        fixed = np.append(np.zeros(2 * self.theta.size + 1), 1.0)
        for k in np.flatnonzero((self.parameter[:-1] - value) * (self.parameter[1:] - value) <= 0):
            low, high = self._point(int(k)), self._point(int(k) + 1)
            step = high[-1] - low[-1]
            share = (value / (self.bounds[1] - self.bounds[0]) - low[-1]) / step if step else 0.0
            guess = low + share * (high - low)
            curve = self._curve(_varies(guess))
            found = curve.correct(guess, guess, fixed, 0.5)
            X = curve.point(state.P.ravel(), state.drift, value)
            if found is not None and curve.apart(found[0], X) < within:
                return True
        return False

    def to_dataset(self) -> xarray.Dataset:
        """Return the branch as an `xarray.Dataset` over `point`, special points over `special`."""
        import xarray

        waves = 2 * np.pi * (1 + np.arange(self.across.shape[1])) / (self.length or LENGTH)
        special = {
            key: ("special", [getattr(p, key) for p in self.points])
            for key in ("kind", "value", "index", "sentence", "axial_mode", "frequency", "ends")
        }
        along = {
            "growth": (("point", "rate"), self.eigenvalues.real),
            "frequency": (("point", "rate"), self.eigenvalues.imag),
            "growth_across": (("point", "wave"), self.across.real),
            "frequency_across": (("point", "wave"), self.across.imag),
            "P": (("point", "component", "theta"), self.states),
            "drift": ("point", self.drift),
            "stable": ("point", self.stable),
            "unstable": ("point", self.unstable),
            "residual": ("point", self.residual),
            **{name: ("point", values) for name, values in self.measures.items()},
        }
        return xarray.Dataset(
            along | {f"special_{key}": values for key, values in special.items()},
            coords={
                self.name: ("point", self.parameter),
                "theta": self.theta,
                "component": ["theta", "z"],
                "q": ("wave", waves),
            },
            attrs={
                "parameter": self.name,
                **{name: float(value) for name, value in self.params.items() if name != self.name},
            },
        )

    def __str__(self) -> str:
        low, high = self.parameter.min(), self.parameter.max()
        head = f"{self.parameter.size} states over {self.name} = {low:.6g} to {high:.6g}, "
        head += f"{int(self.stable.sum())} of them stable."
        return "\n".join([head, *(point.sentence for point in self.points)])

    def _curve(self, varies: bool) -> Curve:
        grid = CylinderGrid(self.theta.size, 8, LENGTH)
        return Curve(self.params, self.name, grid, self.bounds[1] - self.bounds[0], varies)

    def _point(self, index: int) -> Array:
        value = self.parameter[index] / (self.bounds[1] - self.bounds[0])
        return np.append(self.states[index].ravel(), [self.drift[index], value])

    def _state(self, curve: Curve, X: Array) -> Drifting:
        value = curve.value(X)
        return drifting_state(curve.problem(value), curve.at(value), X[:-2], float(X[-2]))


def _varies(X: Array) -> bool:
    return rms(varying(X)) > UNIFORM * max(rms(X[:-2]), 1.0)
