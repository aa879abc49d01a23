"""A measurement beside a run: the shift, rotation, mirror and time that fit best, and what is left."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..display.notebook import text_tree
from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, number
from ..model.scales import Scales
from ..model.units import length_unit, scales_of_measurement, speed_unit, time_unit
from .model_field import Array, ModelFlow, model_flow
from .observation import Observation

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

PACE_STEP = 0.06
"""Relative distance of the speeds that are tried for several frames, whose time passes as they tell."""
MOST_STEPS = 6
"""How many of them on either side of what one frame tells."""
LEAST_POINTS = 20
"""Measured values that a comparison needs."""


@shown
@dataclass(frozen=True, eq=False)
class Comparison:
    """How a run fits a measurement.

    The measured point (θ, z) is the point (±(θ - `rotation`), z - `shift`) of the run, with the minus sign
    if `mirrored`; rotation in radians, shift in radii. `time` is the run's time of the first measured
    frame, in R/U, and `speed` the U of the run in the unit of the measured speeds (1 if that is U). `rms`
    is what is left, in units of the noise, NaN if that is not known: 1 for a run that tells all.
    `rms_of_peak` is the same as a share of the run's largest speed. `other_mirror` is how many times larger
    what is left is with the best fit of the other mirror image: near 1, the measurement does not tell them
    apart. `dataset` holds `measured`, `model` and `residual` (time, component, theta, z), the residual in
    units of the noise, or of the peak.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> seen = run.to_dataset().isel(time=[1], theta=slice(3, 12))[["u"]]
        >>> fit = cy.observations.compare(seen, run)
        >>> fit.time, round(fit.speed, 6), bool(fit.rms_of_peak < 1e-6)
        (1.0, 1.0, True)
    """

    rotation: float
    shift: float
    mirrored: bool
    time: float
    speed: float
    rms: float
    rms_of_peak: float
    other_mirror: float
    dataset: xarray.Dataset

    def figure(self) -> Figure:
        """Return the figure measured | model | residual, at the time of the fastest flow.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0)
            >>> fit = cy.observations.compare(run.to_dataset().isel(time=[1])[["u"]], run)
            >>> len(fit.figure().axes) >= 3
            True
        """
        from ..figures.measured import comparison

        return comparison(self.dataset)

    @property
    def scales(self) -> Scales | None:
        """The radius and the speed U of the measured cell, None if the measurement does not tell them.

        Example:
            >>> import cyclosis as cy
            >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
            >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0)
            >>> seen = run.to_dataset().isel(time=[1])[["u"]].assign_attrs(time_unit_s=1.0)
            >>> seen["u"].attrs["units"] = "s-1"
            >>> fit = cy.observations.compare(seen, run, radius_um=500.0)
            >>> round(fit.scales.speed_um_per_s)
            500
        """
        own = scales_of_measurement(self.dataset)
        return None if own is None else Scales(own.radius_um, self.speed * own.speed_um_per_s)

    def __repr__(self) -> str:
        length, time, speed = self._in_units()
        noise = f"{self.rms:.3g} of the noise, " if np.isfinite(self.rms) else ""
        other = f"the other mirror image leaves {self.other_mirror:.3g} times as much"
        rows = [
            ("rotation", f"{self.rotation:.4f} rad"),
            ("shift", f"{self.shift:.4f} R{length}"),
            ("mirrored", f"{'yes' if self.mirrored else 'no'} ({other})"),
            ("time", f"{self.time:g} R/U{time}"),
            ("speed U", f"{self.speed:.5g} {self.dataset.attrs.get('speed_unit', '')}".rstrip() + speed),
            ("residual", f"{noise}{self.rms_of_peak:.2%} of the peak (rms)"),
        ]
        return text_tree("Comparison of a measurement with a run", rows)

    def _in_units(self) -> tuple[str, str, str]:
        """Return the shift, the time and U in physical units, each with " = " before it, or "" if unknown."""
        scales = self.scales
        if scales is None:
            seconds = self.dataset.attrs.get("time_unit_s")
            late = "" if seconds is None else f" = {self.time * float(seconds) / self.speed:.4g} s"
            return "", late, ""
        return (
            f" = {length_unit(scales, abs(self.shift))(self.shift)}",
            f" = {time_unit(scales, self.time)(self.time)}",
            f" = {speed_unit(scales)(1.0)}",
        )


@door
def compare(
    measured: Any,
    simulated: Any,
    *,
    time: float | None = None,
    speed: float | None = None,
    mirrored: bool | None = None,
    radius_um: float | None = None,
    speed_um_s: float | None = None,
) -> Comparison:
    """Return the best fit of a run to a measured flow: shift along z, rotation, mirror image, time and speed.

    `measured` is an `Observation` with a view, a dataset of `on_surface`, or the path of a file of
    `cyclosis measure`; `simulated` a run: a `Trajectory`, its dataset or its file. The weighted squares of
    the difference are minimised: over all shifts and rotations by Fourier transforms, then continuously,
    with the run's trigonometric interpolant at the measured points. `time` fixes the run's time of the
    first frame (by default all saved times are tried), `speed` the U of the run in the unit of the measured
    speeds, and `mirrored` one of the mirror images. Several measured frames are compared together, with the
    run's time passing at the rate that the speed implies. `radius_um` is the radius of the cell where the
    measurement does not know it, and `speed_um_s` the speed U in µm/s instead of `speed`. Raises
    `InputError` for angles without a flow, which have no polarity, for too few values, for units of which
    the measurement does not know enough, and for runs without a flow.

    Example: half of a cell, turned by one radian.
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> P = cy.initial.disordered(grid, seed=1)
        >>> run = cy.simulate(params, grid, P, t_end=4.0)
        >>> seen = run.to_dataset().isel(time=[4], theta=slice(2, 11))[["u"]]
        >>> turned = seen.assign_coords(theta=seen["theta"] + 1.0)
        >>> fit = cy.observations.compare(turned, run)
        >>> round(fit.rotation, 3), abs(round(fit.shift, 3)), fit.mirrored, fit.time
        (1.0, 0.0, False, 4.0)
    """
    data = _measured(measured)
    u, sigma, theta, z = _values(data)
    data = _with_radius(data, radius_um)
    if speed_um_s is not None:
        speed = _speed(data, speed, speed_um_s)
    if speed is not None:
        speed = number("speed", speed, 1e-12, 1e12, "give U in the unit of the measured speeds")
    elif data["u"].attrs.get("units", "1") == "1":
        speed = 1.0
    flow = model_flow(simulated)
    times = np.asarray(data["time"].values, dtype=np.float64)
    weights = np.where(
        np.isfinite(u), 1.0 / (sigma[None, :, :, None] if sigma is not None else np.ones(1)) ** 2, 0.0
    )
    filled = np.where(np.isfinite(u), u, 0.0)
    found: dict[bool, tuple[float, float, Array, float, Array]] = {}
    for mirror in (False, True) if mirrored is None else (bool(mirrored),):
        found[mirror] = _best(flow, filled, weights, theta, z, times - times[0], time, speed, mirror)
    mirror = min(found, key=lambda key: found[key][0])
    cost, t0, (turn, shift), U, model = found[mirror]
    count = int((weights > 0).sum())
    peak = flow.peak * U
    difference = np.where(np.isfinite(u), u - model, np.nan)
    unit = np.float64(peak) if sigma is None else sigma[None, :, :, None]
    others = [np.sqrt(found[key][0] / max(cost, 1e-300)) for key in found if key != mirror]
    residual = difference / unit
    out = _dataset(data, u, np.where(np.isfinite(u), model, np.nan), residual, sigma is not None)
    rms = float(np.sqrt(np.nansum(residual**2) / count)) if sigma is not None else float("nan")
    return Comparison(
        float(np.mod(turn + np.pi, 2 * np.pi) - np.pi),
        float(shift - flow.length * np.round(shift / flow.length)),
        mirror,
        t0,
        U,
        rms,
        float(np.sqrt(np.nansum(difference**2) / count)) / peak,
        float(others[0]) if others else float("nan"),
        out,
    )


def _with_radius(data: Any, radius_um: float | None) -> Any:
    """Return a measurement that knows the radius of its cell."""
    if radius_um is None:
        return data
    radius = number("radius_um", radius_um, 1e-3, 1e6, "give the radius in µm")
    known = data.attrs.get("radius_um")
    if known is not None and abs(radius / float(known) - 1) > 0.02:
        raise InputError("radius_um", radius, f"that of the measurement, {float(known):.4g}", "leave it out")
    seconds = data.attrs.get("time_unit_s")
    unit = {} if seconds is None else {"speed_unit_um_per_s": radius / float(seconds)}
    return data.assign_attrs(radius_um=radius, **unit)


def _speed(data: Any, speed: float | None, speed_um_s: float) -> float:
    """Return U in the unit of the measured speeds, given in µm/s."""
    if speed is not None:
        raise InputError("speed_um_s", speed_um_s, "left out if speed is given", "give one of the two")
    unit = data.attrs.get("speed_unit_um_per_s")
    if unit is None:
        rule = "given for a measurement that knows the radius of its cell and the time between frames"
        raise InputError("speed_um_s", speed_um_s, rule, "give radius_um too, or speed instead")
    return number("speed_um_s", speed_um_s, 1e-6, 1e6, "give U in µm/s") / float(unit)


def _measured(measured: Any) -> Any:
    import xarray

    from .read import read

    if isinstance(measured, str | os.PathLike):
        measured = read(measured)
    if isinstance(measured, Observation):
        measured = measured.on_surface()
    if not isinstance(measured, xarray.Dataset):
        rule = "an Observation with a view, its dataset on the surface, or a file of `cyclosis measure`"
        raise InputError("measured", type(measured).__name__, rule, "measure it first")
    return measured


def _values(data: Any) -> tuple[Array, Array | None, Array, Array]:
    """Return u, its noise (component, theta) or None, theta and z of a measurement."""
    if "u" not in data:
        rule = "a measurement with a flow: an angle has no polarity, which only the flow tells"
        raise InputError("measured", list(data.data_vars), rule, "measure the flow as well")
    if set(data["u"].dims) != {"time", "component", "theta", "z"} or data.sizes["component"] != 2:
        rule = "u over (time, component, theta, z)"
        raise InputError("measured", list(data["u"].dims), rule, "use a dataset of `on_surface`")
    u = np.asarray(data["u"].transpose("time", "component", "theta", "z").values, dtype=np.float64)
    if np.isfinite(u).sum() < LEAST_POINTS:
        rule = f"one with at least {LEAST_POINTS} values"
        raise InputError("measured", int(np.isfinite(u).sum()), rule, "check its mask and view")
    theta, z = (np.asarray(data[name].values, dtype=np.float64) for name in ("theta", "z"))
    sigma = None
    if "sigma" in data:
        sigma = np.asarray(data["sigma"].transpose("component", "theta").values, dtype=np.float64)
        if not (np.isfinite(sigma).all() and (sigma > 0).all()):
            sigma = None
    return u, sigma, theta, z


def _best(
    flow: ModelFlow,
    u: Array,
    weights: Array,
    theta: Array,
    z: Array,
    later: Array,
    time: float | None,
    speed: float | None,
    mirror: bool,
) -> tuple[float, float, Array, float, Array]:
    """Return the cost, the time, (rotation, shift), U and the model's values of the best fit."""
    from scipy.optimize import minimize

    starts = (
        flow.times if time is None else np.array([number("time", time, *flow.span, "use a time of the run")])
    )
    several = speed is None and later.size > 1
    unknown = (flow, starts, u, weights, theta, z)
    tried = _paces(*unknown, mirror) if several else [speed or 1.0]
    best, pace = (np.inf, 0.0, np.zeros(2)), tried[0]
    for trial in tried:
        found = _coarse(*unknown, later * trial, trial if several else speed, mirror)
        if found[0] < best[0]:
            best, pace = found[:3], trial

    def frames_at(place: Array) -> tuple[Array, float | None]:
        """Return the run's frames, and the speed that tells both how fast they flow and how time passes."""
        told = pace * float(np.exp(place[2])) if several else pace
        return flow.at(best[1] + later * told, mirror), told if several else speed

    def cost_at(place: Array) -> float:
        frames, U = frames_at(place)
        return flow.fitted(frames, place, u, weights, theta, z, U)[0]

    first = np.append(best[2], [0.0] * several)
    steps = np.diag([2 * np.pi / flow.shape[0], flow.length / flow.shape[1], *[0.5 * PACE_STEP] * several])
    simplex = first + 0.5 * np.vstack([np.zeros(first.size), steps])
    options = {"xatol": 1e-7, "fatol": 1e-12 * float((weights * u**2).sum()), "maxiter": 400}
    done = minimize(cost_at, first, method="Nelder-Mead", options=options | {"initial_simplex": simplex})
    frames, told = frames_at(done.x)
    cost, U, model = flow.fitted(frames, done.x, u, weights, theta, z, told)
    return cost, best[1], done.x[:2], U, model


def _paces(
    flow: ModelFlow, starts: Array, u: Array, weights: Array, theta: Array, z: Array, mirror: bool
) -> list[float]:
    """Return speeds to try: those that the first, strongest and last frame tell alone, and near ones."""
    strongest = int((weights * u**2).sum(axis=(1, 2, 3)).argmax())
    paces: list[float] = []
    for k in sorted({0, strongest, u.shape[0] - 1}):
        one, when = slice(k, k + 1), flow.times if k else starts
        if not weights[one].any():
            continue
        told = _coarse(flow, when, u[one], weights[one], theta, z, np.zeros(1), None, mirror)[3]
        near = told * np.exp(PACE_STEP * np.arange(-MOST_STEPS, MOST_STEPS + 1))
        paces += [float(p) for p in near if all(abs(np.log(p / q)) > 0.5 * PACE_STEP for q in paces)]
    return paces or [1.0]


def _coarse(
    flow: ModelFlow,
    starts: Array,
    u: Array,
    weights: Array,
    theta: Array,
    z: Array,
    later: Array,
    speed: float | None,
    mirror: bool,
) -> tuple[float, float, Array, float]:
    """Return the cost, the time, (rotation, shift) and U of the best fit by times and grid points."""
    best = (np.inf, 0.0, np.zeros(2), 1.0)
    for t0 in starts:
        cost, turn, shift, U = flow.coarse(flow.at(t0 + later, mirror), u, weights, theta, z, speed)
        if cost < best[0]:
            best = (cost, float(t0), np.array([turn, shift]), U)
    return best


def _dataset(data: Any, u: Array, model: Array, residual: Array, in_noise: bool) -> Any:
    import xarray

    dims, unit = ("time", "component", "theta", "z"), data["u"].attrs.get("units", "1")
    told = "the noise" if in_noise else "the peak"
    out = xarray.Dataset(
        {
            "measured": (dims, u, {"long_name": "measured velocity", "units": unit}),
            "model": (dims, model, {"long_name": "velocity of the run", "units": unit}),
            "residual": (
                dims,
                residual,
                {"long_name": f"measured - model, in units of {told}", "units": "1"},
            ),
        },
        {name: data[name] for name in dims if name in data.coords},
        {
            **data.attrs,
            "speed_unit": "" if unit == "1" else unit.replace("s-1", "R/s").replace("frame-1", "R/frame"),
        },
    )
    return out
