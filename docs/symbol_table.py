"""The page of symbols: parameters and variables of every model from their definitions, and the theory's.

Units are those in which a number is 1: lengths in R, speeds in U, times in R/U, forces per area in Φ = νU.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from symbols_of_theory import SEVERAL, THEORY

import cyclosis
from cyclosis.contract.model import Model
from cyclosis.dataset.contents import COORDINATES, interventions
from cyclosis.model.definitions import TABLES
from cyclosis.models import MODELS, polar_model
from cyclosis.sweep.plan.variables import standard

INTRO = """# Symbols and names

Every symbol of the models and of their theory, with its name in code and files. A number is in the unit that
is given: R is the radius of the cell, U the speed that perfectly aligned filaments drive, Φ = νU the force
per area that they exert, and 1 stands for a pure number. Ranges and defaults are in [settings](settings.md).
Means <> are over the surface. Letters that stand for more than one thing are
[listed at the end](#letters-with-several-meanings).
"""

UNITS = {
    **dict.fromkeys(("alpha_p", "d_r", "kappa"), "U/R"),
    **{"alpha_u": "1/R", "d_s": "RU", "mu": "R²", "repulsion_angle": "rad", "bump_theta": "rad"},
    **dict.fromkeys(("length", "smoothing", "bump_z", "bump_width"), "R"),
    **{"k_max": "1/R", "radius_um": "µm", "speed_um_s": "µm/s", "steady_rate": "U/R"},
    **dict.fromkeys(("t_end", "save_every", "save_at", "record_every", "dt"), "R/U"),
}
"""Units of settings that are not pure numbers, or words."""
STORED_UNITS = {
    **dict.fromkeys(("u", "peak_speed", "rms_speed", "net_flux"), "U"),
    **dict.fromkeys(("theta", "zone_angle"), "rad"),
    **dict.fromkeys(("x", "y", "z", "s", "r"), "R"),
    **{"area_weight": "R²", "circulation": "U/R", "pressure_gradient": "Φ", "seconds": "s"},
    **dict.fromkeys(
        ("power_input", "viscous_dissipation", "friction_dissipation", "vacuole_dissipation"), "ΦU"
    ),
    **dict.fromkeys(("rate_of_change", "budget", "eigenvalue"), "U/R"),
    **dict.fromkeys(("time", "record_time", "intervention_time", "t_final", "t_order"), "R/U"),
}
"""Units of what is stored, where they are not 1."""
STORED_SYMBOLS = {
    **{"P": "P", "u": "u", "Q": "m_2/c", "c": "c", "moments": "m_n", "moment": "n", "state": "P, c"},
    **{"theta": "θ", "z": "z", "s": "s", "r": "r", "x": "x", "y": "y", "area_weight": "dA", "time": "t"},
    **{
        "concentration": "c, <c>",
        "mean_concentration": "<c>",
        "eigenvalue": "max Re σ",
        "mean_vector": "<P>",
    },
}
"""Symbols of what has none in its definition."""
VARIANTS = {
    "polar": MODELS["polar"],
    "polar with c": polar_model(concentration=True),
    **{name: model for name, model in MODELS.items() if name != "polar"},
}
"""All models, and the polar one with a concentration, by the words for them."""
WORDS = {frozenset(VARIANTS): "all", frozenset(VARIANTS) - {"closed"}: "cylinders"}
"""Words for several of them."""


def page() -> str:
    """Return the page."""
    out = INTRO + "\n## Given\n\nAll models take all of [parameters].\n"
    for table, items in TABLES.items():
        out += f"\n### [{table}]\n\n| symbol | name | meaning | unit |\n|---|---|---|---|\n"
        for item in items:
            meaning = item.meaning.partition(" (default")[0]
            unit = UNITS.get(item.name, "1" if item.kind in ("number", "whole") else "-")
            out += _row(item.symbol, f"`{item.name}`", meaning, unit)
    out += (
        "\n## In files and sweeps\n\nWhat a run or a sweep of each model stores; *cylinders* are all models "
    )
    out += "but the closed one.\n\n"
    out += "| name | symbol | meaning | unit | models |\n|---|---|---|---|---|\n"
    for name, (symbol, meanings, models) in sorted(stored().items(), key=lambda item: item[0].lower()):
        where = WORDS.get(frozenset(models), ", ".join(models))
        unit = STORED_UNITS.get(name, "1")
        out += _row(f"`{name}`", symbol, "; ".join(meanings), unit, where)
    out += "\n## In the theory\n"
    for title, target, rows in THEORY:
        out += f"\n### {title}\n\nDefined in [{target}]({target}).\n\n"
        out += "| symbol | meaning | unit | code |\n|---|---|---|---|\n"
        out += "".join(_row(*row) for row in rows)
    out += "\n## Letters with several meanings\n\nThe page says which is meant.\n\n"
    out += "| letter | meanings |\n|---|---|\n"
    return out + "".join(_row(letter, "; ".join(meanings)) for letter, meanings in SEVERAL.items())


def stored() -> dict[str, tuple[str, list[str], list[str]]]:
    """Return symbol, meanings, and models of all that runs and sweeps store, by name."""
    out: dict[str, tuple[str, list[str], list[str]]] = {}
    for words, model in VARIANTS.items():
        for name, symbol, meaning in _of(model):
            symbol = STORED_SYMBOLS.get(name, symbol)
            _, meanings, models = out.setdefault(name, (symbol, [], []))
            if meaning not in meanings:
                meanings.append(meaning)
            if words not in models:
                models.append(words)
    return out


def _of(model: Model) -> Iterable[tuple[str, str, str]]:
    """Yield name, symbol and meaning of everything that is stored of runs and sweeps of a model."""
    closed = model.grid is cyclosis.ClosedGrid
    grid = cyclosis.ClosedGrid(cyclosis.Sphere(), k_max=4) if closed else cyclosis.CylinderGrid(8, 8)
    for name, meaning in COORDINATES.items():
        yield name, "-", meaning
    for given in (model.coordinates(grid, None), model.geometry(grid)):
        for name, about in given.items():
            yield name, "-", about.meaning
    for item in model.stored:
        yield item.name, "-", item.meaning
    for name, (_, meaning) in interventions(model).items():
        yield name, "-", meaning
    for quantity in model.quantities:
        yield quantity.name, quantity.symbol, quantity.meaning
    known = {item.name for item in (*model.stored, *model.quantities)}
    for variable in standard(model):  # of the final state
        if variable.name not in known:
            yield variable.name, "-", variable.meaning


def _row(*cells: str) -> str:
    # A backslash keeps what looks like a tag, <P>, from being one.
    shown = (re.sub(r"<(?=[A-Za-z]+>)", r"\\<", cell.replace("|", "\\|")) for cell in cells)
    return f"| {' | '.join(shown)} |\n"
