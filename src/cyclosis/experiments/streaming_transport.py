"""What straight streams do for transport in the vacuole: along the cell, and between parts of the wall."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..figures.story import Panel, reference, story
from ..figures.style import DOWN, INK, LEGEND, UP
from ..model.grid import Array
from ..vacuole import band_exchange, dispersion, trace, uptake
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .mixing import CHARA, DIFFUSIVITIES, bands

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

WAVENUMBER = 2 * np.pi / 5.0
"""Of the bands of the wall: one period in 5 radii."""
PECLETS = (1.0, 3.0, 10.0, 30.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0)
QUICK = (1.0, 100.0, 1000.0)
WALKED = (10.0, 20.0, 50.0)
"""Péclet numbers of the random walks."""
SETTLED = 1.2
"""Time in R²/D from which on walkers spread as Taylor says, to e^(-3.39 · 1.2) = 2 % and falling."""
MUCH = 10.0
"""How many times faster than diffusion exchange must be to count as much faster."""
NEAR = 0.05
"""How close to 1/2 the last exponent of exchange must be."""


def exchange(peclet: float) -> tuple[float, float]:
    """Return the flux between bands of the wall in D/R, and the Sherwood number of a uniform wall."""
    flow = bands(np.inf)
    return band_exchange(flow, peclet, WAVENUMBER), uptake(flow, peclet)


def walk(peclet: float, walkers: int) -> Array:
    """Return D_eff/D of random walkers along the cell, and its standard error."""
    rng = np.random.default_rng(0)
    draws = rng.random((3, walkers))
    starts = np.stack([np.sqrt(draws[0]), 2 * np.pi * draws[1], 5 * draws[2]], axis=1)
    early, late = SETTLED * peclet, 3 * SETTLED * peclet
    paths = trace(bands(np.inf), starts, late, [early, late], 0.1, peclet, seed=1, order=3, refine=1)
    moved = paths.xyz[..., 2] - starts[:, 2]
    gained = (moved[1] - moved[1].mean()) ** 2 - (moved[0] - moved[0].mean()) ** 2
    scale = 0.5 * peclet / (late - early)
    return np.array([gained.mean(), gained.std() / np.sqrt(walkers)]) * scale


def measure(lab: Lab) -> xarray.Dataset:
    """Return exchange between bands and uptake over Pe, and dispersion by theory and random walks."""
    peclets, walked = (QUICK, WALKED[:1]) if lab.quick else (PECLETS, WALKED)
    found = np.array(lab.each("exchange", exchange, [(peclet,) for peclet in peclets]))
    walks = np.array(lab.each("walks", walk, [(peclet, lab.seeds) for peclet in walked]))
    from scipy.special import iv

    return xarray.Dataset(
        {
            "exchange": ("peclet", found[:, 0], {"units": "D/R"}),
            "sherwood": ("peclet", found[:, 1], {"units": "1"}),
            "walked": ("walk_peclet", walks[:, 0], {"units": "1"}),
            "walked_error": ("walk_peclet", walks[:, 1], {"units": "1"}),
            "diffusion": (
                (),
                float(WAVENUMBER * iv(1, WAVENUMBER) / iv(0, WAVENUMBER)),
                {"units": "D/R"},
            ),
            "coefficient": ((), dispersion(bands(np.inf)).coefficient, {"units": "1"}),
            "chara_peclet": ("substance", [CHARA.peclet(D) for D in DIFFUSIVITIES.values()]),
        },
        coords={
            "peclet": list(peclets),
            "walk_peclet": list(walked),
            "substance": list(DIFFUSIVITIES),
        },
    )


def exponents(data: xarray.Dataset) -> Array:
    """Return d ln(exchange)/d ln(Pe) between successive Péclet numbers."""
    return np.diff(np.log(data["exchange"].values)) / np.diff(np.log(data["peclet"].values))


def deviations(data: xarray.Dataset) -> Array:
    """Return how far walks lie from Taylor's theory, in standard errors."""
    theory = 1 + float(data["coefficient"]) * data["walk_peclet"].values ** 2
    return np.asarray(np.abs(data["walked"].values - theory) / data["walked_error"].values)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: straight streams disperse along the cell, connect parts of the wall, and leave a uniform one."""
    peclets, c = np.asarray(data["peclet"].values), float(data["coefficient"])
    factor = np.asarray(data["exchange"].values) / float(data["diffusion"])
    last, off = exponents(data)[-1], deviations(data)
    uniform = np.asarray(data["sherwood"].values)
    gain = float(uniform.max() / uniform.min())
    small = float(data["chara_peclet"][0])
    at = int(np.argmin(np.abs(np.log(peclets / 1000.0))))
    text = (
        f"along the cell D_eff = D (1 + {c:.4f} Pe²): {1 + c * small**2:.0f} D for small molecules in Chara "
        f"(Pe = {small:g}); random walks at Pe = "
        f"{', '.join(f'{pe:g}' for pe in data['walk_peclet'].values)} lie within "
        f"{off.max():.1f} standard errors; exchange between bands across the axis is "
        f"{factor[at]:.1f} times that of diffusion at Pe = {peclets[at]:g} and grows as Pe^{last:.2f} up to "
        f"Pe = {peclets[-1]:g}; but a uniform wall takes up as without flow (a factor of {gain:.6f} at all "
        "Pe), because straight streams do not mix the section"
    )
    if factor[at] < MUCH or off.max() > 4 or abs(last - 0.5) > NEAR:
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if gain > 1.1 else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return how much faster bands of the wall exchange at Pe = 1000, and the exponent."""
    at = int(np.argmin(np.abs(np.log(data["peclet"].values / 1000.0))))
    factor = float(data["exchange"][at]) / float(data["diffusion"])
    return f"{factor:.1f} times as much exchange between bands at Pe = {data['peclet'].values[at]:g}"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw exchange between bands, dispersion along the cell, and uptake by a uniform wall, against Pe."""
    peclets = np.asarray(data["peclet"].values)

    def axis(ax: Any, label: str) -> None:
        ax.set_xscale("log")
        ax.set_xlim(peclets[0], peclets[-1])
        ax.set_xlabel("Pe = $UR/D$", labelpad=1.0)
        ax.set_ylabel(label, labelpad=1.0)

    def bands_of_wall(ax: Any) -> None:
        ax.plot(peclets, data["exchange"], "o-", color=UP, markersize=3.0, linewidth=1.2, label="bands")
        high = float(data["exchange"][-1])
        ax.plot(peclets, high * np.sqrt(peclets / peclets[-1]), color=INK, linewidth=0.8, label="$Pe^{1/2}$")
        axis(ax, "flux between bands, $D/R$")
        ax.set_yscale("log")
        reference(ax, float(data["diffusion"]), "diffusion")
        ax.legend(**(LEGEND | {"loc": "upper left"}))

    def along(ax: Any) -> None:
        ax.plot(
            peclets, 1 + float(data["coefficient"]) * peclets**2, color=INK, linewidth=1.0, label="theory"
        )
        ax.errorbar(
            data["walk_peclet"], data["walked"], 2 * data["walked_error"], fmt="o", color=DOWN,
            markersize=3.6, label="random walks",
        )  # fmt: skip
        axis(ax, "$D_{eff}/D$ along the cell")
        ax.set_yscale("log")
        ax.legend(**(LEGEND | {"loc": "upper left"}))

    def uniform(ax: Any) -> None:
        ax.plot(peclets, data["sherwood"], "o-", color=UP, markersize=3.0, linewidth=1.2)
        axis(ax, "Sherwood number, uniform wall")
        ax.set_ylim(0, 10)

    return story([], [Panel(bands_of_wall), Panel(along), Panel(uniform, 0.8)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="streaming-transport",
    headline="Straight streams carry substances along the cell and between parts of its wall.",
    claim="Streaming has been suggested to make up for slow diffusion in large cells, and to even out "
    "what is in them.",
    source="Literature on streaming (abstract of a review, 2015), not the paper itself",
    method="The vacuole is driven by the steady profile of two straight stripes. The coefficient of Taylor "
    "dispersion is a closed series, compared with random walks (one for each seed). A wall that holds "
    "c = cos(2π z/5R), bands across the axis, exchanges what the steady solution of advection and diffusion "
    "says, and the slowest mode with an absorbing wall gives the Sherwood number, at Pe from 1 to 5000.",
    seeds=4000,
    quick_seeds=400,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
