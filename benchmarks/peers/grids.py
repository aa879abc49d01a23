"""The cost of each code against the size of the grid: one right-hand side, and a run at equal error."""

from __future__ import annotations

from statistics import median

from case import GRID_RUNS, LENGTHS, PROBE_DT, TOLERANCE, Code, reference
from scan import measured
from worker import Worker

NEAR = 1.3
"""Settings that take at most this many times the cheapest go on to the next larger grid."""
ONCE = 10.0
"""Runs of more seconds than this are timed in one turn only, and so are right-hand sides in longer runs."""
SECONDS = 0.4
"""What the steps take that are timed for one right-hand side."""
ENOUGH = 12
"""At least so many steps, unless one takes a second: on large grids the first steps of a run are quicker."""


def grids(codes: dict[str, Code], workers: dict[str, Worker], sizes, known: dict, quick: bool):
    """Yield each size with what its codes took, timed in turns; `known` has the sizes that are done."""
    label, length = "2 pi", LENGTHS["2 pi"]
    able = on_grids(codes)
    times = sorted({GRID_RUNS[n][0] for n in sizes})
    fine = reference(length, times, 96, 0.05) if quick else reference(length, times)
    for n in sizes:
        t_end, rounds = GRID_RUNS[n]
        found = {}
        for name, code in able.items():
            before = carried(known, n, name)
            tried = settings(workers[name], code, n, t_end, fine[t_end], before)
            steps = probed(workers[name], code, n)
            best = [one | {"timings": []} for one in near(tried)]
            found[name] = {"tried": tried, "runs": best, "steps": steps, "seconds a right-hand side": []}
        turns = range(1 if quick else rounds)
        for _ in turns:
            for name, code in able.items():
                time_right_hand_side(workers[name], code, n, found[name])
        for _ in turns:
            for name, code in able.items():
                time_runs(workers[name], code, n, t_end, found[name]["runs"])
        known[str(n)] = {"n": n, "length": label, "t": t_end, "codes": found}
        print(f"n {n}: {told(found)}", flush=True)
        yield n, known


def on_grids(codes: dict[str, Code]) -> dict[str, Code]:
    """Return the codes that take part."""
    return {name: code for name, code in codes.items() if code.probe}


def carried(known: dict, n: int, name: str) -> dict[str, float] | None:
    """Return variants and steps that were good on the next smaller grid, or None if there is none."""
    smaller = [item for item in known.values() if item["n"] < n and name in item["codes"]]
    runs = max(smaller, key=lambda item: item["n"])["codes"][name]["runs"] if smaller else []
    if not runs:
        return None
    best = min(median(run["timings"]) for run in runs)
    return {run["variant"]: run["step"] for run in runs if median(run["timings"]) <= NEAR * best}


def settings(worker: Worker, code: Code, n: int, t_end: float, fine, before: dict | None) -> list[dict]:
    """Return for each variant the largest accurate step, found from that of the smaller grid on."""
    found: list[dict] = []  # one of each variant
    for variant, how in code.variants.items():
        if before is not None and variant not in before:
            continue
        steps = code.steps(how)
        begin = steps.index(before[variant]) if before else 0
        worker.run(n, LENGTHS["2 pi"], steps[begin], how, 4 * steps[begin])  # compiles
        for step in steps[begin:]:
            one = measured(worker, n, LENGTHS["2 pi"], step, how, t_end, fine) | {"variant": variant}
            shown = f"{one['error']:.1e} in {one['seconds']:.3f} s"
            print(f"    {code.name} n {n} {variant} {step:.2e}: {shown}", flush=True)
            if one["error"] <= TOLERANCE:
                found.append(one)
                break
            if found and one["seconds"] > 2 * NEAR * min(item["seconds"] for item in found):
                break
    return found


def near(found: list[dict]) -> list[dict]:
    """Return the settings that are timed in turns: those that take about as long as the cheapest."""
    best = min((one["seconds"] for one in found), default=0.0)
    return [one for one in found if one["seconds"] <= NEAR * best]


def probed(worker: Worker, code: Code, n: int) -> list[int]:
    """Return two numbers of steps whose difference takes long enough to be timed."""
    run_steps(worker, code, n, 1)  # compiles
    one = run_steps(worker, code, n, 1)
    if one > 4:
        return [1, 2]
    step = (run_steps(worker, code, n, 4) - one) / 3
    return [1, 1 + max(1 if step > 1 else ENOUGH, min(2000, round(SECONDS / max(step, 1e-4))))]


def run_steps(worker: Worker, code: Code, n: int, steps: int) -> float:
    """Return the seconds that some short steps take, with the overhead of a run."""
    variant, _ = code.probe
    return worker.run(n, LENGTHS["2 pi"], PROBE_DT, code.variants[variant], steps * PROBE_DT)[2]


def time_right_hand_side(worker: Worker, code: Code, n: int, found: dict) -> None:
    """Add one turn: what a right-hand side takes in a step, from the difference of two runs."""
    few, many = found["steps"]
    timings = found["seconds a right-hand side"]
    if timings and timings[-1] * code.probe[1] * many > ONCE / 2:
        return
    taken = run_steps(worker, code, n, many) - run_steps(worker, code, n, few)
    timings.append(taken / (many - few) / code.probe[1])


def time_runs(worker: Worker, code: Code, n: int, t_end: float, runs: list[dict]) -> None:
    """Add one turn: the run of each setting."""
    for one in runs:
        if one["timings"] and one["timings"][-1] > ONCE:
            continue
        setting = (n, LENGTHS["2 pi"], one["step"], code.variants[one["variant"]])
        worker.run(*setting, 4 * one["step"])  # another setting may have run since: prepares it again
        one["timings"].append(worker.run(*setting, t_end)[2])


def told(found: dict) -> str:
    """Return for a person to read what each code took."""
    return "; ".join(
        f"{name} {1e3 * median(item['seconds a right-hand side']):.3g} ms a right-hand side, "
        + ", ".join(f"{one['variant']} {median(one['timings']):.3g} s" for one in item["runs"])
        for name, item in found.items()
    )
