"""What is stored of every member: one table, read by blocks, stores, datasets, exports and documentation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..dataset.contents import ZONES, described
from ..model.errors import InputError
from ..model.grid import CylinderGrid
from .definitions import AXES

if TYPE_CHECKING:
    from .plan import Sweep

ALIASES = {"stripe_widths": "stripe_width", "zone_angles": "zone_angle"}
"""Other names by which a configuration may ask for a variable."""


@dataclass(frozen=True)
class Variable:
    """One variable of the members: name, dimensions beyond the member's, type, value where missing, meaning.

    `codes` names the integers of a coded variable, by the list that holds their meanings.
    """

    name: str
    dims: tuple[str, ...]
    dtype: str
    missing: float
    meaning: str
    codes: str = ""

    def empty(self, shape: tuple[int, ...]) -> npt.NDArray[Any]:
        """Return an array of this variable without any value."""
        return np.full(shape, self.missing, self.dtype)


@dataclass(frozen=True, eq=False)
class Coordinate:
    """Values along dimensions, with their attributes."""

    name: str
    dims: tuple[str, ...]
    values: npt.NDArray[Any]
    attributes: dict[str, Any]


_NAN = float("nan")

STANDARD = (
    Variable("regime", (), "int8", -1, "regime of the final state", "regimes"),
    Variable("status", (), "int8", -1, "how the member ended", "outcomes"),
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
    Variable("order", (), "float64", _NAN, "root mean square of the final order vector"),
    Variable("peak_speed", (), "float64", _NAN, "largest flow speed of the final state"),
    Variable("mean_P", ("component",), "float64", _NAN, "mean of the final order vector"),
    Variable(
        "zone_count",
        (),
        "int16",
        -1,
        "number of sign changes of the final axial mean of P_z around the cell",
    ),
    Variable(
        "zone_angle",
        ("zone",),
        "float64",
        _NAN,
        "angles at which the final axial mean of P_z changes sign, in radians",
    ),
    Variable(
        "stripe_width",
        ("zone",),
        "float64",
        _NAN,
        "width of the stripe after each zone as a fraction of the circumference",
    ),
    Variable("profile", ("component", "theta"), "float64", _NAN, "axial mean of the final order vector"),
    Variable("initial_k0", (), "float64", _NAN, "mean of P_z in the initial state"),
    Variable(
        "initial_m1",
        (),
        "float64",
        _NAN,
        "amplitude of the wave of P_z once around the cell (m = 1, q = 0) in the initial state",
    ),
)
"""What is always stored, everything dimensionless."""

FIELD = Variable("P", ("component", "theta", "z"), "float64", _NAN, "order vector of the final state")


def further(names: Iterable[str]) -> tuple[str, ...]:
    """Return those of the quantities asked for that are not stored anyway, without repeats.

    Raises `InputError` for names that are neither in `STANDARD` nor in `QUANTITIES`.
    """
    own = [item.name for item in STANDARD]
    asked = [ALIASES.get(name, name) for name in names]
    rest = [name for name in asked if name not in own]
    if not rest:
        return ()
    from ..analysis.diagnostics import QUANTITIES

    known = [item.name for item in QUANTITIES]
    for name in rest:
        if name not in known:
            rule = "a list of " + ", ".join(dict.fromkeys([*own, *known]))
            raise InputError("quantities", name, rule, "check the spelling")
    return tuple(name for name in known if name in rest)


def quantity(name: str) -> Variable:
    """Return the variable that holds one of `cyclosis.diagnostics.QUANTITIES`."""
    from ..analysis.diagnostics import QUANTITIES

    item = next(item for item in QUANTITIES if item.name == name)
    return Variable(name, item.dims, "float64", _NAN, f"{item.meaning}, of the final state")


def meanings(codes: str) -> tuple[str, ...]:
    """Return the names that the integers 0, 1, ... of a coded variable stand for."""
    if codes == "regimes":
        from ..analysis.regimes import REGIMES

        return REGIMES
    from ..ensemble import OUTCOMES

    return OUTCOMES


def with_dtype(item: Variable, dtype: str) -> Variable:
    """Return a variable stored in another type."""
    return replace(item, dtype=dtype)


def attributes(item: Variable) -> dict[str, Any]:
    """Return the CF attributes of a variable; everything is dimensionless."""
    out: dict[str, Any] = {**described(item.meaning)}
    if item.codes:
        names = meanings(item.codes)
        out["flag_values"] = np.arange(len(names), dtype=item.dtype)
        out["flag_meanings"] = " ".join(names)
    if np.dtype(item.dtype).kind == "i":
        out["_FillValue"] = np.dtype(item.dtype).type(item.missing)
    return out


def along_axes(sweep: Sweep) -> dict[str, Coordinate]:
    """Return the values of every axis, and the seeds, each along a dimension of its own name."""
    out = {}
    for name, values in sweep.axes.items():
        item = AXES[name][1]
        about = described(item.meaning) | {"symbol": item.symbol}
        out[name] = Coordinate(name, (name,), np.array(values), about)
    seeds = np.arange(sweep.seeds.start, sweep.seeds.stop, dtype="int32")
    out["seed"] = Coordinate("seed", ("seed",), seeds, described("seed of the initial state"))
    return out


def of_members(sweep: Sweep, members: range) -> dict[str, Coordinate]:
    """Return the number of some members, and where they stand on every axis, along `member`."""
    numbers = np.arange(members.start, members.stop, dtype="int32")
    out = {"member": Coordinate("member", ("member",), numbers, described("number of the member"))}
    places = np.unravel_index(numbers, sweep.shape)
    for (name, axis), at in zip(along_axes(sweep).items(), places, strict=True):
        out[name] = replace(axis, dims=("member",), values=axis.values[at])
    return out


def of_states(sweep: Sweep) -> dict[str, Coordinate]:
    """Return the coordinates of what is stored of every member."""
    used = {dim for item in sweep.variables for dim in item.dims}
    given: dict[str, Any] = {"length": 1.0} | sweep.tables["grid"]  # where that is swept, z is in periods
    grid = CylinderGrid(**given)
    unit = "radii" if "length" in sweep.tables["grid"] else "axial periods"
    values: dict[str, tuple[npt.NDArray[Any], str]] = {
        "component": (np.array(["theta", "z"]), "vector component"),
        "zone": (np.arange(ZONES, dtype="int32"), "indifferent zones, by increasing angle"),
        "theta": (grid.theta, "angle around the axis in radians"),
        "z": (grid.z, f"position along the axis in {unit}"),
        "term": (np.array(sweep.tables["run"]["terms"]), "terms of the filament equation"),
    }
    return {
        name: Coordinate(name, (name,), array, described(meaning))
        for name, (array, meaning) in values.items()
        if name in used
    }
