"""Above a threshold flow makes stripes equal.

Without flow alignment the wider of two stripes always grows, by the attraction of fronts. With enough of it
the narrower one grows. The growth rate of a small difference is measured in runs at three values of α_u.
Theory computes it as an eigenvalue, and gives the α_u at which it vanishes, 0.007472 at α_p = 0.1.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def rate(params, grid):
    """Return the rate at which a small mean of P_z grows on two equal stripes."""
    equal = cy.stability.cyclosis(params, grid.n_theta)
    modes = equal.spectrum(3, components="z")
    odd = np.argmax(np.abs(modes.modes[:, 1].real.mean(axis=1)))
    P = equal.P + 1e-4 * modes.modes[odd, 1].real
    state = np.stack([0 * P, P])[:, :, None].repeat(grid.n_z, axis=2)
    run = cy.simulate(params, grid, state, 60.0, save_every=20.0, rtol=1e-8)
    mean = run.records["mean_P"][:, 1]
    return np.log(mean[-1] / mean[0]) / 60.0, modes.eigenvalues[odd].real


def main(folder="."):
    params, grid = cy.Parameters(alpha_p=0.1), cy.CylinderGrid(64, 8, 5.0)
    alpha_u = np.array([0.0025, 0.0075, 0.0125])
    measured, theory = np.array([rate(params.replace(alpha_u=value), grid) for value in alpha_u]).T
    critical = np.roots(np.polyfit(alpha_u, measured, 2)).real
    critical = critical[np.argmin(np.abs(critical - alpha_u[1]))]
    exact = cy.stability.threshold(params)

    figure = Figure(figsize=(5, 3.2), layout="constrained")
    ax = figure.add_subplot(xlabel="α_u", ylabel="growth rate of the difference")
    ax.plot(alpha_u, theory, "k-", linewidth=0.8, label="theory")
    ax.plot(alpha_u, measured, "o", label="runs")
    ax.axhline(0, color="grey", linewidth=0.5)
    ax.axvline(exact, color="tab:red", linestyle=":", label="threshold")
    ax.legend()
    figure.savefig(Path(folder) / "unequal_stripes.png", dpi=150)
    return {
        "growth rate at the least alpha_u": measured[0],
        "the same in theory": theory[0],
        "critical alpha_u, from runs": critical,
        "critical alpha_u, in theory": exact,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
