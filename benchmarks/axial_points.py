"""Cost and outcomes of Figure 5 with adaptive axial resolution, against all points: prints a table.

    python benchmarks/axial_points.py [--points 6] [--seeds 50]
    python benchmarks/axial_points.py --sample 0 420

The first takes points spread over the plane with the seeds 0, 1, ..., and follows the members of each point
to their certain regimes in each way in turn, in one process with one lane. Seconds are those of the
processor; the ratio is that of their sums, the median that over the points. `states` is the largest
difference between the final states. The second compares outcomes, for members FIRST to LAST of those that
benchmarks/certainty.py integrates by brute force.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import numpy as np
from certainty import GRID, VALUES, sample

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, Outcome, follow

WAYS = {
    "fixed": {},
    "adaptive": {"axial_resolution": "adaptive"},
    "fixed, float32": {"precision": "float32"},
    "adaptive, float32": {"axial_resolution": "adaptive", "precision": "float32"},
}


def member(i: int, j: int, seed: int) -> Member:
    """Return a member of Figure 5 from the places of its parameters on the axes, and its seed."""
    params = cy.Parameters(alpha_p=VALUES[i], alpha_u=VALUES[j])
    return Member(params, GRID, partial(cy.initial.disordered, GRID, seed=seed))


def groups(asked: argparse.Namespace) -> list[list[Member]]:
    """Return the members that are followed together: those of a point, or ten of the sample."""
    if asked.sample:
        first, last = asked.sample
        chosen = [member(*place) for place in sample(420)[first:last]]
        return [chosen[k : k + 10] for k in range(0, len(chosen), 10)]
    drawn = np.random.default_rng(7).integers(1, 20, size=(asked.points, 2))
    return [[member(int(i), int(j), seed) for seed in range(asked.seeds)] for i, j in drawn]


def row(name: str, spent: list[float], found: list[Outcome], base: list[float], true: list[Outcome]) -> str:
    """Return the row of one way."""
    total, median = sum(spent) / sum(base), np.median(np.array(spent) / np.array(base))
    pairs = list(zip(true, found, strict=True))
    differ = sum((a.regime, a.status) != (b.regime, b.status) for a, b in pairs)
    apart = max(difference(a.state, b.state) for a, b in pairs)
    each, count = 1e3 * sum(spent) / len(found), np.mean([outcome.evaluations for outcome in found])
    return f"| {name} | {each:.1f} | {total:.2f} | {median:.2f} | {count:.0f} | {differ} | {apart:.0e} |"


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference between the amplitudes of the waves of two states."""
    waves = [np.abs(np.fft.fft2(state, norm="forward")) for state in (a, b)]
    return float(np.abs(waves[0] - waves[1]).max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--points", type=int, default=6)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--sample", type=int, nargs=2, metavar=("FIRST", "LAST"))
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=list(WAYS))
    asked = parser.parse_args()
    settings = {name: EnsembleSettings(rtol=1e-3, lanes=1, **WAYS[name]) for name in asked.ways}
    together = groups(asked)
    for how in settings.values():  # compiles every program
        follow([member(12, 4, 0), member(2, 12, 0)], how, progress=False)
    spent: dict[str, list[float]] = {name: [] for name in settings}
    found: dict[str, list[Outcome]] = {name: [] for name in settings}
    for turn, members in enumerate(together):
        for name in np.roll(asked.ways, turn):
            began = time.process_time()
            found[name] += follow(members, settings[name], progress=False)
            spent[name].append(time.process_time() - began)
    first = asked.ways[0]
    print(f"{len(found[first])} members")
    print("| way | ms a member | ratio | median | right-hand sides | outcomes that differ | states |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name in settings:
        print(row(name, spent[name], found[name], spent[first], found[first]))


if __name__ == "__main__":
    main()
