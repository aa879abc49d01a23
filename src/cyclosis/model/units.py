"""Physical units in which results are shown: micrometres, seconds and minutes, given a cell's `Scales`.

Results stay dimensionless: what is here only names and scales numbers on their way out.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .errors import InputError

if TYPE_CHECKING:
    from .scales import Scales

NAMES = ("radius_um", "speed_um_s")
"""The keys of [scales], both needed."""


def of_table(table: Mapping[str, Any]) -> Scales | None:
    """Return the scales of a [scales] table, or None if it is empty.

    Raises `InputError` if only one of its two values is given.
    """
    from .scales import Scales

    given = {name: table[name] for name in NAMES if table.get(name) is not None}
    if not given:
        return None
    for name, other in (NAMES, NAMES[::-1]):
        if name not in given:
            rule = f"given together with {other}"
            raise InputError(name, None, rule, "give both: length and speed set the unit of time")
    return Scales(given["radius_um"], given["speed_um_s"], table.get("friction_Pa_s_per_m", 1.0))


def table_of(scales: Scales) -> dict[str, float]:
    """Return scales as they are stored with a run. Raises `InputError` for anything else."""
    from .scales import Scales

    if not isinstance(scales, Scales):
        remedy = "write cyclosis.Scales(radius_um=500.0, speed_um_per_s=75.0)"
        raise InputError("scales", scales, "a cyclosis.Scales", remedy)
    return {
        "radius_um": scales.radius_um,
        "speed_um_s": scales.speed_um_per_s,
        "friction_Pa_s_per_m": scales.friction_Pa_s_per_m,
    }


def stored(dataset: Any) -> dict[str, float]:
    """Return the [scales] table of a run's dataset, {} if it has none."""
    return dict(json.loads(dataset.attrs.get("scales", "{}")))


def scales_in(dataset: Any) -> Scales | None:
    """Return the scales of a run's dataset, or None if it has none."""
    return of_table(stored(dataset))


def scales_text(scales: Scales) -> str:
    """Return the scales of a cell in words."""
    return f"R = {scales.radius_um:g} µm, U = {scales.speed_um_per_s:g} µm/s, R/U = {scales.time_s:.4g} s"


def scales_of_measurement(dataset: Any) -> Scales | None:
    """Return the scales in which the numbers of a measured cell are, None if length or time is not known.

    With them a speed in R/s, for example, becomes one in µm/s.
    """
    from .scales import Scales

    radius, speed = (dataset.attrs.get(name) for name in ("radius_um", "speed_unit_um_per_s"))
    return None if radius is None or speed is None else Scales(float(radius), float(speed))


@dataclass(frozen=True)
class Unit:
    """A unit for a quantity: `factor` takes a dimensionless number to a number of units called `name`."""

    factor: float
    name: str

    def __call__(self, value: float) -> str:
        """Return a dimensionless number in words."""
        return f"{self.factor * value:.4g} {self.name}"

    @property
    def brackets(self) -> str:
        """The unit as it follows the name of an axis."""
        return f" ({self.name})" if self.name else ""


_CHOSEN: ContextVar[Scales | None] = ContextVar("scales", default=None)


@contextmanager
def shown_in(scales: Scales | None) -> Iterator[None]:
    """Show results that have no scales of their own in those of a cell, within a `with`."""
    before = _CHOSEN.set(scales or _CHOSEN.get())
    try:
        yield
    finally:
        _CHOSEN.reset(before)


def chosen_scales() -> Scales | None:
    """Return the scales that are chosen for such results, None if they are shown without a dimension."""
    return _CHOSEN.get()


PURE = Unit(1.0, "")
"""The unit of dimensionless numbers."""
_TIMES = ((60.0, "s"), (3600.0, "min"), (86400.0, "h"), (float("inf"), "d"))
_SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}


def time_unit(scales: Scales | None, last: float) -> Unit:
    """Return the unit in which times up to `last` are shown: s, min from two minutes on, h, or d."""
    if scales is None:
        return PURE
    longest = scales.seconds(abs(last))
    name = next(name for limit, name in _TIMES if longest < 2 * limit)
    return Unit(scales.time_s / _SECONDS[name], name)


def length_unit(scales: Scales | None, longest: float = 0.0) -> Unit:
    """Return the unit in which lengths up to `longest` are shown: µm, or mm from one on."""
    if scales is None:
        return PURE
    if scales.micrometres(longest) >= 1e3:
        return Unit(scales.radius_um / 1e3, "mm")
    return Unit(scales.radius_um, "µm")


def speed_unit(scales: Scales | None) -> Unit:
    """Return the unit in which speeds are shown: µm/s."""
    return PURE if scales is None else Unit(scales.speed_um_per_s, "µm/s")


def rate_unit(scales: Scales | None, largest: float) -> Unit:
    """Return the unit in which rates up to `largest`, in U/R, are shown: per s, min, h or day."""
    if scales is None:
        return PURE
    fastest = abs(largest) / scales.time_s
    name = next((name for name, seconds in _SECONDS.items() if fastest * seconds >= 0.1), "d")
    return Unit(_SECONDS[name] / scales.time_s, f"1/{name}")


def wavenumber_unit(scales: Scales | None) -> Unit:
    """Return the unit in which wavenumbers, in 1/R, are shown: per mm."""
    return PURE if scales is None else Unit(1e3 / scales.radius_um, "1/mm")


UNITS: Mapping[str, Callable[[Scales | None, float], Unit]] = {
    "time": time_unit,
    "length": length_unit,
    "speed": lambda scales, _: speed_unit(scales),
    "rate": rate_unit,
    "wavenumber": lambda scales, _: wavenumber_unit(scales),
}
"""The units of each kind of quantity: functions of a cell's scales and of the largest number shown."""


def length_text(length: float, scales: Scales | None, digits: str = "g") -> str:
    """Return a length in radii as it stands at a tick: a number, and with scales its unit below it."""
    unit = length_unit(scales, length)
    return format(length, digits) if scales is None else f"{unit.factor * length:.3g}\n{unit.name}"


def round_length(scales: Scales, about: float) -> tuple[float, str]:
    """Return a round length (1, 2 or 5 times a power of ten) of at most `about` radii, and its name.

    The length is in radii.
    """
    most = scales.micrometres(about)
    power = 10.0 ** math.floor(math.log10(most))
    best = next(m * power for m in (5.0, 2.0, 1.0) if m * power <= most * (1 + 1e-9))
    name = f"{best / 1e3:g} mm" if best >= 1e3 else f"{best:g} µm"
    return best / scales.radius_um, name
