"""Sweeps, their expected cost and their outcome, in a few lines of text."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.errors import InputError
from ..model.units import of_table, time_unit
from .lines import aligned

if TYPE_CHECKING:
    from ..sweep.cluster.estimate import Estimate
    from ..sweep.cluster.progress import SweepProgress, SweepSummary
    from ..sweep.plan.sweep import Sweep
    from ..sweep.store.store import Store

FEW = 10
"""Number of failures that are listed one by one."""


def plan(sweep: Sweep, cost: Estimate) -> str:
    """Return what a sweep will compute and cost."""
    run = sweep.tables["run"]
    follow = "to their certain regimes, at most" if run["finish"] == "certified" else "each"
    axes = [f"{name} {len(values)}" for name, values in sweep.axes.items()]
    sample = f"{_number(cost.members, 'run')} at {_number(cost.points, 'point')} spread over the axes"
    each = f"{cost.core_seconds / sweep.members:.3g} s a run"
    steps = {"protocol": "; ".join(map(str, sweep.protocol))} if sweep.protocol else {}
    return aligned(
        {"sweep": " x ".join([*axes, f"seed {len(sweep.seeds)}"])}
        | steps
        | {
            "runs": f"{sweep.members}, {follow} to t = {_time(sweep)}, {run['precision']}",
            "blocks": f"{sweep.blocks} of {sweep.block_size} runs",
            "time": f"{_about(cost)} with {workers(cost.workers)} like this core",
            "of which": f"{duration(cost.start)} until a worker computes, {_first(cost)}",
            "based on": f"{sample}, {each}",
            "memory": f"{size(cost.memory)} a worker",
            "disk": f"{size(cost.disk)} in {sweep.blocks} files",
        }
    )


def _time(sweep: Sweep) -> str:
    """Return the time up to which members are integrated, also in the units of the cell if they are known."""
    end, scales = float(sweep.tables["run"]["t_end"]), of_table(sweep.tables.get("scales", {}))
    return f"{end:g}" if scales is None else f"{end:g} = {time_unit(scales, end)(end)}"


def _about(cost: Estimate) -> str:
    """Return the time of a sweep, and its likely range."""
    low, high = cost.range
    if math.isnan(high):
        return f"perhaps {duration(cost.seconds)}, judged by one point,"
    ends = duration(low), duration(high)
    return f"about {duration(cost.seconds)}" + (f" ({ends[0]} to {ends[1]})" if ends[0] != ends[1] else "")


def _first(cost: Estimate) -> str:
    return f"{duration(cost.compiling)} more on a machine that has no compiled programs yet"


def _number(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def ended(summary: SweepSummary) -> str:
    """Return how a call of `run_sweep` or `repair` ended."""
    lines = {"status": summary.message}
    if summary.computed:
        each = summary.core_seconds / summary.computed
        crew = f"{summary.computed} runs, {workers(summary.workers)}"
        lines |= {
            "regimes": counts(summary.regimes),
            "outcomes": counts(summary.statuses),
            "wall time": f"{duration(summary.seconds)} for {crew}",
            "cost": f"{each:.3g} core-seconds a run",
        }
    return aligned(lines) + _failures(summary.aside)


def status(store: Store, progress: Callable[[int, int], None]) -> str:
    """Read all blocks of a store and return what it contains.

    `progress` is called with the number of blocks read, and of all that are stored.
    """
    from ..sweep.cluster.task import counted
    from ..sweep.store.read import ranges

    sweep, stored, aside = store.sweep, sorted(store.present()), store.failed()
    found: dict[str, Counter[str]] = {"regime": Counter(), "status": Counter()}
    seconds, done, damaged = 0.0, 0, []
    for number, index in enumerate(stored, 1):
        try:
            arrays: Mapping[str, Any] = store.read(index, ("regime", "status", "seconds"))
        except InputError:
            damaged.append(index)
            continue
        for name, counter in found.items():
            counter.update(counted(store.sweep, arrays, name))
        seconds += float(np.nansum(arrays["seconds"]))
        done += len(sweep.block(index).members)
        progress(number, len(stored))
    lines = {
        "store": f"{store.path}, begun {store.about['created']}",
        "runs": f"{done} of {sweep.members} ({math.floor(100 * done / sweep.members)} %)",
        "blocks": f"{len(stored)} of {sweep.blocks}",
    }
    if done:
        lines["regimes"] = counts(dict(found["regime"].most_common()))
        lines["outcomes"] = counts(dict(found["status"].most_common()))
        lines["cost"] = f"{seconds / done:.3g} core-seconds a run"
    if damaged:
        lines["damaged"] = f"block {ranges(damaged)}; repair with: {_repair_command(store)}"
    return aligned(lines) + _failures(aside)


def verified(store: Store, bad: list[tuple[int, str]]) -> str:
    """Return which blocks of a store are missing or damaged."""
    from ..sweep.store.read import ranges

    kinds: dict[str, list[int]] = {}
    for index, reason in bad:
        kinds.setdefault(reason, []).append(index)
    if not kinds:
        return aligned({"status": f"all {store.sweep.blocks} blocks of {store.path} are whole"})
    lines = {"status": f"{len(bad)} of {store.sweep.blocks} blocks of {store.path} are missing or damaged"}
    lines |= {reason: f"block {ranges(indices)}" for reason, indices in kinds.items()}
    return aligned(lines | {"repair them": _repair_command(store)})


def _repair_command(store: Store) -> str:
    return shlex.join(["cyclosis", "sweep", "repair", str(store.path)])


def told(now: SweepProgress) -> str:
    """Return the progress of a sweep in one line."""
    parts = [f"{now.done} of {now.total} runs"]
    if now.rate > 0:
        parts.append(f"{now.rate:.3g}/s")
    if now.left is not None and now.done < now.total:
        parts.append(f"{duration(now.left)} left")
    parts.append(workers(now.workers) if now.workers else "waiting for workers")
    if now.aside:
        parts.append(f"{now.aside} blocks set aside")
    return ", ".join(parts) + (f"; {counts(now.regimes)}" if now.regimes else "")


def counts(numbers: Mapping[str, int]) -> str:
    """Return how many there are of each kind, such as "cyclosis 412, disordered 300"."""
    return ", ".join(f"{name} {count}" for name, count in numbers.items())


def workers(count: int) -> str:
    """Return a number of workers in words."""
    return "1 worker" if count == 1 else f"{count} workers"


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it."""
    for unit, length in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * length:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds:.3g} s"


def size(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    for unit, length in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if count >= length:
            return f"{count / length:.3g} {unit}"
    return f"{count / 1e3:.3g} kB"


def _failures(aside: Mapping[int, str]) -> str:
    shown = [f"\n{f'block {index}':>18}  {reason}" for index, reason in sorted(aside.items())[:FEW]]
    more = [f"\n{'':>18}  and {len(aside) - FEW} more"] if len(aside) > FEW else []
    return "".join(shown + more)
