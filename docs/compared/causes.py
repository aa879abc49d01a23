"""Claims on what makes the streams: bundling, motors, several processes together, and weak flow."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray

from cyclosis.experiments import closure, coalescence, ends_verdict
from cyclosis.experiments import vacuole_passive_verdict as passive
from cyclosis.experiments.ablation import FATES
from cyclosis.experiments.experiment import AGREES, DOES_NOT, IN_PART
from cyclosis.models.closed.states import REGIMES as CLOSED

from .rows import (
    FEW,
    HALF,
    KAPPA,
    MOST,
    ONE,
    STRONG,
    TWO,
    Cells,
    Row,
    bears_out,
    judged,
    of,
    onset,
    ring_counts,
    striped,
)

FACTORS = ("bundling", "repulsion", "flow alignment")
EQUAL = 0.01
"""Difference of widths from a half up to which stripes are equal."""


def last_speed(data: xarray.Dataset, alpha_u: float) -> tuple[int, int]:
    """Return how many capsules under the drug stream, and of how many."""
    speed = data["peak_speed"].sel(alpha_u=alpha_u).values
    return int((speed > 0.05).sum()), speed.size


def _drug_cells(data: Any) -> Cells:
    drug, cells, capsule = data["cytochalasin"], data["closure"], data["drug-capsule"]
    streams = {way: drug["streams"].sel(way=way, alpha_u=0.5).values for way in drug["way"].values}
    left = closure.lasting(cells.sel(fading_kappa=KAPPA, method="nearest"), "kinetic")
    zero = cells["ring"].sel(model="kinetic", number="outcome", alpha_p=0.0).values
    zero = zero[np.isfinite(zero)]
    on_capsule = last_speed(capsule, 0.5)
    fold = passive.ratios(data["vacuole-passive"], STRONG)["fold"]
    begin, lasts = of(streams["from disorder"].sum(), streams["from disorder"].size), streams["established"]
    return {
        "polar": (
            judged(not lasts.any(), not streams["from disorder"].any()),
            f"{begin} from disorder stream, but {of(lasts.sum(), lasts.size)} established cells stream on",
        ),
        "kinetic": (
            judged(not left.any() and not zero.any(), not zero.any()),
            f"{of((zero > 0).sum(), zero.size)} rings order, and established stripes last at "
            f"{of(left.sum(), left.size)} values of α_u",
        ),
        "closed": (
            judged(on_capsule[0] == 0, True),
            f"{of(*on_capsule)} established capsules stream on at α_u = 0.5, "
            f"{of(*last_speed(capsule, 0.2))} at 0.2",
        ),
        "vacuole": (
            judged(False, fold > 0),
            f"established stripes last above an α_u {fold:.3f} times as large at β = {STRONG:g}",
        ),
    }


def _drug_why(data: Any) -> str:
    told = {name: verdict for name, (verdict, _) in _drug_cells(data).items()}
    bears_out(told["kinetic"] == AGREES and told["polar"] == IN_PART, "the drug stops kinetic cells only")
    fold = float(data["cytochalasin"]["fold"][0])
    weak = data["closure"].sel(fading_kappa=slice(0.05, 0.2))
    lasting = closure.lasting(weak, "kinetic")
    bears_out(lasting.any(), "kinetic streams last with weaker repulsion")
    return (
        "Believe the kinetic model, which here is on the paper's side. That flow alone keeps established "
        f"stripes up (above α_u = {fold:.4f} on the cylinder) is an error of the closure, which has no "
        "nematic "
        "state for them to fade into. With weaker repulsion (κ of 0.05 to 0.2) streams last in the kinetic "
        f"model too, at {of(lasting.sum(), lasting.size)} places."
    )


def processes(data: xarray.Dataset, two: xarray.DataArray) -> tuple[list[tuple[int, int]], tuple[int, int]]:
    """Return how many members have two streams with all of three processes, without each, and with one."""
    full = {"alpha_p": 1.0, "kappa": 0.5, "alpha_u": 0.5}
    names = list(full)

    def count(on: set[str]) -> tuple[int, int]:
        cells = two.sel({name: full[name] if name in on else 0.0 for name in names}).values
        return int(cells.sum()), cells.size

    single = [count({name}) for name in names]
    lists = [count(set(names)), *(count({*names} - {name}) for name in names)]
    return lists, (sum(pair[0] for pair in single), sum(pair[1] for pair in single))


def process_counts(data: Any) -> dict[str, tuple[list[tuple[int, int]], tuple[int, int]]]:
    """Return the counts of `processes` by model."""
    rings, capsules = data["processes-kinetic"], data["processes-capsule"]
    two = np.abs(striped(rings) - 0.5).max("zone", skipna=True) < EQUAL
    return {
        "kinetic": processes(rings, two),
        "closed": processes(capsules, capsules["regime"] == CLOSED.index("cyclosis")),
    }


def _process_cells(data: Any) -> Cells:
    fate = data["ablation"]["fate"].sel(start="disorder")
    equal = fate == list(FATES).index("two equal stripes")
    alone = equal.sel(tried=[str(name) for name in fate["tried"].values if str(name).startswith("only")])
    without = {name: int(equal.sel(tried=f"without {name}").sum()) for name in FACTORS}
    found = {
        "polar": (
            [
                (int(equal.sel(tried="everything").sum()), fate.sizes["seed"]),
                *((count, fate.sizes["seed"]) for count in without.values()),
            ],
            (int(alone.sum()), alone.size),
        ),
        **process_counts(data),
    }
    return {name: (_needs(*counts), _needed(*counts)) for name, counts in found.items()}


def _needs(lists: list[tuple[int, int]], single: tuple[int, int]) -> str:
    together, without = lists[0], lists[1:]
    good = together[0] > MOST * together[1] and single[0] <= FEW * single[1]
    return judged(good and sum(pair[0] < HALF * pair[1] for pair in without) > 1, good)


def _needed(lists: list[tuple[int, int]], single: tuple[int, int]) -> str:
    told = ", ".join(f"{pair[0]} without {name}" for name, pair in zip(FACTORS, lists[1:], strict=True))
    return f"{of(*lists[0])} with all three, {told}; {of(*single)} with a single one"


def _process_why(data: Any) -> str:
    told = _process_cells(data)
    bears_out(all(verdict == AGREES for verdict, _ in told.values()), "several processes are needed")
    counts = process_counts(data)["closed"][0]
    closed = counts[FACTORS.index("flow alignment") + 1]
    bears_out(closed[0] > HALF * closed[1], "capsules do without flow alignment")
    speed = data["processes-capsule"]["peak_speed"].sel(alpha_p=1.0, kappa=KAPPA)
    off, on = (
        f"{float(s.min()):.3f} to {float(s.max()):.3f}" for s in (speed.sel(alpha_u=a) for a in (0, 0.5))
    )
    return (
        "All models agree that it takes several, bundling and repulsion among them. Alignment with the "
        "flow is "
        f"not among them on a capsule: {of(*closed)} have two streams without it, because one stream is "
        "unstable between rounded ends. Believe that for such cells. Alignment still makes all cells "
        "alike: their "
        f"peak speeds are {on} with it and {off} without."
    )


# Without motors, and with weak flow


class Unaligned(NamedTuple):
    """How many cells without flow alignment have one stream, two, of how many; speed of the former."""

    one: int
    two: int
    total: int
    speed: float


def unaligned(data: Any) -> dict[str, Unaligned]:
    """Return what became of cells without flow alignment, by model."""
    motors = data["myosin-inhibition"].isel(alpha_p=-1)
    outcome, speed = motors["outcome"].values, motors["speed"].values
    rings = data["closure"]["ring"].sel(model="kinetic", alpha_u=0.0)
    rings = rings.isel(alpha_p=np.flatnonzero(rings["alpha_p"].values > onset(data)[1]))
    ended, fast = (rings.sel(number=name).values for name in ("outcome", "speed"))
    capsule = data["processes-capsule"].sel(alpha_p=1.0, kappa=KAPPA, alpha_u=0.0)
    regime = capsule["regime"].values
    sink = regime == CLOSED.index("source-to-sink")
    return {
        "polar": _counted(outcome == 0, np.isin(outcome, (1, 2)), speed),
        "kinetic": _counted(ended == ONE, ended == TWO, fast),
        "closed": _counted(sink, regime == CLOSED.index("cyclosis"), capsule["peak_speed"].values),
    }


def _counted(one: np.ndarray, two: np.ndarray, speed: np.ndarray) -> Unaligned:
    total = int(np.isfinite(speed).sum())
    return Unaligned(
        int(one.sum()), int(two.sum()), total, float(np.median(speed[one])) if one.any() else 0.0
    )


def _motor_cells(data: Any) -> Cells:
    return {
        name: (
            judged(found.one > HALF * found.total and found.speed > 0.05, found.one > 0),
            f"one in {of(found.one, found.total)}"
            + (f" (median speed {found.speed:.0e})" if found.one else "")
            + f", two in {found.two}",
        )
        for name, found in unaligned(data).items()
    }


def _motor_why(data: Any) -> str:
    told = {name: verdict for name, (verdict, _) in _motor_cells(data).items()}
    bears_out(told["polar"] == IN_PART and told["closed"] == DOES_NOT, "capsules do not end with one stream")
    advection = float(
        data["ends"]["parts"].sel(pushed="capsule 5, 0.5, 0", defect="displaced", part="advection")
    )
    bears_out(advection > 0, "advection drives the sink of one stream away")
    return (
        "On both cylinders what is left is order in one direction, which drives no flow, as no net flux "
        "can pass "
        "the ends. Believe the capsule: with rounded ends the experiment that the paper proposes would "
        "show "
        "two streams, and would not refute the mechanism. What makes them two is that the flow still "
        "carries "
        f"filaments (ε = 0.1): advection alone lets a displaced sink grow at {advection:.4f}."
    )


def _weak_cells(data: Any) -> Cells:
    near = data["coalescence"]
    zero = coalescence.crossing(near["near"].values, near["growth"].values)
    two, rings = ring_counts(data)
    none, some = two.sel(alpha_u=0.0).sum(), two.sum("alpha_p") == rings.sum("alpha_p")
    least = float(some["alpha_u"].where(some).min())
    ends = data["ends"]
    weak = ends["end"].sel(shape=ends_verdict.CAPSULE, alpha_u=ends["alpha_u"].min())
    kinds = ends_verdict.kinds(weak)
    begins = ends_verdict.onset(ends, 0.0)
    ratio = passive.ratios(data["vacuole-passive"], STRONG)["alpha_u_widths"]
    return {
        "polar": (
            judged(abs(zero - 1) < 0.05),
            f"equal stripes are stable above {zero:.3f} of the predicted α_u = "
            f"{float(near.attrs['threshold']):.5f} (α_p = 0.1)",
        ),
        "kinetic": (
            judged(np.isfinite(least) and none < HALF * rings.sel(alpha_u=0.0).sum()),
            f"two stripes in {of(none, rings.sel(alpha_u=0.0).sum())} rings at α_u = 0, in all from "
            f"{least:.2f} on",
        ),
        "closed": (
            judged(False, begins > 0),
            f"two streams in {of((kinds == 1).sum(), (kinds != ends_verdict.NONE).sum())} capsules at "
            f"α_u = {float(ends['alpha_u'].min()):g}; at α_u = 0 advection does it from ε = {begins:.3f} "
            "on",
        ),
        "vacuole": (
            judged(np.isfinite(ratio)),
            f"above an α_u {ratio:.3f} times as large at β = {STRONG:g}",
        ),
    }


def _weak_why(data: Any) -> str:
    told = {name: verdict for name, (verdict, _) in _weak_cells(data).items()}
    bears_out(told["kinetic"] == AGREES and told["closed"] == IN_PART, "only capsules need no alignment")
    return (
        "Flow stabilises two streams in all models. On a closed cell it need not turn filaments to do "
        "so: it carries them, and with them the sink of one "
        "stream. Believe that for rounded ends; the threshold of the paper is one of cells without ends."
    )


ROWS = (
    Row(
        "The drug",
        "A drug against bundling (α_p = 0) stops streaming.",
        "Discussion; Model",
        _drug_cells,
        _drug_why,
    ),
    Row(
        "Motors",
        "With myosin inhibited (α_u = 0) one stream is left, or two of unequal width.",
        "Discussion",
        _motor_cells,
        _motor_why,
    ),
    Row(
        "Several processes",
        "Several processes make two streams, each ineffectual on its own.",
        "Abstract",
        _process_cells,
        _process_why,
    ),
    Row(
        "Weak flow",
        "Above a small α_u flow stabilises two streams, which merge without it.",
        "Flow-Stabilized Pattern Formation",
        _weak_cells,
        _weak_why,
    ),
)
"""Rows of the table."""
