"""How often the intervals of `cyclosis.fit` contain the truth, on films of simulated cells.

    python benchmarks/fitting.py --noise 0.03 0.1 --draws 40
    python benchmarks/fitting.py --noise 0.05 --from 1.5 --to 13.4 --draws 5
    python benchmarks/fitting.py --noise 0.03 --from 20 --to 60 --facing 0 --draws 5
    python benchmarks/fitting.py --method film --noise 0.02 0.05 --draws 40
    python benchmarks/fitting.py --method film --fields u angle --noise 0.02 --draws 10

Every draw is another cell (the seed of its initial state) with other noise, the paper's parameters and a
window of 70 degrees either way. The noise is white, in units of the peak (of an angle: in radians).

* equation: P and u at 64 x 64 points from t = 1 to 30, a frame every 0.25 R/U
* film: u at 32 x 32 points from t = 4 to 10, a frame every 0.5 R/U; the search begins, and the prior has its
  mean, at values that are wrong by a factor 1.5, up or down by chance
"""

from __future__ import annotations

import argparse
import sys
import time
from functools import cache
from typing import Any

import numpy as np

import cyclosis as cy
from cyclosis.fitting import prepared

TRUTH = {**{name: float(value) for name, value in cy.Parameters().items()}, "U": 1.0}
USUAL = {"equation": (64, 1.0, 30.0, 0.25), "film": (32, 4.0, 10.0, 0.5)}
WRONG = 1.5


@cache
def film(seed: int, points: int, begin: float, end: float, every: float, facing: float) -> Any:
    """Return the exact film of a window: P, u, and the angle of the filaments from +z, in radians."""
    grid = cy.CylinderGrid(points, points)
    times = [round(begin + every * k, 9) for k in range(int((end - begin) / every + 1e-9) + 1)]
    start = cy.initial.disordered(grid, seed=seed)
    run = cy.simulate(cy.Parameters(), grid, start, t_end=times[-1], save_at=times, rtol=1e-7)
    data = run.to_dataset()[["P", "u"]].drop_attrs()
    theta = (data["theta"].values - facing + np.pi) % (2 * np.pi) - np.pi + facing
    data = data.assign_coords(theta=theta).sortby("theta").assign_attrs(length=grid.length)
    data = data.isel(theta=np.abs(data["theta"].values - facing) <= np.radians(70))
    P = data["P"]
    return data.assign(angle=np.arctan2(P.sel(component="theta"), P.sel(component="z")))


def drawn(given: Any, draw: int, noise: float) -> Any:
    """Return the fit of one draw."""
    points, begin, end, every = USUAL[given.method]
    begin, end = given.begin or begin, given.end or end
    exact = film(draw, given.points or points, begin, end, given.every or every, given.facing)
    rng = np.random.default_rng(1000 + draw)
    data = exact[given.fields].map(lambda f: f + noise * rng.normal(size=f.shape), keep_attrs=True)
    wrong = WRONG ** rng.choice([-1.0, 1.0], 7)
    shift = dict(zip(prepared.START, [*wrong, 1.0], strict=True))
    usual = {name: TRUTH[name] * by for name, by in shift.items()}
    before, prepared.START = prepared.START, usual
    try:
        return cy.fit(data.assign_attrs(exact.attrs), method=given.method, seed=draw)
    finally:
        prepared.START = before


def table(fits: list[Any]) -> str:
    """Return what the fits of all draws say, a row for each parameter."""
    out = [
        "| parameter | told | mean error, % | deviation, % | half width, % | covered, % |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    every = []
    for name in fits[0].estimate:
        truth = TRUTH[name]
        told = [fit for fit in fits if np.isfinite(fit.estimate[name])]
        if not told:
            out.append(f"| {name} | 0 | - | - | - | - |")
            continue
        hits = [fit.interval[name][0] <= truth <= fit.interval[name][1] for fit in told]
        every += hits
        errors = 100 * (np.array([fit.estimate[name] for fit in told]) / truth - 1)
        half = np.median([50 * np.ptp(fit.interval[name]) / truth for fit in told])
        share = np.mean(hits)
        error = 100 * np.sqrt(max(share * (1 - share), 0.95 * 0.05) / len(hits))
        numbers = f"{errors.mean():.2f} | {errors.std():.2f} | {half:.2f} | {100 * share:.0f} ± {error:.0f}"
        out.append(f"| {name} | {len(told)} | {numbers} |")
    residual = np.mean([fit.residual for fit in fits if np.isfinite(fit.residual)])
    return "\n".join(
        [*out, f"all intervals: {100 * np.mean(every):.1f} %, residual {residual:.3f} of the noise"]
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--method", choices=list(USUAL), default="equation")
    parser.add_argument("--fields", nargs="+", choices=["P", "u", "angle"])
    parser.add_argument("--noise", type=float, nargs="+", default=[0.03])
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="seed of the first draw")
    parser.add_argument("--points", type=int)
    parser.add_argument("--from", dest="begin", type=float)
    parser.add_argument("--to", dest="end", type=float)
    parser.add_argument("--every", type=float)
    parser.add_argument("--facing", type=float, default=np.pi)
    given = parser.parse_args()
    given.fields = given.fields or {"equation": ["P", "u"], "film": ["u"]}[given.method]
    for noise in given.noise:
        fits, refused = [], []
        begin = time.process_time()
        for draw in range(given.first, given.first + given.draws):
            fit = drawn(given, draw, noise)
            fits.append(fit)
            if fit.refused:
                refused.append(f"draw {draw}: {fit.refused}")
            missed = [name for name, (low, high) in fit.interval.items() if not low <= TRUTH[name] <= high]
            print(f"{draw}: missed {missed}, {fit.refused or ''}", file=sys.stderr, flush=True)
            if draw % 10 == 9:
                print(table(fits), file=sys.stderr, flush=True)
        seconds = (time.process_time() - begin) / len(fits)
        print(f"\nnoise {noise:g}, {len(fits)} draws, {seconds:.0f} s each, {len(refused)} with a refusal")
        print(*refused, table(fits), sep="\n", flush=True)


if __name__ == "__main__":
    main()
