"""Which processes make cyclosis: each removed, and each alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from ..analysis.regimes import REGIMES
from ..ensemble import OUTCOMES
from ..figures.story import Panel, cells, story
from ..figures.style import DOWN, INK, PAPER, QUIET, SHADE, UP
from ..model import initial
from ..model.definitions import TERM_NAMES
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab, frames
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

COUPLINGS = {
    "bundling": {"alpha_p": 0.0},
    "flow alignment": {"alpha_u": 0.0},
    "repulsion": {"kappa": 0.0},
    "diffusion": {"d_s": 0.0},
    "shear and advection": {"epsilon": 0.0},
}
"""What must be zero for a process to be absent; shear and advection share one coupling."""
TERMS = {"shear": "shear", "advection": "advection"}
ORDERING = ("bundling", "flow alignment", "repulsion", "shear", "advection")
"""Processes that could create order. Both diffusions only reduce it, and remain where a process is alone."""
QUICK = ("everything", *(f"without {one}" for one in ORDERING[:3]), *(f"only {one}" for one in ORDERING[:2]))
SHOWN = QUICK
STARTS = {
    "disorder": {"kind": "disordered"},
    # Established stripes, with the noise of as many filaments as leave |P| <= 1.
    "stripes": {"kind": "stripes", "magnitude": 0.9, "filaments_per_square": 4000.0},
}
END, QUICK_END = 200.0, 80.0
"""Time at which a run stops if the final regime is not certain by then."""
EQUAL = 0.005
"""Difference of a stripe's width from a half that counts as zero."""
FATES = {
    "two equal stripes": UP,
    "two unequal stripes": "#bd9bdc",
    "one direction": DOWN,
    "around the axis": "#d08b2e",
    "other order": QUIET,
    "finer than the grid": SHADE,
    "disorder": INK,
}
"""The fates of a cell, and their colours."""
FEW = 0.2
"""Upper end of the interval of a share of cells that counts as none."""


def conditions() -> dict[str, tuple[dict[str, float], tuple[str, ...]]]:
    """Return the couplings that are zero and the terms that remain, by the name of the condition."""
    every = tuple(TERM_NAMES)
    found: dict[str, tuple[dict[str, float], tuple[str, ...]]] = {"everything": ({}, every)}
    for name, off in COUPLINGS.items():
        found[f"without {name}"] = (off, every)
    for name, term in TERMS.items():
        found[f"without {name}"] = ({}, tuple(one for one in every if one != term))
    for name in ORDERING:
        kept = "shear and advection" if name in TERMS else name
        off = {key: 0.0 for one, zero in COUPLINGS.items() if one not in (kept, "diffusion") for key in zero}
        other = next((one for one in TERMS.values() if name in TERMS and one != name), None)
        found[f"only {name}"] = (off, tuple(one for one in every if one != other))
    return found


def measure(lab: Lab) -> xarray.Dataset:
    """Return the fate of every cell by condition and initial state, and the frames of some."""
    tried = {name: how for name, how in conditions().items() if not lab.quick or name in QUICK}
    end = QUICK_END if lab.quick else END
    found = _cells(lab, end)
    fate = np.empty((len(tried), len(STARTS), lab.seeds), dtype=np.int8)
    for k, (name, (off, terms)) in enumerate(tried.items()):
        for j, (start, table) in enumerate(STARTS.items()):
            values = {"alpha_p": 1.0, "alpha_u": 0.5} | off
            # Without flow stripes merge too slowly for the end to be certified.
            creeps = values["alpha_p"] > 0 and values["alpha_u"] == 0
            tables = {
                "initial": table,
                "axes": {"alpha_u": {"values": [values.pop("alpha_u")]}},
                "parameters": values,
                "run": {
                    "t_end": end,
                    "finish": "t_end" if creeps else "certified",
                    "rtol": 1e-3,
                    "terms": list(terms),
                },
            }
            label = f"{name}-{start}".replace(" ", "-")
            swept = lab.sweep(label, tables).isel(alpha_u=0)
            fate[k, j] = fates(
                np.asarray(swept["regime"].values),
                np.asarray(swept["status"].values),
                np.asarray(swept["stripe_width"].values)[:, 0],
            )
    found["fate"] = ("tried", "start", "seed"), fate
    return found.assign_coords(tried=list(tried), start=list(STARTS)).assign_attrs(end=end)


def _cells(lab: Lab, end: float) -> xarray.Dataset:
    """Return the frames of cells that began disordered, one for each of `SHOWN`, at the end."""
    grid = CylinderGrid(48, 48, 5.0)
    shown = []
    for name in SHOWN:
        params = Parameters(alpha_p=1.0, alpha_u=0.5).replace(**conditions()[name][0])
        run = lab.story(params, grid, initial.disordered(grid), end, (end,), rtol=1e-3)
        shown.append(frames(run, (end,)))
    return xarray.concat(shown, "frame", combine_attrs="override", data_vars="minimal")


def fates(
    regime: npt.NDArray[Any], status: npt.NDArray[Any], width: npt.NDArray[Any]
) -> npt.NDArray[np.int8]:
    """Return the fates of cells (n,), as numbers in `FATES`, from regime, status and a stripe's width."""
    lost = (status == OUTCOMES.index("underresolved")) | (status == OUTCOMES.index("diverged"))
    two = regime == REGIMES.index("cyclosis")
    equal = np.abs(width - 0.5) <= EQUAL
    where = {
        "finer than the grid": lost,
        "two equal stripes": two & equal,
        "two unequal stripes": two & ~equal,
        "one direction": regime == REGIMES.index("unidirectional"),
        "around the axis": regime == REGIMES.index("circumferential"),
        "disorder": regime == REGIMES.index("disordered"),
    }
    names = list(FATES)
    codes = [names.index(name) for name in where]
    return np.select(list(where.values()), codes, names.index("other order")).astype(np.int8)


def _share(data: xarray.Dataset, tried: str, start: str, fate: str) -> tuple[float, float, float]:
    codes = np.asarray(data["fate"].sel(tried=tried, start=start).values)
    return proportion(int(np.sum(codes == list(FATES).index(fate))), codes.size)


def _alone(data: xarray.Dataset) -> tuple[float, float, float]:
    """Return the share of disordered cells with a single process that end with two equal stripes."""
    single = [str(name).startswith("only") for name in data["tried"].values]
    fate = np.asarray(data["fate"].sel(start="disorder").values)[single]
    return proportion(int(np.sum(fate == 0)), fate.size)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: all processes together turn disorder into two equal stripes, none alone does; several must."""
    tried = [str(name) for name in data["tried"].values]
    equal = {name: _share(data, name, "disorder", "two equal stripes") for name in tried}
    single = _alone(data)
    fine = {name for name in tried if _share(data, name, "disorder", "finer than the grid")[0] > 0.5}
    without = {name.removeprefix("without "): equal[name] for name in tried if name.startswith("without")}
    needed = [name for name, one in without.items() if one[2] < 0.5 and f"without {name}" not in fine]
    spare = [name for name, one in without.items() if one[1] > 0.5]
    spare = [name for name in spare if not any(name != one and name in one for one in spare)]
    text = (
        f"with all processes disorder becomes two equal stripes in {in_words(equal['everything'])} of "
        f"{data.sizes['seed']} cells, with a single one in {in_words(single)}; without "
        + ", ".join(f"{name} in {in_words(without[name])}" for name in needed)
    )
    if spare:
        least = min((without[name] for name in spare), key=lambda one: one[0])
        text += f"; {' and '.join(spare)} can be spared ({in_words(least)} without)"
    if fine:
        text += f"; {', '.join(sorted(fine))} order becomes finer than the grid, with no end to be seen"
    kept = [
        name
        for name in tried
        if equal[name][2] < 0.5
        and name not in fine
        and _share(data, name, "stripes", "two equal stripes")[1] > 0.5
    ]
    if kept:
        text += f". Stripes that are there already last {' and '.join(kept)}, to t = "
        text += f"{float(data.attrs['end']):g} at least"
    together = equal["everything"][1] > 0.5
    if not together or single[1] > FEW:
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if single[2] <= FEW and len(needed) > 1 else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of cells in which a single process makes two equal stripes."""
    return f"{in_words(_alone(data))} of cells get two equal stripes by one process"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw a cell for some conditions, and the fates of all cells, from disorder and from stripes."""
    tried = [str(name) for name in data["tried"].values]

    def bars(ax: Any, start: str) -> None:
        codes = np.asarray(data["fate"].sel(start=start).values)
        counts = np.array([np.bincount(row, minlength=len(FATES)) for row in codes])
        shares = 100 * counts / codes.shape[1]
        left = np.zeros(len(tried))
        rows = -np.arange(len(tried)) - 0.4 * np.cumsum(_breaks(tried))
        for k, (name, colour) in enumerate(FATES.items()):
            ax.barh(rows, shares[:, k], 0.78, left, color=colour, label=name)
            left = left + shares[:, k]
        for row, count in zip(rows, counts[:, 0], strict=True):
            if 0 < count < codes.shape[1]:
                _, low, high = proportion(int(count), codes.shape[1])
                ax.plot([100 * low, 100 * high], [row, row], color=PAPER, linewidth=1.0)
        ax.spines["left"].set_visible(False)
        ax.set_yticks([])
        ax.set_ylim(rows[-1] - 0.6, 0.6)
        ax.set_xticks([0, 50, 100])
        ax.set_xlabel({"disorder": "cells, %, begun in disorder", "stripes": "begun with two stripes"}[start])
        ax.xaxis.labelpad = 1.0
        if start == "disorder":
            for row, name in zip(rows, tried, strict=True):
                ax.text(-3, row, name, fontsize=8.0, ha="right", va="center_baseline")
            ax.set_xlim(-85, 100)
            ax.spines["bottom"].set_bounds(0, 100)
            ax.xaxis.set_label_coords(0.73, -0.1)
            ax.legend(
                loc="lower left", bbox_to_anchor=(-0.13, 0.985), ncols=len(FATES), fontsize=8.0,
                frameon=False, handlelength=0.8, handletextpad=0.4, columnspacing=1.0,
            )  # fmt: skip
        else:
            ax.set_xlim(0, 100)
            ax.xaxis.set_label_coords(0.5, -0.1)

    panels = [Panel(lambda ax: bars(ax, "disorder"), 1.85), Panel(lambda ax: bars(ax, "stripes"))]
    titles = [name.replace("without", "no") for name in SHOWN]
    return story(cells(data, titles), panels, str(verdict(data)), same_view=False)


def _breaks(tried: list[str]) -> npt.NDArray[np.bool_]:
    """Return where a new kind of condition begins, by the first word of its name."""
    kinds = [name.split()[0] for name in tried]
    return np.array([k > 0 and kinds[k] != kinds[k - 1] for k in range(len(kinds))])


EXPERIMENT = Experiment(
    name="ablation",
    headline="No single process makes cyclosis; several together do.",
    claim="Several independent processes, none of which achieves anything alone, reinforce each other and so "
    "make cyclosis.",
    source="Abstract; Discussion (importance of each component)",
    method="At α_p = 1 and α_u = 0.5 the coupling of each process is set to zero (the term is left out "
    "where two share one), and each ordering process is left alone with the two diffusions. Cells begin "
    "disordered or with two stripes, and are integrated until their end is certain, or to t = 200.",
    seeds=200,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
