"""A steady profile with its eigenvalues and leading modes, and eigenvalues along a branch."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array
from ..stability.branches.branch import Branch
from ..stability.profiles.eigenmodes import Modes
from ..stability.profiles.profile import Profile
from ..stability.profiles.travelling import Drifting
from . import quantities
from .looks import setting
from .style import DOWN, INK, LEGEND, QUIET, TYPE, UP, WIDTH, ZONE, blank, place
from .swept import axis

__all__ = [
    "NEUTRAL",
    "SHOWN",
    "drifting",
    "eigenvalues",
    "profile",
    "spectrum",
]


def __dir__() -> list[str]:
    return sorted(__all__)


SHOWN = 4
"""Modes that are drawn."""
NEUTRAL = 1e-9
"""Growth rates no larger count as zero."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP = 15.0, 4.0, 10.0, 9.0, 16.0
_PROFILE, _HIGH, _BETWEEN = 46.0, 56.0, 5.0


@door
def profile(found: Profile, width: float = WIDTH) -> Figure:
    """Return the figure of a steady state: polarity P and flow u around the cell, dimensionless.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import spectra
        >>> figure = spectra.profile(cy.stability.cyclosis(cy.Parameters(), n_theta=64))
        >>> len(figure.axes)
        2
    """
    with setting(TYPE):
        figure = blank(width, _BELOW + _PROFILE + _ABOVE)
        across = (width - _LEFT - _RIGHT - _GAP) / 2
        for k, (name, colour) in enumerate((("P_z", UP), ("u_z", INK))):
            ax = place(figure, _LEFT + k * (across + _GAP), _BELOW, across, _PROFILE)
            _profile(ax, found, k)
            if k == 0:
                ax.set_ylabel(f"${name}$", color=colour)
            else:
                quantities.name(ax.yaxis, f"${name}$", "speed", color=colour)
        return figure


@door
def drifting(found: Drifting, width: float = WIDTH) -> Figure:
    """Return the figure of tilted stripes that rotate: both components of P and of u, dimensionless.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import spectra
        >>> figure = spectra.drifting(cy.stability.drifting(cy.Parameters(kappa=0.2), n_theta=32))
        >>> len(figure.axes)
        2
    """
    theta = np.append(found.theta, 2 * np.pi)
    with setting(TYPE):
        figure = blank(width, _BELOW + _PROFILE + _ABOVE)
        across = (width - _LEFT - _RIGHT - _GAP) / 2
        for k, (name, field) in enumerate((("P", found.P), ("u", found.u))):
            ax = place(figure, _LEFT + k * (across + _GAP), _BELOW, across, _PROFILE)
            ax.axhline(0.0, color=QUIET, linewidth=0.6)
            for part, colour, axis_name in ((1, UP, "z"), (0, DOWN, r"\theta")):
                values = np.append(field[part], field[part][0])
                ax.plot(theta, values, color=colour, linewidth=1.3, label=f"${name}_{{{axis_name}}}$")
            _around(ax)
            ax.set_xlabel("θ", labelpad=1.0)
            ax.legend(**LEGEND)
            if k == 0:
                drift = quantities.words(found.drift, "speed", ".6g")
                ax.set_title(f"drift {drift}", loc="right", fontsize=9.0, pad=3.0)
            else:
                quantities.name(ax.yaxis, "", "speed")
        return figure


@door
def spectrum(found: Profile, modes: Modes, width: float = WIDTH) -> Figure:
    """Return the figure of a steady state's leading eigenvalues in the complex plane and its first modes.

    Full dots grow or decay, the open one is the neutral rotation; modes are their components (v_theta, v_z)
    over the angle, with the profile P behind. Dimensionless. `width` is in millimetres.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import spectra
        >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
        >>> figure = spectra.spectrum(state, state.spectrum(4))
        >>> len(figure.axes)
        5
    """
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    count = min(SHOWN, modes.eigenvalues.size)
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        across = (width - _LEFT - _RIGHT - _GAP) / 2
        ax = place(figure, _LEFT, _BELOW, across, _HIGH)
        _plane(ax, modes)
        each = (_HIGH - (count - 1) * _BETWEEN) / count
        for k in range(count):
            bottom = _BELOW + (count - 1 - k) * (each + _BETWEEN)
            panel = place(figure, _LEFT + across + _GAP, bottom, across, each)
            _mode(panel, found, modes, k)
            panel.tick_params(labelbottom=k == count - 1)
        panel.set_xlabel("θ", labelpad=1.0)
        key = [
            Line2D([], [], color=UP, linewidth=1.1, label="$v_z$"),
            Line2D([], [], color=DOWN, linewidth=1.1, label=r"$v_\theta$"),
            Line2D([], [], color=QUIET, linewidth=0.8, label="$P$"),
        ]
        top = figure.axes[1]
        top.legend(handles=key, **LEGEND | {"bbox_to_anchor": (-0.03, 1.0)})
        return figure


@door
def eigenvalues(branch: Branch, log: bool = False, width: float = WIDTH) -> Figure:
    """Return the figure of growth rates along a branch: over its parameter, and their paths in the plane.

    Left, real parts over the parameter: purple for perturbations that do not vary along the cell, green for
    the leading one of each axial wavenumber; vertical lines mark special points. Right, their paths in the
    complex plane, darker as the parameter grows, or, where all are nearly real, a close-up around zero. `log`
    draws the parameter on a logarithmic scale. Dimensionless; `width` in millimetres. Raises `InputError` for
    a logarithmic scale that reaches 0.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import spectra
        >>> state = cy.stability.cyclosis(cy.Parameters(alpha_p=0.3), n_theta=64)
        >>> branch = cy.stability.continue_branch(state, "alpha_u", (0.45, 0.55), length=None, longest=0.1)
        >>> len(spectra.eigenvalues(branch).axes)
        2
    """
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    if log and branch.parameter.min() <= 0:
        raise InputError(
            branch.name, float(branch.parameter.min()), "above 0 on a logarithmic scale", "raise its bound"
        )
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        across = 0.55 * (width - _LEFT - _RIGHT - _GAP)
        ax = place(figure, _LEFT, _BELOW, across, _HIGH)
        plane = place(figure, _LEFT + across + _GAP, _BELOW, width - _LEFT - across - _GAP - _RIGHT, _HIGH)
        low, high = _window(branch)
        _rates(ax, branch, log, (low, high))
        both = np.concatenate([branch.eigenvalues.imag.ravel(), branch.across.imag.ravel()])
        span = float(np.nanmax(np.abs(both)))
        if span > 1e-3 * (high - low):
            _ways(plane, branch, (low, high), span)
        else:
            near = max(2.5 * max(_largest(branch), 0.0), 0.03 * (high - low))
            _rates(plane, branch, log, (-near, near))
            plane.set_ylabel("")
            plane.get_legend().remove()
            plane.set_title("near zero", loc="left", fontsize=9.0, pad=3.0)
        return figure


def _profile(ax: Any, found: Profile, which: int) -> None:
    angle = np.linspace(0, 2 * np.pi, 721)
    values = found.at(angle)[which]
    ax.axhline(0.0, color=QUIET, linewidth=0.6)
    for sign, colour in ((1, UP), (-1, DOWN)):
        ax.plot(angle, np.where(sign * values >= 0, values, np.nan), color=colour, linewidth=1.4)
        ax.fill_between(angle, values, where=sign * values >= 0, color=colour, alpha=0.12, linewidth=0)
    zones = np.cumsum(found.widths)[:-1] * 2 * np.pi
    for zone in zones:
        ax.axvline(zone, color=QUIET, linewidth=0.6, linestyle=(0, (1, 1.4)))
    _around(ax)
    ax.set_xlabel("θ", labelpad=1.0)
    largest = float(np.abs(values).max())
    told = quantities.words(largest, "speed", ".6g") if which else f"{largest:.6g}"
    ax.set_title(f"largest {told}", loc="left", fontsize=9.0, pad=3.0)


def _plane(ax: Any, modes: Modes) -> None:
    values = np.concatenate([modes.eigenvalues, np.conj(modes.eigenvalues)])
    ax.axvline(0.0, color=QUIET, linewidth=0.6)
    ax.axhline(0.0, color=QUIET, linewidth=0.6)
    neutral = np.abs(values) < NEUTRAL
    ax.plot(values.real[~neutral], values.imag[~neutral], "o", color=UP, markersize=4.2, markeredgewidth=0)
    ax.plot(values.real[neutral], values.imag[neutral], "o", color=INK, markerfacecolor=ZONE, markersize=4.2)
    span = max(float(np.abs(values.imag).max()), 1e-6)
    ax.set_ylim(-1.3 * span, 1.3 * span)
    if span <= 1e-6:
        ax.set_yticks([0.0])
        ax.set_ylim(-1.0, 1.0)
    _name_plane(ax, 1.0)
    title = f"{modes.eigenvalues.size} leading eigenvalues"
    if modes.wavenumber:
        title += f", q = {quantities.words(modes.wavenumber, 'wavenumber')}"
    ax.set_title(title, loc="left", fontsize=9.0, pad=3.0)


def _name_plane(ax: Any, pad: float) -> None:
    """Name the axes of the complex plane, both in one unit."""
    unit = quantities.unit("rate", float(np.abs(ax.get_xlim()).max()))
    ax.set_xlabel(f"Re σ{unit.brackets}", labelpad=1.0)
    ax.set_ylabel(f"Im σ{unit.brackets}", labelpad=pad)
    quantities.ticks(ax.xaxis, unit)
    if ax.get_yticks().size > 1:
        quantities.ticks(ax.yaxis, unit)


def _mode(ax: Any, found: Profile, modes: Modes, k: int) -> None:
    theta = np.append(modes.theta, 2 * np.pi)
    v = modes.modes[k].real
    v = v / np.abs(v).max()
    ax.axhline(0.0, color=QUIET, linewidth=0.5)
    ax.plot(theta, np.append(found.P, found.P[0]), color=QUIET, linewidth=0.8)
    for part, colour in ((v[1], UP), (v[0], DOWN)):
        if np.abs(part).max() > 1e-6:
            ax.plot(theta, np.append(part, part[0]), color=colour, linewidth=1.1)
    _around(ax)
    ax.set_ylim(-1.25, 1.25)
    ax.set_yticks([])
    value = modes.eigenvalues[k]
    unit = quantities.unit("rate", abs(value))
    real, imaginary = (f"{unit.factor * part:.4g}" for part in (value.real, abs(value.imag)))
    shown = real if abs(value.imag) < NEUTRAL else f"{real} ± {imaginary}i"
    shown = f"{shown} {unit.name}".rstrip()
    shown = "0 (rotation)" if abs(value) < NEUTRAL else shown
    ax.set_title(f"σ = {shown}", loc="right", fontsize=8.5, pad=1.5)


def _around(ax: Any) -> None:
    ax.set_xlim(0, 2 * np.pi)
    ax.set_xticks([0, np.pi, 2 * np.pi], ["0", "π", "2π"])
    ax.spines[["top", "right"]].set_visible(False)


def _rates(ax: Any, branch: Branch, log: bool, window: tuple[float, float]) -> None:
    x = branch.parameter
    ax.axhline(0.0, color=INK, linewidth=0.6)
    for rates, colour in ((branch.across, DOWN), (branch.eigenvalues, UP)):
        for column in rates.T:
            ax.plot(x, column.real, color=colour, linewidth=0.9)
    for point in branch.points:
        if point.kind != "end":
            ax.axvline(point.value, color=QUIET, linewidth=0.6, linestyle=(0, (1, 1.4)), zorder=0)
    if log:
        ax.set_xscale("log")
    ax.set_xlim(x.min(), x.max())
    ax.set_ylim(*window)
    ax.set_xlabel(axis(branch.name, x[[0, -1]] if x[0] < x[-1] else x[[-1, 0]], False).symbol, labelpad=1.0)
    quantities.name(ax.yaxis, "growth rate Re σ", "rate")
    ax.spines[["top", "right"]].set_visible(False)
    key = [
        Line2D([], [], color=UP, linewidth=1.1, label="the same along the cell"),
        Line2D([], [], color=DOWN, linewidth=1.1, label="waves along the cell"),
    ]
    ax.legend(handles=key, **LEGEND)


def _ways(ax: Any, branch: Branch, window: tuple[float, float], span: float) -> None:
    ax.axvline(0.0, color=INK, linewidth=0.6)
    ax.axhline(0.0, color=QUIET, linewidth=0.6)
    share = np.argsort(np.argsort(branch.parameter)) / max(branch.parameter.size - 1, 1)
    for rates, colour in ((branch.across, DOWN), (branch.eigenvalues, UP)):
        for column in rates.T:
            for part in (column.imag, -column.imag):
                places = np.stack([column.real, part], axis=1)
                pieces = np.stack([places[:-1], places[1:]], axis=1)
                usable = np.isfinite(pieces).all(axis=(1, 2))
                faded = [(*matplotlib.colors.to_rgb(colour), 0.15 + 0.85 * s) for s in share[:-1][usable]]
                ax.add_collection(LineCollection(list(pieces[usable]), colors=faded, linewidths=1.1))
    ax.set_xlim(*window)
    ax.set_ylim(-1.15 * span, 1.15 * span)
    _name_plane(ax, 0.0)


def _window(branch: Branch) -> tuple[float, float]:
    """Return limits that show the neighbourhood of zero well, and leave out fast decay."""
    high = max(_largest(branch), 0.0)
    low = float(np.nanmin(branch.eigenvalues[:, : min(4, branch.eigenvalues.shape[1])].real))
    room = 0.06 * max(high - low, 1e-6)
    return low - room, high + room


def _largest(branch: Branch) -> float:
    """Return the largest growth rate anywhere on a branch."""
    leading: Array = np.concatenate([branch.eigenvalues[:, 0].real, branch.across.real.ravel()])
    return float(np.nanmax(leading))
