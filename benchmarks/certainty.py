"""Certified regimes against brute force, member by member.

python benchmarks/certainty.py [--members 400] [--t-end 5000] [--rtol 1e-3] [--out certainty.csv]

Half of the members are spread over the plane of Figure 5, half lie where outcomes are mixed (alpha_u up to
0.3). Each is followed once until its regime is certain, and once to --t-end whatever happens. Members that
brute force has not settled by then are listed apart, with the largest growth rate of the certified state.
Rows already in --out are not computed again.
"""

from __future__ import annotations

import argparse
import csv
from functools import partial
from pathlib import Path

import numpy as np

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, follow

VALUES = np.linspace(0.025, 1.0, 20)
GRID = cy.CylinderGrid(48, 48, 5.0)
FIELDS = [
    "alpha_p",
    "alpha_u",
    "seed",
    "certified",
    "status",
    "t_certified",
    "t_order",
    "eigenvalue",
    "reason",
    "brute",
    "brute_status",
    "settled",
    "rate",
    "evaluations_certified",
    "evaluations_brute",
    "seconds_certified",
    "seconds_brute",
]


def sample(members: int) -> list[tuple[int, int, int]]:
    """Return (index of alpha_p, index of alpha_u, seed) of every member."""
    rng = np.random.default_rng(2013)
    spread = members // 2
    everywhere = rng.integers(0, (20, 20, 50), size=(spread, 3))
    mixed = rng.integers((1, 0, 0), (20, 6, 50), size=(members - spread, 3))
    return [tuple(map(int, row)) for row in np.concatenate([everywhere, mixed])]


def row(i: int, j: int, seed: int, t_end: float, rtol: float) -> dict[str, object]:
    """Follow one member both ways."""
    params = cy.Parameters(alpha_p=VALUES[i], alpha_u=VALUES[j])
    member = Member(params, GRID, partial(cy.initial.disordered, GRID, seed=seed))
    (sure,) = follow([member], EnsembleSettings(t_end=t_end, rtol=rtol))
    (brute,) = follow([member], EnsembleSettings(t_end=t_end, rtol=rtol, finish="t_end"))
    found = cy.regime(params, GRID, brute.state)
    # A disordered state at alpha_p = d_r decays as t^-1/2: its relative rate says nothing.
    settled = found.settled or found.name == "disordered"
    return dict(
        zip(
            FIELDS,
            (
                f"{VALUES[i]:.6f}",
                f"{VALUES[j]:.6f}",
                seed,
                sure.regime,
                sure.status,
                f"{sure.t_final:.1f}",
                f"{sure.t_order:.1f}",
                f"{sure.eigenvalue:.4g}",
                sure.reason,
                brute.regime,
                brute.status,
                int(settled),
                f"{found.rate:.2g}",
                sure.evaluations,
                brute.evaluations,
                f"{sure.seconds:.3f}",
                f"{brute.seconds:.3f}",
            ),
            strict=True,
        )
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--members", type=int, default=400)
    parser.add_argument("--t-end", type=float, default=5000.0)
    parser.add_argument("--rtol", type=float, default=1e-3)
    parser.add_argument("--out", type=Path, default=Path("certainty.csv"))
    asked = parser.parse_args()
    done = list(csv.DictReader(asked.out.open())) if asked.out.exists() else []
    with asked.out.open("a", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        if not done:
            writer.writeheader()
        for i, j, seed in sample(asked.members)[len(done) :]:
            done.append({key: str(value) for key, value in row(i, j, seed, asked.t_end, asked.rtol).items()})
            writer.writerow(done[-1])
            file.flush()
    report(done)


def report(rows: list[dict[str, str]]) -> None:
    """Print how many agree, and every member that does not or has not settled."""
    settled = [r for r in rows if r["settled"] == "1"]
    open_ones = [r for r in rows if r["settled"] != "1"]
    differ = [r for r in settled if r["certified"] != r["brute"]]
    uncertain = [r for r in rows if r["status"] == "completed"]
    print(f"{len(rows)} members, {len(settled)} settled by brute force, {len(differ)} of them differ")
    print(f"{len(uncertain)} not certain by t_end; {len(open_ones)} not settled by brute force")
    for name, listed in (("differ", differ), ("not settled", open_ones), ("not certain", uncertain)):
        for r in listed:
            print(f"  {name}: " + ", ".join(f"{key} {r[key]}" for key in FIELDS[:13]))
    for regime in sorted({r["certified"] for r in rows}):
        own = [r for r in rows if r["certified"] == regime]
        sure, brute = (
            np.array([float(r[f"evaluations_{way}"]) for r in own]) for way in ("certified", "brute")
        )
        cost = f"{sure.mean():.0f} right-hand sides, brute force {brute.mean():.0f}"
        print(f"{regime:>15}: {len(own)} members, {cost}")


if __name__ == "__main__":
    main()
