"""A run's last state against the one-dimensional theory of straight stripes."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.lines import Line2D

from ..analysis.zones import crossings
from ..dynamics.protocol import Protocol
from ..dynamics.schedule import Schedule
from ..model.definitions import TERM_NAMES
from ..model.errors import InputError
from ..model.grid import Array
from ..model.parameters import Parameters
from ..stability.profiles.profile import Profile, stripes
from .frames import frame, grid_of
from .style import DOWN, INK, UP

_NEEDED = {"bundling", "flow_alignment", "diffusion", "rotational_diffusion"}
"""Terms without which the theory does not apply; the others do not affect straight stripes."""
_PANELS = ("P_z", "u_z")


def expected(dataset: xarray.Dataset) -> Profile | str:
    """Return the theory of a run's last state, or in a few words why there is none."""
    P = frame(dataset, -1)[0]
    if not np.all(crossings(P) == 2):
        return "no two-stripe state"
    configuration = json.loads(dataset.attrs.get("configuration", "{}"))
    if "model" in configuration:  # of the polar model by the paper's closure it is left out
        return "no theory for this model"
    terms = set(configuration.get("run", {}).get("terms", ()))
    if not _NEEDED <= terms <= set(TERM_NAMES):
        return "no theory for these terms"
    try:
        params = Parameters(**configuration["parameters"])
        if "protocol" in configuration:
            protocol = Protocol.from_tables(configuration["protocol"])
            params = Schedule(params, grid_of(dataset), protocol).params_at(float(dataset["time"][-1]))
        return stripes(params, 2, max(256, 2 * P.shape[1]))
    except InputError:
        return "no theory for these parameters"


def draw_profiles(axes: tuple[Any, Any], dataset: xarray.Dataset, legend: Callable[..., None]) -> None:
    """Draw the axial means of P_z and u_z in a run's last frame, and the theory, into two axes.

    Points are the run, coloured by the direction of P_z; lines are the theory, shifted so that the rising
    zones coincide. The largest difference between them is stated; `legend` draws that of the first panel.
    Everything is dimensionless.
    """
    theta = np.asarray(dataset["theta"].values, dtype=np.float64)
    measured = [field[1].mean(axis=1) for field in frame(dataset, -1)]
    colours = np.where(measured[0] > 0, UP, DOWN)
    theory = expected(dataset)
    lines: tuple[Array, Array] | None = None
    if isinstance(theory, Profile):
        zone = _rising(dataset, measured[0])
        lines = theory.at(theta, zone)
        angle = np.linspace(0, 2 * np.pi, 600)
        curves = theory.at(angle, zone)
    for k, (ax, name) in enumerate(zip(axes, _PANELS, strict=True)):
        ax.axhline(0.0, color=INK, linewidth=0.4)
        ax.scatter(theta, measured[k], s=7.0, c=colours, linewidths=0, zorder=2)
        note = str(theory)
        if lines is not None:
            ax.plot(angle, curves[k], color=INK, linewidth=0.8, zorder=3)
            note = f"largest difference {_power_of_ten(np.abs(measured[k] - lines[k]).max())}"
        top = 1.1 * max(float(np.abs(measured[k]).max()), 1e-3)
        # The note is above the curve, inside the axes.
        ax.set(xlim=(0, 2 * np.pi), ylim=(-top, 1.4 * top), ylabel=f"$\\langle {name}\\rangle_z$")
        ax.text(0.5, 0.98, note, transform=ax.transAxes, ha="center", va="top", fontsize=_note_size())
        ax.set_xticks([0, np.pi, 2 * np.pi], ["0", "π", "2π"])
    if lines is not None:
        point, line = (
            Line2D([], [], color=UP, marker=".", markersize=3.2, markeredgewidth=0, linestyle=""),
            Line2D([], [], color=INK, linewidth=0.8),
        )
        legend(axes[0], [point, line], ["run", "theory"])


def _note_size() -> float:
    """Return the size of the note: half a point below that of the labels."""
    return float(matplotlib.rcParams["axes.labelsize"]) - 0.5


def _power_of_ten(value: float) -> str:
    """Return a small number as mathematics, with one digit."""
    digit, exponent = f"{value:.0e}".split("e")
    return f"${digit} \\times 10^{{{int(exponent)}}}$"


def _rising(dataset: xarray.Dataset, profile: Array) -> float:
    """Return the zone at which the profile of the last frame turns upward."""
    theta = dataset["theta"].values
    zones = dataset["zone_angle"].values[-1]
    zones = zones[np.isfinite(zones)]
    slopes = np.interp(zones + 0.1, theta, profile, period=2 * np.pi)
    return float(zones[np.argmax(slopes)])
