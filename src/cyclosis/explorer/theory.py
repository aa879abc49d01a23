"""Curves of theory that the engine in the browser cannot compute: a table for the parameters of the presets.

`python -m cyclosis.explorer.theory` computes the table anew, in a minute or two.
"""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from ..model.definitions import PARAMETERS
from ..model.parameters import Parameters
from ..models import polar
from .about import curves
from .presets import PRESETS

NAME = "theory.json"
DIGITS, POINTS = 6, 200
"""Significant digits and points of a curve that are stored: more than a picture shows."""


def described() -> list[Parameters]:
    """Return the parameters of the table: those of the presets of the cylinder, and their changes.

    The axes of the diagram, α_p and α_u, have their defaults.
    """
    known = {each.name for each in PARAMETERS} - {"alpha_p", "alpha_u"}
    found: list[Parameters] = []
    for item in PRESETS:
        if item.tables.get("model", {}).get("kind", polar.name) != polar.name:
            continue
        own = item.tables.get("parameters", {})
        for step in ({}, *item.protocol):
            names = step if step.get("action") == "change" and "where" not in step else {}
            values = {name: value for name, value in (own | names).items() if name in known}
            params = Parameters(**values)
            if params not in found:
                found.append(params)
    return found


def entry(params: Parameters) -> dict[str, Any]:
    """Return the curves for these parameters as the table has them."""
    return {
        "parameters": {name: value for name, value in params.items() if name not in ("alpha_p", "alpha_u")},
        "curves": [
            {"name": each["name"], "alpha_p": _rounded(each["alpha_p"]), "alpha_u": _rounded(each["alpha_u"])}
            for each in curves(params)["curves"]
        ],
    }


@cache
def stored() -> list[dict[str, Any]]:
    """Return the table: the curves for each set of parameters besides α_p and α_u."""
    found: list[dict[str, Any]] = json.loads(resources.files(__package__).joinpath(NAME).read_text())
    return found


def _rounded(values: list[float | None]) -> list[float | None]:
    every = -(-len(values) // POINTS)
    return [None if value is None else float(f"{value:.{DIGITS}g}") for value in values[::every]]


def _main() -> None:
    table = [entry(params) for params in described()]
    Path(__file__).with_name(NAME).write_text(
        json.dumps(table, separators=(",", ":"), allow_nan=False) + "\n"
    )


if __name__ == "__main__":
    _main()
