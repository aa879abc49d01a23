"""How a run went: order, speed, stripes and power over time, and its last profile against theory."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..analysis.diagnostics import QUANTITIES
from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array
from ..model.units import scales_in, speed_unit
from .clock import time_axis, time_label
from .frames import grid_of, in_memory, is_closed
from .looks import setting
from .records import NARROWEST, Panels, draw_records, fonts, is_polar
from .style import DOWN, INK, QUIET, SHADE, UP, WIDTH, mathtext
from .theory import draw_profiles

__all__ = [
    "draw_power",
    "draw_speed",
    "history",
]


def __dir__() -> list[str]:
    return sorted(__all__)


_SYMBOLS = {item.name: mathtext(item.symbol) for item in QUANTITIES} | {
    "mean": r"$|\langle\mathbf{P}\rangle|$"
}
_NEEDED = (
    "order",
    "mean_P",
    "peak_speed",
    "rms_speed",
    "power_input",
    "viscous_dissipation",
    "friction_dissipation",
    "zone_angle",
    "stripe_width",
)
_NEEDED_CLOSED = (
    "order",
    "mean_vector",
    "peak_speed",
    "rms_speed",
    "circulation",
    "power_input",
    "viscous_dissipation",
    "friction_dissipation",
)


@door
def history(dataset: Any, width: float = WIDTH) -> Figure:
    """Return the figure of a run over time: order, speeds, stripe widths, power; and its last profile.

    `dataset` is a run's `xarray.Dataset`. Time is on a square-root scale, because cyclosis forms early and
    settles late. The power input is a line over the two dissipations, stacked: it coincides with their
    sum. On the right points are the axial means of P_z and u_z of the last frame; if there are two stripes,
    lines are the steady state of `cyclosis.stability`, and the largest difference is stated. Of a closed cell
    the numbers of defects take the place of the widths, and there is no theory (see
    `cyclosis.figures.closed_history`). Of a run of another model, every recorded quantity is drawn in a panel
    of its own.
    `width` is in millimetres, at least 80; below 150 there are two panels in a row instead of three. All
    quantities are dimensionless. Of a dataset with scales (see `cyclosis.dataset.with_scales`) time and
    speeds are in units. Raises `InputError` for a dataset without fields or recorded quantities, or of a
    single time.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.history import history
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=4.0)
        >>> history(run.to_dataset()).get_size_inches().round(1)
        array([7.1, 3.9])
    """
    closed = is_closed(dataset)
    polar = not closed and is_polar(dataset)
    if polar:
        grid_of(dataset)
    for name in _NEEDED_CLOSED if closed else _NEEDED if polar else ():
        if name not in dataset:
            rule = f"with the recorded quantity {name}, and others"
            raise InputError("the dataset's variables", list(dataset.data_vars), rule, "use a whole run")
    if dataset.sizes["time"] < 2:
        raise InputError("the number of saved frames", dataset.sizes["time"], "at least 2", "save more often")
    width = number("width", width, NARROWEST, 1000.0, "choose a width in millimetres")
    if closed:
        from .closed_history import draw_closed_history  # loads JAX, by way of `cyclosis.closed`

        with setting(fonts(width)):
            return draw_closed_history(in_memory(dataset), width, draw_speed, draw_power)
    if not polar:
        return draw_records(dataset, width)
    with setting(fonts(width)):
        return _drawn(in_memory(dataset), width)


def _drawn(dataset: xarray.Dataset, width: float) -> Figure:
    panels = Panels.of(width, 6)
    axes = panels.pairs()
    (order, speed), (widths, power), profiles = axes
    _order(order, dataset)
    draw_speed(speed, dataset)
    _widths(widths, dataset)
    draw_power(power, dataset)
    draw_profiles((profiles[0], profiles[1]), dataset, panels.legend)
    first, last = (float(dataset["time"].values[k]) for k in (0, -1))
    scales = scales_in(dataset)
    for ax in (order, speed, widths, power):
        time_axis(ax, first, last, scales)
        panels.legend(ax)
    panels.label(axes[:2], time_label(scales, last))
    panels.label(axes[2:], "$θ$")
    return panels.figure


def _symbol(dataset: xarray.Dataset, name: str) -> str:
    """Return the symbol of a recorded quantity: that of the dataset, if it says so."""
    given = dataset[name].attrs.get("symbol")
    return _SYMBOLS[name] if given is None else mathtext(given)


def _series(dataset: xarray.Dataset, name: str) -> tuple[Array, Array]:
    """Return the times and values of a recorded quantity, on its time axis."""
    values = dataset[name]
    return values[values.dims[0]].values, values.values


def _order(ax: Any, dataset: xarray.Dataset) -> None:
    ax.plot(*_series(dataset, "order"), color=INK, linewidth=1.2, label=_SYMBOLS["order"])
    times, mean = _series(dataset, "mean_P")
    ax.plot(
        times, np.hypot(*mean.T), color=INK, linewidth=1.0, linestyle=(0, (3, 1.5)), label=_SYMBOLS["mean"]
    )
    ax.set(ylim=(0, 1.0), ylabel="order")


def draw_speed(ax: Any, dataset: xarray.Dataset) -> None:
    """Draw the largest and the root mean square speed over time."""
    unit = speed_unit(scales_in(dataset))
    for name, style in (("peak_speed", "-"), ("rms_speed", (0, (3, 1.5)))):
        times, values = _series(dataset, name)
        ax.plot(times, unit.factor * values, color=INK, linewidth=1.1, linestyle=style, label=_SYMBOLS[name])
    ax.set_ylim(bottom=0)
    ax.set_ylabel(f"speed{unit.brackets}")


def _widths(ax: Any, dataset: xarray.Dataset) -> None:
    """Draw every stripe's width as a point, coloured by the direction of the filaments in it."""
    times, angles, widths = (dataset[name].values for name in ("time", "zone_angle", "stripe_width"))
    theta = dataset["theta"].values
    middle = angles + np.pi * widths
    up = np.zeros(widths.shape, dtype=bool)
    for index in range(times.size):
        profile = dataset["P"].isel(time=index, component=1).values.mean(axis=1)
        up[index] = np.interp(middle[index], theta, profile, period=2 * np.pi) > 0
    when = np.broadcast_to(times[:, None], widths.shape)
    for chosen, colour, label in ((up, UP, "up"), (~up, DOWN, "down")):
        shown = chosen & np.isfinite(widths)
        ax.plot(when[shown], widths[shown], ".", markersize=3.2, markeredgewidth=0, color=colour, label=label)
    ax.set_ylim(0, 1.0)
    ax.set_ylabel("stripe width / 2π")


def draw_power(ax: Any, dataset: xarray.Dataset) -> None:
    """Draw the power input as a line over the two dissipations, stacked."""
    times, total = _series(dataset, "power_input")
    friction, viscous = (_series(dataset, f"{name}_dissipation")[1] for name in ("friction", "viscous"))
    ax.plot(times, total, color=INK, linewidth=1.2, label=_symbol(dataset, "power_input"))
    ax.fill_between(
        times,
        friction,
        friction + viscous,
        color=QUIET,
        linewidth=0,
        label=_symbol(dataset, "viscous_dissipation"),
    )
    ax.fill_between(times, friction, color=SHADE, linewidth=0, label=_symbol(dataset, "friction_dissipation"))
    ax.set_ylim(bottom=0)
    ax.set_ylabel("power")
