"""How much flow two stripes need.

The least α_u at which two equal stripes are stable falls by eight decades as bundling grows, by the law of
fronts: narrow zones hardly interact. Below α_p = d_r + d_s = 0.05 stripes exist only beyond a fold.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cyclosis as cy


def main(folder="."):
    alpha_p = np.array([0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0])
    cells = [cy.Parameters(alpha_p=value) for value in alpha_p]
    exact = np.array([cy.stability.threshold(params) for params in cells])
    fronts = np.array([cy.stability.front_threshold(params) for params in cells])

    figure = Figure(figsize=(5, 3.2), layout="constrained")
    ax = figure.add_subplot(xlabel="α_p", ylabel="least α_u of stable stripes")
    ax.semilogy(alpha_p, exact, "o", label="computed")
    ax.semilogy(alpha_p, fronts, "k-", linewidth=0.8, label="law of fronts")
    ax.legend()
    figure.savefig(Path(folder) / "thresholds.png", dpi=150)
    return {
        "least alpha_u at alpha_p = 0.1": exact[2],
        "least alpha_u at alpha_p = 1": exact[-1],
        "computed over law of fronts at alpha_p = 1": exact[-1] / fronts[-1],
        "fold at alpha_p = 0": cy.stability.fold(cy.Parameters(alpha_p=0.0)),
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
