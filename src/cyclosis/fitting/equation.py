"""Parameters from P and u by the weak form, with instruments from alternating frames.

Rows from the odd frames, X and y, are regressed with those from the even frames, Z, as instruments,
c = (ZᵀX)⁻¹ Zᵀy: noise in X would bias least squares towards 0, and that of other frames is independent of it.
Either half takes both parts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..model.grid import Array
from .bumps import InSpace, in_space, in_time, slopes, weights
from .film import Film
from .geometry import Tilt, carried, turned
from .noise import noise_of, surrogate
from .weak import FILAMENTS, FLOW, RATES, Chart, Rows, White, rows, whitening

NAMES = (*FILAMENTS, *FLOW)
LEAST_FRAMES = 18
"""Two times the nine frames that a bump in time needs."""
_TIME, _THETA, _Z = (6.5, 3.0), (7.5, 0.7), (8.5, 0.66)
"""Half widths of bumps: so many spacings, and at least this long in R/U or R."""
_FEWEST = 3.5
"""Spacings that half of a bump must have."""
SMALLER = 0.8
"""Size of other bumps, relative to the usual ones, by which the error of the quadrature is measured."""
USUAL_MU = 0.05
"""The μ that is assumed where rows are weighted; it does not bias the result."""
LONGER = (1.0, 1.4, 2.0)
"""Lengths of bumps in time that are tried, relative to the usual one."""
LONGEST_GAP, INNER = 0.5, 0.8
"""Longest gap between frames within the inner part of a bump in time, both relative to half its length."""
_STEP = 0.25
"""Distance of test functions in half widths."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Where the integrals of a film are taken: the bumps of either half of the frames, and the chart."""

    halves: tuple[tuple[slice, tuple[Array, Array]], ...]
    space: InSpace
    chart: Chart
    vectors: Array | None


@dataclass(frozen=True, eq=False)
class Estimate:
    """One estimate: `values` by name, `moments` ZᵀX of each equation, `squares` XᵀX without its noise.

    `residual` is the mean square of the rows that is left, relative to that of the left-hand side.
    """

    values: dict[str, float]
    moments: dict[str, tuple[tuple[str, ...], Array]]
    squares: dict[str, Array]
    residual: dict[str, float]


class TooSmall(Exception):
    """The window has no room for a test function: "time" or "space"."""


def wrapped(film: Film) -> Film:
    """Return a film of the whole turn with some columns repeated on either side, so that it has no seam."""
    n = film.theta.size
    if n < 8 or film.theta[-1] - film.theta[0] < 2 * np.pi * (1 - 1.5 / n):
        return film
    extra = max(int(np.ceil(n * _THETA[1] / (2 * np.pi))), int(np.ceil(_THETA[0]))) + 1
    extra = min(extra, n // 2)
    left, right = slice(n - extra, n), slice(0, extra)

    def round_(array: Any, axis: int) -> Any:
        parts = [np.take(array, range(*part.indices(n)), axis) for part in (left, right)]
        return np.concatenate([parts[0], array, parts[1]], axis)

    theta = np.concatenate([film.theta[left] - 2 * np.pi, film.theta, film.theta[right] + 2 * np.pi])
    P, u = (None if f is None else round_(f, 2) for f in (film.P, film.u))
    seen, known = round_(film.seen, 0), round_(film.known, 1)
    return replace(film, theta=theta, P=P, u=u, seen=seen, known=known, angle=None)


def _centres(points: Array, half: float) -> Array:
    first, last = points[0] + half, points[-1] - half
    count = 1 + max(int(np.ceil((last - first) / (_STEP * half) - 1e-9)), 0)
    return np.linspace(first, last, count) if count > 1 else np.array([0.5 * (first + last)])


def _half(points: Array, size: tuple[float, float], share: float) -> float:
    spacing = float(np.median(np.diff(points))) if points.size > 1 else np.inf
    half = min(max(size[0] * spacing, size[1]) * share, 0.499 * float(points[-1] - points[0]))
    if not half >= _FEWEST * spacing:
        raise TooSmall("space")
    return half


def framed(film: Film, share: float = 1.0, tilt: Tilt | None = None) -> Frame:
    """Return the `Frame` of a film; `share` scales all bumps. Raises `TooSmall`."""
    times = film.times
    common = times[1:-1] if film.frames > 3 else times
    sub = times[::2]
    half_t = min(_half(sub, _TIME, share), 0.5 * (common[-1] - common[0]))
    halves = _halves(times, half_t, common)
    half = (_half(film.theta, _THETA, share), _half(film.z, _Z, share))
    rule = np.outer(weights(film.theta), weights(film.z)) * film.seen
    slope_theta, slope_z = slopes(film.theta), slopes(film.z)
    theta, z = np.meshgrid(film.theta, film.z, indexing="ij")
    inverse = vectors = None
    if tilt is not None:
        theta, z, vectors = tilt.moved(film.theta, film.z, film.facing)
        J = np.array([[slope_theta @ f, f @ slope_z.T] for f in (theta, z)])
        size = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        inverse = np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]]) / size
        rule = rule * np.abs(size)
    place = np.stack(np.meshgrid(_centres(film.theta, half[0]), _centres(film.z, half[1]), indexing="ij"))
    space, whole = in_space(theta.ravel(), z.ravel(), rule.ravel(), place.reshape(2, -1).T, half)
    if not whole.any():
        raise TooSmall("space")
    return Frame(halves, space, Chart(slope_theta, slope_z, inverse), vectors)


def _halves(times: Array, half: float, common: Array) -> tuple[tuple[slice, tuple[Array, Array]], ...]:
    """Return the integrals in time of either half of the frames, over those bumps that both resolve.

    Frames may have any spacing; a bump in which too many are missing is left out, and all are longer if
    there are few of the usual length.
    """
    best: tuple[tuple[slice, tuple[Array, Array]], ...] = ()
    most = 0
    for longer in LONGER:
        size = min(half * longer, 0.5 * float(common[-1] - common[0]))
        at = _centres(common, size)
        found = [in_time(times[k::2], at, size) for k in range(2)]
        good = np.ones(at.size, bool)
        for k in range(2):
            early, late = times[k::2][:-1] - at[:, None], times[k::2][1:] - at[:, None]
            wide = (late - early > LONGEST_GAP * size) & (late > -INNER * size) & (early < INNER * size)
            good &= ~wide.any(axis=1)
        if good.sum() > most:
            most = int(good.sum())
            best = tuple((slice(k, None, 2), (v[good], s[good])) for k, (v, s) in enumerate(found))
        if 2 * good.sum() >= at.size:
            break
    if not most:
        raise TooSmall("time")
    return best


def halves(
    film: Film, frame: Frame, noise: tuple[Array, Array], angle: float, white: White | None = None
) -> list[Rows]:
    """Return the `Rows` of either half of the frames; `noise` has the variances of P and of u."""
    P, u = film.P, film.u
    assert P is not None
    assert u is not None
    s = noise[0]
    if frame.vectors is not None:
        P, u = turned(P, frame.vectors), carried(u, frame.vectors)
    return [
        rows(P[part], u[part], s, angle, frame.chart, time, frame.space, white) for part, time in frame.halves
    ]


def solved(parts: list[Rows], fixed: Mapping[str, float]) -> Estimate:
    """Return the `Estimate` from the rows of both halves, with some parameters `fixed`."""
    values: dict[str, float] = dict(fixed)
    moments, squares, residual = {}, {}, {}
    for kind, names in (("flow", FLOW), ("filaments", FILAMENTS)):
        pairs = [getattr(part, kind) for part in parts]
        free = [k for k, name in enumerate(names, 1) if name not in fixed]
        for k, name in enumerate(names, 1):
            if name in fixed:
                by = fixed[name] * (values["U"] if name in RATES else 1.0)
                pairs = [np.column_stack([p[:, 0] - by * p[:, k], p[:, 1:]]) for p in pairs]
        y = [p[:, 0] for p in pairs]
        X = [p[:, free] for p in pairs]
        Z = [_instruments(kind, p, free) if free else p[:, :0] for p in pairs]
        A = Z[1].T @ X[0] + Z[0].T @ X[1]
        b = Z[1].T @ y[0] + Z[0].T @ y[1]
        chosen = tuple(names[k - 1] for k in free)
        c = np.zeros(0)
        if free:
            scale = np.sqrt(np.maximum(np.abs(np.diag(A)), 1e-300))
            c = np.linalg.lstsq(A / np.outer(scale, scale), b / scale, rcond=1e-14)[0] / scale
            values |= dict(zip(chosen, c.tolist(), strict=True))
        pairwise = X[1].T @ X[0]
        moments[kind] = (chosen, A)
        squares[kind] = pairwise + pairwise.T
        left = sum(float(np.sum((y[k] - X[k] @ c) ** 2)) for k in range(2))
        residual[kind] = left / max(sum(float(np.sum(v**2)) for v in y), 1e-300)
    for name in RATES:
        if name not in fixed:
            values[name] /= values["U"]
    return Estimate({name: values[name] for name in NAMES}, moments, squares, residual)


def _instruments(kind: str, table: Array, free: list[int]) -> Array:
    """Return the instruments (rows, free) that one half of the frames gives for the other.

    They are the columns themselves, except that ∇²ω = (ω - U curl F)/μ is replaced by ω, which spans the same
    with curl F and is less noisy by two derivatives.
    """
    return np.stack([-table[:, 0] if kind == "flow" and k == 1 else table[:, k] for k in free], axis=1)


@dataclass(frozen=True, eq=False)
class Repeats:
    """The estimate of a film, those with its noise added again, with other bumps and other geometries."""

    first: Estimate
    noisy: list[Estimate]
    other: list[Estimate]
    moved: list[Estimate]
    noise: tuple[Array, Array]


def repeated(
    film: Film, fixed: Mapping[str, float], angle: float, tilts: list[Tilt], draws: int, seed: int
) -> Repeats:
    """Return the `Repeats` of a film. Raises `TooSmall`."""
    film = wrapped(film.cropped()).spread()
    P, u = film.P, film.u
    assert P is not None
    assert u is not None
    known = film.known & film.seen
    noise = (noise_of(P, film.times, known), noise_of(u, film.times, known))
    frame = framed(film)
    white = _white(film, frame, noise)
    first = solved(halves(film, frame, noise, angle, white), fixed)
    rng = np.random.default_rng(seed)
    twice = (2 * noise[0], 2 * noise[1])
    noisy = []
    for _ in range(draws):
        again = film.with_fields(
            P + surrogate(P, film.times, noise[0], rng), u + surrogate(u, film.times, noise[1], rng)
        )
        noisy.append(solved(halves(again, frame, twice, angle, white), fixed))
    other, moved = [], []
    try:
        smaller = framed(film, SMALLER)
        other.append(solved(halves(film, smaller, noise, angle, _white(film, smaller, noise)), fixed))
    except TooSmall:
        pass
    for tilt in tilts:
        place = framed(film, 1.0, tilt)
        moved.append(solved(halves(film, place, noise, angle, _white(film, place, noise)), fixed))
    return Repeats(first, noisy, other, moved, noise)


def _white(film: Film, frame: Frame, noise: tuple[Array, Array]) -> White:
    assert film.P is not None
    order = np.mean((film.P[:, :, film.seen] ** 2).sum(axis=1) ** 2)
    if not max(map(np.max, noise)) > 0:
        noise = (np.ones_like(noise[0]), np.ones_like(noise[1]))
    # Of |P|² P the components along and across P have 3 |P|² and |P|² times the noise of P.
    return whitening(frame.halves[0][1], frame.space, noise, USUAL_MU, 5 * float(order))
