"""How a run on a closed cell went: order, defects, speed and power over time, and its last state."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..model.grid import Array
from ..model.units import scales_in
from .clock import time_axis, time_label
from .closed_cells import closed_grid, marks_of, skin_of
from .frames import frame
from .records import Panels
from .style import DOWN, INK, QUIET, UP, mathtext

MOST_FRAMES = 120
"""Defects are counted in at most about this many frames."""
DASHED = (0, (3, 1.5))
NOTHING = 0.1
"""Least height of the axes of a profile: smaller values are drawn as the flat line that they are."""
Draw = Callable[[Any, xarray.Dataset], None]


def draw_closed_history(dataset: xarray.Dataset, width: float, draw_speed: Draw, draw_power: Draw) -> Figure:
    """Return the figure of a closed run over time; two panels are drawn as for a cylinder.

    The defects of P are counted by the sign of their index, and their indices sum to 2; frames in disorder
    are left out. On the right are P_s and u_s of the last frame around the middle of the cell, against theta.
    On a sphere, where theta has no meaning, it is the circulation of the flow, and the share of <|u|²> that
    a rigid rotation explains.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.history import history
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=6)
        >>> run = cy.simulate(cy.Parameters(), grid, cy.closed.rotation(grid), t_end=2.0)
        >>> history(run.to_dataset()).get_size_inches()[0].round(1)  # drawn by draw_closed_history
        np.float64(7.1)
    """
    grid = closed_grid(dataset)
    panels = Panels.of(width, 6)
    pairs = panels.pairs()
    (order, speed), (counts, power), (upper, lower) = pairs
    times = dataset["order"][dataset["order"].dims[0]].values
    order.plot(times, dataset["order"].values, color=INK, linewidth=1.2, label=mathtext("<|P|²>^½"))
    mean = np.hypot.reduce(dataset["mean_vector"].values, axis=1)
    label = r"$|\langle\mathbf{P}\rangle|$"
    order.plot(times, mean, color=INK, linewidth=1.0, linestyle=DASHED, label=label)
    order.set(ylim=(0, 1.0), ylabel="order")
    draw_speed(speed, dataset)
    draw_power(power, dataset)
    _defects(counts, dataset, grid)
    over_time = [order, counts, speed, power]
    if skin_of(grid).axial:
        _around(upper, lower, dataset, grid)
    else:
        _circulation(upper, lower, dataset)
        over_time += [upper, lower]
    scales = scales_in(dataset)
    first, last = (float(dataset["time"].values[k]) for k in (0, -1))
    for ax in over_time:
        time_axis(ax, first, last, scales)
    for ax in (order, counts, speed, power, upper, lower):
        if ax.get_legend_handles_labels()[0]:
            panels.legend(ax)
    around = "$θ$" if skin_of(grid).axial else time_label(scales, last)
    panels.label(pairs[:2], time_label(scales, last))
    panels.label(pairs[2:], around)
    return panels.figure


def _defects(ax: Any, dataset: xarray.Dataset, grid: Any) -> None:
    """Draw the numbers of defects of both signs as steps over time."""
    saved = dataset["time"].values
    chosen = np.unique(np.linspace(0, saved.size - 1, min(saved.size, MOST_FRAMES)).astype(int))
    counts = np.full((2, chosen.size), np.nan)
    for k, index in enumerate(chosen.tolist()):
        found = [mark[0] for mark in marks_of(grid, frame(dataset, index)[0])]
        if found:
            counts[:, k] = sum(i for i in found if i > 0), -sum(i for i in found if i < 0)
    for values, style, label in zip(counts, ("-", DASHED), ("+1", "−1"), strict=True):
        ax.step(saved[chosen], values, color=INK, linewidth=1.1, linestyle=style, where="mid", label=label)
    most = np.nanmax(counts) if np.isfinite(counts).any() else 2.0
    ax.set(ylim=(0, 1.08 * max(most, 3.0)), ylabel="defects")


def _around(upper: Any, lower: Any, dataset: xarray.Dataset, grid: Any) -> None:
    """Draw P_s and u_s of the last frame on the middle circle."""
    P, u = (_middle(grid, field[1]) for field in frame(dataset, -1))
    theta = np.append(grid.theta, 2 * np.pi)
    for ax, values, label in ((upper, P, "$P_s$"), (lower, u, "$u_s$")):
        closed = np.append(values, values[0])
        ax.axhline(0.0, color=QUIET, linewidth=0.6)
        ax.plot(theta, closed, color=INK, linewidth=1.1)
        ax.fill_between(theta, closed, where=closed > 0, color=UP, alpha=0.25, linewidth=0, interpolate=True)
        ax.fill_between(
            theta, closed, where=closed < 0, color=DOWN, alpha=0.25, linewidth=0, interpolate=True
        )
        size = 1.1 * max(float(np.abs(closed).max()), NOTHING)
        ax.set(xlim=(0, 2 * np.pi), ylim=(-size, size), ylabel=f"{label} at mid-cell")
        ax.set_xticks([0, np.pi, 2 * np.pi], ["0", "π", "2π"])
        ax.locator_params(axis="y", nbins=4)


def _middle(grid: Any, values: Array) -> Array:
    """Return a field (n_theta, n_s) on the equator, between the two latitudes next to it."""
    half = grid.n_s // 2
    return np.asarray(values[:, half] if grid.n_s % 2 else 0.5 * (values[:, half - 1] + values[:, half]))


def _circulation(upper: Any, lower: Any, dataset: xarray.Dataset) -> None:
    """Draw the circulation of the flow, and the share of its energy that is a rotation."""
    item = dataset["circulation"]
    times, vectors = item[item.dims[0]].values, item.values
    for name, values, style in zip("xyz", vectors.T, ("-", DASHED, (0, (1, 1.5))), strict=True):
        upper.plot(times, values, color=INK, linewidth=1.1, linestyle=style, label=f"${name}$")
    upper.set_ylabel("circulation")
    # A rotation with angular velocity w has <|u|²> = 2/3 |w|², and circulation w.
    speed2 = dataset["rms_speed"].values ** 2
    rigid = 2 / 3 * np.sum(vectors**2, axis=1)
    share = np.where(speed2 > 1e-12, rigid / np.maximum(speed2, 1e-12), np.nan)
    lower.plot(times, share, color=INK, linewidth=1.1)
    lower.set(ylim=(0, 1.05), ylabel="share of rotation")
