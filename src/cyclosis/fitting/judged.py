"""From repeated estimates to intervals, and the reasons to refuse."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..model.grid import Array
from .equation import LEAST_FRAMES, NAMES, Repeats, TooSmall, repeated
from .film import Film
from .geometry import Tilt
from .noise import noise_of
from .result import ORDER, Fit, directions, masked
from .weak import FILAMENTS, FLOW
from .windows import Window, sharpened

STEADY = 50.0
"""Condition beyond which the filament equation is not tested by a film."""
WEAK = 10.0
"""Least F of the instruments of a parameter."""
NOISY = 0.2
"""Largest noise, as a share of the peak, that was tried."""
EXACT = 1e-6
"""Share of the residual below which added noise shows that the data are exact: nothing is compared."""
WRONG = (2.0, 0.05)
"""A model does not fit if it leaves this many times the noise, and this share of the signal."""
COARSE = (
    "The window has too few points for a test function, which needs seven in theta and in z; measure on a "
    "finer grid or with smaller windows, or film a larger part of the surface."
)
GAPS = (
    "No stretch of this film has enough frames for a test function, which needs about seven of every second "
    "frame without a longer gap; film at even times, or fit by method film, which takes any."
)
ABOUT_STEADY = (
    "This film hardly changes (condition {0:.3g}, the limit is 50), so that alpha_p, alpha_u, "
    "epsilon, d_s, d_r "
    "and kappa can be told only up to combinations; film the hours in which streaming appears, or "
    "fix parameters."
)


def by_equation(
    film: Film,
    wanted: tuple[str, ...],
    fixed: dict[str, float],
    tilts: list[Tilt],
    draws: int,
    seed: int,
    window: Window | None = None,
    notes: tuple[str, ...] = (),
) -> Fit:
    """Return the `Fit` of a film with P and u by the weak form of the equations."""
    free = tuple(name for name in ORDER if name not in fixed)
    names = tuple(name for name in free if name in wanted)
    given = {name: value for name, value in fixed.items() if name in NAMES}
    if film.frames < LEAST_FRAMES:
        sentence = (
            f"This film has {film.frames} frames, and the equations need at least {LEAST_FRAMES}, "
            f"two times nine; "
            "film longer or more often, or fit by method film."
        )
        return refusal("equation", names, fixed, film, sentence, seed, None, notes)
    assert film.P is not None
    assert film.u is not None
    peak = {"P": 1.0, "u": float(np.quantile(np.hypot(film.u[:, 0], film.u[:, 1])[:, film.seen], 0.999))}
    known = film.known & film.seen
    noise = {k: _rms(noise_of(f, film.times, known), film.seen) for k, f in (("P", film.P), ("u", film.u))}
    for name, size in noise.items():
        said = loud(name, size, peak[name])
        if said is not None:
            return refusal("equation", names, fixed, film, said, seed, noise, notes)
    film = film if window is None else sharpened(film, window)
    try:
        found = repeated(film, given, fixed.get("repulsion_angle", 0.0), tilts, draws, seed)
    except TooSmall as why:
        sentence = GAPS if "time" in why.args else COARSE
        return refusal("equation", names, fixed, film, sentence, seed, noise, notes)
    return _judged(found, film, names, free, fixed, noise, seed, notes)


def _judged(
    found: Repeats,
    film: Film,
    names: tuple[str, ...],
    free: tuple[str, ...],
    fixed: dict[str, float],
    noise: dict[str, float],
    seed: int,
    notes: tuple[str, ...],
) -> Fit:
    values = np.array([found.first.values[name] for name in free])
    deviation = _deviation(found, free)
    strength = _strength(found)
    conditions = {kind: _condition(square) for kind, square in found.first.squares.items()}
    condition = max(conditions.values())
    steady = conditions["filaments"] > STEADY
    unknown = {name for name in free if strength.get(name, np.inf) < WEAK or not deviation[name] > -1}
    sentence = None
    if steady:
        unknown |= set(FILAMENTS)
        sentence = ABOUT_STEADY.format(conditions["filaments"])
    if strength.get("U", np.inf) < WEAK:
        unknown |= set(free)  # the unit of every rate
    # What does not even have a known sign or size is not an estimate.
    unknown |= {
        name
        for name, value in zip(free, values, strict=True)
        if not T95 * deviation[name] < abs(value) * VAGUE
    }
    residual, wrong = _residual(found)
    if wrong and not steady:  # of a steady film the left-hand side is noise
        sentence = (
            f"The model does not fit: it leaves {residual:.3g} times the noise; check the geometry, "
            f"the direction "
            "of y and mirroring, and whether the film shows what the model describes."
        )
        unknown = set(free)
    lost = [name for name in ORDER if name in unknown and name in names]
    if sentence is None and lost:
        weakest = min(strength.get(name, np.inf) for name in lost)
        sentence = (
            f"This film cannot tell {', '.join(lost)} (first-stage strength of the instruments F = "
            f"{weakest:.2g}, "
            "10 is needed, or an interval wider than the value); film longer, beyond the onset of streaming."
        )
    covariance = _covariance(found, free, values, deviation)
    known = [k for k, name in enumerate(free) if name not in unknown]
    parts = directions(tuple(free[k] for k in known), values[known], covariance[np.ix_(known, known)])
    return Fit(
        "equation",
        {name: float("nan") if name in unknown else found.first.values[name] for name in names},
        {name: _interval(found.first.values[name], deviation[name], name in unknown) for name in names},
        sentence,
        masked(covariance, free, names, unknown),
        parts,
        condition,
        residual,
        fixed,
        noise,
        {name: value for name, value in strength.items() if name in names},
        film.scales,
        seed,
        notes=notes,
    )


T95 = 2.365
"""Student's t for 95 % and 7 degrees of freedom: eight repeats."""
VAGUE = 1.0
"""An interval must not be wider, either way, than the value itself."""


def _deviation(found: Repeats, free: tuple[str, ...]) -> dict[str, float]:
    """Return standard deviations: of the noise added again, of the quadrature and of the geometry."""
    out = {}
    for name in free:
        value = found.first.values[name]
        noise = [each.values[name] - value for each in found.noisy]
        other = [each.values[name] - value for each in found.other]
        moved = [each.values[name] - value for each in found.moved]
        parts = [np.mean(np.square(part)) for part in (noise, moved) if part]
        parts += [np.mean(np.square(other)) / 4] if other else []
        out[name] = float(np.sqrt(np.sum(parts)))
    return out


def _strength(found: Repeats) -> dict[str, float]:
    """Return F of the instruments: what they move of a parameter's column alone, against its noise."""
    out: dict[str, float] = {}
    for kind in ("flow", "filaments"):
        names, moments = found.first.moments[kind]
        if not names:
            continue
        here = _alone(moments)
        again = np.array([_alone(each.moments[kind][1]) for each in found.noisy])
        spread = np.sqrt(np.mean((again - here) ** 2, axis=0)) if len(again) else np.zeros_like(here)
        with np.errstate(divide="ignore", invalid="ignore"):
            F = np.where((here > 0) | (kind == "flow"), (here / spread) ** 2, 0.0)
        out |= dict(zip(names, np.where(np.isnan(F), 0.0, F).tolist(), strict=True))
    return out


def _alone(moments: Array) -> Array:
    """Return what is left of each column's moment beside all others: 1/(A⁻¹)_kk."""
    scale = np.sqrt(np.maximum(np.abs(np.diag(moments)), 1e-300))
    inverse = np.linalg.pinv(moments / np.outer(scale, scale), rcond=1e-14)
    return scale**2 / np.where(np.diag(inverse) != 0, np.diag(inverse), np.inf)


def _condition(moments: Array) -> float:
    if moments.size == 0:
        return 1.0
    scale = np.sqrt(np.maximum(np.abs(np.diag(moments)), 1e-300))
    sizes = np.linalg.eigvalsh(moments / np.outer(scale, scale))
    return float(np.sqrt(sizes[-1] / sizes[0])) if sizes[0] > 0 else float("inf")


def _residual(found: Repeats) -> tuple[float, bool]:
    """Return what the model leaves in units of the noise, and whether that is too much."""
    worst, wrong = 1.0, False
    for kind, left in found.first.residual.items():
        again = float(np.mean([each.residual[kind] for each in found.noisy]))
        noise = again - left  # the repeats have twice the noise
        ratio = float(np.sqrt(left / noise)) if noise > EXACT * left else 1.0
        wrong |= ratio > WRONG[0] and left > WRONG[1] ** 2
        worst = ratio if abs(np.log(ratio)) > abs(np.log(worst)) else worst
    return worst, bool(wrong)


def _covariance(found: Repeats, free: tuple[str, ...], values: Array, deviation: dict[str, float]) -> Array:
    """Return the covariance: correlations by the moments, deviations by the repeats."""
    correlation = np.eye(len(free))
    for kind in ("flow", "filaments"):
        names, square = found.first.moments[kind][0], found.first.squares[kind]
        if not names:
            continue
        inverse = np.linalg.pinv(square, hermitian=True)
        size = np.sqrt(np.abs(np.diag(inverse)))
        at = [free.index(name) for name in names]
        correlation[np.ix_(at, at)] = inverse / np.outer(size, size)
    spread = np.array([deviation[name] for name in free])
    return np.clip(correlation, -1, 1) * np.outer(spread, spread)


def _interval(value: float, deviation: float, unknown: bool) -> tuple[float, float]:
    if unknown:
        return 0.0, float("inf")
    return max(value - T95 * deviation, 0.0), value + T95 * deviation


def loud(name: str, size: float, peak: float) -> str | None:
    """Return a sentence if noise of a standard deviation is too large beside the peak of its field."""
    if size <= NOISY * peak:
        return None
    return (
        f"The noise of {name} is {100 * size / peak:.0f} % of its peak, and the fit holds up to 20 %; "
        "average neighbouring vectors, or film at a higher magnification."
    )


def _rms(variance: Array, seen: npt.NDArray[np.bool_]) -> float:
    return float(np.sqrt(variance[:, seen].mean()))


def refusal(
    method: str,
    names: tuple[str, ...],
    fixed: dict[str, float],
    film: Film,
    sentence: str,
    seed: int,
    noise: dict[str, float] | None = None,
    notes: tuple[str, ...] = (),
) -> Fit:
    """Return a `Fit` that says nothing but why."""
    return Fit(
        method,
        dict.fromkeys(names, float("nan")),
        dict.fromkeys(names, (0.0, float("inf"))),
        sentence,
        np.full((len(names), len(names)), np.nan),
        (),
        float("inf"),
        float("nan"),
        fixed,
        noise or {},
        {},
        film.scales,
        seed,
        notes=notes,
    )


assert set(FLOW) | set(FILAMENTS) == set(NAMES)
