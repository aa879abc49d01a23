"""The data that the page is built from: settings, terms, presets, colours and the computed phase diagram."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from ..analysis.diagnostics import QUANTITIES
from ..config import USED_BY
from ..model.definitions import GRID, INITIAL, PARAMETERS, Definition
from ..model.equation import EQUATION
from ..model.errors import choice
from ..model.parameters import Parameters
from ..version import __version__
from .messages import FASTEST, MOST_POINTS
from .palettes import PALETTES
from .presets import PRESETS, Preset
from .session import TRACES
from .setup import FINEST, INTERVAL, KINDS

_SHOWN = ("kind", "seed", "filaments_per_square", "magnitude", "stripes")


@cache
def about() -> dict[str, Any]:
    """Return everything that the page is built from, as it is sent."""
    return {
        "version": __version__,
        "limits": {
            "points": FINEST,
            "stroke": MOST_POINTS,
            "fastest": FASTEST,
        },
        "parameters": [_described(item) for item in PARAMETERS],
        "grid": [_described(item) for item in GRID],
        "initial": [_described(item) for item in INITIAL if item.name in _SHOWN],
        "uses": {kind: [name for name in USED_BY[kind] if name in _SHOWN] for kind in KINDS},
        "interval": _described(INTERVAL),
        "terms": [{"name": item.name, "formula": item.formula, "caption": item.caption} for item in EQUATION],
        "traces": [_trace(name) for name in TRACES],
        "presets": [
            {"name": item.name, "group": item.group, "title": item.title, "text": item.text}
            for item in PRESETS
        ],
        "palettes": [asdict(palette) for palette in PALETTES],
        "diagram": diagram(),
    }


def preset(name: str) -> Preset:
    """Return a preset by name. Raises `InputError` for an unknown name."""
    choice("preset", name, tuple(item.name for item in PRESETS))
    return next(item for item in PRESETS if item.name == name)


@cache
def diagram() -> dict[str, Any]:
    """Return the computed phase diagram: the share of cyclosis over alpha_p and alpha_u."""
    text = resources.files(__package__).joinpath("figure5.json").read_text()
    found: dict[str, Any] = json.loads(text)
    return found


def curves(params: Parameters) -> dict[str, Any]:
    """Return the thresholds of theory over (alpha_p, alpha_u) for the other active parameters.

    `applies` is False where there are none: for parameters that vary in space.
    """
    from ..figures.swept import Axis
    from ..figures.thresholds import thresholds

    applies = params.shape is None
    axes = [Axis(name, np.array(diagram()[name])) for name in ("alpha_p", "alpha_u")]
    found = thresholds(params, axes) if applies else []
    return {
        "applies": applies,
        "curves": [
            {"name": each.name, "alpha_p": _points(each.x), "alpha_u": _points(each.y)} for each in found
        ],
    }


def _points(values: Any) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _described(item: Definition) -> dict[str, Any]:
    return {
        "name": item.name,
        "symbol": item.symbol,
        "meaning": item.meaning,
        "default": item.default,
        "kind": item.kind,
        "minimum": item.minimum,
        "maximum": FINEST if item.name in ("n_theta", "n_z") else item.maximum,
        "usual": item.usual,
        "allowed": KINDS if item.name == "kind" else item.allowed,
    }


def _trace(name: str) -> dict[str, str]:
    base = "mean_P" if name.startswith("mean_P") else name
    item = next(quantity for quantity in QUANTITIES if quantity.name == base)
    part = name.removeprefix(base).strip("_")
    return {
        "name": name,
        "symbol": f"<P_{part}>" if part else item.symbol,
        "meaning": item.meaning + (f", component {part}" if part else ""),
    }
