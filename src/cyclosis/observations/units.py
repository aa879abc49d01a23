"""Units of positions and speeds in files: pixels, frames, and those of length and time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..model.errors import InputError, number

LENGTHS = {
    **dict.fromkeys(("px", "pix", "pixel", "pixels"), None),
    **dict.fromkeys(("nm",), 1e-3),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns", "micrometer", "micrometre"), 1.0),
    **dict.fromkeys(("mm",), 1e3),
    **dict.fromkeys(("cm",), 1e4),
    **dict.fromkeys(("m", "metre", "meter"), 1e6),
}
"""Units of length in µm, None for pixels."""
TIMES = {
    **dict.fromkeys(("frame", "frames", "dt"), None),
    **dict.fromkeys(("ms",), 1e-3),
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("min",), 60.0),
    **dict.fromkeys(("h",), 3600.0),
}
"""Units of time in seconds, None for frames."""
EXAMPLES = "px/s, px/frame, um/s, mm/s or m/s"


@dataclass(frozen=True)
class Calibration:
    """What turns the units of a file into pixels and seconds: either may be unknown (None)."""

    pixel_um: float | None = None
    frame_s: float | None = None

    def __post_init__(self) -> None:
        for name, unit in (("pixel_um", "micrometres"), ("frame_s", "seconds")):
            value = getattr(self, name)
            if value is not None:
                remedy = f"give the {name.partition('_')[0]}'s size in {unit}"
                if name == "frame_s":
                    remedy = "give the seconds between the two images of a pair"
                object.__setattr__(self, name, number(name, value, 1e-12, 1e12, remedy))

    def pixels(self, field: str, unit: str) -> float:
        """Return how many pixels a unit of length is. Raises `InputError` if the pixel's size is needed."""
        micrometres = LENGTHS[length_unit(field, unit)]
        if micrometres is None:
            return 1.0
        if self.pixel_um is None:
            rule = "given, because the positions or speeds are in " + unit
            raise InputError(
                "pixel_um",
                None,
                rule,
                "give the size of a pixel in micrometres, as pixel_um=5.0",
                "give the size of a pixel in micrometres, as --pixel-um 5",
            )
        return micrometres / self.pixel_um

    def per_time(self, unit: str) -> tuple[float, str]:
        """Return what a speed per `unit` is multiplied by, and the unit of time that it then has."""
        seconds = TIMES[unit]
        if seconds is not None:
            return 1.0 / seconds, "s"
        return (1.0, "frame") if self.frame_s is None else (1.0 / self.frame_s, "s")


def length_unit(field: str, unit: Any) -> str:
    """Return a unit of length as it stands in `LENGTHS`. Raises `InputError` for any other."""
    text = _plain(unit)
    if text not in LENGTHS:
        raise InputError(field, unit, "a unit of length", "write px, um, mm or m")
    return text


def speed_unit(field: str, unit: Any) -> tuple[str, str]:
    """Return the units of length and time of a speed. Raises `InputError` if they are not known."""
    length, over, time = _plain(unit).partition("/")
    if not over or length not in LENGTHS or time not in TIMES:
        raise InputError(field, unit, "a length per time", f"write {EXAMPLES}")
    return length, time


def is_speed(unit: Any) -> bool:
    """Return whether a text is a known unit of speed."""
    length, over, time = _plain(unit).partition("/")
    return bool(over) and length in LENGTHS and time in TIMES


def is_length(unit: Any) -> bool:
    """Return whether a text is a known unit of length."""
    return _plain(unit) in LENGTHS


def _plain(unit: Any) -> str:
    return unit.strip().strip("[]()").replace(" ", "") if isinstance(unit, str) else ""
