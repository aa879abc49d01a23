"""Whether a vesicle walks off its filament before turning it, and turns it before letting go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray

from ..figures.story import Panel, reference, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, SHADE, UP
from ..model.errors import InputError
from ..model.grid import Array
from .experiment import AGREES, DOES_NOT, IN_PART, Experiment, Verdict
from .lab import Lab
from .statistics import in_words, proportion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

BOLTZMANN_PN_UM_PER_K = 1.380649e-5
FILAMENT_DIAMETER_UM = 0.008
"""Of F-actin; it enters by a logarithm."""
READINGS = ("vesicle", "strain", "heat")


class TimeEstimate(NamedTuple):
    """The times in seconds, arrays of one shape: τ_p, τ_r in the three readings, and τ_d."""

    procession_s: Array
    vesicle_s: Array
    strain_s: Array
    heat_s: Array
    detachment_s: Array

    def margin(self, reading: str = "vesicle") -> Array:
        """Return the smaller of τ_r/τ_p and τ_d/τ_r: above 1 the three times are in the required order."""
        turning = self.reorientation_s(reading)
        return np.minimum(turning / self.procession_s, self.detachment_s / turning)

    def reorientation_s(self, reading: str = "vesicle") -> Array:
        """Return τ_r by one of `READINGS`."""
        found: Array = getattr(self, f"{reading}_s")
        return found

    def best_margin(self) -> Array:
        """Return the largest margin that any τ_r could have: (τ_d/τ_p)^½."""
        return np.sqrt(self.detachment_s / self.procession_s)


def estimate(
    filament_um: npt.ArrayLike = 10.0,
    speed_um_per_s: npt.ArrayLike = 100.0,
    dwell_s: npt.ArrayLike = 1.0,
    viscosity_Pa_s: npt.ArrayLike = 0.01,
    temperature_K: npt.ArrayLike = 293.0,
    vesicle_um: npt.ArrayLike = 1.0,
    crowding: npt.ArrayLike = 10.0,
    strain_per_s: npt.ArrayLike = 2.0,
) -> TimeEstimate:
    """Return the `TimeEstimate` of a vesicle on a filament.

    The first three defaults are the paper's; `dwell_s`, how long a stalled motor stays, is its lower bound.
    `crowding` is the ratio of the drag of walls and network on the filament to that of the fluid: 1/ε in the
    model, in which a filament is advected at ε times the speed of the flow. Raises `InputError` unless all
    are positive.
    """
    L = _positive("filament_um", filament_um)
    speed = _positive("speed_um_per_s", speed_um_per_s)
    dwell = _positive("dwell_s", dwell_s)
    held = restriction(L, vesicle_um, crowding)
    return TimeEstimate(
        *np.broadcast_arrays(
            L / speed,
            (1 + held) * 0.5 * L / speed,
            1 / _positive("strain_per_s", strain_per_s),
            heat_s(L, viscosity_Pa_s, temperature_K),
            dwell,
        )
    )


def rotational_drag(filament_um: npt.ArrayLike, viscosity_Pa_s: npt.ArrayLike) -> Array:
    """Return the drag (pN µm s) of a thin rod against turning about its middle: π η L³/(3 [ln(L/d) - 0.66]).

    Its length is L (µm), its thickness that of F-actin, and the viscosity of the fluid η (Pa s, or pN s/µm²).
    """
    L = _positive("filament_um", filament_um)
    slender = np.log(L / FILAMENT_DIAMETER_UM) - 0.66
    if np.any(slender <= 0):
        raise InputError("filament_um", filament_um, "much longer than F-actin is thick", "give 0.1 or more")
    return np.asarray(np.pi * _positive("viscosity_Pa_s", viscosity_Pa_s) * L**3 / (3 * slender))


def heat_s(
    filament_um: npt.ArrayLike, viscosity_Pa_s: npt.ArrayLike, temperature_K: npt.ArrayLike = 293.0
) -> Array:
    """Return the time (s) in which heat turns a free filament: 1/(2 D_r), D_r = kT over its drag."""
    thermal = BOLTZMANN_PN_UM_PER_K * _positive("temperature_K", temperature_K)
    return np.asarray(rotational_drag(filament_um, viscosity_Pa_s) / (2 * thermal))


def restriction(
    filament_um: npt.ArrayLike, vesicle_um: npt.ArrayLike, crowding: npt.ArrayLike = 1.0
) -> Array:
    """Return the drag of a filament against turning, over that of a vesicle of a diameter (µm) at its end.

    A stalled vesicle drifts with the flow on an arm of L/2, slowed down by the drag of the filament: it turns
    the filament by a radian in τ_r = (1 + restriction) L/2 over the speed. Viscosity cancels.
    """
    arm = 0.5 * _positive("filament_um", filament_um)
    vesicle = 3 * np.pi * _positive("vesicle_um", vesicle_um) * arm**2
    return np.asarray(_positive("crowding", crowding) * rotational_drag(filament_um, 1.0) / vesicle)


def _positive(field: str, value: npt.ArrayLike) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if not np.all(np.isfinite(array) & (array > 0)):
        raise InputError(field, value, "positive", "give it in the unit that its name ends with")
    return array


RANGES = {
    # Between these values, equally often on a logarithmic scale. Length, speed and dwell time about those of
    # the paper; the rest is our choice: from water to a crowded cytoplasm, organelles, and ε from 1 to 0.01.
    "filament_um": (3.0, 30.0),
    "speed_um_per_s": (30.0, 100.0),
    "dwell_s": (1.0, 30.0),
    "viscosity_Pa_s": (0.001, 0.1),
    "temperature_K": (283.0, 303.0),
    "vesicle_um": (0.2, 2.0),
    "crowding": (1.0, 100.0),
    "strain_per_s": (0.2, 20.0),
}
TIMES = ("procession_s", "vesicle_s", "strain_s", "heat_s", "detachment_s")
FACTORS = np.geomspace(1.0, 30.0, 30)
SOME, MUCH = 3.0, 10.0
"""Factors between successive times that "shorter" and "much shorter" require."""
MOST = 0.5
COLOURS = dict(zip(READINGS, (UP, DOWN, INK), strict=True))


def measure(lab: Lab) -> xarray.Dataset:
    """Return the times at values drawn from `RANGES`, one set per seed, and those at the paper's values."""
    drawn = {name: sampled(name, lab.seeds) for name in RANGES}
    found, paper = estimate(**drawn), estimate()
    data = xarray.Dataset(
        {name: ("seed", values.astype(np.float32), {"units": "see name"}) for name, values in drawn.items()}
    )
    for name in TIMES:
        data[name] = "seed", getattr(found, name).astype(np.float32), {"units": "s"}
        data[f"paper_{name}"] = (), float(getattr(paper, name)), {"units": "s"}
    return data


def sampled(name: str, count: int) -> Array:
    """Return `count` values (n,) drawn from one of `RANGES`; more values begin with the same ones."""
    low, high = RANGES[name]
    stream = np.random.default_rng(np.random.SeedSequence(0, spawn_key=(list(RANGES).index(name),)))
    return np.asarray(low * (high / low) ** stream.random(count))


def times(data: xarray.Dataset, prefix: str = "") -> TimeEstimate:
    """Return the estimate that a dataset holds: of all draws, or with "paper_" at the paper's values."""
    return TimeEstimate(*(np.asarray(data[prefix + name].values, dtype=np.float64) for name in TIMES))


def shares(found: TimeEstimate, reading: str, factor: float) -> tuple[float, float, float]:
    """Return the share of draws whose successive times differ by a factor, with its interval."""
    good = found.margin(reading) > factor
    return proportion(int(good.sum()), int(good.size))


# Judged


def verdict(data: xarray.Dataset) -> Verdict:
    """Judge: the order holds at the paper's values and at most others, by a factor of ten."""
    found, paper = times(data), times(data, "paper_")
    ordered, some, much = (shares(found, "vesicle", factor) for factor in (1.0, SOME, MUCH))
    margin, best = float(paper.margin()), float(paper.best_margin())
    fails_first = np.mean(found.vesicle_s < found.procession_s)
    fails_last = np.mean(found.vesicle_s > found.detachment_s)
    other = [in_words(shares(found, reading, 1.0)) for reading in READINGS[1:]]
    held = restriction(data["filament_um"].values, data["vesicle_um"].values, 1.0)
    free = proportion(int(np.sum(held < 1)), int(held.size))
    p, r, d = (float(one) for one in (paper.procession_s, paper.vesicle_s, paper.detachment_s))
    text = (
        f"at the paper's values τ_p, τ_r, τ_d = {p:.2f}, {r:.2f}, {d:.2f} s: in order, by a factor of "
        f"{margin:.1f}, which no τ_r could make more than {best:.1f}; two factors of {MUCH:g} need τ_d above "
        f"{MUCH**2 * p:.0f} s; of {held.size} draws from plausible ranges the order holds in "
        f"{in_words(ordered)}, by factors of {SOME:g} in {in_words(some)}, of {MUCH:g} in {in_words(much)}; "
        f"{100 * fails_first:.1f} % turn before they walk off, {100 * fails_last:.1f} % let go before they "
        f"turn; without restriction {in_words(free)} would turn first; turned by strain the order holds in "
        f"{other[0]}, by heat in {other[1]}"
    )
    if margin <= 1:
        text = text.replace(": in order, by a factor of", ": not in order, the smaller ratio is")
    if margin <= 1 or ordered[1] <= MOST:
        return Verdict(DOES_NOT, text)
    return Verdict(AGREES if margin > MUCH and much[1] > MOST else IN_PART, text)


def decisive(data: xarray.Dataset) -> str:
    """Return the share of draws in which the three times differ by a factor of ten."""
    apart = shares(times(data), "vesicle", MUCH)
    return f"{in_words(apart)} of draws have times apart by factors of {MUCH:g}"


# Drawn


def draw(data: xarray.Dataset) -> Figure:
    """Draw the times, the share of draws whose times are in order by a factor, and the two ratios."""
    found, paper = times(data), times(data, "paper_")

    def scales(ax: Any) -> None:
        names = ("$\\tau_p$", "$\\tau_r$, vesicle", "$\\tau_r$, strain", "$\\tau_r$, heat", "$\\tau_d$")
        for k, row in enumerate(TIMES):
            low, high = np.quantile(getattr(found, row), [0.05, 0.95])
            colour = COLOURS.get(row.removesuffix("_s"), QUIET)
            ax.barh(-k, high - low, 0.55, left=low, color=colour, alpha=0.45, linewidth=0)
            ax.plot(float(getattr(paper, row)), -k, "D", color=INK, markersize=3.5, markeredgewidth=0)
        ax.set_xscale("log")
        ax.set_xlim(0.02, 2e4)
        ax.set_yticks([-k for k in range(5)], names)
        ax.tick_params(axis="y", length=0)
        ax.set_xlabel("seconds", labelpad=1.0)

    def share(ax: Any) -> None:
        for reading in READINGS:
            value, low, high = 100 * np.array([shares(found, reading, one) for one in FACTORS]).T
            ax.fill_between(FACTORS, low, high, color=COLOURS[reading], alpha=0.25, linewidth=0)
            ax.plot(FACTORS, value, color=COLOURS[reading], linewidth=1.2, label=reading)
        reference(ax, MUCH, "", upright=True)
        best = float(paper.best_margin())
        reference(ax, best, "the paper's window", upright=True)
        ax.set_xscale("log")
        ax.set_xticks([1, 3, 10, 30], ["1", "3", "10", "30"])
        ax.minorticks_off()
        ax.set_xlim(1, 30)
        ax.set_ylim(0, 100)
        ax.set_xlabel("factor between times", labelpad=1.0)
        ax.set_ylabel("in order, % of draws", labelpad=1.0)
        # A white background, since the reference lines pass behind it.
        legend: dict[str, Any] = {
            "facecolor": "white",
            "edgecolor": "none",
            "framealpha": 1.0,
            "handlelength": 1.2,
        }
        ax.legend(fontsize=8.5, title="turned by", title_fontsize=8.5, loc="upper right", **legend)

    def ratios(ax: Any) -> None:
        shown = slice(0, 1500)
        x, y = found.vesicle_s / found.procession_s, found.detachment_s / found.vesicle_s
        ax.plot(x[shown], y[shown], "o", color=UP, markersize=1.6, alpha=0.5, markeredgewidth=0)
        ax.plot(
            float(paper.vesicle_s / paper.procession_s), float(paper.detachment_s / paper.vesicle_s),
            "D", color=INK, markersize=4.5, label="the paper's values",
        )  # fmt: skip
        ax.set_xscale("log")
        ax.set_yscale("log")
        low, high = ax.get_xlim(), ax.get_ylim()
        ax.fill_between([1, low[1]], 1, high[1], color=SHADE, alpha=0.6, linewidth=0, zorder=-2)
        ax.fill_between([MUCH, low[1]], MUCH, high[1], color=SHADE, linewidth=0, zorder=-1)
        ax.set_xlim(low)
        ax.set_ylim(high)
        ax.set_xlabel("$\\tau_r/\\tau_p$", labelpad=1.0)
        ax.set_ylabel("$\\tau_d/\\tau_r$", labelpad=1.0)
        ax.legend(**(LEGEND | {"fontsize": 8.5, "markerscale": 1.0}))

    return story([], [Panel(scales, 0.8), Panel(share), Panel(ratios)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="timescales",
    headline="Walking, turning and detaching take well separated times.",
    claim="A vesicle walks along a filament in much less time than it takes to turn it, and turns it in much "
    "less than a stalled motor stays, so that alignment with the flow is robust.",
    source="Model (Figure 3)",
    method="The three times follow from length, speed and dwell time as in the paper (10 µm, 100 µm/s, 1 "
    "s), with τ_r from the drag of a vesicle relative to that of a restricted filament (ε = 0.1), from "
    "strain, or from heat. The same is done for 5000 draws, uniform on logarithmic scales, from plausible "
    "ranges.",
    seeds=5000,
    quick_seeds=2000,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
