"""Whether streams that wind about the cell mix the vacuole and speed its uptake more than straight ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray

from ..figures.story import Panel, reference, story
from ..figures.style import INK, LEGEND, QUIET
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.scales import Scales
from ..stability import cyclosis
from ..vacuole import VacuoleFlow, dispersion, helical_bands, mixing_rate, poincare, stretching, trace, uptake
from ..vacuole import flow as flow_of
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

USUAL = 5.0
"""Pitch in radii that the verdict is about: one turn in the paper's length of a cell."""
PITCHES = (np.inf, 25.0, 12.5, USUAL, 3.0, 2.0)
PECLETS = (1.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0)
QUICK = (50.0, 500.0)
CHARA = Scales(radius_um=500.0, speed_um_per_s=100.0)
DIFFUSIVITIES = {"small molecules": 1000.0, "proteins": 100.0, "large assemblies": 10.0}
"""Of substances in water, by order of magnitude, in µm²/s."""
SIDE = 48
"""Points around the cell, and along it where bands wind."""
LINES = 8
"""Tracers of the section of Poincaré."""
FADING = 0.4
"""Share of the first exponent below which the last one must be for a flow without chaos."""
GAIN, LOSS = 1.1, 0.9
"""Changes of a rate from which on it counts as higher or lower."""


def bands(pitch: float) -> VacuoleFlow:
    """Return the flow in the vacuole of two steady stripes of a pitch, in radii; infinite: straight."""
    straight = np.isinf(pitch)
    grid = CylinderGrid(SIDE, 16 if straight else SIDE, 5.0 if straight else pitch)
    return flow_of(grid, helical_bands(grid, np.asarray(cyclosis(Parameters()).u), pitch))


def rates(pitch: float, peclet: float) -> tuple[float, float, float]:
    """Return the Sherwood number, the rate of mixing in D/R², and (D_eff/D - 1)/Pe²."""
    flow = bands(pitch)
    return uptake(flow, peclet), mixing_rate(flow, peclet), dispersion(flow, peclet).coefficient


def sections(lines: int, t_end: float) -> tuple[Array, npt.NDArray[np.int64]]:
    """Return where tracers cross a section of the helix, (crossings, 2), and which tracers they are."""
    angle = np.pi * (1 + 2 * np.arange(lines)) / lines
    starts = np.stack([np.linspace(0.05, 0.95, lines), angle, np.zeros(lines)], axis=1)
    found = poincare(trace(bands(USUAL), starts, t_end, order=3))
    return found.xy, found.tracer


def stretched(tracers: int, t_end: float) -> tuple[Array, Array]:
    """Return times, and the exponents of stretching (times, tracers), in the helix of the usual pitch."""
    rng = np.random.default_rng(0)
    draws = rng.random((3, tracers))
    starts = np.stack([0.95 * np.sqrt(draws[0]), 2 * np.pi * draws[1], USUAL * draws[2]], axis=1)
    found = stretching(bands(USUAL), starts, t_end, every=0.125 * t_end, order=3)
    return found.t, found.exponent


def measure(lab: Lab) -> xarray.Dataset:
    """Return rates by pitch and Péclet number, exponents of stretching, and a section of Poincaré."""
    pitches, peclets = ((np.inf, USUAL), QUICK) if lab.quick else (PITCHES, PECLETS)
    items = [(pitch, peclet) for pitch in pitches for peclet in peclets]
    table = np.array(lab.each("rates", rates, items)).reshape(len(pitches), len(peclets), 3)
    [(t, exponent)] = lab.each("stretching", stretched, [(lab.seeds, 80.0 if lab.quick else 800.0)])
    [(xy, line)] = lab.each("section", sections, [(2, 60.0) if lab.quick else (LINES, 1500.0)])
    dims = ("pitch", "peclet")
    return xarray.Dataset(
        {
            "sherwood": (dims, table[..., 0], {"units": "1"}),
            "mixing": (dims, table[..., 1], {"units": "D/R²"}),
            "dispersion": (dims, table[..., 2], {"units": "1"}),
            "exponent": (("t", "seed"), exponent.astype(np.float32), {"units": "U/R"}),
            "crossing": (("point", "axis"), xy.astype(np.float32), {"units": "R"}),
            "line": ("point", line.astype(np.int16)),
            "chara_peclet": ("substance", [CHARA.peclet(D) for D in DIFFUSIVITIES.values()]),
        },
        coords={
            "pitch": list(pitches),
            "peclet": list(peclets),
            "t": t,
            "axis": ["x", "y"],
            "substance": list(DIFFUSIVITIES),
        },
    )


def gains(data: xarray.Dataset, name: str) -> Array:
    """Return a rate with the usual pitch over that of straight bands, at every Péclet number."""
    rate = data[name]
    return np.asarray((rate.sel(pitch=USUAL) / rate.sel(pitch=np.inf)).values)


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: whether a twist raises uptake and mixing at the Péclet numbers of a cell of *Chara*."""
    peclets = np.asarray(data["peclet"].values)
    faster, mixed, spread = (gains(data, name) for name in ("sherwood", "mixing", "dispersion"))
    low, high = peclets[0], peclets[-1]
    helped = peclets[faster > GAIN]
    at = int(np.argmin(np.abs(np.log(peclets / float(data["chara_peclet"][0])))))
    exponent = np.median(np.asarray(data["exponent"].values), axis=1)
    t = np.asarray(data["t"].values)
    begin = f"from Pe = {helped[0]:g} on" if helped.size else f"at no Pe up to {high:g}"
    text = (
        f"with a pitch of {USUAL:g} R a uniform wall takes up {faster[at]:.3f} times as fast as with "
        f"straight streams at Pe = {peclets[at]:g} (small molecules in Chara) and {faster[-1]:.2f} times at "
        f"Pe = {high:g}, by more than {100 * (GAIN - 1):.0f} % {begin}; a sealed vacuole mixes "
        f"{mixed[at]:.2f} and {mixed[-1]:.2f} times as fast; but the twist lowers dispersion along the cell, "
        f"to {100 * spread[0]:.0f} % at Pe = {low:g} and {100 * spread[-1]:.0f} % at Pe = {high:g}; the "
        f"median exponent of stretching goes from {exponent[0]:.4f} U/R at t = {t[0]:g} to "
        f"{exponent[-1]:.4f} at t = {t[-1]:g}"
        + (": the helix does not mix chaotically" if exponent[-1] < FADING * exponent[0] else "")
    )
    if not helped.size:
        return Verdict(DOES_NOT, text)
    held_back = faster[at] < GAIN or np.any(spread < LOSS)
    return Verdict(IN_PART if held_back else AGREES, text)


def decisive(data: xarray.Dataset) -> str:
    """Return by how much a twist of the usual pitch raises uptake, at the ends of the range of *Chara*."""
    peclets, faster = np.asarray(data["peclet"].values), gains(data, "sherwood")
    at = int(np.argmin(np.abs(np.log(peclets / float(data["chara_peclet"][0])))))
    return (
        f"{faster[at]:.3f} times as fast an uptake at Pe = {peclets[at]:g}, and {faster[-1]:.2f} times at "
        f"Pe = {peclets[-1]:g}"
    )


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw Sherwood number and dispersion against Pe by pitch, and where tracers cross a section."""
    from matplotlib import colormaps

    pitches, peclets = np.asarray(data["pitch"].values), np.asarray(data["peclet"].values)
    colours = [INK, *colormaps["viridis"](np.linspace(0.85, 0.1, pitches.size - 1))]

    def curves(ax: Any, name: str) -> None:
        for pitch, colour in zip(pitches, colours, strict=True):
            label = "straight" if np.isinf(pitch) else f"{pitch:g} R"
            ax.plot(peclets, data[name].sel(pitch=pitch), color=colour, linewidth=1.2, label=label)
        ax.set_xscale("log")
        ax.set_xlim(peclets[0], peclets[-1])
        ax.set_xlabel("Pe = $UR/D$", labelpad=1.0)

    def sherwood(ax: Any) -> None:
        curves(ax, "sherwood")
        reference(ax, 5.783186, "diffusion")
        ax.set_ylim(5, None)
        ax.set_ylabel("Sherwood number", labelpad=1.0)
        ax.legend(**(LEGEND | {"title": "pitch", "fontsize": 8.0, "loc": "upper left"}))

    def along(ax: Any) -> None:
        curves(ax, "dispersion")
        ax.set_ylim(0, None)
        ax.set_ylabel("$(D_{eff}/D - 1)/Pe^2$", labelpad=1.0)

    def section(ax: Any) -> None:
        x, y = np.asarray(data["crossing"].values).T
        line = np.asarray(data["line"].values)
        ax.scatter(x, y, c=line, s=1.0, cmap="viridis", linewidths=0, rasterized=True)
        angle = np.linspace(0, 2 * np.pi, 200)
        ax.plot(np.cos(angle), np.sin(angle), color=QUIET, linewidth=0.8)
        ax.set_aspect("equal")
        ax.set_axis_off()

    return story([], [Panel(sherwood), Panel(along), Panel(section, 0.8)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="mixing",
    headline="Streams that wind about the cell mix its vacuole.",
    claim="Opposing streams that spiral along the cell drive a helical flow in the vacuole, which has been "
    "suggested to enhance mixing there.",
    source="Literature on the vacuole (abstract of an article in J. Fluid Mech., 2010), not the paper itself",
    method="The steady profile of two stripes winds about the cell with a pitch of 2 to 25 radii, or is "
    "straight. Stokes flow in the vacuole is exact. The slowest mode of advection and diffusion with an "
    "absorbing wall gives the Sherwood number, with a sealed wall the rate of mixing, and the cell "
    "problem dispersion along the cell, at Pe from 1 to 5000. One tracer per seed measures stretching for "
    "800 R/U. Chara: R = 500 µm, U = 100 µm/s, "
    "D = 1000 µm²/s for small molecules (Pe = 50) to 10 µm²/s (Pe = 5000).",
    seeds=100,
    quick_seeds=8,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
