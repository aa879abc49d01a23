"""Parameters from a film by matching: runs from an unknown initial state are compared with it.

The unknowns are the logarithms of the parameters, with a prior of a factor e about the paper's values, and
the Fourier coefficients of P at the first frame, with a smooth prior. `search` finds the most probable ones.
The intervals are those of the posterior's normal approximation, in which the initial state is integrated
out; they are widened by sqrt(χ²/N) where that is above 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..model.grid import Array
from ..model.precision import double
from .compared import fields, waves
from .displaced import displaced
from .film import Film
from .geometry import Tilt
from .judged import loud, refusal
from .marginal import integrated
from .noise import noise_of
from .prepared import COARSE, DT, QUICK, Match, begin, peak, prepared
from .result import ORDER, Fit, directions, masked, of_logarithms
from .search import WIDTH, Found, Near, approached, ended
from .windows import Window

STAGES = 32
"""Steps that one search takes at most, as a rule, for the progress."""
LEAST = 4
"""One frame less than the fewest."""
WRONG = 1.5
"""χ²/N of a model that does not fit."""
SPARSE = 0.8
"""χ²/N below which differences in time have taken change for noise: what the run leaves is the noise."""
OPEN = 0.1
"""Gain still expected of one more step, beyond which a search has not ended."""
CHANCE = 6.0
"""Standard deviations of χ²/N beyond which it is not chance."""
LUCK = 4.0
"""The same, beyond which a search is begun again."""
STARTS = 6
"""Most starts."""
SAME = 3.0
"""Difference of the logarithms of evidence below which two ends are taken to be one."""
LOST = 0.5
"""Posterior deviation of a logarithm at which the prior, 1, decides."""
ALIKE = "what neighbouring vectors share of their noise was taken into account: {0:.2g} of them count as one"


def by_film(
    film: Film,
    wanted: tuple[str, ...],
    fixed: dict[str, float],
    seed: int,
    length: float | None,
    window: Window | None,
    notes: tuple[str, ...],
    progress: Callable[[int, int], None] | None,
    tilts: list[Tilt],
) -> Fit:
    """Return the `Fit` of a film of u, with P or angles if they were measured, by matching runs to it."""
    free = tuple(name for name in ORDER if name not in fixed)
    names = tuple(name for name in free if name in wanted)
    assert film.u is not None
    measured = {"u": film.u} | ({"P": film.P} if film.P is not None else {})
    noise = {name: _rms(noise_of(each, film.times, film.known), film) for name, each in measured.items()}
    sentence = None
    if film.frames < LEAST + 1 or not noise["u"] > 0:
        sentence = (
            f"This film has {film.frames} frames, too few to find its noise and to follow a change; "
            f"film at least {LEAST + 1}."
        )
    for name, each in measured.items():
        sentence = sentence or loud(name, noise[name], 1.0 if name == "P" else peak(each, film.known))
    if sentence is not None:
        return refusal("film", names, fixed, film, sentence, seed, noise, notes)
    match = prepared(film, free, fixed, length, window)
    with double():
        return _fitted(match, film, names, free, fixed, noise, seed, notes, progress, tilts)


def _rms(variance: Array, film: Film) -> float:
    return float(np.sqrt(variance[..., film.known.any(axis=0)].mean()))


@dataclass(frozen=True, eq=False)
class End:
    """The end of a search, χ²/N there, by what the noise was too large, and how many starts it took."""

    match: Match
    found: Found
    ratio: float
    over: float
    starts: int


def _searched(match: Match, film: Film, seed: int, told: Callable[[], None]) -> End:
    """Return the end of the largest evidence among those of as many starts as are needed."""
    near: list[tuple[Near, Match]] = []
    ends: list[End] = []
    for start in range(STARTS):
        aged, y, sizes = begin(match, film, start, seed)
        reached = approached(aged.problem(), y, sizes, told)
        near.append((reached, aged))
        if reached.fits:
            ends.append(_ended(*near[-1], start + 1, told))
            if _good(ends[-1]) or _alike(ends):
                break
    if not ends:
        reached, aged = max(near, key=lambda each: (each[0].stages, -each[0].ratio))
        sizes = aged.problem().sizes(reached.scale)
        reached = approached(aged.problem(), reached.y, sizes, told, patient=True)
        ends.append(_ended(reached, aged, STARTS, told))
    best = max(ends, key=lambda end: end.found.evidence)
    if best.ratio < SPARSE:
        found = best.found
        quiet, over = best.match.quieter(found.left, _free(best.match, found) / found.left.size)
        found = ended(quiet.problem(), found.x, found.sizes, found.width, told)
        best = replace(best, match=quiet, found=found, ratio=_ratio(quiet, found), over=over)
    return replace(best, starts=max(end.starts for end in ends))


def _ended(near: Near, match: Match, starts: int, told: Callable[[], None]) -> End:
    problem = match.problem()
    sizes = problem.sizes(near.scale * problem.shrinkage(near.y))
    found = ended(problem, problem.first(near.y), sizes, WIDTH, told)
    return End(match, found, _ratio(match, found), 1.0, starts)


def _good(end: End) -> bool:
    """Return whether a search has ended and leaves no more than chance allows."""
    return end.found.short < OPEN and end.ratio < 1 + LUCK * _chance(end.match, end.found)


def _alike(ends: list[End]) -> bool:
    """Return whether the last search has ended where another has."""
    *others, last = (end.found for end in ends)
    same = (abs(other.evidence - last.evidence) < SAME and other.short < OPEN for other in others)
    return last.short < OPEN and any(same)


def _chance(match: Match, found: Found) -> float:
    """Return the standard deviation of χ²/N."""
    return float(np.sqrt(2 * max(match.share.values()) / found.left.size))


def _free(match: Match, found: Found) -> float:
    """Return the number of values less what the unknowns take of them."""
    return max(found.left.size - max(match.share.values()) * found.effective, 1.0)


def _ratio(match: Match, found: Found) -> float:
    """Return χ²/N by the noise of single values."""
    parts = match.parts(found.left)
    return float(sum(match.share[name] * (part @ part) for name, part in parts.items())) / _free(match, found)


def _total(done: int) -> int:
    """Return the steps to expect after some: those of as many searches as these make, and the last one."""
    return STAGES * (1 + done // STAGES) + 1


def _fitted(
    match: Match,
    film: Film,
    names: tuple[str, ...],
    free: tuple[str, ...],
    fixed: dict[str, float],
    noise: dict[str, float],
    seed: int,
    notes: tuple[str, ...],
    progress: Callable[[int, int], None] | None,
    tilts: list[Tilt],
) -> Fit:
    n = len(free)
    done = [0]

    def told() -> None:
        done[0] += 1
        if progress is not None:
            progress(done[0], _total(done[0]))

    end = _searched(match, film, seed, told)
    match, found, ratio, over = end.match, end.found, end.ratio, end.over
    alike = max(match.share.values())
    if ratio < WRONG and found.short < OPEN:
        found = integrated(match.problem(), found, told)
    if alike > 1.2:
        notes = (*notes, ALIKE.format(alike))
    if ratio > 1 + CHANCE * _chance(match, found):
        notes = (
            *notes,
            f"the best run leaves {np.sqrt(ratio):.3g} times the noise, more than chance allows: it is not "
            "quite this cell, and the intervals, widened by that, may still be too narrow",
        )
    if over > 1.0:
        notes = (
            *notes,
            f"frames are so far apart that differences in time show {over:.2g} times the noise; it was taken "
            "from what the run leaves instead",
        )
    if end.starts > 1:
        notes = (*notes, f"the search was begun {end.starts} times, from other parameters and states")
    x = found.x
    covariance = found.covariance * max(ratio, 1.0)
    if tilts:
        P, u = _waves(match, x)
        covariance = covariance + displaced(match.layout.grid, match.arrays, film, (P, u), found.gain, tilts)
    deviation = np.sqrt(np.diag(covariance))
    values = np.exp(x[:n])
    logs = dict(zip(free, deviation.tolist(), strict=True))
    best = dict(zip(free, values.tolist(), strict=True))
    lost = [name for name in free if logs[name] > LOST]
    sentence = None
    if not ratio < WRONG:
        sentence = (
            f"No run of the model matches this film (chi²/N is {ratio:.3g}, the noise alone gives 1); take a "
            "part of the film in which streaming appears, and check the geometry and the length."
        )
        lost = list(free)
    elif not found.short < OPEN:
        sentence = (
            "The search has not ended at a best fit; take a shorter part of the film, or fix parameters."
        )
        lost = list(free)
    elif any(name in names for name in lost):
        told_of = ", ".join(name for name in lost if name in names)
        sentence = f"This film cannot tell {told_of}; film the hours in which streaming appears, or fix them."
    if progress is not None:
        progress(_total(done[0]), _total(done[0]))
    return Fit(
        "film",
        *of_logarithms(names, best, logs, lost),
        sentence,
        masked(covariance * np.outer(values, values), free, names, lost),
        () if len(lost) == n else directions(free, np.ones(n), covariance),
        float(np.sqrt(np.divide(*np.linalg.eigvalsh(covariance)[[-1, 0]]))) if n else 1.0,
        float(np.sqrt(ratio)),
        fixed,
        noise,
        {},
        film.scales,
        seed,
        None if len(lost) == n else lambda: _predicted(match, film, x),
        notes,
    )


def _waves(match: Match, x: Array) -> tuple[Any, Any]:
    """Return the waves of P and u at the film's times."""
    with double():
        dt = match.step(x, DT, QUICK * DT / COARSE)
        P, u = fields(match.layout, match.arrays, jnp.asarray(x), dt, "float64")
        return np.asarray(waves(P)), np.asarray(waves(u))


def _predicted(match: Match, film: Film, x: Array) -> Any:
    import xarray

    arrays = match.arrays
    P, u = _waves(match, x)
    there = np.einsum("am,tcmn,bn->tcab", arrays.around, P, arrays.along).real
    flow = np.einsum("camn,tcmn,bn->tcab", arrays.windows, u, arrays.along).real
    dims = ("time", "component", "theta", "z")
    coords = {"time": film.times, "component": ["theta", "z"], "theta": film.theta, "z": film.z}
    return xarray.Dataset({"P": (dims, there), "u": (dims, flow)}, coords)
