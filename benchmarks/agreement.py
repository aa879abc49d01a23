"""Do regimes depend on precision, tolerance or the number of lanes? Member by member.

python benchmarks/agreement.py [--members 1000]

Members are drawn from the plane of Figure 5 at 48 x 48. Each variant is compared with float64, one lane
and a tolerance of 1e-3; every member whose regime differs is listed.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import numpy as np

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, Outcome, follow

VALUES = np.linspace(0.025, 1.0, 20)
GRID = cy.CylinderGrid(48, 48, 5.0)
BASE = EnsembleSettings(rtol=1e-3, lanes=1)
VARIANTS = {
    "again": BASE,
    "4 lanes": EnsembleSettings(rtol=1e-3, lanes=4),
    "32 lanes": EnsembleSettings(rtol=1e-3, lanes=32),
    "float32": EnsembleSettings(rtol=1e-3, lanes=1, precision="float32"),
    "rtol = 1e-4": EnsembleSettings(rtol=1e-4, lanes=1),
    "rtol = 1e-5": EnsembleSettings(rtol=1e-5, lanes=1),
}


def sample(members: int) -> list[tuple[float, float, int]]:
    """Return alpha_p, alpha_u and seed of every member."""
    drawn = np.random.default_rng(5).integers(0, (20, 20, 50), size=(members, 3))
    return [(float(VALUES[i]), float(VALUES[j]), int(seed)) for i, j, seed in drawn]


def run(points: list[tuple[float, float, int]], how: EnsembleSettings) -> tuple[list[Outcome], float]:
    """Return the outcomes, and seconds a member."""
    members = [
        Member(cy.Parameters(alpha_p=p, alpha_u=u), GRID, partial(cy.initial.disordered, GRID, seed=seed))
        for p, u, seed in points
    ]
    follow(members[:1], how)
    began = time.perf_counter()
    outcomes = follow(members, how)
    return outcomes, (time.perf_counter() - began) / len(members)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--members", type=int, default=1000)
    points = sample(parser.parse_args().members)
    base, cost = run(points, BASE)
    print(f"{len(points)} members, {cost:.3f} s each in float64, one lane, rtol = 1e-3")
    for name, how in VARIANTS.items():
        other, cost = run(points, how)
        pairs = list(zip(points, base, other, strict=True))
        differ = [pair for pair in pairs if pair[1].regime != pair[2].regime]
        equal = sum(np.array_equal(a.state, b.state) for _, a, b in pairs)
        print(f"{name:>12}: {len(differ)} regimes differ, {equal} final states bitwise equal, {cost:.3f} s")
        for (p, u, seed), a, b in differ:
            print(f"    alpha_p {p:.4f}, alpha_u {u:.4f}, seed {seed}: {a.regime}, {b.regime} here")


if __name__ == "__main__":
    main()
