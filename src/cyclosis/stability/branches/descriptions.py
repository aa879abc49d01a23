"""What happens along a branch, in words."""

from __future__ import annotations

import numpy as np

from ...model.grid import Array
from .branch import SpecialPoint
from .curve import Curve
from .events import Event

STILL = 1e-9
"""Drift below which a state counts as stationary."""
SHARE = 0.05
"""Part of a perturbation's square in a component above which the component is named."""


def special_point(curve: Curve, event: Event, index: int) -> SpecialPoint:
    """Return the `SpecialPoint` of an event at a point of a branch."""
    value = curve.value(event.node.X)
    kind, what = _described(curve, event)
    sentence = (
        f"{kind.capitalize() if kind != 'Hopf point' else kind} at {curve.name} = {value:.12g}: {what}."
    )
    return SpecialPoint(kind, value, index, sentence, event.wave, event.frequency, event.last)


def end_point(curve: Curve, value: float, index: int, why: str) -> SpecialPoint:
    """Return the `SpecialPoint` of a branch that ends because range, points or resolution are exhausted."""
    return SpecialPoint("end", value, index, f"End at {curve.name} = {value:.12g}: {why}.", ends=True)


def _described(curve: Curve, event: Event) -> tuple[str, str]:
    if event.what == "fold":
        return "fold", "the branch turns back"
    if event.what == "apex":
        return (
            "branch point",
            "the state becomes symmetric, and the branch would continue as its own mirror image",
        )
    if event.what == "vanish":
        return _vanishing(event)
    if event.wave:
        q = 2 * np.pi * event.wave / curve.grid.length
        mode = f"waves along the cell with {event.wave} in its length (q = {q:.4g})"
        if event.what == "branch":
            return "branch point", f"a real growth rate of {mode} passes through zero"
        return (
            "Hopf point",
            f"the growth rate of {mode} passes through zero at the frequency {event.frequency:.6g}",
        )
    if event.what == "branch":
        return "branch point", (
            f"a real eigenvalue passes through zero, and a branch crosses that differs {_mode(curve, event)}"
        )
    turning = "a rotating wave branches off" if not curve.varies else "an oscillation branches off"
    return (
        "Hopf point",
        f"a pair of eigenvalues passes the imaginary axis at ±{event.frequency:.6g} i, and {turning}",
    )


def _vanishing(event: Event) -> tuple[str, str]:
    mean = event.node.X[:-2].reshape(2, -1).mean(axis=1)
    theta, z = (abs(float(part)) for part in mean)
    order = max(theta, z)
    name = "circumferential" if theta > z else "unidirectional"
    into = "disorder" if order < 1e-3 else f"the uniform {name} state (|P| = {order:.4g})"
    drift = float(event.node.X[-2])
    if abs(drift) > STILL:
        return "Hopf point", f"the stripes vanish into {into}, turning about the axis at {drift:.6g}"
    return "branch point", f"the stripes vanish into {into}"


def _mode(curve: Curve, event: Event) -> str:
    """Return the components in which the critical perturbation is strong, and with how many waves."""
    mode: Array = curve.critical(event.node.X)[:-2].reshape(2, -1)
    share = np.sum(mode**2, axis=1) / np.sum(mode**2)
    parts = [
        _part(name, part)
        for name, part, size in zip(("P_theta", "P_z"), mode, share, strict=True)
        if size > SHARE
    ]
    return "in " + " and ".join(parts)


def _part(name: str, mode: Array) -> str:
    waves = np.abs(np.fft.rfft(mode))
    waves[1:] *= np.sqrt(2)
    m = int(np.argmax(waves))
    return f"the mean of {name}" if m == 0 else f"{name} ({m} wave{'s' * (m > 1)} around the axis)"
