"""Write the pages that are generated from definitions, docstrings, scripts and stored data.

python docs/generate.py            # writes the files named in `PAGES`
"""

from __future__ import annotations

import ast
import inspect
import json
import re
import sys
from collections.abc import Iterable
from functools import partial
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import xarray

import cyclosis
from cyclosis.analysis.diagnostics import QUANTITIES
from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments.catalogue import NAMES, experiment
from cyclosis.experiments.experiment import OUTCOMES
from cyclosis.explorer.worksheet import described
from cyclosis.model.definitions import TABLES, Definition
from cyclosis.model.definitions import option as option_name
from cyclosis.model.filaments import TERMS
from cyclosis.model.interventions import ACTIONS, AT, NAME, SHAPES
from cyclosis.models import polar
from cyclosis.sweep.plan import definitions as sweeps
from cyclosis.sweep.plan.variables import field, standard

HERE = Path(__file__).parent
NOTE = "<!-- Written by docs/generate.py from the definitions in the code. -->\n\n"


def settings() -> str:
    """Return the page of every setting."""
    out = NOTE + "# Settings\n\nThe tables of `run.toml` and the options of `cyclosis run`. "
    out += "All values but those of [scales] are dimensionless.\n"
    for table, items in TABLES.items():
        out += f"\n## [{table}]\n\n| name | option | symbol | meaning | allowed | default |\n"
        out += "|---|---|---|---|---|---|\n"
        for item in items:
            allowed = item.rule + (", or a field (n_theta, n_z)" if item.field else "")
            option = option_name(table, item)
            meant = f"{_cell(item.symbol)} | {_cell(item.meaning)}"
            out += f"| `{item.name}` | `{option}` | {meant} | {allowed} | {_default(item)} |\n"
    out += _protocols() + _sweep()
    out += "\n## Terms\n\n| name | in dP/dt |\n|---|---|\n"
    return out + "".join(f"| `{term.name}` | {_cell(term.formula)} |\n" for term in TERMS)


def _protocols() -> str:
    """Return the keys of the steps of a protocol and of their regions."""
    out = "\n## Protocols\n\nThe keys of a step of a [protocol](protocols.md), a table [[protocol]], "
    out += "besides `action`. `change` also\ntakes the names and values of [parameters].\n\n"
    out += "| action | does | key | meaning | allowed | default |\n|---|---|---|---|---|---|\n"
    out += f"| any | | `{AT.name}` | {AT.meaning} | {AT.rule} | - |\n"
    out += f"| | | `{NAME.name}` | {NAME.meaning} | a letter, then letters, digits, - and _ | - |\n"
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
    out += "Every region also takes `invert = true`, which gives its complement.\n\n"
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
    out += "without `seed`,\nand these.\n"
    out += "\n### [axes]\n\nA key is one of " + ", ".join(f"`{name}`" for name in sweeps.AXES)
    out += ", or\n[`protocol.STEP.KEY`](sweeps.md#axes-over-a-protocol)"
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
    """Return the rule of a setting. The ends of an axis have the rule of the swept setting."""
    return "as for the swept setting" if abs(item.minimum) >= 1e300 else item.rule


def _default(item: Definition) -> str:
    return "all" if isinstance(item.default, tuple) else "-" if item.default is None else str(item.default)


def quantities() -> str:
    """Return the page of every recorded quantity."""
    out = (
        NOTE + "# Quantities\n\nEvery run records these quantities, and `cyclosis.diagnose` returns them.\n\n"
    )
    out += "| name | symbol | dimensions | unit | meaning |\n|---|---|---|---|---|\n"
    for item in QUANTITIES:
        dims = ", ".join(("time", *item.dims))
        out += f"| `{item.name}` | {_cell(item.symbol)} | {dims} | {item.unit} | {_cell(item.meaning)} |\n"
    out += (
        "\n## Of every member of a sweep\n\nThe dimensions are the axes, `seed` and those of the table. "
        "The unit is 1. Missing values are\n-1 in integers and NaN in numbers. `[record] quantities` adds "
        "the quantities above, of the final state, and\n`fields = true` adds `P`.\n\n"
    )
    out += "| name | further dimensions | type | meaning |\n|---|---|---|---|\n"
    for variable in (*standard(polar), field(polar)):
        dims = ", ".join(variable.dims) or "-"
        out += f"| `{variable.name}` | {dims} | {variable.dtype} | {_cell(variable.meaning)} |\n"
    return out


def _cell(text: str) -> str:
    # A backslash keeps what looks like a tag, <P>, from being one.
    return re.sub(r"<(?=[A-Za-z]+>)", r"\\<", text.replace("|", "\\|"))


def symbols() -> str:
    """Return the page of symbols and the names that they have in code."""
    return NOTE + _page_of("symbol_table")


def gallery() -> str:
    """Return the page that shows the scripts of the gallery as cards, with their pictures and titles."""
    out = NOTE + "# Gallery\n\nEach phenomenon is shown by a script that takes some seconds, and by numbers "
    out += "that a test checks.\nThe scripts are in `examples/`, and these pages run them.\n"
    for heading, names in CHAPTERS.items():
        out += f"\n## {heading}\n\n" + cards(
            (f"{name}.md", f"../images/gallery/{name}.png", *_titled(SCRIPTS[name])[:2]) for name in names
        )
    return out + "\n```{toctree}\n:hidden:\n\n" + "".join(f"{p.stem}\n" for p in EXAMPLES) + "```\n"


def cards(items: Iterable[tuple[str, str, str, str]]) -> str:
    """Return a grid of cards, each with a page, a picture, a title, and the first sentence of a text."""
    out = "::::{grid} 1 2 2 3\n:gutter: 3\n"
    for page, picture, title, text in items:
        first = re.split(r"(?<=[.])\s", " ".join(text.split()))[0]
        out += f"\n:::{{grid-item-card}} {title}\n:img-top: {picture}\n:img-alt: {title}\n"
        out += f":link: {page.removesuffix('.md')}\n:link-type: doc\n\n{first}\n:::\n"
    return out + "::::\n"


def example(path: Path) -> str:
    """Return the page of one script of the gallery, which runs it."""
    title, text, first = _titled(path)
    cell = (
        'import sys\nimport tempfile\n\nimport PIL.Image\n\nsys.path.insert(0, "../../examples")\n'
        f"import {path.stem}\n\nfolder = tempfile.mkdtemp()\nfound = {path.stem}.main(folder)\n"
        f'PIL.Image.open(f"{{folder}}/{path.stem}.png")\n'
    )
    told = 'print(*(f"{value:12.6g}  {name}" for name, value in found.items()), sep="\\n")\n'
    return (
        "---\nfile_format: mystnb\nkernelspec:\n  name: python3\nmystnb:\n  execution_in_temp: false\n---\n\n"
        + NOTE
        + f"# {title}\n\n{text}\n\n```{{try-it}} {path.stem}\n```\n\n"
        + f"```{{code-cell}}\n:tags: [remove-input]\n\n{cell}```\n\n"
        + f"```{{code-cell}}\n:tags: [remove-input]\n\n{told}```\n\n"
        + f"`examples/{path.name}`:\n\n"
        + f"```{{literalinclude}} ../../examples/{path.name}\n:language: python\n:lines: {first}-\n```\n"
    )


def _titled(path: Path) -> tuple[str, str, int]:
    """Return a script's title, its description, and the line at which its code begins."""
    tree = ast.parse(path.read_text())
    title, _, text = (ast.get_docstring(tree) or "").partition("\n\n")
    return title.rstrip("."), text, tree.body[1].lineno


def api() -> str:
    """Return the page that lists the pages of the reference."""
    out = NOTE + "# Reference\n\nEvery public name, with an example.\n\n"
    out += "".join(f"* [{title}]({name}.md): {what}\n" for name, (title, what, *_) in REFERENCE.items())
    return out + "\n```{toctree}\n:hidden:\n\n" + "".join(f"{name}\n" for name in REFERENCE) + "```\n"


def reference(name: str) -> str:
    """Return one page of the reference."""
    title, what, names, modules = REFERENCE[name]
    out = NOTE + f"# {title}\n\n{what[0].upper()}{what[1:]}.\n\n"
    if names:
        out += _documented("cyclosis", names.split())
    for module in modules:
        text = (import_module(_home(module)).__doc__ or "").strip().split("\n\n")[0]
        out += f"## {module}\n\n{' '.join(text.split())}\n\n"
        out += _documented(module, FIGURES.get(module) or _public(_home(module)))
    return out


def _home(module: str) -> str:
    """Return the module that a name like cyclosis.zones refers to."""
    first, _, rest = module.partition(".")
    return getattr(cyclosis, rest).__name__ if rest in cyclosis.__all__ else f"{first}.{rest}"


def _public(module: str) -> list[str]:
    """Return the functions and classes that a module offers and that `cyclosis` itself does not."""
    home = import_module(module)
    package = hasattr(home, "__path__")
    found = [*HANDED_ON.get(module, ())]
    for name, value in vars(home).items():
        if name.startswith("_") or not (inspect.isfunction(value) or inspect.isclass(value)):
            continue
        own = value.__module__.startswith(module) if package else value.__module__ == module
        if own and getattr(cyclosis, name, None) is not value:
            found.append(name)
    return found


def _documented(module: str, names: Iterable[str]) -> str:
    out = "```{eval-rst}\n"
    home = cyclosis if module == "cyclosis" else import_module(_home(module))
    for name in names:
        value = getattr(home, name)
        if inspect.isclass(value):
            out += f".. autoclass:: {module}.{name}\n   :members:\n"
        elif inspect.isroutine(value):
            out += f".. autofunction:: {module}.{name}\n"
        else:
            out += f".. py:data:: {module}.{name}\n\n   {CONSTANTS[name]}\n\n"
    return out + "```\n\n"


def claims() -> str:
    """Return the page of the paper's claims, from the datasets in docs/data/experiments."""
    out = "<!-- Written by docs/generate.py from the datasets in data/experiments. -->\n\n"
    out += "# The paper's claims\n\n"
    out += "Woodhouse & Goldstein (2013) make claims about living cells and about their model. "
    out += "[Virtual experiments](experiments.md)\ntest each of them on the model cell. "
    out += "This page has the results of the full form. "
    out += "The last two claims, on the vacuole, are from other literature.\n\n"
    rows, sections, tally = "", [], dict.fromkeys(OUTCOMES, 0)
    for name in NAMES:
        file = HERE / "data" / "experiments" / f"{name}.nc"
        if not file.exists():
            continue
        chosen = experiment(name)
        with xarray.open_dataset(file, engine="h5netcdf") as data:
            said = {key: str(value) for key, value in data.attrs.items()}
            decisive = chosen.decisive(data)
        tally[said["verdict"]] += 1
        verdict, picture = f"**{said['verdict']}**", f"images/experiments/{name}.png"
        # Both GitHub and Sphinx link an image with a width to the image itself.
        thumbnail = f'<img src="{picture}" alt="{name}" width="120">'
        cells = (f"[{chosen.headline}](#{name})", verdict, decisive, thumbnail)
        rows += f"| {' | '.join(map(_cell, cells))} |\n"
        sections.append(
            f"## {name}\n\n![{name}: the cell and what was measured]({picture})\n\n"
            f"* **Claim:** {chosen.claim} ({chosen.source})\n"
            f"* **Verdict:** {verdict}\n"
            f"* **Method:** {chosen.method} {said['seeds']} seeds, `{said['command']}`.\n"
            "* **Measured:**\n" + "".join(f"    * {_cell(part)}\n" for part in _parts(said["measured"]))
        )
    agree, in_part, do_not = tally.values()
    total = agree + in_part + do_not
    out += f"Of {total} claims {agree} agree, {in_part} agree in part and {do_not} do not. "
    out += "Intervals are 95 %. Each claim leads to all that was measured. "
    out += "[The claims by every model](models_compared.md)\n"
    out += "judges them again where newer physics has something to say.\n\n"
    out += "| the paper's claim | verdict | decisive number | picture |\n|---|---|---|---|\n"
    return out + rows + "\n" + "\n".join(sections)


def models_compared() -> str:
    """Return the page that judges the claims by every model."""
    return _page_of("compared")


def _page_of(name: str) -> str:
    """Return the page that a module beside this file writes."""
    if str(HERE) not in sys.path:
        sys.path.insert(0, str(HERE))
    return str(import_module(name).page())


def _parts(text: str) -> list[str]:
    """Return the parts of a sentence, or of several, that semicolons and stops outside brackets divide."""
    parts, depth, start = [], 0, 0
    for k, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and text[k : k + 2] in ("; ", ". "):
            parts.append(text[start:k])
            start = k + 2
    return [*parts, text[start:]]


def peers() -> str:
    """Return the page that compares other codes."""
    spec = spec_from_file_location("peers_page", HERE.parent / "benchmarks" / "peers" / "page.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return str(module.page())


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


CHAPTERS = {
    "From disorder to two streams": ("emergence", "growth", "breaking_up", "two_ends"),
    "What keeps the pattern": ("thresholds", "unequal_stripes", "straightening", "wound", "cytochalasin"),
    "Other directions": ("circumferential", "drifting_stripes", "helix"),
    "Beyond the mean, beyond the cylinder": ("closure", "ends"),
    "Inside the cell": ("mixing", "transport"),
    "Your own cell": ("own_film",),
}
"""The scripts of the gallery, in its order."""
SCRIPTS = {name: HERE.parent / "examples" / f"{name}.py" for names in CHAPTERS.values() for name in names}
ORDER = tuple(SCRIPTS)
EXAMPLES = sorted((HERE.parent / "examples").glob("*.py"), key=lambda path: ORDER.index(path.stem))
"""The scripts of the gallery, in its order."""


HANDED_ON = {
    "cyclosis.analysis.diagnostics": ("Quantity",),
    "cyclosis.model.initial": ("bump", "with_concentration"),
    "cyclosis.kinetic": (
        *("moments", "density", "order", "dressed", "nematic", "disordered", "with_noise"),
        *("thresholds", "NematicThresholds", "uniform_state", "growth_rates", "kinetic_model"),
        *("dispersion", "KineticDispersion", "travelling_state", "TravellingState", "KineticModes"),
        *("continuation", "KineticBranch"),
    ),
}
"""Names that a module has from elsewhere and offers as its own."""
CONSTANTS = {
    "TERMS": "The terms of the filament equation, a tuple of `Term`: `terms=[*cy.TERMS, mine]` adds one.",
    "REGIMES": "The names that a `Regime` may have; a sweep stores their indices.",
    "__version__": "The version of this package.",
}
FIGURES = {
    "cyclosis.figures.emergence": ["emergence"],
    "cyclosis.figures.history": ["history"],
    "cyclosis.figures.snapshot": ["snapshot"],
    "cyclosis.figures.compare": ["compare"],
    "cyclosis.figures.roses": ["roses"],
    "cyclosis.figures.movie": ["movie"],
    "cyclosis.figures.cylinder": ["draw"],
    "cyclosis.figures.unwrapped": ["draw_map"],
    "cyclosis.figures.streamlines": ["streamlines"],
    "cyclosis.figures.phase_diagram": ["phase_diagram"],
    "cyclosis.figures.regime_maps": ["regimes_and_time"],
    "cyclosis.figures.basins": ["basins"],
    "cyclosis.figures.dispersion": ["dispersion", "kinetic_dispersion"],
    "cyclosis.figures.kinetic": ["travelling"],
    "cyclosis.figures.spectra": ["profile", "drifting", "spectrum", "eigenvalues"],
    "cyclosis.figures.bifurcation": ["bifurcation"],
    "cyclosis.figures.limits": ["limits"],
    "cyclosis.figures.regime_map": ["regime_map"],
    "cyclosis.figures.vacuole_section": ["vacuole_section"],
    "cyclosis.figures.vacuole_cutaway": ["vacuole_cutaway"],
    "cyclosis.figures.vacuole_pitch": ["vacuole_pitch"],
    "cyclosis.figures.vacuole_uptake": ["vacuole_uptake"],
    "cyclosis.figures.vacuole_dispersion": ["vacuole_dispersion"],
    "cyclosis.figures.vacuole_poincare": ["vacuole_poincare"],
    "cyclosis.figures.dye": ["dye"],
    "cyclosis.figures.measured": ["measurement", "comparison"],
    "cyclosis.figures.fitted": ["fitted"],
    "cyclosis.figures.plot": ["Plot"],
    "cyclosis.figures.looks": ["chosen"],
    "cyclosis.figures.style": ["save"],
}
"""The functions that draw and write figures, by module."""

REFERENCE: dict[str, tuple[str, str, str, tuple[str, ...]]] = {
    "cell": (
        "A cell",
        "parameters, grid, units, initial states, regions, and the right-hand side",
        "Parameters CylinderGrid Scales flow rate_of_change interpolate Term TERMS InputError __version__",
        ("cyclosis.initial", "cyclosis.regions"),
    ),
    "run": (
        "A run",
        "simulating a cell, continuing a run, and protocols",
        "simulate resume Trajectory Status Snapshot Protocol "
        "change wash_out fragment depolymerise align noise",
        (),
    ),
    "analysis": (
        "What a state is",
        "recorded quantities, spectra, indifferent zones and regimes",
        "diagnose spectra regime Regime REGIMES",
        ("cyclosis.diagnostics", "cyclosis.zones"),
    ),
    "files": (
        "Files",
        "writing and reading runs",
        "write open_dataset load resume_file RunWriter",
        ("cyclosis.dataset",),
    ),
    "sweeps": (
        "Ensembles and sweeps",
        "many cells, each until its end is certain",
        "Sweep run_sweep open_sweep",
        ("cyclosis.ensemble", "cyclosis.sweep.export", "cyclosis.sweep.store"),
    ),
    "stability": ("Theory", "steady states, growth rates, thresholds", "", ("cyclosis.stability",)),
    "experiments": ("Experiments", "tests of the paper's claims on the model", "", ("cyclosis.experiments",)),
    "figures": ("Figures", "pictures of runs, sweeps and theory", "", tuple(FIGURES)),
    "models": ("Models", "the physics to choose from", "", ("cyclosis.models", "cyclosis.kinetic")),
    "closed": (
        "The closed cell",
        "shapes, grids, initial states and defects on closed surfaces",
        "Capsule Spheroid Sphere ClosedGrid",
        ("cyclosis.closed",),
    ),
    "vacuole": ("The vacuole", "the flow inside the cell, and what it carries", "", ("cyclosis.vacuole",)),
    "observations": (
        "Measured cells",
        "reading measurements, the camera, and comparing with runs",
        "",
        ("cyclosis.observations",),
    ),
    "fitting": (
        "Fits",
        "the model fitted to a measurement, with what it cannot tell",
        "fit",
        ("cyclosis.fitting",),
    ),
    "traced": ("For JAX", "the functions that `jit`, `grad` and `vmap` may trace", "", ("cyclosis.traced",)),
}
"""Pages of the reference: title, what is there, names of `cyclosis`, and modules."""


def worksheet() -> str:
    """Return the page of questions for a class."""
    out = NOTE + "# A worksheet for a class\n\nTen questions to the [explorer](explorer.md), each with a "
    out += "cell to try it on. On the site of this\ndocumentation the links open the cells in the browser. "
    out += "Elsewhere start `cyclosis explore` first: the links lead there. At another\naddress, put what "
    out += "follows `#` behind it. The explorer itself has the questions under *Worksheet*, also in German. "
    out += "A test\ntries each question, and checks what is seen.\n"
    for k, item in enumerate(described(), 1):
        address = f"http://127.0.0.1:8765/#{item['link']}"
        out += f"\n## {k}. {item['question']}\n\n{item['attempt']} [Open the cell]({address}).\n\n"
        out += f"*What is seen:* {item['answer']}\n"
    return out


PAGES = {
    "worksheet.md": worksheet,
    "settings.md": settings,
    "quantities.md": quantities,
    "symbols.md": symbols,
    "gallery/index.md": gallery,
    **{f"gallery/{path.stem}.md": partial(example, path) for path in EXAMPLES},
    "api/index.md": api,
    **{f"api/{name}.md": partial(reference, name) for name in REFERENCE},
    "claims.md": claims,
    "models_compared.md": models_compared,
    "peers.md": peers,
    "../src/cyclosis/explorer/figure5.json": phase_diagram,
}
"""Paths from this folder, and the functions that return their content."""

if __name__ == "__main__":
    for name, page in PAGES.items():
        (HERE / name).parent.mkdir(exist_ok=True)
        (HERE / name).write_text(page())
