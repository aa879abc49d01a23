"""Right-hand sides that the adaptive steppers need for their accuracy, at three points and for five seeds.

    python benchmarks/steps.py

The reference is the default stepper with rtol = 1e-8 on the same grid. Rejected steps are counted. A step of
`multistep` also applies (1 - τ D)⁻¹ twice, four transforms, where a right-hand side has seven: the last count
adds them as fractions of a right-hand side. `--points all` adds points at which its steps gain less.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np

import cyclosis as cy

TIMES = (10.0, 20.0, 200.0)
POINTS = {
    "Figure 4": {"alpha_p": 1.0, "alpha_u": 0.5},
    "alpha_p = 0.5, alpha_u = 1": {"alpha_p": 0.5, "alpha_u": 1.0},
    "alpha_p = 1, alpha_u = 0.1": {"alpha_p": 1.0, "alpha_u": 0.1},
}
FURTHER = {
    "alpha_p = 0.3, alpha_u = 0.9, kappa = 0": {"alpha_p": 0.3, "alpha_u": 0.9, "kappa": 0.0},
    "alpha_p = 2, d_s = 0.05": {"alpha_p": 2.0, "d_s": 0.05},
    "force exponent 0, d_r = 0.2": {"force_exponent": 0.0, "d_r": 0.2},
    "alpha_u = 1, epsilon = 1": {"alpha_u": 1.0, "epsilon": 1.0},
}
TRANSFORMS, OF_A_STEP = 7, 4
"""Complex transforms of a right-hand side, and what a step of `multistep` needs besides its one."""
FIRST = 3
"""Steps of ETDRK4 with which `multistep` begins."""


def errors(run: cy.Trajectory, reference: cy.Trajectory) -> list[float]:
    """Return the relative L2 errors of P at the saved times."""
    pairs = zip(run.frames, reference.frames, strict=True)
    return [float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs]


def cost(run: cy.Trajectory) -> float:
    """Return the cost of a run in right-hand sides, with further transforms as fractions of one."""
    steps = run.effort.accepted + run.effort.rejected
    further = OF_A_STEP * (steps - FIRST) if run.settings.stepper == "multistep" else 0
    return run.effort.evaluations + further / TRANSFORMS


def rows(points: dict[str, dict[str, float]], seeds: int, rtol: float) -> Iterator[str]:
    """Yield the rows of the table."""
    grid = cy.CylinderGrid(64, 64, 5.0)
    for name, values in points.items():
        params = cy.Parameters(**{"alpha_p": 1.0, "alpha_u": 0.5} | values)
        for seed in range(seeds):
            state = cy.initial.disordered(grid, seed=seed)
            reference = cy.simulate(params, grid, state, save_at=TIMES, rtol=1e-8, atol=1e-12)
            for stepper in ("adaptive", "multistep"):
                run = cy.simulate(params, grid, state, save_at=TIMES, stepper=stepper, rtol=rtol)
                shown = " | ".join(f"{error:.1e}" for error in errors(run, reference))
                effort = run.effort
                counts = f"{effort.evaluations} | {effort.rejected} | {cost(run):.0f}"
                yield f"| {name} | {seed} | {stepper} | {counts} | {shown} |"


def time_of_a_step(stepper: str, rounds: int = 5) -> float:
    """Return the shortest time on the clock per step of a run at Figure 4's parameters, in microseconds."""
    grid, params = cy.CylinderGrid(64, 64, 5.0), cy.Parameters(alpha_p=1.0, alpha_u=0.5)
    state = cy.initial.disordered(grid, seed=0)
    efforts = [cy.simulate(params, grid, state, save_at=TIMES, stepper=stepper).effort for _ in range(rounds)]
    return min(1e6 * effort.wall_time / (effort.accepted + effort.rejected) for effort in efforts)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--rtol", type=float, default=1e-4)
    parser.add_argument("--points", choices=("three", "all"), default="three")
    parser.add_argument("--time", action="store_true", help="only the time on the clock of a step")
    arguments = parser.parse_args()
    if arguments.time:
        for stepper in ("adaptive", "multistep"):
            print(f"{stepper}: {time_of_a_step(stepper):.0f} us a step")
        return
    print(
        "| point | seed | stepper | right-hand sides | rejected steps | with transforms "
        "| error at t = 10 | 20 | 200 |"
    )
    print("|---|---:|---|---:|---:|---:|---:|---:|---:|")
    points = POINTS | (FURTHER if arguments.points == "all" else {})
    for row in rows(points, arguments.seeds, arguments.rtol):
        print(row, flush=True)


if __name__ == "__main__":
    main()
