"""Write the tables of settings and quantities from their definitions, and what follows from stored data.

python docs/generate.py            # writes the files named in `PAGES`
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import xarray

from cyclosis.analysis.diagnostics import QUANTITIES
from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.catalogue import NAMES
from cyclosis.experiments.experiment import OUTCOMES
from cyclosis.model.definitions import TABLES, Definition
from cyclosis.model.filaments import TERMS
from cyclosis.model.interventions import ACTIONS, AT, SHAPES
from cyclosis.sweep import definitions as sweeps
from cyclosis.sweep.variables import FIELD, STANDARD

HERE = Path(__file__).parent
NOTE = "<!-- Written by docs/generate.py from the definitions in the code. -->\n\n"


def settings() -> str:
    """Return the page of every setting."""
    out = NOTE + "# Settings\n\nThe tables of `run.toml` and the options of `cyclosis run`. "
    out += "All values are dimensionless.\n"
    for table, items in TABLES.items():
        out += f"\n## [{table}]\n\n| name | option | symbol | meaning | allowed | default |\n"
        out += "|---|---|---|---|---|---|\n"
        for item in items:
            allowed = item.rule + (", or a field (n_theta, n_z)" if item.field else "")
            option = "--" + item.name.replace("_", "-")
            meant = f"{_cell(item.symbol)} | {_cell(item.meaning)}"
            out += f"| `{item.name}` | `{option}` | {meant} | {allowed} | {_default(item)} |\n"
    out += _protocols() + _sweep()
    out += "\n## Terms\n\n| name | in dP/dt |\n|---|---|\n"
    return out + "".join(f"| `{term.name}` | {_cell(term.formula)} |\n" for term in TERMS)


def _protocols() -> str:
    """Return the keys of the steps of a protocol and of the regions they may be limited to."""
    out = "\n## Protocols\n\nThe keys of a step of a [protocol](protocols.md), a table [[protocol]], "
    out += "besides `action`. `change` takes further\nthe names and values of [parameters].\n\n"
    out += "| action | does | key | meaning | allowed | default |\n|---|---|---|---|---|---|\n"
    out += f"| any | | `{AT.name}` | {AT.meaning} | {AT.rule} | - |\n"
    for name, action in ACTIONS.items():
        head = f"| `{name}` | {action.meaning} |"
        if action.regional:
            out += f"{head} `where` | a region, below | a table | everywhere |\n"
            head = "| | |"
        for item in action.keys:
            if item not in TABLES["parameters"]:
                default = _default(item)
                out += f"{head} `{item.name}` | {_cell(item.meaning)} | {item.rule} | {default} |\n"
                head = "| | |"
    out += "\nThe keys of a region, the table `where`, besides `shape`. "
    out += "All take `invert = true` for all but it.\n\n"
    out += "| shape | is | key | meaning | allowed | default |\n|---|---|---|---|---|---|\n"
    for name, (meaning, items) in SHAPES.items():
        head = f"| `{name}` | {meaning} |"
        for item in items:
            out += f"{head} `{item.name}` | {_cell(item.meaning)} | {item.rule} | {_default(item)} |\n"
            head = "| | |"
        if not items:
            out += f"{head} `parts` | the regions | a list of tables | - |\n"
    return out


def _sweep() -> str:
    """Return the tables that a sweep has beyond those of a run."""
    out = (
        "\n## Sweeps\n\nThe tables of a [sweep](sweeps.md) are [parameters], [grid] and [initial] as above, "
    )
    out += "less `seed`,\nand these.\n"
    out += "\n### [axes]\n\nA key is one of " + ", ".join(f"`{name}`" for name in sweeps.AXES)
    out += "; each is a table of\n\n" + _plain_table(sweeps.AXIS)
    for name in ("ensemble", "run", "record"):
        out += f"\n### [{name}] of a sweep\n\n" + _plain_table(sweeps.TABLES[name])
    new = [item for item in sweeps.START if item not in TABLES["initial"]]
    return out + "\n### [initial] of a sweep, further\n\n" + _plain_table(new)


def _plain_table(items: Iterable[Definition]) -> str:
    out = "| name | meaning | allowed | default |\n|---|---|---|---|\n"
    for item in items:
        out += f"| `{item.name}` | {_cell(item.meaning)} | {_allowed(item)} | {_default(item)} |\n"
    return out


def _allowed(item: Definition) -> str:
    """Return the rule of a setting; the ends of an axis are those of what is swept."""
    return "as for what is swept" if abs(item.minimum) >= 1e300 else item.rule


def _default(item: Definition) -> str:
    return "all" if isinstance(item.default, tuple) else "-" if item.default is None else str(item.default)


def quantities() -> str:
    """Return the page of every recorded quantity."""
    out = NOTE + "# Quantities\n\nRecorded along every run, and returned by `cyclosis.diagnose`.\n\n"
    out += "| name | symbol | dimensions | unit | meaning |\n|---|---|---|---|---|\n"
    for item in QUANTITIES:
        dims = ", ".join(("time", *item.dims))
        out += f"| `{item.name}` | {_cell(item.symbol)} | {dims} | {item.unit} | {_cell(item.meaning)} |\n"
    out += (
        "\n## Of every member of a sweep\n\nOver the axes, `seed` and further dimensions; unit 1. Missing is "
    )
    out += (
        "-1 in integers and NaN in numbers.\n`[record] quantities` adds those above, of the final state, and "
    )
    out += "`fields = true` adds `P`.\n\n"
    out += "| name | further dimensions | type | meaning |\n|---|---|---|---|\n"
    for variable in (*STANDARD, FIELD):
        dims = ", ".join(variable.dims) or "-"
        out += f"| `{variable.name}` | {dims} | {variable.dtype} | {_cell(variable.meaning)} |\n"
    return out


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def claims() -> str:
    """Return the page of the paper's claims, from the datasets in docs/data/experiments."""
    out = "<!-- Written by docs/generate.py from the datasets in data/experiments. -->\n\n"
    out += "# The paper's claims\n\n"
    out += "What Woodhouse & Goldstein (2013) claim of living cells and of their model, in our words, put\n"
    out += "to the model cell by [virtual experiments](experiments.md): full form, with the numbers that\n"
    out += "decide.\n\n"
    lines, pictures, tally = [], [], dict.fromkeys(OUTCOMES, 0)
    for name in NAMES:
        file = HERE / "data" / "experiments" / f"{name}.nc"
        if not file.exists():
            continue
        with xarray.open_dataset(file, engine="h5netcdf") as data:
            told = {key: str(value) for key, value in data.attrs.items()}
        tally[told["verdict"]] += 1
        picture = f"images/experiments/{name}.png"
        cells = (told["claim"], told["measured"], f"**{told['verdict']}**")
        lines.append(f"| [{name}](#{name}) | " + " | ".join(map(_cell, cells)) + " |\n")
        pictures.append(
            f"## {name}\n\n![{name}: the cell and what was measured]({picture})\n\n"
            f"The paper: {told['claim_source']}. {told['method']} {told['seeds']} seeds, "
            f"`{told['command']}`.\n"
        )
    out += ", ".join(f"{count} {outcome}" for outcome, count in tally.items()) + ".\n\n"
    out += "| experiment | the paper's claim | measured | verdict |\n|---|---|---|---|\n"
    return out + "".join(lines) + "\n" + "\n".join(pictures)


def phase_diagram() -> str:
    """Return the computed phase diagram for the explorer's page, as JSON."""
    with xarray.open_dataset(HERE / "data" / "figure5.nc", engine="h5netcdf") as data:
        cyclosis = data["regime"].isin([REGIMES.index("cyclosis")])
        share = (100 * cyclosis.mean("seed")).round().astype(int)
        configuration = json.loads(data.attrs["configuration"])
        found = {
            "alpha_p": data["alpha_p"].values.round(6).tolist(),
            "alpha_u": data["alpha_u"].values.round(6).tolist(),
            "share": share.transpose("alpha_p", "alpha_u").values.tolist(),
            "parameters": configuration["parameters"],
            "caption": f"How many per cent of {data.sizes['seed']} disordered cells at each point become "
            "cyclosis, each followed until its end was certain.",
        }
    return json.dumps(found) + "\n"


PAGES = {
    "settings.md": settings,
    "quantities.md": quantities,
    "claims.md": claims,
    "../src/cyclosis/explorer/figure5.json": phase_diagram,
}
"""Paths from this folder, and what stands there."""

if __name__ == "__main__":
    for name, page in PAGES.items():
        (HERE / name).write_text(page())
