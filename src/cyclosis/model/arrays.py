"""Input arrays made plain: whatever else they carry is used correctly or refused.

Every public function that takes an array takes it through `numbers`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import EllipsisType
from typing import Any

import numpy as np
import numpy.typing as npt

from .carried import PLAIN, framed, labelled, objection
from .errors import InputError
from .wording import beside

Array = npt.NDArray[np.float64]
Dims = tuple[str | EllipsisType, ...]

STATE_DIMS = ("component", "theta", "z")
FIELD_DIMS = ("theta", "z")
SURFACE_DIMS = ("theta", "s")
"""Those of a field on a closed surface, whose s is the arc length along a meridian."""
COMPONENTS = ("theta", "z")
"""The labels of the dimension `component`."""
AS_GIVEN = re.compile(r"dim_\d+")
"""Names that xarray invents if none are given."""
CLOSE = 1e-3
"""Share of the spacing within which a coordinate matches that of a grid: single precision is enough."""


def numbers(
    field: str,
    value: Any,
    rule: str,
    remedy: str,
    dims: Dims = (),
    coordinates: Mapping[str, Sequence[str] | Array] | None = None,
) -> Array:
    """Return an array-like as a new float64 array in C order, or raise `InputError`.

    Masked entries, units and values that JAX traces are refused. Named dimensions (of xarray, or a table
    of pandas with named index and columns) are brought into the order `dims`, and refused if they have
    other names; a first `...` matches any. Their coordinates, where they have some, must be `coordinates`,
    by default those of any grid on a cylinder; what is only in another order is sorted.
    """
    try:
        given = np.asarray(_ordered(field, value, dims, coordinates))
    except InputError:
        raise
    except Exception as error:  # array-likes of other libraries raise any error
        raise InputError(field, value, rule, remedy) from error
    if given.dtype.kind not in "iuf":
        raise InputError(field, given if given.ndim else value, rule, remedy)
    return np.array(given, dtype=np.float64, order="C")


def vectors(
    name: str, state: Any, shape: tuple[int, int], coordinates: Mapping[str, Any], bounded: bool
) -> Array:
    """Return a vector field on a grid of some shape as a float64 array (2, *shape), or raise `InputError`.

    `coordinates` are those of its dimensions, in their order. With `bounded`, a length above 1 is refused.
    """
    expected = (2, *shape)
    rule = f"an array of real numbers of shape {expected} ({', '.join(coordinates)})"
    remedy = "make state and grid match, and give one array with both components"
    array = numbers(name, state, rule, remedy, tuple(coordinates), coordinates)
    if array.shape != expected:
        raise InputError(name, array, rule, remedy)
    if not np.all(np.isfinite(array)):
        raise InputError(name, array, "finite everywhere", "remove its NaN or infinite entries")
    largest = float(np.sqrt(np.max(np.sum(array**2, axis=0))))
    if bounded and largest > 1 + 1e-12:
        raise InputError(
            f"max |P| of {name}",
            float(beside(largest, 1.0)),
            "at most 1, because P is a mean of unit vectors",
            "scale the state down, or raise filaments_per_square if it is noise",
        )
    return array


def series(field: str, value: Any, remedy: str = "give a list of numbers") -> Array:
    """Return one number or a row of numbers as an array of dimension one, or raise `InputError`."""
    found = numbers(field, value, "one number or a list of numbers", remedy)
    if found.ndim > 1:
        raise InputError(field, found, "one number or a list of numbers", remedy)
    return np.atleast_1d(found)


def by_names(value: Any) -> Any:
    """Return a table of pandas whose index and columns have names as an array of xarray."""
    if framed(value) and getattr(value, "ndim", 0) == 2 and {value.index.name, value.columns.name} != {None}:
        import xarray  # slow to load, and needed only for names

        return xarray.DataArray(value)
    return value


def even(value: Any) -> dict[str, Any]:
    """Return the coordinates that an array with coordinates would have on a grid on a cylinder."""
    found: dict[str, Any] = {}
    known = getattr(value, "coords", ()) if labelled(value) else ()
    for name in FIELD_DIMS:
        given = value[name].values if name in known else np.empty(0)
        if given.ndim == 1 and given.size > 1:
            far = 2 * np.pi * (1 - 1 / given.size) if name == "theta" else _extent(given)
            found[name] = far / (given.size - 1) * np.arange(given.size)
    return found | ({"component": COMPONENTS} if "component" in known else {})


def _extent(given: Any) -> float:
    return float(np.ptp(given)) if given.dtype.kind in "iuf" else 1.0


def dimensions(value: Any) -> int:
    """Return the number of dimensions of an array-like, 0 for anything else."""
    if isinstance(value, list | tuple):
        return 1
    try:
        return int(np.ndim(value))
    except Exception:  # what NumPy cannot read is refused later
        return 0


def alike(**values: Any) -> None:
    """Raise `InputError` where arrays that are combined by position have dimensions of other names."""
    named = {name: tuple(map(str, value.dims)) for name, value in values.items() if labelled(value)}
    if len(set(named.values())) > 1:
        names = " and ".join(named)
        rule = "without names where they differ, because these arrays are combined by position"
        raise InputError(f"dimensions of {names}", tuple(named.values()), rule, "give plain arrays (.values)")


def _ordered(field: str, value: Any, dims: Dims, coordinates: Mapping[str, Any] | None) -> Any:
    """Return a value as NumPy can read it, with named dimensions in their order."""
    if type(value) in PLAIN:
        return value
    refused = objection(value)
    if refused:
        raise InputError(field, value, *refused)
    value = by_names(value)
    if labelled(value):
        return _by_name(field, value, dims, coordinates)
    if isinstance(value, list | tuple):
        return [_ordered(field, item, dims[1:], coordinates) for item in value]
    return getattr(value, "magnitude", value)


def _by_name(field: str, value: Any, dims: Dims, coordinates: Mapping[str, Any] | None) -> Any:
    found = tuple(map(str, value.dims))
    if not dims or all(AS_GIVEN.fullmatch(name) for name in found):
        return value.data
    names = [name for name in dims if name is not ...]
    if not set(names) <= set(found) or (... not in dims and len(found) != len(names)):
        rule = f"({', '.join(names)}), in any order"
        raise InputError(f"dimensions of {field}", found, rule, "select the rest, or rename the dimensions")
    value = value.transpose(*dims)
    for name, wanted in (even(value) if coordinates is None else coordinates).items():
        if name in getattr(value, "coords", ()) and value.sizes.get(name) == len(wanted):
            value = value.isel({name: _places(field, name, value[name].values, wanted)})
    return value.data


def _places(field: str, name: str, given: Any, wanted: Any) -> npt.NDArray[np.int64]:
    """Return the order in which the given coordinates equal the wanted ones."""
    if name == "component":
        labels, known = list(map(str, given)), list(map(str, wanted))
        if labels == [str(k) for k in range(len(known))]:
            labels = known
        if sorted(labels) == sorted(known):
            return np.array([labels.index(label) for label in known])
        rule = ", ".join(known)
        raise InputError(f"component of {field}", labels, rule, "use these labels, in any order")
    places = np.argsort(given, kind="stable")
    sorted_ = given[places]
    if given.dtype.kind in "iuf":
        if np.allclose(sorted_, wanted, rtol=0.0, atol=CLOSE * float(wanted[1] - wanted[0])):
            return places
        found = f"{sorted_[0]:g} to {sorted_[-1]:g}"
    else:
        found = f"{sorted_[0]} to {sorted_[-1]}"
    rule = f"that of the grid, even from {wanted[0]:g} to {wanted[-1]:g}"
    raise InputError(
        f"{name} of {field}", found, rule, "use the grid that it was given on, or interpolate it"
    )
