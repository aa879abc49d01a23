"""Maps of regimes from theory alone: which states are stable over two parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import series
from ..model.definitions import PARAMETERS, definition
from ..model.doors import door
from ..model.errors import InputError, choice, number
from ..model.grid import Array
from ..model.parameters import Parameters
from .branches.continuation import NUMBERS
from .profiles.travelling import LENGTH
from .states import STATES, states

if TYPE_CHECKING:
    import xarray

AXES = (*NUMBERS, "length")
"""The possible axes of a map: parameters that are numbers, and the length of the cell."""


@shown
@dataclass(frozen=True, eq=False)
class RegimeMap:
    """Which of `STATES` exist and are stable over two parameters, dimensionless.

    `x` (columns,) and `y` (rows,) are the values of the parameters `x_name` and `y_name`; `exists` and
    `stable` (states, columns, rows) are given for each state in the order of `names`; `cause` (states,
    columns, rows) says in words which perturbation grows, or that there is no such state, and is empty where
    the state is stable. All other parameters are those of `params`, in a cell of `length`.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(d_r=0.025)
        >>> found = cy.stability.regime_map(params, ("alpha_p", [0.01, 0.02]), ("alpha_u", [0.0, 0.01]))
        >>> found.at(0.01, 0.0), found.stable.shape, dict(found.to_dataset().sizes)
        (('disordered',), (6, 2, 2), {'state': 6, 'alpha_p': 2, 'alpha_u': 2})
    """

    x_name: str
    x: Array
    y_name: str
    y: Array
    names: tuple[str, ...]
    exists: npt.NDArray[np.bool_]
    stable: npt.NDArray[np.bool_]
    cause: npt.NDArray[np.str_]
    params: Parameters
    length: float

    def at(self, x: float, y: float) -> tuple[str, ...]:
        """Return the names of the stable states at the point of the map next to (x, y)."""
        place = int(np.abs(self.x - x).argmin()), int(np.abs(self.y - y).argmin())
        return tuple(name for name, row in zip(self.names, self.stable, strict=True) if row[place])

    def to_dataset(self) -> xarray.Dataset:
        """Return the map as an `xarray.Dataset` over `state` and both parameters."""
        import xarray

        dims = ("state", self.x_name, self.y_name)
        rest = {name: float(value) for name, value in self.params.items() if name not in dims}
        return xarray.Dataset(
            {"exists": (dims, self.exists), "stable": (dims, self.stable), "cause": (dims, self.cause)},
            coords={"state": list(self.names), self.x_name: self.x, self.y_name: self.y},
            attrs=rest if "length" in dims else rest | {"length": self.length},
        )


def opened(dataset: xarray.Dataset) -> RegimeMap:
    """Return the `RegimeMap` of a dataset made by `to_dataset`. Raises `InputError` for other datasets."""
    try:
        _, x_name, y_name = (str(name) for name in dataset["stable"].dims)
        values: dict[str, Any] = {
            item.name: bool(dataset.attrs[item.name])
            if item.kind == "flag"
            else float(dataset.attrs[item.name])
            for item in PARAMETERS
            if item.name in dataset.attrs
        }
        exists, stable = (np.asarray(dataset[name].values, dtype=bool) for name in ("exists", "stable"))
        return RegimeMap(
            x_name,
            np.asarray(dataset[x_name].values, dtype=np.float64),
            y_name,
            np.asarray(dataset[y_name].values, dtype=np.float64),
            tuple(str(name) for name in dataset["state"].values),
            exists,
            stable,
            np.asarray(dataset["cause"].values, dtype=np.str_),
            Parameters(**values),
            float(dataset.attrs.get("length", LENGTH)),
        )
    except (KeyError, ValueError, TypeError) as error:
        rule = "a regime map, as `cyclosis stability map` writes it"
        raise InputError("dataset", "this file", rule, "choose another") from error


@door
def regime_map(
    params: Parameters,
    x: tuple[str, npt.ArrayLike],
    y: tuple[str, npt.ArrayLike],
    length: float = LENGTH,
    progress: Callable[[int, int], None] | None = None,
) -> RegimeMap:
    """Return the `RegimeMap` over two parameters (name, values), each with at least two values that grow.

    Any parameter that is a number, or "length". `progress` is called with the number of points done and the
    total. Raises `InputError` for other names and for values out of range, and, as `states` does, where zones
    are too narrow to be resolved.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.regime_map(cy.Parameters(), ("alpha_p", [0.01, 0.02]), ("kappa", [0.2, 0.5]))
        >>> found.at(0.02, 0.5), found.at(0.02, 0.2)  # α_p < d_r: flow alone can sustain two stripes
        (('disordered', 'cyclosis'), ('disordered', 'cyclosis'))
    """
    (x_name, across), (y_name, up) = _axis("x", x), _axis("y", y)
    if x_name == y_name:
        raise InputError("y", y_name, f"another parameter than {x_name}", "choose two")
    shape = (len(STATES), across.size, up.size)
    exists, stable = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    cause = np.full(shape, "", dtype="U64")
    for i, j in np.ndindex(shape[1:]):
        values = {x_name: float(across[i]), y_name: float(up[j])}
        here = values.pop("length", length)
        found = states(params.replace(**values), here)
        for k, name in enumerate(STATES):
            exists[k, i, j], stable[k, i, j], cause[k, i, j] = found[name]
        if progress is not None:
            progress(i * up.size + j + 1, across.size * up.size)
    return RegimeMap(x_name, across, y_name, up, STATES, exists, stable, cause, params, length)


def _axis(field: str, axis: tuple[str, npt.ArrayLike]) -> tuple[str, Array]:
    if not isinstance(axis, list | tuple) or len(axis) != 2:
        raise InputError(field, axis, "a pair (name, values)", 'write ("alpha_p", [0.1, 0.2])')
    name = choice(field, axis[0], AXES)
    values = series(name, axis[1], "give numbers")
    allowed = definition("grid" if name == "length" else "parameters", name)
    checked = [
        number(name, value, allowed.minimum, allowed.maximum, "give numbers") for value in values.tolist()
    ]
    if values.size < 2 or not np.all(np.diff(values) > 0):
        raise InputError(name, values.tolist(), "at least two values that grow", "give more, in order")
    return name, np.array(checked)
