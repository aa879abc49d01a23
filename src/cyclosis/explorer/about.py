"""The data that the page is built from: settings, terms, presets, colours and the computed phase diagram."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, is_dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from ..closed.shapes import KINDS as KINDS_OF_SHAPES
from ..closed.shapes import LONGEST
from ..config import USED_BY
from ..contract.model import Quantity
from ..model.definitions import GRID, INITIAL, PARAMETERS, Definition, definition
from ..model.equation import EQUATION
from ..model.errors import choice
from ..model.parameters import Parameters
from ..models import MODELS, closed, polar
from ..version import __version__
from .messages import FASTEST, MOST_POINTS
from .palettes import PALETTES
from .preset import Preset
from .presets import PRESETS
from .setup import INTERVAL, KINDS, USUAL_WAVES, WAVES
from .surfaces import FINEST, Surface, surfaces
from .worksheet import described

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
        "shapes": shapes(),
        "initial": [_described(item) for item in INITIAL if item.name in _SHOWN],
        "models": {name: _model(name, surface) for name, surface in surfaces().items()},
        "interval": _described(INTERVAL),
        "terms": [{"name": item.name, "formula": item.formula, "caption": item.caption} for item in EQUATION],
        "presets": [
            {"name": item.name, "group": item.group, "title": item.title, "text": item.text}
            for item in PRESETS
        ],
        "palettes": [asdict(palette) for palette in PALETTES],
        "diagram": diagram(),
        "scales": None,
        "worksheet": described(),
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


def curves(params: Parameters, straight: bool = True) -> dict[str, Any]:
    """Return the thresholds of theory over (alpha_p, alpha_u) for the other active parameters.

    `applies` is False where there are none: for parameters that vary in space, and on closed cells, which
    are not `straight`.
    """
    from ..figures.swept import Axis
    from ..figures.thresholds import thresholds

    applies = straight and params.shape is None
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


def shapes() -> list[dict[str, Any]]:
    """Return the shapes of cells, each with its model and the settings of its grid."""
    own = {"k_max": {"default": USUAL_WAVES, "allowed": WAVES}}
    found: list[dict[str, Any]] = [_shape("cylinder", polar.name, [item.name for item in GRID], {})]
    for kind, made in KINDS_OF_SHAPES.items():
        settings = (
            {item.name: {"default": item.default} for item in fields(made)} if is_dataclass(made) else {}
        )
        if "length" in settings:
            settings["length"]["meaning"] = "length of the straight part, in radii"
            settings["length"]["minimum"], settings["length"]["maximum"] = 0.0, LONGEST
        found.append(_shape(kind, closed.name, [*settings, *own], settings | own))
    return found


def _shape(name: str, model: str, settings: list[str], changed: dict[str, Any]) -> dict[str, Any]:
    items = [_described(definition("grid", each)) | changed.get(each, {}) for each in settings]
    return {"name": name, "model": model, "settings": items}


def _model(name: str, surface: Surface) -> dict[str, Any]:
    """Return what a model's cells record, and what has no meaning in them."""
    hidden = () if surface.straight else ("stripes",)
    uses = {kind: [key for key in USED_BY[kind] if key in _SHOWN and key not in hidden] for kind in KINDS}
    return {
        "traces": [_trace(each, MODELS[name].quantities) for each in surface.traces],
        "unused": surface.unused,
        "uses": uses,
        "straight": surface.straight,
    }


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


def _trace(name: str, quantities: tuple[Quantity, ...]) -> dict[str, str]:
    item = next(each for each in quantities if name == each.name or name.startswith(f"{each.name}_"))
    part = name.removeprefix(item.name).strip("_")
    letter = "P" if "P" in item.symbol else "Ω"
    return {
        "name": name,
        "symbol": f"<{letter}_{part}>" if part else item.symbol,
        "meaning": item.meaning + (f", component {part}" if part else ""),
    }
