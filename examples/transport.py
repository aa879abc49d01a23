"""Streaming carries along the cell what diffusion cannot.

A wall gives off in some bands across the axis what it takes up in others. Streams carry it from one to the
next, and the exchange grows as the square root of the Péclet number. In a sealed cell two streams spread a
drop of dye along the cell with D (1 + 7/96 Pe²).

    cyclosis experiment streaming-transport
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.special import iv

import cyclosis as cy


def main(folder="."):
    grid = cy.CylinderGrid(16, 16, 5.0)
    flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.sin, np.inf))
    q, numbers = 2 * np.pi / grid.length, np.geomspace(0.1, 3000, 16)
    still = q * iv(1, q) / iv(0, q)
    exchange = np.array([cy.vacuole.band_exchange(flow, number, q) for number in numbers])
    spread = cy.vacuole.dispersion(flow).coefficient

    figure = Figure(figsize=(7, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.loglog(numbers, exchange / still, "o-", color="#2a5fa6", ms=4)
    left.loglog(
        numbers, (numbers / numbers[-1]) ** 0.5 * exchange[-1] / still, "--", color="0.5", label="Pe$^{1/2}$"
    )
    left.set(xlabel="Péclet number UR/D", ylabel="exchange between bands", ylim=(0.7, 100))
    left.legend(fontsize=8)
    wider = np.geomspace(0.1, 2e4, 100)
    right.loglog(wider, 1 + spread * wider**2, color="#9757c8")
    for name, number in (("small molecules", 50), ("large assemblies", 5000)):
        right.plot(number, 1 + spread * number**2, "o", color="#472860", ms=5)
        right.annotate(
            name,
            (number, 1 + spread * number**2),
            (-8, 2),
            textcoords="offset points",
            ha="right",
            fontsize=8,
        )
    right.set(xlabel="Péclet number UR/D", ylabel="dispersion along the cell, D$_{eff}$/D")
    figure.savefig(Path(folder) / "transport.png", dpi=150)

    steepness = np.log(exchange[-1] / exchange[-2]) / np.log(numbers[-1] / numbers[-2])
    return {
        "exchange without flow": cy.vacuole.band_exchange(flow, 1e-3, q),
        "the same in theory": still,
        "exchange at Pe = 3000, of that without flow": exchange[-1] / still,
        "exponent of the Péclet number": steepness,
        "coefficient of dispersion": spread,
        "its theory, 7/96": 7 / 96,
    }


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
