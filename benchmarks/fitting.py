"""How often the intervals of `cyclosis.fit` contain the truth, on films of a simulated cell.

    python benchmarks/fitting.py --noise 0.03 0.1 --draws 40
    python benchmarks/fitting.py --noise 0.05 --from 1.5 --to 13.4 --draws 5
    python benchmarks/fitting.py --noise 0.03 --from 20 --to 60 --facing 0 --draws 5

64 x 64 points, seed 0, the paper's parameters, a frame every 0.25 R/U, a window of 70 degrees either way,
white noise in units of the peak on P and u.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

import cyclosis as cy

TRUTH = {**{name: float(value) for name, value in cy.Parameters().items()}, "U": 1.0}


def film(begin: float, end: float, facing: float) -> Any:
    """Return the exact film of the window."""
    grid = cy.CylinderGrid(64, 64)
    times = [round(begin + 0.25 * k, 9) for k in range(int((end - begin) / 0.25 + 1e-9) + 1)]
    start = cy.initial.disordered(grid, seed=0)
    run = cy.simulate(cy.Parameters(), grid, start, t_end=times[-1], save_at=times, rtol=1e-7)
    data = run.to_dataset()[["P", "u"]].drop_attrs()
    theta = (data["theta"].values - facing + np.pi) % (2 * np.pi) - np.pi + facing
    data = data.assign_coords(theta=theta).sortby("theta")
    return data.isel(theta=np.abs(data["theta"].values - facing) <= np.radians(70))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--noise", type=float, nargs="+", default=[0.03])
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--from", dest="begin", type=float, default=1.0)
    parser.add_argument("--to", dest="end", type=float, default=30.0)
    parser.add_argument("--facing", type=float, default=np.pi)
    given = parser.parse_args()
    exact = film(given.begin, given.end, given.facing)
    for noise in given.noise:
        fits = []
        for draw in range(given.draws):
            rng = np.random.default_rng(1000 + draw)
            data = exact.map(lambda f, rng=rng, s=noise: f + s * rng.normal(size=f.shape))
            fits.append(cy.fit(data, method="equation", seed=draw))
        refused = [fit.refused for fit in fits if fit.refused]
        print(
            f"\nnoise {noise:g}, {len(fits)} draws, {len(refused)} with a refusal",
            *sorted(set(refused))[:2],
            sep="\n",
        )
        print("| parameter | told | mean error, % | deviation, % | half width, % | covered, % |")
        print("|---|---:|---:|---:|---:|---:|")
        every = []
        for name in fits[0].estimate:
            truth = TRUTH[name]
            hits = [fit.interval[name][0] <= truth <= fit.interval[name][1] for fit in fits]
            told = [fit for fit in fits if np.isfinite(fit.estimate[name])]
            every += hits
            if not told:
                print(f"| {name} | 0 | - | - | - | {100 * np.mean(hits):.0f} |")
                continue
            errors = 100 * (np.array([fit.estimate[name] for fit in told]) / truth - 1)
            half = np.median([50 * np.ptp(fit.interval[name]) / truth for fit in told])
            numbers = f"{errors.mean():.2f} | {errors.std():.2f} | {half:.2f} | {100 * np.mean(hits):.0f}"
            print(f"| {name} | {len(told)} | {numbers} |")
        print(f"all: {100 * np.mean(every):.1f} %", flush=True)


if __name__ == "__main__":
    main()
