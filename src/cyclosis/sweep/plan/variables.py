"""What is stored of every member: one table that blocks, stores, datasets, exports and docs share."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...contract.members import Variable as Variable
from ...contract.model import Coordinate, Model
from ...dataset.contents import described
from ...ensemble.members import OUTCOMES
from ...model.errors import InputError, closest
from .step_axes import setting

if TYPE_CHECKING:
    from .sweep import Sweep

ALIASES = {"stripe_widths": "stripe_width", "zone_angles": "zone_angle"}
"""Alternative names of variables in a configuration."""


@dataclass(frozen=True, eq=False)
class Placed:
    """Values along dimensions, under a name, with their attributes."""

    name: str
    dims: tuple[str, ...]
    values: npt.NDArray[Any]
    attributes: dict[str, Any]


_NAN = float("nan")


def standard(model: Model) -> tuple[Variable, ...]:
    """Return the variables that are always stored of the members of a model, all dimensionless."""
    return (
        Variable("regime", (), "int8", -1, "regime of the final state", model.regimes),
        Variable("status", (), "int8", -1, "how the member ended", OUTCOMES),
        Variable(
            "t_final", (), "float64", _NAN, "time up to which the two-dimensional equations were integrated"
        ),
        Variable(
            "t_order",
            (),
            "float64",
            _NAN,
            "time since which the state has looked like its final regime; NaN if it is disordered",
        ),
        Variable(
            "eigenvalue",
            (),
            "float64",
            _NAN,
            "largest growth rate of a disturbance of the final state, if that is certified",
        ),
        Variable("evaluations", (), "int32", -1, "evaluations of the right-hand side"),
        Variable("seconds", (), "float64", _NAN, "seconds on the clock that the member took"),
        *model.member_variables,
    )


def field(model: Model) -> Variable:
    """Return the variable of complete final states."""
    state = model.stored[0]
    what = state.meaning.partition(" of ")[0]
    return Variable(state.name, state.dims, "float64", _NAN, f"{what} of the final state")


def further(model: Model, names: Iterable[str]) -> tuple[str, ...]:
    """Return the requested quantities that are not standard variables, without repeats.

    Raises `InputError` for names that are neither standard variables nor quantities of the model.
    """
    own = [item.name for item in standard(model)]
    asked = [ALIASES.get(name, name) for name in names]
    rest = [name for name in asked if name not in own]
    if not rest:
        return ()
    known = [item.name for item in model.quantities]
    for name in rest:
        if name not in known:
            listed = list(dict.fromkeys([*own, *known]))
            raise InputError("quantities", name, "a list of " + ", ".join(listed), closest(name, listed))
    return tuple(name for name in known if name in rest)


def quantity(model: Model, name: str) -> Variable:
    """Return the variable that holds a quantity of a model."""
    item = next(item for item in model.quantities if item.name == name)
    return Variable(name, item.dims, "float64", _NAN, f"{item.meaning}, of the final state")


def with_dtype(item: Variable, dtype: str) -> Variable:
    """Return a variable stored in another type."""
    return replace(item, dtype=dtype)


def attributes(item: Variable) -> dict[str, Any]:
    """Return the CF attributes of a variable; everything is dimensionless.

    Integers are never negative, except `Variable.missing` where a value is missing.
    """
    out: dict[str, Any] = {**described(item.meaning)}
    if item.codes:
        out["flag_values"] = np.arange(len(item.codes), dtype=item.dtype)
        out["flag_meanings"] = " ".join(item.codes)
    if np.dtype(item.dtype).kind == "i":
        # No _FillValue: readers that heed it, such as xarray, would turn all integers into floats.
        out["valid_min"] = np.dtype(item.dtype).type(0)
        out["comment"] = f"{item.missing:g} where the member has not been computed"
    return out


def along_axes(sweep: Sweep) -> dict[str, Placed]:
    """Return the values of every axis, and the seeds, each along a dimension of the same name."""
    out = {}
    for name, values in sweep.axes.items():
        item = setting(name, sweep.tables.get("protocol", []))
        about = described(item.meaning) | {"symbol": item.symbol}
        out[name] = Placed(name, (name,), np.array(values), about)
    seeds = np.arange(sweep.seeds.start, sweep.seeds.stop, dtype="int32")
    out["seed"] = Placed("seed", ("seed",), seeds, described("seed of the initial state"))
    return out


def of_members(sweep: Sweep, members: range) -> dict[str, Placed]:
    """Return the numbers of some members, their values on every axis, and their seeds, along `member`."""
    numbers = np.arange(members.start, members.stop, dtype="int32")
    out = {"member": Placed("member", ("member",), numbers, described("number of the member"))}
    places = np.unravel_index(numbers, sweep.shape)
    for (name, axis), at in zip(along_axes(sweep).items(), places, strict=True):
        out[name] = replace(axis, dims=("member",), values=axis.values[at])
    return out


def of_states(sweep: Sweep) -> dict[str, Placed]:
    """Return the coordinates of the variables that are stored of every member."""
    used = {dim for item in sweep.variables for dim in item.dims}
    terms = Coordinate(np.array(sweep.tables["run"]["terms"]), "terms of the filament equation")
    out = {}
    # Labels first, then positions: the order in which blocks have always been written.
    ordered = sorted(sweep.coordinates.items(), key=lambda item: item[1].values.dtype.kind == "f")
    for name, along in (dict(ordered) | {"term": terms}).items():
        if name in used:
            values, meaning = _for_classic_netcdf(along.values), along.meaning
            if "length" in sweep.axes:
                meaning = meaning.replace("in radii", "in axial periods")
            out[name] = Placed(name, (name,), values, described(meaning))
    return out


def _for_classic_netcdf(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return values of types that the format has: integers of 32 bits, texts of one length."""
    if values.dtype.kind == "i":
        return values.astype("int32")
    return np.array(values.tolist()) if values.dtype.kind == "O" else values
