"""Every key of a protocol, defined once: the actions, and the shapes of regions that limit them.

Steps and regions check their values with these definitions, and the documentation's tables read them.
Nothing heavy is imported here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .definitions import PARAMETERS, Definition, definition

AT = Definition("at", "t", "time of the step", None, "number", 0.0, 1e9, needed=True)
OVER = Definition(
    "over", "-", "duration of a linear ramp from that time on; 0 is a jump", 0.0, "number", 0.0, 1e9
)
NAME = Definition(
    "name", "-", "name of the step, by which an axis of a sweep finds it", None, "text", optional=True
)
SHORTEST_RAMP = 1e-6
"""The shortest ramp that is not a jump."""
FILAMENTS = replace(
    definition("initial", "filaments_per_square"), meaning="filaments per grid square, noise variance 1/(2N)"
)
SEED = Definition(
    "seed",
    "-",
    "further seed of the step's random numbers (default: 1, 2, ... for the random steps in turn)",
    None,
    "whole",
    1,
    2**31 - 1,
    optional=True,
)
KEEP = Definition("keep", "-", "factor by which P is multiplied", 0.0, "number", 0.0, 1.0)
SIZE = Definition(
    "size",
    "-",
    "standard deviation of the noise added to each component",
    None,
    "number",
    0.0,
    10.0,
    needed=True,
)
ANGLE = Definition(
    "angle",
    "-",
    "direction of P from e_theta, in radians; π/2 is along e_z",
    None,
    "number",
    -10.0,
    10.0,
    needed=True,
)
MAGNITUDE = replace(definition("initial", "magnitude"), meaning="magnitude of P")


@dataclass(frozen=True)
class Action:
    """What a step may do: its meaning, its keys besides `at`, and whether it may be limited to a region."""

    meaning: str
    keys: tuple[Definition, ...]
    regional: bool


ACTIONS = {
    "change": Action(
        "set parameters to other values, at once or over a ramp; in a region only those that may be fields",
        (OVER, *PARAMETERS),
        True,
    ),
    "fragment": Action(
        "set P to fresh disorder",
        (FILAMENTS, definition("initial", "noise_grid"), SEED),
        True,
    ),
    "depolymerise": Action("multiply P by a factor", (KEEP,), True),
    "align": Action("set P to one direction", (ANGLE, MAGNITUDE), True),
    "noise": Action("add noise to P", (SIZE, definition("initial", "noise_grid"), SEED), True),
    "wash_out": Action("return all parameters to their values before the protocol", (OVER,), False),
}

_ANGLE = Definition("theta", "θ", "angle", None, "number", -6.3, 6.3, needed=True)
_ALONG = "axial position on the cell; arc length s from the south pole of a closed one"
_PLACE = Definition("z", "z", _ALONG, None, "number", 0.0, 1e4, needed=True)
_AXIS = Definition("axis", "-", "coordinate that bounds it", "theta", "choice", allowed=("theta", "z"))
_END = Definition("start", "-", "from here", None, "number", -6.3, 1e4, needed=True)

SHAPES: dict[str, tuple[str, tuple[Definition, ...]]] = {
    "box": (
        "theta0 <= theta < theta1 and z0 <= z < z1; each wraps around if its first end is beyond the second",
        (
            replace(_ANGLE, name="theta0"),
            replace(_ANGLE, name="theta1"),
            replace(_PLACE, name="z0"),
            replace(_PLACE, name="z1"),
        ),
    ),
    "disc": (
        "all points within a distance, measured on the surface, or through space on a closed cell",
        (
            _ANGLE,
            _PLACE,
            Definition("radius", "-", "that distance, in radii", None, "number", 1e-6, 1e4, needed=True),
        ),
    ),
    "band": (
        "start <= axis < stop; it wraps around if start is beyond stop",
        (_AXIS, _END, replace(_END, name="stop", meaning="to here")),
    ),
    "strips": (
        "strips at even distances along an axis: with theta they run along the cell, with z around it",
        (
            Definition("count", "-", "number of strips", None, "whole", 1, 4096, needed=True),
            Definition("share", "-", "share of the surface that they cover", 0.5, "number", 1e-6, 1.0),
            _AXIS,
            Definition("offset", "-", "where the first begins, in spacings", 0.0, "number", -1.0, 1.0),
        ),
    ),
    "image": (
        "the light pixels of an image laid over the unwrapped surface, theta to the right and z up",
        (Definition("path", "-", "file of the image", None, "text", needed=True),),
    ),
    "union": ("all points in any of the regions listed under `parts`", ()),
    "intersection": ("all points in every one of the regions listed under `parts`", ()),
}
