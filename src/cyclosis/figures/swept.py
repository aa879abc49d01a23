"""A sweep's dataset prepared for drawing: at most two axes, codes of regimes, the fixed parameters."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.outcomes import REGIONS, regions, share, tally
from ..analysis.regimes import REGIMES
from ..model.definitions import GRID, INITIAL, PARAMETERS, TERM_NAMES
from ..model.errors import InputError, closest, number
from ..model.grid import Array
from ..model.parameters import Parameters

Codes = npt.NDArray[np.int64]

DOUBTFUL = ("underresolved", "diverged")
"""Statuses of members that a figure mentions; these members are counted too."""
_USED = ("regime", "status", "t_order", "initial_k0", "initial_m1")
_SYMBOLS = {item.name: item.symbol for item in (*INITIAL, *GRID, *PARAMETERS) if item.symbol != "-"}
_STEP_KEYS = {"at": "time", "over": "duration"}
_STEP_LENGTHS = ("radius", "z", "z0", "z1", "width")
_RAISED = {"⁽ˢ⁾": "^{(s)}", "⁽ʳ⁾": "^{(r)}", "ℓ": r"\ell"}


@dataclass(frozen=True, eq=False)
class Axis:
    """One swept parameter: its name, its increasing values (n,), dimensionless, and the scale of its axis."""

    name: str
    values: Array
    log: bool = False

    @property
    def symbol(self) -> str:
        """The parameter's symbol set as mathematics, or its name in words."""
        step, _, key = self.name.removeprefix("protocol.").rpartition(".")
        if step:  # an axis over a step of a protocol
            key = _SYMBOLS.get(key, _STEP_KEYS.get(key, key.replace("_", " ")))
            return f"{key} of {step.removesuffix('.where')}"
        symbol = _SYMBOLS.get(self.name)
        if symbol is None:
            return self.name.replace("_", " ")
        for mark, raised in _RAISED.items():
            symbol = symbol.replace(mark, raised)
        return f"${symbol}$"

    @property
    def kind(self) -> str:
        """What is swept, one of `UNITS` of the model, or "" for a number without a dimension."""
        step, _, key = self.name.rpartition(".")
        if not step:
            return "length" if key == "length" else ""
        return "time" if key in _STEP_KEYS else "length" if key in _STEP_LENGTHS else ""

    @property
    def scale(self) -> str:
        """Matplotlib's name of the scale."""
        return "log" if self.log else "linear"

    @cached_property
    def edges(self) -> Array:
        """The ends (n + 1,) of the cells around the values, halfway between them on the scale."""
        places = np.log(self.values) if self.log else self.values
        steps = np.diff(places) if places.size > 1 else np.array([0.1 * max(abs(places[0]), 1e-3)])
        inner = 0.5 * (places[1:] + places[:-1])
        ends = np.concatenate([[places[0] - 0.5 * steps[0]], inner, [places[-1] + 0.5 * steps[-1]]])
        return np.exp(ends) if self.log else ends

    def between(self, count: int) -> Array:
        """Return `count` points from the first edge to the last, evenly spread on the scale."""
        first, last = self.edges[[0, -1]]
        return np.geomspace(first, last, count) if self.log else np.linspace(first, last, count)


def axis(name: str, values: npt.ArrayLike, log: bool | None = None) -> Axis:
    """Return an `Axis` on a logarithmic scale or not.

    The default is the scale on which its values are more even, linear if they span less than a factor of
    ten. Raises `InputError` for a logarithmic scale of values that are not above 0.
    """
    places = np.asarray(values, dtype=np.float64)
    if log and places[0] <= 0:
        raise InputError(name, float(places[0]), "above 0 on a logarithmic scale", "use a linear scale")
    if log is None:
        wide = places.size >= 3 and places[0] > 0 and places[-1] >= 10 * places[0]
        log = bool(wide and _unevenness(np.log(places)) < 0.99 * _unevenness(places))
    return Axis(name, places, log)


def _unevenness(places: Array) -> float:
    steps = np.diff(places)
    return float(np.std(steps) / np.mean(steps))


@dataclass(frozen=True, eq=False)
class Swept:
    """Outcomes of a sweep over at most two axes.

    `regime` (axes..., members) holds codes, indices into `REGIMES`, or -1 where a member is missing;
    `dataset` the selection, its axes sorted; `params` the parameters that are not swept, or
    None where no theory applies (unknown or changed terms, fields, no configuration).
    """

    axes: tuple[Axis, ...]
    regime: Codes
    dataset: xarray.Dataset
    params: Parameters | None

    @cached_property
    def counts(self) -> Codes:
        """Members (axes..., regimes) in each of `REGIMES`."""
        return tally(self.regime)

    @cached_property
    def trials(self) -> Codes:
        """Numbers of members present (axes...)."""
        found: Codes = self.counts.sum(axis=-1)
        return found

    @cached_property
    def share(self) -> Array:
        """Share (axes...) of cyclosis, between 0 and 1; NaN without members."""
        return share(self.counts)

    @cached_property
    def regions(self) -> Codes:
        """Region (axes...), an index into `REGIONS`; -1 without members."""
        return regions(self.counts)

    @property
    def present(self) -> list[str]:
        """The regimes that occur at all, in the order of `REGIMES`."""
        total = self.counts.reshape(-1, len(REGIMES)).sum(axis=0)
        return [name for name, count in zip(REGIMES, total, strict=True) if count]

    @property
    def disordered(self) -> npt.NDArray[np.bool_]:
        """Points (axes...) with members, none of which is ordered."""
        found: npt.NDArray[np.bool_] = self.regions == list(REGIONS).index("D")
        return found

    def variable(self, name: str) -> Array:
        """Return a variable of the dataset, broadcast to (axes..., members).

        Raises `InputError` if it is missing.
        """
        if name not in self.dataset:
            raise InputError(
                "the dataset's variables", list(self.dataset.data_vars), f"with {name}", "use open_sweep"
            )
        spread = self.dataset[name].broadcast_like(self.dataset["regime"])
        values = spread.transpose(*self.dataset["regime"].dims).values
        return np.asarray(values, dtype=np.float64).reshape(self.regime.shape)

    @property
    def summary(self) -> str:
        """How many runs there are, and how many are missing or have a doubtful status, in a few words."""
        there, missing = int(self.trials.sum()), int((self.regime < 0).sum())
        fewest, most = int(self.trials.min()), int(self.trials.max())
        each = f"{most}" if fewest == most else f"{fewest} to {most}"
        words = f"{grouped(there)} runs" + (f", {each} at each point" if there else "")
        doubts = {"missing": missing} | {name: self._with_status(name) for name in DOUBTFUL}
        return words + "".join(f", {grouped(count)} {name}" for name, count in doubts.items() if count)

    def _with_status(self, name: str) -> int:
        status = self.dataset.get("status")
        names = [] if status is None else str(status.attrs.get("flag_meanings", "")).split()
        if status is None or name not in names:
            return 0
        codes = np.atleast_1d(status.attrs.get("flag_values", np.arange(len(names))))
        return int(np.sum(status.values == codes[names.index(name)]))


def grouped(count: int) -> str:
    """Return a number with its digits in groups of three."""
    return f"{count:,}".replace(",", "\N{THIN SPACE}")


def swept(
    dataset: Any,
    select: Mapping[str, float] | None = None,
    log: Collection[str] | None = None,
    beside: tuple[str, ...] = (),
) -> Swept:
    """Return the `Swept` outcomes of a sweep's dataset (as from `open_sweep`).

    `select` names axes and the swept values to keep; axes of a single value are dropped automatically as
    long as one is left. `log` names the axes to draw on logarithmic scales, the others being linear; by
    default each scale is the one on which the values are more even. `beside` are axes to treat as further
    members. Raises `InputError` for anything but a sweep, for unknown axes or values, and if more than two
    axes are left.
    """
    if not isinstance(dataset, xarray.Dataset) or "regime" not in dataset:
        found = list(dataset.data_vars) if isinstance(dataset, xarray.Dataset) else type(dataset).__name__
        raise InputError("dataset", found, "an xarray.Dataset of a sweep, with regime", "use open_sweep")
    dims = [str(name) for name in dataset["regime"].dims]
    names = [name for name in dims if name != "seed"]
    if "seed" not in dims or not names or any(name not in dataset.coords for name in names):
        raise InputError(
            "the dimensions of regime", dims, "axes with coordinates, and seed", "use open_sweep"
        )
    dataset = dataset[[name for name in _USED if name in dataset]]
    dataset, fixed = _selected(dataset, dict(select or {}), names)
    left = [str(name) for name in dataset["regime"].dims if name not in ("seed", *beside)]
    for name in [name for name in left if dataset.sizes[name] == 1]:
        if len(left) > 1:
            fixed[name] = float(dataset[name].values[0])
            dataset = dataset.isel({name: 0})
            left.remove(name)
    if not (1 if not beside else 0) <= len(left) <= 2:
        remedy = "choose values of the others with select" if left else "leave out one of those in select"
        raise InputError("the axes to draw", ", ".join(left) or "none", "one or two of them", remedy)
    for name in log or ():
        if name not in left:
            raise InputError("log", name, "one of the axes " + ", ".join(left), closest(name, left))
    dataset = dataset.sortby(left).transpose(*left, ..., "seed", missing_dims="ignore")
    codes = _codes(dataset["regime"])
    axes = tuple(axis(name, dataset[name].values, None if log is None else name in log) for name in left)
    members = codes.reshape(*codes.shape[: len(left)], -1)
    return Swept(axes, members, dataset, _parameters(dataset, fixed))


def _selected(
    dataset: xarray.Dataset, select: dict[str, float], axes: list[str]
) -> tuple[xarray.Dataset, dict[str, float]]:
    fixed = {}
    for name, value in select.items():
        if name not in axes:
            raise InputError("select", name, "one of the axes " + ", ".join(axes), closest(name, axes))
        values = np.asarray(dataset[name].values, dtype=np.float64)
        place = place_of(name, values, value)
        fixed[name] = float(values[place])
        dataset = dataset.isel({name: place})
    return dataset, fixed


def place_of(name: str, values: Array, value: Any) -> int:
    """Return the index of the axis value (n,) that equals a value to three digits, or raise `InputError`."""
    wanted = number(name, value, -1e300, 1e300, "choose one of the swept values")
    place = int(np.argmin(np.abs(values - wanted)))
    if not np.isclose(values[place], wanted, rtol=5e-3, atol=0):
        known = ", ".join(f"{each:.4g}" for each in values)
        raise InputError(name, value, "one of the swept values", f"choose from {known}")
    return place


def _codes(regime: xarray.DataArray) -> Codes:
    """Return codes as indices into `REGIMES`, for any codes in the dataset; -1 for missing."""
    names = str(regime.attrs.get("flag_meanings", " ".join(REGIMES))).split()
    given = np.atleast_1d(regime.attrs.get("flag_values", np.arange(len(names))))
    if len(given) != len(names) or not set(names) <= set(REGIMES):
        raise InputError(
            "the regimes of the dataset", names, "among " + ", ".join(REGIMES), "use a sweep on the cylinder"
        )
    # Missing codes become NaN where a file was decoded.
    stored = np.nan_to_num(np.asarray(regime.values, dtype=np.float64), nan=-1.0).astype(np.int64)
    found = np.full(stored.shape, -1, dtype=np.int64)
    for value, name in zip(given, names, strict=True):
        found[stored == int(value)] = REGIMES.index(name)
    return found


def _parameters(dataset: xarray.Dataset, fixed: dict[str, float]) -> Parameters | None:
    """Return the parameters that are not swept, or None where the closed forms do not apply."""
    try:
        configuration = json.loads(dataset.attrs["configuration"])
        terms = configuration.get("run", {}).get("terms")
        if (terms is not None and set(terms) != set(TERM_NAMES)) or "protocol" in configuration:
            return None
        if "model" in configuration:  # of the polar model by the paper's closure it is left out
            return None
        names = {item.name for item in PARAMETERS}
        values = configuration.get("parameters", {}) | {k: v for k, v in fixed.items() if k in names}
        params = Parameters(**values)
    except (KeyError, AttributeError, TypeError, ValueError):
        return None
    return params if params.shape is None else None
