"""Regions of the surface described by tables, as in configuration files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .errors import InputError, choice, closest, flag
from .interventions import SHAPES
from .regions import Band, Box, Disc, Image, Intersection, Region, Strips, Union, image

DEEPEST = 8
"""How deep regions may be nested."""
_MADE = {"box": Box, "disc": Disc, "band": Band, "strips": Strips}


def from_table(table: Any, depth: int = 0) -> Region:
    """Return the region that a table describes: `shape`, its keys, and `invert = true` for its complement.

    Raises `InputError` for any mistake in it. The keys are in `cyclosis.model.interventions.SHAPES`.
    """
    if not isinstance(table, Mapping):
        raise InputError("where", table, "a table with a shape", 'write { shape = "disc", ... }')
    if depth > DEEPEST:
        raise InputError("where", table, f"nested at most {DEEPEST} deep", "simplify it")
    given = dict(table)
    shape = choice("shape", given.pop("shape", None), tuple(SHAPES))
    inverted = flag("invert", given.pop("invert", False))
    region = _plain(shape, given, depth)
    return ~region if inverted else region


def _plain(shape: str, given: dict[str, Any], depth: int) -> Region:
    if shape in ("union", "intersection"):
        _refuse_unknown(shape, given, ("parts",))
        parts = given.get("parts")
        if not isinstance(parts, list | tuple) or not parts:
            raise InputError(
                "parts", parts, "a list of regions", 'write parts = [{ shape = "disc", ... }, ...]'
            )
        made = tuple(from_table(part, depth + 1) for part in parts)
        return Union(made) if shape == "union" else Intersection(made)
    if shape == "image" and "pixels" in given:
        known = ("width", "height", "pixels")
        _refuse_unknown(shape, given, known)
        return Image(*(given.get(name, 0) for name in known))
    items = SHAPES[shape][1]
    _refuse_unknown(shape, given, tuple(item.name for item in items))
    for item in items:
        if item.needed and given.get(item.name) is None:
            raise InputError(item.name, None, f"given for shape = {shape}", f"add {item.name}, {item.rule}")
    values = {item.name: item.check(given.get(item.name, item.default)) for item in items}
    return image(values["path"]) if shape == "image" else _MADE[shape](**values)


def _refuse_unknown(shape: str, given: Mapping[str, Any], known: tuple[str, ...]) -> None:
    for name in given:
        if name not in known:
            rule = f"a key of shape {shape}: " + ", ".join((*known, "invert"))
            raise InputError("where key", name, rule, closest(name, known))
