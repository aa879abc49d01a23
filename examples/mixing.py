"""Helical streams mix the vacuole.

Dye fills one half of a cell. Straight streams run along the dye and leave it to diffusion. Streams that wind
about the cell once in 5 radii turn the fluid over, and the dye is mixed sooner. With
straight streams differences vanish at the rate of diffusion in a cylinder, the square of a zero of a Bessel
function.

    cyclosis experiment mixing
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import resample
from scipy.special import jnp_zeros, jv

import cyclosis as cy

PECLET = 100.0
COLOURS = {"straight": "#2a5fa6", "helical": "#9757c8"}
ZERO = jnp_zeros(1, 1)[0]


def dye(r, theta, z):
    """Return the slowest wave that diffusion leaves in a sealed cylinder."""
    return 1 + jv(1, ZERO * r) / jv(1, ZERO) * np.cos(theta) + 0 * z


def draw(ax, r, section):
    """Draw dye (r, θ) on the section z = 0, between its points by waves in θ and lines in r."""
    fine = resample(section, 96, axis=1)
    fine = np.vstack([np.full(96, fine[0].mean()), fine])[:, np.arange(97) % 96]
    around, out = np.linspace(0, 2 * np.pi, 97), np.append(0.0, r)[:, None]
    x, y = out * np.cos(around), out * np.sin(around)
    ax.pcolormesh(x, y, fine, shading="gouraud", cmap="BuPu", vmin=0, vmax=2)
    ax.plot(np.cos(around), np.sin(around), color="0.4", lw=1)
    ax.set(aspect="equal")
    ax.set_axis_off()


def main(folder="."):
    grid, times = cy.CylinderGrid(16, 16, 5.0), np.linspace(0, 12, 25)
    figure = Figure(figsize=(7, 2.6), layout="constrained")
    first, *axes, curves = figure.subplots(1, 4, width_ratios=(1, 1, 1, 1.5))
    found = {}
    for ax, name, pitch in zip(axes, ("straight", "helical"), (np.inf, 5.0), strict=True):
        flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.sin, pitch))
        run = cy.vacuole.transport(flow, PECLET, start=dye, t_end=12.0, times=times, frames=times, n_r=12)
        drawn = (
            [(ax, run.frames[-1])] if name == "helical" else [(first, run.frames[0]), (ax, run.frames[-1])]
        )
        for where, frame in drawn:
            draw(where, run.r, frame[:, :, 0])
        ax.set_title(f"{name}, t = 12", fontsize=9)
        curves.semilogy(run.t, run.variance / run.variance[0], label=f"{name} streams", color=COLOURS[name])
        rate = -np.log(run.variance[-1] / run.variance[0]) * PECLET / (2 * run.t[-1])
        found[f"rate of mixing, {name} streams"] = rate
        if name == "straight":
            found["the same in theory"] = ZERO**2
        else:
            found["its slowest mode"] = cy.vacuole.mixing_rate(flow, PECLET)
    first.set_title("dye at t = 0", fontsize=9)
    curves.set(xlabel="time t", ylabel="variance of the dye")
    curves.legend(fontsize=8)
    figure.savefig(Path(folder) / "mixing.png", dpi=150)
    return found


if __name__ == "__main__":
    print(*(f"{name}: {value:.6g}" for name, value in main().items()), sep="\n")
