"""The door of the room: what is measured decides how it is fitted."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..model.doors import door
from ..model.errors import InputError, choice, closest, number, whole
from ..model.reporting import Progress, counted, reported
from ..model.scales import Scales
from .film import Film, film_of
from .geometry import axes, tilts, visible
from .judged import by_equation, refusal
from .noise import noise_of
from .result import ORDER, Fit
from .windows import unknown, window_of

METHODS = ("auto", "equation", "film", "profile")
LARGEST = {
    "epsilon": 10.0,
    "d_s": 10.0,
    "d_r": 10.0,
    "mu": 100.0,
    "alpha_p": 1e6,
    "alpha_u": 1e6,
    "kappa": 1e6,
}
"""Largest values that may be fixed."""
CHANGE = 0.02
"""A film of u that varies by less than this share of its peak, beyond its noise, is a profile."""

UNKNOWN = (
    "vectors are means over windows, whose size the data do not tell; they make mu and alpha_u too large, so "
    "give window_px when reading, or window in radii"
)


@door
def fit(
    data: Any,
    parameters: Iterable[str] | None = None,
    fix: Mapping[str, float] | None = None,
    method: str = "auto",
    scales: Scales | None = None,
    seed: int = 0,
    *,
    geometry: Mapping[str, float] | None = None,
    draws: int = 8,
    length: float | None = None,
    window: float | None = None,
    progress: Progress = None,
) -> Fit:
    """Return the parameters of a measured cell, with intervals, or a sentence that says what it cannot tell.

    data: an xarray.Dataset of the order P and the flow u of the cytoplasm, or of u alone, over time,
    component (theta, z), theta and z, as of a run: on any part of the surface, at any spacing, NaN where
    nothing was seen. It is dimensionless (R, U, R/U), or in the units that its variables name (s, um, um/s,
    deg), with `scales`. Without time, or in one frame, it is a steady profile. Frames may have any spacing.
    In place of P there may be the angle of the filaments over time, theta and z, from +z towards +theta,
    without polarity, as `on_surface` gives it.

    parameters: the names to report, all by default: alpha_p, alpha_u, epsilon, d_s, d_r, kappa, mu and U, the
    unit of speed in units of that of the data. All others stay unknown as well, unless `fix` gives their
    values. repulsion_angle is 0 unless it is fixed.

    method: "equation" tests the equations themselves on P and u; it takes seconds and needs no initial guess.
    "film" matches a film of u by runs from an unknown initial state, and P or angles too where they are
    given; it takes minutes, and U is 1 unless `parameters` names it. "profile" fits the steady profile.
    "auto" takes the first that the data allow.

    geometry: standard deviations of the camera's geometry, of axis_deg, radius (relative) and centre (in
    radii); intervals of a film then include it. By "equation", `draws` times the estimated noise is added
    again, from `seed`, for the intervals. `length` is the period of the cell along the axis in a fit of a
    film, by default that of the data's attribute length or 1.2 times the window. A fit by "film" shows a
    bar in a terminal or a notebook unless `progress` is False; a function is called as
    `progress(done, total)`.

    window: the side, in radii, of the squares of the image over which vectors of u are averaged, 0 for values
    at points; by default what the measurement knows (its attributes window_px and radius_px). The model is
    averaged in the same way by "film", and the average is undone to fourth order by "equation".

    What the data cannot tell is NaN with the interval (0, inf), and `Fit.refused` says why. Raises
    `InputError` for what is no measurement. Method: `docs/fitting.md`.

    Example: a cell that does not change gives no rates.
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(24, 24)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=20.0)
        >>> fit = cy.fit(run.to_dataset()[["P", "u"]].isel(time=slice(1, None)))
        >>> fit.method, "hardly changes" in fit.refused
        ('equation', True)
    """
    method = choice("method", method, METHODS)
    seed = whole("seed", seed, 0, 2**63 - 1, "give a whole number")
    draws = whole("draws", draws, 3, 1000, "the default is 8")
    if scales is not None and not isinstance(scales, Scales):
        raise InputError(
            "scales", scales, "a cyclosis.Scales", "write cyclosis.Scales(radius_um, speed_um_per_s)"
        )
    fixed = _fixed(fix)
    wanted = _wanted(parameters, fixed)
    moved = tilts(geometry, draws, np.random.default_rng([seed, 1]))
    film = visible(film_of(data, scales)) if moved else film_of(data, scales)
    names = tuple(name for name in ORDER if name in wanted and name not in fixed)
    if film.u is None:
        sentence = (
            "Filaments without a flow say neither which way they point nor how fast anything is; "
            "measure the flow in the same film."
        )
        return refusal(method, names, fixed, film, sentence, seed)
    square = window_of(film, window)
    notes = (UNKNOWN,) if window is None and unknown(film) else ()
    chosen = _method(film) if method == "auto" else method
    if chosen == "equation":
        if film.P is None:
            rule, remedy = "given with method equation", "fit a film of u alone by method film"
            if film.angle is not None:
                rule = "given with method equation: |P|, which angles do not tell, is in every term"
                remedy = "fit by method film, which compares runs with u and with the angles"
            raise InputError("P of the data", None, rule, remedy)
        return by_equation(film, wanted, fixed, moved, draws, seed, square, notes)
    if chosen == "film":
        from .matching import by_film

        if parameters is None or "U" not in wanted:
            fixed = {"U": 1.0} | fixed
        with reported(progress, "fit", counted) as report:
            return by_film(film, wanted, fixed, seed, length, square, notes, report, axes(geometry))
    from .steady import by_profile

    return by_profile(film, wanted, fixed, seed)


def _method(film: Film) -> str:
    if film.frames == 1:
        return "profile"
    if film.P is not None:
        return "equation"
    return "film" if _changes(film) else "profile"


def _changes(film: Film) -> bool:
    """Return whether u varies in time by more than its noise, by a share `CHANGE` of its peak.

    A film without enough frames to tell its noise is taken to change.
    """
    assert film.u is not None
    variance = film.u.var(axis=0, ddof=1)[:, film.seen].mean()
    noise = noise_of(film.u, film.times, film.known & film.seen)[:, film.seen].mean()
    peak = float(np.quantile(np.hypot(film.u[:, 0], film.u[:, 1])[:, film.seen], 0.999))
    return bool(np.sqrt(max(variance - noise, 0.0)) > CHANGE * peak)


def _fixed(fix: Mapping[str, float] | None) -> dict[str, float]:
    if fix is None:
        return {}
    if not isinstance(fix, Mapping):
        raise InputError("fix", fix, "a table of values by parameter name", "write fix={'mu': 0.05}")
    out = {}
    for name, value in fix.items():
        if name not in (*ORDER, "repulsion_angle"):
            rule = "one of " + ", ".join((*ORDER, "repulsion_angle"))
            raise InputError("fix", name, rule, closest(name, (*ORDER, "repulsion_angle")))
        low, high = (-10.0, 10.0) if name == "repulsion_angle" else (1e-6 if name == "U" else 0.0, 1e6)
        out[name] = number(name, value, low, min(high, LARGEST.get(name, high)), "give its value")
    return out


def _wanted(parameters: Iterable[str] | None, fixed: Mapping[str, float]) -> tuple[str, ...]:
    if parameters is None:
        return ORDER
    if isinstance(parameters, str) or not isinstance(parameters, Iterable):
        raise InputError("parameters", parameters, "a list of names", "write them as a list")
    wanted = tuple(parameters)
    for name in wanted:
        if name not in ORDER:
            raise InputError("parameters", name, "one of " + ", ".join(ORDER), closest(name, ORDER))
        if name in fixed:
            raise InputError("parameters", name, "either fitted or fixed", "leave it out of one of the two")
    return wanted
