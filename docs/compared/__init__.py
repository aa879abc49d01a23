"""The page that judges the paper's claims again by every model, from the stored datasets.

Each cell of its table is computed, the verdict included. `docs/generate.py` writes the page.
"""

from __future__ import annotations

from pathlib import Path

import xarray

from . import beyond, causes, patterns

HERE = Path(__file__).parents[1]
EXPERIMENTS, SWEEPS = HERE / "data" / "experiments", HERE / "data" / "compared"
ROWS = (*patterns.ROWS, *causes.ROWS, *beyond.ROWS)
COLUMNS = ("polar", "kinetic", "closed", "vacuole")
HEAD = """<!-- Written by docs/generate.py from the datasets in data/experiments and data/compared. -->

# The claims by every model

[The paper's claims](claims.md) were tested on the paper's own model. Those on which newer physics has
something to say are judged again here, with the numbers of all models side by side.

| model | what it is |
|---|---|
| [polar](model.md) | the paper's: order by a moment closure, on a periodic cylinder without net flux |
| [kinetic](kinetic.md) | the density of filament angles, which the closure approximates, on that cylinder |
| [closed](closed.md) | the polar model on cells with ends: capsules, spheroids, droplets |
| [vacuole](vacuole.md) | the polar model with the drag β of the vacuole's fluid; 0.007 for a thin layer |

The verdict is that on the paper's claim, and follows from the number beside it. *Not asked*: nobody has
computed it. Intervals are 95 %.

![Verdicts on twelve claims by four models](images/models-compared.png)
*The verdicts of the table below, drawn by `python docs/compared_picture.py`.*

"""
RULES = """
## Which to believe

Three rules decide most rows.

* **Kinetic before polar.** The paper starts from the kinetic equation, and its polar equation approximates
  it. Where they differ, the closure is wrong as a solution of the stated physics. That does not say which is
  nearer to *Chara*: α_p and α_u have not been measured there, and a cell with larger values may behave as the
  paper says.
* **Ends before a cylinder.** A cell has ends. On a closed surface no flux has to be forbidden. But how
  strongly a pointed end repels filaments is not in the paper, and the fate of pointed cells depends on it.
* **The vacuole by its drag.** Below β = {tilts:.3f} streams are as without it. A thin layer is far below.

No model has two of these at once: the density of angles on a closed cell, or with the drag of the vacuole,
has not been computed.

"""
ORIGIN = """
## Where the numbers come from

From the experiments
{experiments},
and from small sweeps that ask the other models what only the polar one had been asked:

{sweeps}

They are made by

    cyclosis sweep run sweeps/compared/NAME.toml --out NAME
    cyclosis sweep export NAME --out docs/data/compared/NAME.nc
    python docs/generate.py

The grids are those of the experiments `closure` and `ends`, which compare finer ones. Each dataset holds its
configuration, versions and date. `tests/test_models_compared.py` counts again what the
table says, without the code that writes it. A sentence that the data no longer bear out is not written.
"""


class Stored:
    """The datasets by name, each read when it is first needed.

    `changed` are used instead of stored ones. `used` are the names of all that were needed.
    """

    def __init__(self, changed: dict[str, xarray.Dataset] | None = None) -> None:
        self._held = dict(changed or {})
        self.used: list[str] = []

    def __getitem__(self, name: str) -> xarray.Dataset:
        if name not in self.used:
            self.used.append(name)
        if name not in self._held:
            file = SWEEPS / f"{name}.nc"
            with xarray.open_dataset(
                file if file.exists() else EXPERIMENTS / f"{name}.nc", engine="h5netcdf"
            ) as data:
                self._held[name] = data.load()
        return self._held[name]


def page(stored: Stored | None = None) -> str:
    """Return the page. Raises `ValueError` where the data do not bear out one of its sentences."""
    stored = stored or Stored()
    table = f"| the paper | {' | '.join(COLUMNS)} |\n|---|{'---|' * len(COLUMNS)}\n"
    reasons = ""
    for row in ROWS:
        cells = row.cells(stored)
        table += f"| {row.claim} ({row.source}) | {' | '.join(_shown(cells.get(c)) for c in COLUMNS)} |\n"
        reasons += f"* **{row.title}.** {row.why(stored)}\n"
    tilts = float(stored["vacuole-passive"]["tilting_drag"].sel(cell="corner"))
    swept = sorted(name for name in stored.used if (SWEEPS / f"{name}.nc").exists())
    experiments = ", ".join(f"[{n}](claims.md#{n})" for n in sorted(set(stored.used) - set(swept)))
    sweeps = "\n".join(f"* [{n}](../sweeps/compared/{n}.toml): {_size(stored[n])}" for n in swept)
    origin = ORIGIN.format(experiments=experiments, sweeps=sweeps)
    return HEAD + table + RULES.format(tilts=tilts) + reasons + origin


def verdicts(stored: Stored | None = None) -> dict[str, dict[str, str]]:
    """Return the verdict by title of the row and by model, "" without one."""
    stored = stored or Stored()
    found = {row.title: row.cells(stored) for row in ROWS}
    return {title: {c: cells.get(c, ("", ""))[0] for c in COLUMNS} for title, cells in found.items()}


def _shown(cell: tuple[str, str] | None) -> str:
    if cell is None:
        return "not asked"
    verdict, number = cell
    return (f"**{verdict}**: {number}" if verdict else number).replace("|", "\\|")


def _size(data: xarray.Dataset) -> str:
    return f"{data['regime'].size} runs of {str(data.attrs['created'])[:10]}"
