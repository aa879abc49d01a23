"""Right-hand sides that the default stepper needs for its accuracy, at the parameters of Figure 4.

    python benchmarks/efficiency.py

The reference is ETDRK4 with dt = 0.0125 on the same grid. Rejected steps and error stages are counted.
"""

from __future__ import annotations

import argparse

import numpy as np

import cyclosis as cy

TIMES = [10.0, 20.0, 200.0]


def errors(run: cy.Trajectory, reference: cy.Trajectory) -> list[float]:
    """Relative L2 error of P at the saved times that both runs share."""
    chosen = [int(np.flatnonzero(run.times == t)[0]) for t in reference.times]
    pairs = zip((run.frames[i] for i in chosen), reference.frames, strict=True)
    return [float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    params, grid = cy.Parameters(alpha_p=1.0, alpha_u=0.5), cy.CylinderGrid(64, 64, 5.0)
    runs = {
        "default": {"save_at": TIMES},
        "default, save_every = 1": {"save_every": 1.0},
        "rtol = 1e-3": {"save_at": TIMES, "rtol": 1e-3},
        "rtol = 1e-5": {"save_at": TIMES, "rtol": 1e-5},
        "etdrk4, dt = 0.1": {"save_at": TIMES, "stepper": "etdrk4", "dt": 0.1},
        "rk4, dt = 0.03125": {"save_at": TIMES, "stepper": "rk4", "dt": 0.03125},
    }
    print(
        "| seed | stepper | right-hand sides | rejected steps | error at t = 10 | 20 | 200 | wall time, s |"
    )
    print("|---:|---|---:|---:|---:|---:|---:|---:|")
    for seed in range(arguments.seeds):
        state = cy.initial.disordered(grid, seed=seed)
        reference = cy.simulate(params, grid, state, save_at=TIMES, stepper="etdrk4", dt=0.0125)
        for name, settings in runs.items():
            run = cy.simulate(params, grid, state, **settings)
            shown = " | ".join(f"{error:.1e}" for error in errors(run, reference))
            cost = f"{run.effort.evaluations} | {run.effort.rejected}"
            print(f"| {seed} | {name} | {cost} | {shown} | {run.effort.wall_time:.1f} |", flush=True)


if __name__ == "__main__":
    main()
