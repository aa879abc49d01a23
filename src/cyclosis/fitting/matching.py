"""Parameters from a film by matching: runs from an unknown initial state are compared with it.

The unknowns are the logarithms of the parameters, with a prior of a factor e about the paper's values, and
the Fourier coefficients of P at the first frame, with a smooth prior. `search` finds the most probable ones.
The intervals are those of the posterior's normal approximation, in which the initial state is integrated
out; they are widened by sqrt(χ²/N) where that is above 1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np

from ..model.grid import Array
from ..model.precision import double
from .compared import fields, waves
from .film import Film
from .judged import loud, refusal
from .noise import noise_of
from .prepared import COARSE, DT, QUICK, WIDTH, Match, begin, peak, prepared
from .result import ORDER, Fit, directions, masked, of_logarithms
from .search import Found, search
from .windows import Window

STAGES = 16
"""Steps that a search usually takes, for the progress."""
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
        return _fitted(match, film, names, free, fixed, noise, seed, notes, progress)


def _rms(variance: Array, film: Film) -> float:
    return float(np.sqrt(variance[..., film.known.any(axis=0)].mean()))


def _searched(match: Match, film: Film, told: Callable[[], None]) -> tuple[Match, Found, float, float]:
    """Return the film with its noise, the end of the search, χ²/N, and by what the noise was too large."""
    assert film.u is not None
    problem = match.problem()
    # u is about |P|² P, and the film's first frames bound it from above with their noise.
    rms = np.sqrt(2 * np.mean(film.u[:2][np.broadcast_to(film.known[:2, None], film.u[:2].shape)] ** 2))
    size = float(np.clip(rms, 1e-6, 1.0) ** (1 / 3))
    found = search(problem, begin(match, film, problem, size), np.full(2, size), WIDTH, told)
    ratio = _ratio(match, found)
    if ratio >= SPARSE:
        return match, found, ratio, 1.0
    match, over = match.quieter(found.left, _free(match, found) / found.left.size)
    found = search(match.problem(), found.x, found.sizes, found.width, told, blurred=False)
    return match, found, _ratio(match, found), over


def _free(match: Match, found: Found) -> float:
    """Return the number of values less what the unknowns take of them."""
    return max(found.left.size - max(match.share.values()) * found.effective, 1.0)


def _ratio(match: Match, found: Found) -> float:
    """Return χ²/N by the noise of single values."""
    parts = match.parts(found.left)
    return float(sum(match.share[name] * (part @ part) for name, part in parts.items())) / _free(match, found)


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
) -> Fit:
    n = len(free)
    done = [0]

    def told() -> None:
        done[0] += 1
        if progress is not None:
            progress(min(done[0], STAGES), STAGES + 1)

    match, found, ratio, over = _searched(match, film, told)
    alike = max(match.share.values())
    if alike > 1.2:
        notes = (*notes, ALIKE.format(alike))
    if ratio > 1 + CHANCE * np.sqrt(2 * alike / found.left.size):
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
    x = found.x
    covariance = found.covariance * max(ratio, 1.0)
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
        progress(STAGES + 1, STAGES + 1)
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


def _predicted(match: Match, film: Film, x: Array) -> Any:
    import xarray

    arrays = match.arrays
    with double():
        P, u = fields(match.layout, arrays, jnp.asarray(x), match.step(x, DT, QUICK * DT / COARSE), "float64")
        P, u = (np.asarray(waves(f)) for f in (P, u))
    there = np.einsum("am,tcmn,bn->tcab", arrays.around, P, arrays.along).real
    flow = np.einsum("camn,tcmn,bn->tcab", arrays.windows, u, arrays.along).real
    dims = ("time", "component", "theta", "z")
    coords = {"time": film.times, "component": ["theta", "z"], "theta": film.theta, "z": film.z}
    return xarray.Dataset({"P": (dims, there), "u": (dims, flow)}, coords)
