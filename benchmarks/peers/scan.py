"""The cheapest setting of each code that is accurate enough, and how its error falls with the step."""

from __future__ import annotations

import math

import numpy as np
from case import DIFFERENCES, SIZES, TOLERANCE, Code, error
from worker import Worker

FLOOR = 0.97
"""A step that leaves more than this share of the error has met the grid's own error."""


def measured(worker: Worker, n, length, step, how, t_end, fine) -> dict:
    """Return error and seconds of one setting; all but long runs are made twice, to leave compiling out."""
    state, setup, seconds = worker.run(n, length, step, how, t_end)
    found = error(state, fine) if isinstance(state, np.ndarray) else math.inf
    if seconds < 6 and math.isfinite(found):
        again = worker.run(n, length, step, how, t_end)[2]
        setup, seconds = setup + max(seconds - again, 0), again
    return {"n": n, "step": step, "error": found, "setup": setup, "seconds": seconds}


def cheapest(worker: Worker, code: Code, length: float, t_end: float, fine, sizes=SIZES) -> list[dict]:
    """Return all that was tried, the cheapest setting that is accurate enough first."""
    tried, best = [], math.inf
    for variant, how in code.variants.items():
        begin, steps = 0, code.steps(how)
        for n in sizes:
            before = math.inf
            # What was too coarse a step on the grid before hardly suits a finer one.
            for step in steps[begin:]:
                begin = max(steps.index(step) - 1, 0)
                found = measured(worker, n, length, step, how, t_end, fine) | {"variant": variant}
                tried.append(found)
                shown = f"{found['error']:.1e} in {found['seconds']:.3f} s"
                print(f"    {code.name} {variant} n {n} step {step:.2e}: {shown}", flush=True)
                if found["error"] <= TOLERANCE:
                    best = min(best, found["seconds"])
                    break
                stalled = math.isfinite(before) and FLOOR * before < found["error"] < 0.3
                if stalled or found["seconds"] > 1.5 * best or found["seconds"] > 60:
                    break
                before = found["error"]
    return sorted(tried, key=lambda item: (item["error"] > TOLERANCE, item["seconds"]))


def differences(worker: Worker, length: float, t_end: float, fine, sizes) -> list[dict]:
    """Return errors of py-pde's own second-order differences on ever finer grids, at their largest step."""
    found = []
    for n in sizes:
        steps_per_unit = max(8, 2 ** math.ceil(math.log2(0.0018 * n**2)))
        found.append(measured(worker, n, length, 1 / steps_per_unit, DIFFERENCES, t_end, fine))
        print(f"    py-pde, differences, n {n}: {found[-1]['error']:.1e}", flush=True)
    return found


def convergence(worker: Worker, code: Code, length: float, t_end: float, fine, n: int) -> list[dict]:
    """Return how the error of each variant falls when the step is halved."""
    found = []
    for variant, how in code.variants.items():
        steps = (1e-4, 1e-5, 1e-6) if code.steps(how) is code.rtols else (1 / 48, 1 / 96)
        errors = [error(worker.run(n, length, step, how, t_end)[0], fine) for step in steps]
        found.append({"variant": variant, "n": n, "steps": steps, "errors": errors})
    return found
