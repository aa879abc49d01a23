"""Results of the theory in a few lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..model.units import PURE, Unit, chosen_scales, length_unit, rate_unit, speed_unit, wavenumber_unit

if TYPE_CHECKING:
    from ..stability.dispersion_table import DispersionTable
    from ..stability.existence.boundaries import Limits
    from ..stability.existence.thresholds import Threshold
    from ..stability.kinetic.dispersion import KineticDispersion
    from ..stability.profiles.eigenmodes import Modes
    from ..stability.profiles.profile import Profile
    from ..stability.profiles.travelling import Drifting
    from ..stability.regime_map import RegimeMap

NEUTRAL = 1e-9
"""Rates no larger are shown as zero."""
WAVES = 12
"""Number of waves that are listed."""


def dispersion(table: DispersionTable) -> str:
    """Return a table of growth rates and frequencies, and how many waves grow."""
    growing = int(np.sum(table.rates[:, 0].real > NEUTRAL))
    verdict = f"{growing} of {table.m.size} listed waves grow" if growing else "none of these waves grows"
    first = table.rates[:, 0]
    along, rates = wavenumber_unit(chosen_scales()), rate_unit(chosen_scales(), float(np.abs(first).max()))
    lines = [
        f"{table.base} (|P| = {table.order:.6g}, cell of length {_length(table.length)}): {verdict}",
        f"   m   j         q       growth    frequency{_columns(along, rates, rates)}",
    ]
    for m, j, q, rate in zip(table.m, table.j, table.q, first, strict=True):
        growth, turning = rate.real, _clean(-rate.imag)
        told = "" if along is PURE else _row((along, q), (rates, growth), (rates, turning))
        lines.append(f"{m:4d}{j:4d}{q:10.4f}{growth:13.6g}{turning:13.6g}{told}")
        if len(lines) == WAVES + 2:
            lines.append(f"   ... {table.m.size - WAVES} more")
            break
    return "\n".join(lines)


def kinetic_dispersion(table: KineticDispersion) -> str:
    """Return the same of the kinetic model, and whether there are enough angular modes."""
    lines = [dispersion(table)]
    if not table.resolved:
        remedy = "take more modes"
        lines.append(f"underresolved: |m_{table.modes}| is {table.tail:.1e} of the first moments; {remedy}")
    return "\n".join(lines)


def profile(found: Profile) -> str:
    """Return the numbers of a steady state of stripes."""
    angles = np.linspace(0, 2 * np.pi, 4096, endpoint=False)
    P, u = found.at(angles)
    return _table({
        "state": f"{found.count} equal stripes, steady to {found.residual:.1e} between grid points",
        "largest P": f"{np.abs(P).max():.10g}",
        "largest u": _speed(np.abs(u).max(), ".10g"),
        "rms u": _speed(np.sqrt(np.mean(u**2)), ".10g"),
        "power <Fu>": f"{np.mean(np.abs(P) ** found.params.force_exponent * P * u):.10g}",
    })  # fmt: skip


def drifting(found: Drifting) -> str:
    """Return the numbers of tilted stripes that rotate."""
    return _table({
        "state": f"two tilted stripes, steady to {found.residual:.1e} between grid points, seen turning",
        "drift": f"{_speed(found.drift, '.8g')} about the axis",
        "mean P_theta": f"{found.P[0].mean():.8g}",
        "largest |P|": f"{np.hypot(*found.P).max():.8g}",
        "largest |u|": _speed(np.hypot(*found.u).max(), ".8g"),
    })  # fmt: skip


def spectrum(found: Profile, modes: Modes) -> str:
    """Return the leading eigenvalues, each with the shares of P_theta and P_z in its mode."""
    along = wavenumber_unit(chosen_scales())
    wave = f"{modes.wavenumber:.6g}" + ("" if along is PURE else f" = {along(modes.wavenumber)}")
    kind = f"waves along the cell of q = {wave}" if modes.wavenumber else "the same all along"
    rates = rate_unit(chosen_scales(), float(np.abs(modes.eigenvalues).max()))
    lines = [
        f"{found.count} stripes, perturbations {kind}",
        f"      Re σ             Im σ       P_theta : P_z{_columns(rates, rates)}",
    ]
    for value, mode in zip(modes.eigenvalues, modes.modes, strict=True):
        share = np.sum(np.abs(mode) ** 2, axis=1)
        parts = share / share.sum()
        note = "  the rotation" if abs(value) < NEUTRAL else ""
        text = f"{_clean(value.real):15.9g}{_clean(value.imag):15.9g}"
        told = "" if rates is PURE else _row((rates, value.real), (rates, value.imag))
        lines.append(f"{text}{parts[0]:10.2f} : {parts[1]:.2f}{told}{note}")
    largest = max((v.real for v in modes.eigenvalues if abs(v) > NEUTRAL), default=0.0)
    lines.append("unstable" if largest > NEUTRAL else "all of these decay")
    return "\n".join(lines)


def limits(found: Limits) -> str:
    """Return existence, stability and the front's formula by parameter."""
    lines = [f"{found.name:>10}   exists beyond   stable beyond         error   front formula"]
    for k, value in enumerate(found.values):
        exists = "every alpha_u" if found.exists[k] == 0 else _number(found.exists[k])
        row = (exists, _number(found.stable[k]), f"{found.stable_error[k]:.1e}", _number(found.front[k]))
        lines.append(f"{value:10.6g}" + "".join(f"{text:>16}" for text in row))
    return "\n".join(lines)


def threshold(found: Threshold) -> str:
    """Return one threshold, its error and which perturbation grows below it."""
    return (
        f"stable against everything beyond alpha_u = {found.alpha_u:.10g} +- {found.error:.1e}: "
        f"below it, {found.cause} ({found.n_theta} points)"
    )


def regime_map(found: RegimeMap) -> str:
    """Return how many points of a map have each set of stable states."""
    sets: dict[str, int] = {}
    for i, j in np.ndindex(*found.stable.shape[1:]):
        names = [name for name, there in zip(found.names, found.stable[:, i, j], strict=True) if there]
        text = ", ".join(names) or "none of these"
        sets[text] = sets.get(text, 0) + 1
    head = f"stable states over {found.x.size} x {found.y.size} values of {found.x_name} and {found.y_name}"
    rows = sorted(sets.items(), key=lambda item: -item[1])
    return "\n".join([head, *(f"{count:8d}  {text}" for text, count in rows)])


def _speed(value: float, digits: str) -> str:
    """Return a speed in U, and in the units of the cell that was chosen."""
    unit = speed_unit(chosen_scales())
    return f"{value:{digits}} U" + ("" if unit is PURE else f" = {unit(value)}")


def _length(value: float) -> str:
    """Return a length in R, and in the units of the cell that was chosen."""
    unit = length_unit(chosen_scales(), value)
    return f"{value:g}" + ("" if unit is PURE else f" = {unit(value)}")


def _columns(*units: Unit) -> str:
    """Return the names of columns in these units, "" without any."""
    return "".join(f"{unit.name:>13}" for unit in units if unit is not PURE)


def _row(*values: tuple[Unit, float]) -> str:
    return "".join(f"{_clean(unit.factor * value):13.5g}" for unit, value in values)


def _number(value: float) -> str:
    return f"{value:.9g}" if np.isfinite(value) else "none"


def _clean(value: float) -> float:
    """Return a value, with a rounding error replaced by zero."""
    return 0.0 if abs(value) < NEUTRAL else float(value)


def _table(lines: dict[str, str]) -> str:
    return "\n".join(f"{name:>14}  {text}" for name, text in lines.items())
