"""A thousand members on one core: our ensemble, Exponax mapped over members, and loops over them."""

from __future__ import annotations

from statistics import median

from case import LENGTHS, Code, error, reference
from worker import Worker

BATCHES = (1, 4, 16)
"""Members that Exponax takes at once, of which the quickest is timed beside all at once."""
CHECKED = 3
"""Members whose errors are measured."""
TAKE_PART = ("cyclosis", "exponax", "numba")
"""Codes whose members are timed."""
CHOSEN = {"cyclosis": "adaptive"}
"""Variants other than the cheapest for one cell: ours has the stepper that ensembles use."""


def members(codes: dict[str, Code], workers: dict[str, Worker], size: dict, quick: bool) -> dict:
    """Return how long each code takes for many members, in turns, at the settings of one grid of `grids`."""
    count, rounds = (8, 1) if quick else (1000, 2)
    length, t_end = LENGTHS[size["length"]], size["t"]
    ways = {}
    for name, code in codes.items():
        if name in size["codes"]:
            item = setting(size["codes"][name], name) | {"n": size["n"]}
            for label, how in choices(code, workers[name], item, length, t_end, count).items():
                ways[label] = item | {"code": name, "how": how, "timings": []}
    checked = range(min(CHECKED, count))
    fine = [reference(length, (t_end,), seed=seed)[t_end] for seed in checked]
    for turn in range(rounds):
        for label, way in ways.items():
            worker, how = workers[way["code"]], codes[way["code"]].variants[way["variant"]] | way["how"]
            given, batch = (way["n"], length, way["step"], how), way["how"].get("batch", 1)
            worker.run(*given, 4 * way["step"], kind="ensemble", seeds=range(batch))  # compiles
            states, _, seconds = worker.run(*given, t_end, kind="ensemble", seeds=range(count))
            way["timings"].append(seconds)
            if turn == 0:
                pairs = zip(states[: len(fine)], fine, strict=True)
                way["errors"] = [error(state, exact) for state, exact in pairs]
            print(f"{label}: {count / seconds:.1f} members a second, errors {way['errors']}", flush=True)
    return {"length": size["length"], "t": t_end, "members": count, "ways": ways}


def setting(found: dict, name: str) -> dict:
    """Return the cheapest accurate setting of one cell that a code's ensemble can use."""
    right = [one for one in found["tried"] if CHOSEN.get(name) in (None, one["variant"])]
    best = min(right, key=lambda one: one["seconds"])
    return {key: best[key] for key in ("step", "variant")}


def choices(code: Code, worker: Worker, item: dict, length, t_end, count: int) -> dict[str, dict]:
    """Return the ways in which a code computes members together, by name."""
    if not code.batched:
        return {code.name: {}}
    seconds = {}
    for batch in BATCHES:
        how = code.variants[item["variant"]] | {"batch": batch}
        given, seeds = (item["n"], length, item["step"], how), range(min(count, max(BATCHES)))
        worker.run(*given, 4 * item["step"], kind="ensemble", seeds=range(batch))  # compiles
        seconds[batch] = median(worker.run(*given, t_end, kind="ensemble", seeds=seeds)[2] for _ in range(3))
    best = min(seconds, key=seconds.get)
    print(f"{code.name}: seconds for {len(seeds)} members by how many at once: {seconds}", flush=True)
    return {f"{code.name}, all at once": {"batch": count}, f"{code.name}, {best} at once": {"batch": best}}
