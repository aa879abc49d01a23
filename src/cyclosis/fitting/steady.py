"""What a steady profile across two stripes says of the parameters: Fisher information about a fit.

Steady stripes solve 0 = d_s P'' - d_r P + (1 - P²)(α_p P + α_u u) and u - μ u'' = P³, both odd about the
zone.
Implicit differentiation gives how u and P change with the logarithm of each parameter: δP = -J⁻¹ δR. The
whole
first equation may be multiplied by a number, so that (α_p, α_u, d_s, d_r) → c (α_p, α_u, d_s, d_r) changes
nothing: an exact null vector. ε and κ do not enter at all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.errors import InputError
from ..model.grid import Array
from ..model.parameters import Parameters
from ..stability.profiles.profile import Profile, cyclosis
from .film import Film
from .judged import refusal
from .result import ORDER, Direction, Fit, of_logarithms

NAMES = ("alpha_p", "alpha_u", "d_s", "d_r", "mu", "U")
"""What enters a profile."""
POINTS = 128
START = {"alpha_p": 1.0, "alpha_u": 0.5, "d_s": 0.025, "d_r": 0.025, "mu": 0.05, "U": 1.0}
LOST = 0.5
"""Deviation of a logarithm beyond which a parameter is not known."""
EXACT = 1e-9
"""Singular values below this share of the largest are those of combinations that change nothing."""
LEAST_NOISE = 1e-4
"""Least noise that is assumed, in units of the peak."""
MOVES = 0.1
"""A film whose halves differ by this share of the peak, beyond its noise, is not a profile."""


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives of P and of u by the logarithms of `NAMES` and by the zone's angle, each (angles, 7)."""

    P: Array
    u: Array


def slopes(state: Profile, U: float, angles: Array, zone: float) -> Slopes:
    """Return the `Slopes` of a profile of speed U u at angles, with its zone at an angle."""
    a, n = state.params, state.theta.size
    inner = np.arange(1, n // 2)
    S = np.sin(2 * np.pi / n * np.outer(inner, inner))
    m2 = inner.astype(np.float64) ** 2

    def operator(symbol: Array) -> Array:
        return S * (4.0 / n * symbol) @ S

    p = state.P[inner]
    laplacian, G = operator(-m2), operator(1 / (1 + a.mu * m2))
    by_mu = operator(-m2 / (1 + a.mu * m2) ** 2)
    u, room = G @ p**3, 1 - p**2
    torque = a.alpha_p * p + a.alpha_u * u
    J = a.d_s * laplacian + a.alpha_u * room[:, None] * G * (3 * p**2)
    J[np.diag_indices_from(J)] += room * a.alpha_p - 2 * p * torque - a.d_r
    forced = {
        "alpha_p": a.alpha_p * room * p,
        "alpha_u": a.alpha_u * room * u,
        "d_s": a.d_s * (laplacian @ p),
        "d_r": -a.d_r * p,
        "mu": a.mu * a.alpha_u * room * (by_mu @ p**3),
    }
    dP = -np.linalg.solve(J, np.stack(list(forced.values()), axis=1))
    du = G @ (3 * p[:, None] ** 2 * dP)
    du[:, 4] += a.mu * (by_mu @ p**3)
    away = angles[:, None] - zone
    sines, cosines = np.sin(away * inner), np.cos(away * inner) * inner

    def placed(values: Any) -> Any:
        return sines @ (4.0 / n * S @ values)

    zero = np.zeros((angles.size, 1))
    turned = [-(cosines @ (4.0 / n * S @ f))[:, None] for f in (p, u)]
    return Slopes(
        np.hstack([placed(dP), zero, turned[0]]),
        U * np.hstack([placed(du), placed(u)[:, None], turned[1]]),
    )


@dataclass(frozen=True, eq=False)
class Measured:
    """A profile: `angles`, and the values and standard deviations of u and perhaps of P."""

    angles: Array
    values: dict[str, Array]
    deviations: dict[str, Array]
    estimated: bool


def by_profile(film: Film, wanted: tuple[str, ...], fixed: dict[str, float], seed: int) -> Fit:
    """Return the `Fit` of a steady profile of u, or of u and P."""
    free = tuple(name for name in ORDER if name not in fixed)
    names = tuple(name for name in free if name in wanted)
    changed = _change(film)
    if changed > MOVES:
        sentence = (
            f"This film is not steady: its halves differ by {100 * changed:.0f} % of the peak; fit "
            f"it by method "
            "equation or film, which use the change."
        )
        return refusal("profile", names, fixed, film, sentence, seed)
    data = _measured(film)
    if data.angles.size < 12:
        sentence = (
            f"This profile has {data.angles.size} angles and needs at least 12; measure on a finer grid."
        )
        return refusal("profile", names, fixed, film, sentence, seed)
    asked = tuple(name for name in NAMES if name not in fixed)
    found = _searched(data, asked, fixed)
    if found is None:
        sentence = (
            "No steady state of two stripes is like this profile; check that the window shows a zone between "
            "streams, and that theta and the sign of u are right."
        )
        return refusal("profile", names, fixed, film, sentence, seed)
    values, zone, state, rows, left = found
    count = left.size - len(asked) - 1
    residual = float(np.sqrt(left @ left / max(count, 1)))
    if not data.estimated:
        rows, residual = rows / max(residual, 1e-12), 1.0
    # The zone's angle is not asked for: what it can imitate is projected out.
    turn = rows[:, -1:]
    kept = rows[:, :-1] - turn @ (turn.T @ rows[:, :-1]) / float((turn**2).sum())
    _, sizes, vectors = np.linalg.svd(kept, full_matrices=False)
    deviations = np.where(sizes > EXACT * sizes[0], 1 / np.maximum(sizes, 1e-300), np.inf)
    with np.errstate(invalid="ignore"):
        shares = np.where(np.abs(vectors) > 1e-6, vectors, 0.0)
        spread = np.sqrt(np.sum(np.where(shares != 0, shares**2 * deviations[:, None] ** 2, 0.0), axis=0))
    logs = dict(zip(asked, spread.tolist(), strict=True))
    lost = {name for name in free if logs.get(name, np.inf) > LOST}
    verdict = _said(names, lost, fixed)
    wrong = data.estimated and residual > 2.0 and _share(left, data) > 0.05
    if wrong:
        verdict = (
            f"Steady stripes of the model do not fit this profile: they leave {residual:.3g} times "
            f"the noise; check "
            "the geometry, and whether the stripes run along the cell."
        )
        lost = set(free)
    parts = tuple(
        Direction(float(deviations[k]), dict(zip(asked, _signed(vectors[k]).tolist(), strict=True)))
        for k in range(len(asked))
    )
    covariance = np.full((len(names), len(names)), np.nan)
    for i, one in enumerate(names):
        for j, other in enumerate(names):
            if one not in lost and other not in lost:
                a, b = asked.index(one), asked.index(other)
                with np.errstate(invalid="ignore"):
                    terms = np.where(
                        shares[:, a] * shares[:, b] != 0, shares[:, a] * shares[:, b] * deviations**2, 0.0
                    )
                covariance[i, j] = values[one] * values[other] * terms.sum()
    return Fit(
        "profile",
        *of_logarithms(names, values, logs, lost),
        verdict,
        covariance,
        parts,
        float(deviations[-1] / deviations[0]),
        residual,
        fixed,
        {name: float(np.median(d)) for name, d in data.deviations.items()},
        {},
        film.scales,
        seed,
        None if wrong else lambda: _predicted(state, values["U"], zone, rows, data),
    )


def _said(names: tuple[str, ...], lost: set[str], fixed: dict[str, float]) -> str | None:
    unknown = [name for name in names if name in lost]
    if not unknown:
        return None
    parts = ["A steady profile fixes combinations of parameters only"]
    if not {"alpha_p", "alpha_u", "d_s", "d_r"} & fixed.keys():
        parts.append("a common factor of alpha_p, alpha_u, d_s and d_r changes nothing")
    absent = [name for name in ("epsilon", "kappa") if name in unknown]
    if absent:
        parts.append(f"{' and '.join(absent)} {'do' if len(absent) == 2 else 'does'} not enter")
    return (
        f"{'; '.join(parts)}; not known: {', '.join(unknown)}; film the hours in which streaming "
        f"appears, or fix "
        "what is known from elsewhere."
    )


def _signed(vector: Array) -> Array:
    return vector * np.sign(vector[np.argmax(np.abs(vector))])


def _share(left: Array, data: Measured) -> float:
    signal = np.concatenate([data.values[name] / data.deviations[name] for name in data.values])
    return float(np.sqrt((left @ left) / (signal @ signal)))


def _change(film: Film) -> float:
    assert film.u is not None
    if film.frames < 2:
        return 0.0
    half = film.frames // 2
    means = [part.mean(axis=0)[1][film.seen] for part in (film.u[:half], film.u[-half:])]
    noise = np.var(np.diff(film.u[:, 1][:, film.seen], axis=0)) / 2 * (2 / half)
    peak = float(np.abs(film.u[:, 1][:, film.seen]).max()) or 1.0
    return float(np.sqrt(max(np.mean((means[0] - means[1]) ** 2) - noise, 0.0))) / peak


def _measured(film: Film) -> Measured:
    """Return the mean along the cell and in time, with its standard deviation where that can be found."""
    values, deviations, estimated = {}, {}, True
    rows = film.seen.any(axis=1)
    for name, field in (("u", film.u), ("P", film.P)):
        if field is None:
            continue
        axial = field[:, 1][:, rows]
        seen = film.seen[rows]
        count = seen.sum(axis=1) * film.frames
        mean = np.where(seen, axial, 0.0).sum(axis=(0, 2)) / count
        square = (np.where(seen, axial - mean[None, :, None], 0.0) ** 2).sum(axis=(0, 2))
        floor = LEAST_NOISE * max(float(np.abs(mean).max()), 1e-12)
        if count.min() > 4:
            spread = np.sqrt(np.mean(square / (count - 1)) / count)
        else:
            estimated, spread = False, np.full(mean.shape, floor)
        values[name], deviations[name] = mean, np.maximum(spread, floor)
    return Measured(film.theta[rows], values, deviations, estimated)


def _searched(data: Measured, asked: tuple[str, ...], fixed: dict[str, float]) -> Any:
    """Return values, zone, state, scaled slopes and residual at the best fit, or None if there is none."""
    waves = np.stack([np.sin(data.angles), np.cos(data.angles)], axis=1)
    a, b = np.linalg.lstsq(waves, data.values["u"], rcond=None)[0]
    zone = float(np.arctan2(-b, a))
    values = {name: fixed.get(name, START[name]) for name in NAMES}
    if "U" not in fixed:
        values["U"] = float(np.abs(data.values["u"]).max()) or 1.0
    begin = np.array([np.log(values[name]) for name in asked])
    at = begin.copy()
    now = _compared(data, asked, values, zone)
    if now is None:
        return None
    damping = 1e-3
    for _ in range(60):
        state, rows, left = now
        keep = np.append(np.ones(at.size), 0.0)
        normal = rows.T @ rows + np.diag(keep)
        slope = rows.T @ left + keep * np.append(at - begin, 0.0)
        step = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), slope)
        step *= min(1.0, 0.7 / max(np.abs(step).max(), 1e-12))
        new = at + step[:-1]
        tried = values | dict(zip(asked, np.exp(new).tolist(), strict=True))
        then = _compared(data, asked, tried, zone + step[-1])
        before = left @ left + np.sum((at - begin) ** 2)
        if then is None or not then[2] @ then[2] + np.sum((new - begin) ** 2) <= before:
            damping *= 10
            if damping > 1e8:
                break
            continue
        gained = before - (then[2] @ then[2] + np.sum((new - begin) ** 2))
        at, zone, values, now, damping = new, zone + step[-1], tried, then, max(damping / 10, 1e-9)
        if gained < 1e-9 * max(before, 1.0):
            break
    state, rows, left = now
    if left @ left > 0.25 * sum(np.sum((data.values[k] / data.deviations[k]) ** 2) for k in data.values):
        return None
    return values, zone, state, rows, left


def _compared(data: Measured, asked: tuple[str, ...], values: dict[str, float], zone: float) -> Any:
    try:
        params = Parameters().replace(**{name: values[name] for name in NAMES if name != "U"})
        state = cyclosis(params, POINTS)
    except InputError:
        return None
    P, u = state.at(data.angles, zone)
    model = {"P": P, "u": values["U"] * u}
    slope = slopes(state, values["U"], data.angles, zone)
    columns = [*(NAMES.index(name) for name in asked), -1]
    rows = np.concatenate([getattr(slope, k)[:, columns] / data.deviations[k][:, None] for k in data.values])
    left = np.concatenate([(model[k] - data.values[k]) / data.deviations[k] for k in data.values])
    return state, rows, left


def _predicted(state: Profile, U: float, zone: float, rows: Array, data: Measured) -> Any:
    """Return u and P of the fit at the angles, with the band of u: one standard deviation."""
    import xarray

    P, u = state.at(data.angles, zone)
    left, _, _ = np.linalg.svd(rows, full_matrices=False)
    size = np.linalg.norm(left[: data.angles.size], axis=1) * data.deviations["u"]
    band = {"u_deviation": ("theta", size)}
    fields = {"u": ("theta", U * u), "P": ("theta", P), "measured_u": ("theta", data.values["u"])}
    return xarray.Dataset({**fields, **band}, {"theta": data.angles})
