"""What the engine in the browser needs besides the equation: settings, presets, the curves of theory."""

from __future__ import annotations

from functools import cache
from typing import Any

from ..config import USED_BY
from ..model.definitions import GRID, INITIAL, MODEL, PARAMETERS, SCALES, SURFACE, Definition
from ..model.interventions import ACTIONS, AT, SHAPES
from .presets import PRESETS
from .session import DRUGS
from .setup import INTERVAL, KINDS, MOST_FRAMES, MOST_PLACED
from .surfaces import FINEST
from .theory import stored


@cache
def catalogue() -> dict[str, Any]:
    """Return the catalogue, as it is sent, but for its curves."""
    return {
        "parameters": _settings(PARAMETERS),
        "grid": _settings((*GRID, *SURFACE)),
        "initial": _settings(INITIAL),
        "model": _settings(MODEL),
        "scales": _settings(SCALES),
        "interval": _setting(INTERVAL),
        "uses": {kind: list(USED_BY[kind]) for kind in KINDS},
        "kinds": list(KINDS),
        "at": _setting(AT),
        "actions": {
            name: {"keys": _settings(action.keys), "regional": action.regional}
            for name, action in ACTIONS.items()
        },
        "shapes": {name: _settings(items) for name, (_, items) in SHAPES.items()},
        "presets": [
            {"name": item.name, "tables": item.tables, "protocol": list(item.protocol)} for item in PRESETS
        ],
        "finest": FINEST,
        "mostFrames": MOST_FRAMES,
        "mostPlaced": MOST_PLACED,
        "drugs": DRUGS,
        "curves": [],
    }


@cache
def whole() -> dict[str, Any]:
    """Return the catalogue with the curves of theory that are stored."""
    return catalogue() | {"curves": stored()}


def _settings(items: tuple[Definition, ...]) -> list[dict[str, Any]]:
    return [_setting(item) for item in items]


def _setting(item: Definition) -> dict[str, Any]:
    return {
        "name": item.name,
        "kind": item.kind,
        "default": item.default,
        "minimum": item.minimum,
        "maximum": item.maximum,
        "allowed": list(item.allowed),
        "optional": item.optional,
        "needed": item.needed,
        "field": item.field,
        "also": item.also,
    }
