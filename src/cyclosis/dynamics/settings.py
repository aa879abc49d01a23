"""How a run is integrated and what it saves."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..display.shown import shown
from ..model.definitions import ADAPTIVE, RUN, defaults
from ..model.errors import InputError
from ..model.grid import Array
from ..model.instants import instant
from ..model.wording import beside

_DEFAULT = defaults("run")
MAX_FRAMES = 1_000_000


@shown
@dataclass(frozen=True)
class Settings:
    """Settings of `simulate`, checked against `cyclosis.model.definitions.RUN`.

    Times are dimensionless (R/U) and rounded by `cyclosis.model.instants.instant`. `terms` are chosen
    separately, since some may be custom functions.
    """

    t_end: float = _DEFAULT["t_end"]
    save_every: float = _DEFAULT["save_every"]
    save_at: tuple[float, ...] | None = _DEFAULT["save_at"]
    record_every: float | None = _DEFAULT["record_every"]
    stepper: str = _DEFAULT["stepper"]
    rtol: float = _DEFAULT["rtol"]
    atol: float = _DEFAULT["atol"]
    dt: float | None = _DEFAULT["dt"]
    dealias: str = _DEFAULT["dealias"]
    precision: str = _DEFAULT["precision"]
    steady_rate: float | None = _DEFAULT["steady_rate"]

    def __post_init__(self) -> None:
        checks = {item.name: item for item in RUN}
        for item in fields(self):
            value = getattr(self, item.name)
            object.__setattr__(self, item.name, checks[item.name].check(value))
        object.__setattr__(self, "t_end", instant(self.t_end))
        if self.save_at is not None:
            # Times that mean the same, for example from two joined lists, are saved once.
            object.__setattr__(self, "save_at", tuple(dict.fromkeys(map(instant, self.save_at))))
            late = next((time for time in self.save_at if time > self.t_end), None)
            if late is not None:
                remedy = "raise t_end, or leave out what is later"
                raise InputError("save_at", late, f"at most t_end = {beside(self.t_end, late)}", remedy)
        for name in ("save_every", "record_every"):
            interval = getattr(self, name)
            if interval is not None and self.t_end / interval > MAX_FRAMES:
                raise InputError(
                    name,
                    interval,
                    f"at least t_end / {MAX_FRAMES} = {beside(self.t_end / MAX_FRAMES, interval)}",
                    "save less often",
                )
        if self.precision == "float32" and self.stepper in ADAPTIVE and self.rtol < 1e-6:
            raise InputError("rtol", self.rtol, "at least 1e-06 in float32", "raise it, or use float64")

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The names of all settings."""
        return tuple(item.name for item in fields(cls))

    def as_dict(self) -> dict[str, Any]:
        """Return the settings by name."""
        return {name: getattr(self, name) for name in self.names()}

    def save_times(self) -> Array:
        """Times at which fields are saved; without `save_at`, always the first and the last instant."""
        if self.save_at is not None:
            return np.array(self.save_at)
        return _every(self.save_every, self.t_end)

    def record_times(self) -> Array:
        """Times at which scalars are recorded: every `record_every`, and wherever fields are saved."""
        saved = self.save_times()
        if self.record_every is None:
            return saved
        return np.union1d(saved, _every(self.record_every, self.t_end))


def _every(interval: float, end: float) -> Array:
    # A last interval shorter than a millionth of the others is a rounding error.
    count = int(np.floor(end / interval + 1e-6))
    times: Array = np.minimum(instant(interval * np.arange(count + 1, dtype=np.float64)), end)
    if times[-1] == end:
        return times
    if count and end - times[-1] <= 1e-6 * interval:
        times[-1] = end
        return times
    return np.append(times, end)
