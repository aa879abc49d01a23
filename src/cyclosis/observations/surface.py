"""From the image to the surface: measured fields over theta and z, as a run has them."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, choice, number, whole
from ..version import __version__
from . import checks
from .formats.content import ANGLE, KYMOGRAPH, SLICE, SURFACE
from .noise import estimated_noise
from .observation import Array, Frame, Observation
from .pictured import at_rim, of_kymograph
from .resample import binned, interpolated
from .view import View

if TYPE_CHECKING:
    import xarray

    from ..model.scales import Scales

MOST_POINTS = 4096
"""Points along one direction of the surface, at most."""
PER_CELL = 4.0
"""Scattered samples per cell of the surface, on average, where the spacing is not given."""


@door
def on_surface(
    obs: Observation,
    n_theta: int | None = None,
    n_z: int | None = None,
    *,
    theta: npt.ArrayLike | None = None,
    z: npt.ArrayLike | None = None,
    scales: Scales | None = None,
    max_angle_deg: float = 80.0,
    outside: str = "refuse",
    depth_um: float | None = None,
) -> xarray.Dataset:
    """Return a measurement on the surface of its cell, as a dataset like that of a run.

    `u` (time, component, theta, z) is NaN where nothing was measured; so is `angle` (time, theta, z) of a
    measurement of filaments, from +z towards +θ, which has no polarity. `good` tells where there is a value,
    `cos_phi` (theta) how the surface is inclined to the image, and `sigma` (component, theta) the noise of u,
    which for u_θ grows as 1/cos φ. Values on a grid are interpolated linearly, component by component in the
    image; scattered ones are averaged over the cells of the grid.

    The grid covers what was seen, up to `max_angle_deg` from the meridian that faces the camera. Its spacing
    is that of the measurement; `n_theta` and `n_z` choose other numbers of points, `theta` (radians) and `z`
    (radii) the points themselves. Lengths are in radii. Times and speeds are in seconds and radii per second,
    or frames; with `scales` they are in R/U and U, dimensionless as those of a run. `depth_um` is the depth
    of field: what lies deeper is left out. `outside="drop"` accepts a measurement of which more than a fifth
    lies outside the cell.

    A warning tells of a component whose sign seems wrong, and of an axis that seems turned. Raises
    `InputError` if there is no view, if little of the measurement is on the cell, and for a range that is
    empty.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> x, y = np.arange(0.0, 400.0, 16.0), np.arange(0.0, 200.0, 16.0)
        >>> along = np.tile(20.0 * np.cos(np.arcsin((y - 100.0) / 100.0))[:, None], (1, x.size))
        >>> frame = cy.observations.gridded(x, y, along, 0.0 * along)
        >>> seen = cy.observations.Observation((frame,)).view(100.0, 0.0, (0.0, 100.0), mirrored=False)
        >>> data = seen.on_surface()
        >>> print(data["u"].sel(component="z").isel(time=0).max().round(2).item(), data["u"].attrs["units"])
        0.2 s-1
        >>> seen.on_surface(scales=cy.Scales(500.0, 100.0))["u"].attrs["units"]
        '1'
    """
    if obs.kind == SURFACE:
        return obs.extra["dataset"].copy()
    view = obs.camera
    if view is None:
        rule, remedy = "a measurement with a view", "call its method view(radius_px=..., ...)"
        raise InputError("observation", "without a view", rule, remedy)
    most = math.radians(number("max_angle_deg", max_angle_deg, 1.0, 89.9, "give degrees below 90"))
    choice("outside", outside, ("refuse", "drop"))
    if obs.kind == SLICE:
        return _section(obs, view, n_theta, theta, scales)
    component = None
    if obs.kind == KYMOGRAPH:
        obs, component = of_kymograph(obs, view)
    if obs.kind != ANGLE:
        # An optical flow has values everywhere, and spreads beyond the rim by the width of its window.
        rule = "drop" if obs.format == "flow" else outside
        obs = replace(obs, frames=tuple(checks.inside(f, view, rule, obs.source) for f in obs.frames))
    frames = [_sharp(frame, view, most, depth_um, obs.pixel_um) for frame in obs.frames]
    if not any(frame.good.any() for frame in frames):
        rule = "one with good samples on the part of the cell that is seen"
        raise InputError("observation", obs.source, rule, "check radius, axis and centre")
    angles, along = _axes(frames, view, n_theta, n_z, theta, z, most)
    names = ("angle",) if obs.kind == ANGLE else ("u",)
    found, counts = zip(*(_field(frame, view, angles, along) for frame in frames), strict=True)
    fields = np.array(found)
    if component is not None:
        fields[:, 1 - component] = np.nan
    return _dataset(obs, view, names[0], frames, fields, np.array(counts), angles, along, scales)


def _section(
    obs: Observation, view: View, n_theta: int | None, theta: npt.ArrayLike | None, scales: Scales | None
) -> xarray.Dataset:
    """Return the flow along the cell at the rim of a cross-section, all around it; that across it is NaN."""
    count = 64 if n_theta is None else whole("n_theta", n_theta, 1, MOST_POINTS, "give a number of points")
    across = 2 * np.pi * np.arange(count) / count if theta is None else _given("theta", theta)
    w, noise = at_rim(obs, view, across)
    u = np.stack([np.full_like(w, np.nan), w / view.radius_px])[None, :, :, None]
    frame = Frame(np.zeros(1), np.zeros(1), np.ones(1, dtype=bool))
    if obs.noise_px is None:
        obs = replace(obs, noise_px=noise * _interval(obs))
    counts = np.ones((1, across.size, 1))
    return _dataset(obs, view, "u", [frame], u, counts, across, np.zeros(1), scales)


def _sharp(frame: Frame, view: View, most: float, depth_um: float | None, pixel_um: float | None) -> Frame:
    """Return a frame of which only those samples are good that are near enough, and in focus."""
    _, _, cos_phi = view.to_surface(frame.x, frame.y)
    with np.errstate(invalid="ignore"):
        good = frame.good & (cos_phi >= math.cos(most) - 1e-12)
        if depth_um is not None or frame.focus_um is not None:
            if pixel_um is None or depth_um is None:
                missing = "depth_um" if depth_um is None else "pixel_um"
                rule = "given, because what is in focus depends on it"
                raise InputError(missing, None, rule, "give the depth of field and the size of a pixel in um")
            depth = number("depth_um", depth_um, 1e-6, 1e9, "give the depth of field in micrometres")
            low, high = view.sharp(depth / pixel_um, (frame.focus_um or 0.0) / pixel_um)
            good &= (cos_phi <= math.cos(low)) & (cos_phi >= math.cos(high)) if low == low else False
    return replace(frame, good=good)


def _axes(
    frames: list[Frame],
    view: View,
    n_theta: int | None,
    n_z: int | None,
    theta: npt.ArrayLike | None,
    z: npt.ArrayLike | None,
    most: float,
) -> tuple[Array, Array]:
    """Return the points of the grid on the surface: theta and z."""
    good = [(frame.x[frame.good], frame.y[frame.good]) for frame in frames]
    x, y = (np.concatenate(part) for part in zip(*good, strict=True))
    found, z_seen, _ = view.to_surface(x, y)
    phi = view.phi(found)
    step = _spacing(frames, view, phi, z_seen)
    ends = (max(-most, float(phi.min())), min(most, float(phi.max())))
    across = view.facing + _points("theta", n_theta, ends, step) if theta is None else _given("theta", theta)
    along = (
        _points("z", n_z, (float(z_seen.min()), float(z_seen.max())), step) if z is None else _given("z", z)
    )
    return across, along


def _spacing(frames: list[Frame], view: View, phi: Array, z: Array) -> float:
    """Return the spacing of the surface's grid, in radii."""
    if frames[0].grid is not None:
        rows, columns = frames[0].grid
        x, y = frames[0].x.reshape(rows, columns), frames[0].y.reshape(rows, columns)
        # A kymograph is one row or column, along a line in any direction.
        ways = (np.hypot(np.diff(x, axis=k), np.diff(y, axis=k)) for k in (0, 1))
        steps = [float(np.median(way)) for way in ways if way.size]
        return float(np.mean(steps)) / view.radius_px if steps else 0.1
    area = max(float(np.ptp(phi)) * float(np.ptp(z)), 1e-9)
    return math.sqrt(PER_CELL * area / max(phi.size / len(frames), 1.0))


def _points(name: str, count: int | None, ends: tuple[float, float], step: float) -> Array:
    if count is None:
        count = min(MOST_POINTS, max(1, round((ends[1] - ends[0]) / step) + 1))
    else:
        count = whole(f"n_{name}", count, 1, MOST_POINTS, "give a number of points")
    return np.linspace(*ends, count) if count > 1 else np.array([0.5 * sum(ends)])


def _given(name: str, values: npt.ArrayLike) -> Array:
    out = numbers(name, values, "increasing numbers (n,)", "give the points of the grid")
    if (
        out.ndim != 1
        or not 1 <= out.size <= MOST_POINTS
        or not np.isfinite(out).all()
        or (np.diff(out) <= 0).any()
    ):
        raise InputError(name, out, f"1 to {MOST_POINTS} increasing finite numbers", "sort them")
    return out


def _field(frame: Frame, view: View, theta: Array, z: Array) -> tuple[Array, Array]:
    """Return the values of a frame on the surface, (2 or 1, n_theta, n_z), and their weights."""
    if frame.angle is not None:
        x, y, _ = view.to_image(theta[:, None], z[None, :])
        doubled = (np.cos(2 * frame.angle), np.sin(2 * frame.angle))
        c, s = interpolated(frame, doubled, x, y) if frame.grid else binned(frame, view, doubled, theta, z)[0]
        count = np.isfinite(c).astype(float)
        with np.errstate(invalid="ignore"):
            return view.angle_to_surface(x, y, 0.5 * np.arctan2(s, c))[None], count
    assert frame.vx is not None
    assert frame.vy is not None
    if frame.grid is not None and min(frame.grid) > 1:
        x, y, _ = view.to_image(theta[:, None], z[None, :])
        vx, vy = interpolated(frame, (frame.vx, frame.vy), x, y)
        u = np.stack(view.velocity_to_surface(x, y, vx, vy))
        return u, np.isfinite(u).any(axis=0).astype(float)
    u_theta, u_z = view.velocity_to_surface(frame.x, frame.y, frame.vx, frame.vy)
    found, count = binned(frame, view, (u_theta, u_z), theta, z)
    return np.stack(found), count


def _dataset(
    obs: Observation,
    view: View,
    name: str,
    frames: list[Frame],
    fields: Array,
    counts: Array,
    theta: Array,
    z: Array,
    scales: Scales | None,
) -> xarray.Dataset:
    import xarray

    times = np.array([frame.time for frame in frames])
    if len({frame.focus_um for frame in frames}) > 1:
        fields, counts, times = _stacked(fields, counts), counts.sum(axis=0, keepdims=True), times[:1]
    unit_s, radius_um = _scaled(obs, view, scales)
    per = "1" if scales is not None else f"{obs.time_unit}-1" if obs.time_unit == "s" else "frame-1"
    told = "U" if scales is not None else f"radii per {'second' if obs.time_unit == 's' else 'frame'}"
    clock = "R/U" if scales is not None else "seconds" if obs.time_unit == "s" else "frames"
    factor = 1.0 if scales is None else scales.time_s
    good = np.isfinite(fields).any(axis=1)  # a kymograph has one component
    cos_phi = np.cos(view.phi(theta))
    data: dict[str, Any] = {
        "good": (("time", "theta", "z"), good.astype(np.int8), _about("whether there is a value")),
        "count": (("time", "theta", "z"), counts, _about("samples in the cell, or 1 where interpolated")),
        "cos_phi": (("theta",), cos_phi, _about("cosine of the angle between the surface and the image")),
    }
    noise = obs.noise_px
    if name == "u":
        data["u"] = (
            ("time", "component", "theta", "z"),
            fields * factor,
            _about(f"measured velocity, in {told}", per),
        )
        noise = estimated_noise(obs) if noise is None else noise
        if noise is not None:
            per_time = noise / view.radius_px * factor / _interval(obs)
            sigma = np.stack([per_time / np.maximum(cos_phi, 1e-3), np.full_like(cos_phi, per_time)])
            data["sigma"] = (("component", "theta"), sigma, _about(f"noise of the velocity, in {told}", per))
    else:
        about = _about("angle of the filaments from +z towards +theta, without polarity", "radian")
        data["angle"] = (("time", "theta", "z"), fields[:, 0], about)
    out = xarray.Dataset(
        data,
        {
            "time": (
                ("time",),
                times / factor,
                _about(f"time in {clock}", "1" if scales is not None else obs.time_unit),
            ),
            "component": (("component",), ["theta", "z"], {"long_name": "direction on the surface"}),
            "theta": (("theta",), theta, _about("angle around the cell", "radian")),
            "z": (("z",), z, _about("place along the cell in units of R")),
        },
        _attributes(obs, view, unit_s, radius_um, scales, noise),
    )
    said = checks.sanity(out, view) if name == "u" and obs.kind != SLICE else []
    for sentence in said:
        warnings.warn(sentence, UserWarning, stacklevel=4)
    return out.assign_attrs(warnings="; ".join(said))


def _stacked(fields: Array, counts: Array) -> Array:
    """Return one field from a stack of foci: their mean, weighted by the samples, where several are sharp."""
    weight = np.where(np.isfinite(fields), counts[:, None], 0.0)
    total = weight.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(weight > 0, fields, 0.0) * weight
        return np.asarray(np.where(total > 0, mean.sum(axis=0) / total, np.nan))[None]


def _interval(obs: Observation) -> float:
    """Return the time between the two images of a pair, in the unit of the measurement's times."""
    return 1.0 if obs.time_unit == "frame" or obs.frame_s is None else obs.frame_s


def _scaled(obs: Observation, view: View, scales: Scales | None) -> tuple[float | None, float | None]:
    """Return the seconds of the unit of time and the radius in µm. Raises `InputError` if they clash."""
    radius = None if obs.pixel_um is None else view.radius_px * obs.pixel_um
    if scales is None:
        return (1.0 if obs.time_unit == "s" else obs.frame_s), radius
    if obs.time_unit != "s":
        rule = "given with frame_s, because the speeds are in pixels per frame"
        raise InputError("scales", scales, rule, "give frame_s when reading")
    if radius is not None and abs(radius / scales.radius_um - 1) > 0.02:
        rule = f"{radius:.4g}, the radius in the image times the size of a pixel"
        raise InputError("radius_um", scales.radius_um, rule, "correct one of the two")
    return scales.time_s, scales.radius_um


def _about(meaning: str, units: str = "1") -> dict[str, str]:
    return {"long_name": meaning, "units": units}


def _attributes(
    obs: Observation,
    view: View,
    unit_s: float | None,
    radius_um: float | None,
    scales: Scales | None,
    noise: float | None,
) -> dict[str, Any]:
    out: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": "A measured cell on its unrolled surface",
        "program": "cyclosis",
        "versions": json.dumps({"cyclosis": __version__}),
        "measurement": obs.kind,
        "source_file": obs.source,
        "format": obs.format,
        "conventions_applied": "; ".join(obs.notes),
        "view": json.dumps(view.to_dict()),
        "radius_px": view.radius_px,
        "facing": view.facing,
        "time_unit": "R/U" if scales is not None else obs.time_unit,
    }
    known = {"pixel_um": obs.pixel_um, "frame_s": obs.frame_s, "radius_um": radius_um, "time_unit_s": unit_s}
    known["window_px"] = obs.window_px
    if unit_s is not None and radius_um is not None:
        known["speed_unit_um_per_s"] = radius_um / unit_s
    if noise is not None:
        known["noise_px"] = noise
        out["noise_is"] = "given" if obs.noise_px is not None else "estimated"
    return out | {name: value for name, value in known.items() if value is not None}
