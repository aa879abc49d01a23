"""One stream breaks up into two.

A cell whose filaments all point the same way has no flow: pressure stops it. Beyond α_u = 0.327 (at α_p =
0.1) one wave around the axis grows on this state. Its rate in a run is that of the 2 x 2 matrix of theory,
and two equal stripes result.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def main(folder="."):
    params = cy.Parameters(alpha_p=0.1, alpha_u=0.5)
    grid = cy.CylinderGrid(48, 8, 5.0)
    order = cy.stability.orders(params, "unidirectional")[0]
    state = cy.initial.unidirectional(grid, order)
    state[1] += 1e-4 * np.cos(grid.theta)[:, None]
    run = cy.simulate(params, grid, state, 200.0, save_every=1.0)

    wave = np.array([2 * np.abs(np.fft.fft(P[1].mean(axis=1))[1]) / grid.n_theta for P in run.frames])
    early = (run.times > 0) & (wave < 1e-3)
    rate = np.polyfit(run.times[early], np.log(wave[early]), 1)[0]
    theory = cy.stability.growth_rates(params, "unidirectional", 1, 0)[0].real

    figure = Figure(figsize=(5, 3.2), layout="constrained")
    ax = figure.add_subplot(xlabel="time t", ylabel="wave once around the axis", ylim=(5e-5, 2))
    ax.semilogy(run.times, wave, label="run")
    ax.semilogy(run.times, wave[0] * np.exp(theory * run.times), "k:", label="theory")
    ax.legend()
    figure.savefig(Path(folder) / "breaking_up.png", dpi=150)
    found = cy.regime(params, grid, run.final_state)
    return {
        "growth rate": rate,
        "the same in theory": theory,
        "stripes at the end": len(found.zones),
        "critical alpha_u": cy.stability.stripes_threshold(params),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
