"""The settings that a sweep has beyond those of a run, each defined once, and what may be swept."""

from __future__ import annotations

from dataclasses import replace

from ...model.definitions import GRID, INITIAL, MODEL, PARAMETERS, SCALES, SURFACE, Definition, definition

MAX_MEMBERS = 10**9
"""Largest number of members of one sweep."""

AXIS = (
    Definition("start", "-", "first value of the axis", None, minimum=-1e300, maximum=1e300, optional=True),
    Definition("stop", "-", "last value of the axis", None, minimum=-1e300, maximum=1e300, optional=True),
    Definition("count", "-", "number of values", None, "whole", 2, 100_000, optional=True),
    Definition("spacing", "-", "how values are spaced", "linear", "choice", allowed=("linear", "log")),
    Definition(
        "values",
        "-",
        "the values, instead of start, stop and count",
        None,
        "numbers",
        -1e300,
        1e300,
        optional=True,
    ),
)

ENSEMBLE = (
    Definition("seeds", "-", "members at every point of the axes, one per seed", 1, "whole", 1, MAX_MEMBERS),
    Definition("first_seed", "-", "seed of the first of them", 0, "whole", 0, MAX_MEMBERS),
    Definition(
        "block",
        "-",
        "members computed and stored together (default: whole points of the axes, about 64)",
        None,
        "whole",
        1,
        100_000,
        optional=True,
    ),
)

AXIAL_RESOLUTION = Definition(
    "axial_resolution",
    "-",
    "points along the cell: always n_z, or at each time only as many as the waves along it need",
    "fixed",
    "choice",
    allowed=("fixed", "adaptive"),
)

RUN = (
    replace(definition("run", "t_end"), default=2000.0, meaning="time up to which members are integrated"),
    Definition(
        "finish",
        "-",
        "when a member is done: once its final regime is certain, or at t_end",
        "certified",
        "choice",
        allowed=("certified", "t_end"),
    ),
    *(definition("run", name) for name in ("precision", "rtol", "atol", "dealias", "terms")),
    Definition(
        "lanes",
        "-",
        "members computed side by side (default: chosen for the device)",
        None,
        "whole",
        1,
        1_048_576,
        optional=True,
    ),
    AXIAL_RESOLUTION,
)

RECORD = (
    Definition("quantities", "-", "further quantities of the final states", None, "names", optional=True),
    Definition("fields", "P", "whether final states are stored whole", False, "flag"),
)

START = (
    *(item for item in INITIAL if item.name != "seed"),
    Definition(
        "sha256",
        "-",
        "checksum of the file at path, which must have it (default: that of the file as it is)",
        None,
        "text",
        optional=True,
    ),
)

TABLES = {
    "model": MODEL,
    "parameters": PARAMETERS,
    "grid": (*GRID, *SURFACE),
    "initial": START,
    "ensemble": ENSEMBLE,
    "run": RUN,
    "record": RECORD,
    "scales": SCALES,
}
"""The tables of a sweep, except [axes], whose keys are those of `AXES`, each a table of `AXIS`."""

AXES: dict[str, tuple[str, Definition]] = {
    **{item.name: ("parameters", item) for item in PARAMETERS if item.kind == "number"},
    **{name: ("grid", definition("grid", name)) for name in ("length", "aspect", "smoothing")},
    "filaments_per_square": ("initial", definition("initial", "filaments_per_square")),
    "magnitude": ("initial", definition("initial", "magnitude")),
}
"""What may be swept, besides steps of a protocol: the table that holds it in a run, and its definition."""
