"""With weak repulsion, stripes tilt and drift.

Between κ = 0.048 and 0.471 two tilted stripes turn about the axis without changing: they are neither steady
nor disordered. A run turns at the speed that Newton's method finds together with the shape of the stripes.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def main(folder="."):
    params = cy.Parameters(kappa=0.1)
    grid = cy.CylinderGrid(48, 8, 5.0)
    theta = grid.theta[:, None] + 0 * grid.z
    state = np.stack([0 * theta + 0.5, 0.8 * np.sin(theta)])
    run = cy.simulate(params, grid, state, 400.0, save_every=10.0, rtol=1e-6)

    wave = np.fft.rfft(np.stack([P[1].mean(axis=1) for P in run.frames]))[:, 1]
    angle = -np.unwrap(np.angle(wave))
    late = run.times >= 250.0
    speed = np.polyfit(run.times[late], angle[late], 1)[0]
    theory = cy.stability.drifting(params, 96)

    figure = Figure(figsize=(7, 2.8), layout="constrained")
    axes = figure.subplots(1, 2)
    for component, name in enumerate(("$P_θ$", "$P_z$")):
        axes[0].plot(theory.theta, theory.P[component], label=name)
    axes[0].set(xlabel="θ")
    axes[0].legend()
    axes[1].plot(run.times, angle - angle[0], label="run")
    axes[1].plot(run.times, angle[-1] - angle[0] + theory.drift * (run.times - 400.0), "k:", label="theory")
    axes[1].set(xlabel="time t", ylabel="angle")
    axes[1].legend()
    figure.savefig(Path(folder) / "drifting_stripes.png", dpi=150)
    return {
        "speed of drift": speed,
        "the same in theory": theory.drift,
        "mean of P around the axis": run.final_state[0].mean(),
        "its theory": theory.P[0].mean(),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
