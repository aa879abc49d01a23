"""Parameters from a film of u alone: runs from an unknown initial state are matched to it.

The unknowns are the logarithms of the parameters, with a prior of a factor e about the paper's values, and
the Fourier coefficients of P at the first frame, with a smooth prior. `search` finds the most probable ones.
The intervals are those of the posterior's normal approximation, in which the initial state is integrated
out; they are widened by sqrt(χ²/N) where that is above 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from .. import traced
from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.precision import double
from .film import Film, noise_of
from .judged import NOISY, refusal
from .result import ORDER, Fit, directions, masked, of_logarithms
from .search import Problem, search

POINTS, DT, COARSE = 32, 0.125, 0.25
"""Points of the model's grid either way, and its steps in R/U for the misfit and for its slopes."""
FINEST, FEWEST, MOST_WAVES = 7.0, 3, 12
"""Largest wave number of the initial state, per radian or radius, and least and most waves along the cell."""
START = {
    "alpha_p": 1.0,
    "alpha_u": 0.5,
    "epsilon": 0.1,
    "d_s": 0.025,
    "d_r": 0.025,
    "kappa": 0.5,
    "mu": 0.05,
    "U": 1.0,
}
"""Where the search begins: the paper's values. The prior is a factor e either way."""
WIDTH = 2.5
"""Wave number at which the prior of P begins to fall off, before the film has told it."""
STAGES = 16
"""Steps that a search usually takes, for the progress."""
LEAST, LONGEST = 4, 400
"""Frames and steps of a film that is matched."""
WRONG = 1.5
"""χ²/N of a model that does not fit."""
OPEN = 0.1
"""Gain still expected of one more step, beyond which a search has not ended."""
LOST = 0.5
"""Posterior deviation of a logarithm at which the prior, 1, decides."""
SHARE = 24
"""Columns of the Jacobian that are computed together."""


@dataclass(frozen=True, eq=False)
class Match:
    """A film prepared for matching: `names` are the free parameters, in the order of the first unknowns.

    `around` and `along` are the waves of the grid at the film's places, and `waves` the cosines and sines of
    the initial state on the grid, of which those in `kept` are used.
    """

    grid: CylinderGrid
    names: tuple[str, ...]
    fixed: dict[str, float]
    times: Array
    around: Array
    along: Array
    data: Array
    sigma: Array
    seen: npt.NDArray[np.bool_]
    waves: tuple[Array, Array]
    squares: Array
    kept: npt.NDArray[np.bool_]

    def initial(self, waves: Any) -> Any:
        """Return P (2, n_theta, n_z) of the coefficients that are used."""
        full = jnp.zeros((2, *self.kept.shape)).at[:, self.kept].set(waves.reshape(2, -1))
        return jnp.einsum("am,cmn,bn->cab", self.waves[0], full, self.waves[1])

    def values(self, logs: Any) -> dict[str, Any]:
        """Return the parameters by name, the rates in units of the data's time."""
        given: dict[str, Any] = {
            **self.fixed,
            **{name: jnp.exp(logs[k]) for k, name in enumerate(self.names)},
        }
        unit = given.pop("U")
        angle = given.pop("repulsion_angle", 0.0)
        # u in units of the data is U u: all terms but those of μ become U times as fast.
        return {
            "U": unit,
            "repulsion_angle": angle,
            **{n: v if n == "mu" else v * unit for n, v in given.items()},
        }

    def fields(self, unknowns: Any, dt: float) -> tuple[Any, Any]:
        """Return P and u (n, 2, n_theta, n_z) on the grid at the film's times."""
        logs, waves = unknowns[: len(self.names)], unknowns[len(self.names) :]
        values = self.values(logs)
        unit = values.pop("U")
        P = traced.rollout(PLAIN, self.grid, self.initial(waves), self.times, dt, **values)
        return P, unit * jax.vmap(lambda p: traced.flow(PLAIN, self.grid, p, mu=values["mu"]))(P)

    def misfit(self, unknowns: Any, dt: float = DT) -> Any:
        """Return (u_model - u)/σ where u was seen, as one vector."""
        wave = jnp.fft.fft2(self.fields(unknowns, dt)[1], norm="forward")
        there = jnp.einsum("am,tcmn,bn->tcab", self.around, wave, self.along).real
        return ((there[..., self.seen] - self.data) / self.sigma).ravel()

    def problem(self) -> Problem:
        """Return what `search` minimises."""
        misfit = jax.jit(self.misfit)
        columns = jax.jit(lambda x, v: jax.vmap(jax.linearize(lambda y: self.misfit(y, COARSE), x)[1])(v))

        def jacobian(x: Array) -> Array:
            unit = np.eye(-(-x.size // SHARE) * SHARE, x.size)
            shares = [columns(x, unit[k : k + SHARE]) for k in range(0, x.size, SHARE)]
            return np.concatenate([np.asarray(share) for share in shares])[: x.size]

        mean = [np.mean(wave**2, axis=0) for wave in self.waves]
        peak = np.quantile(np.hypot(self.data[:, 0], self.data[:, 1]), 0.999)
        return Problem(
            lambda x: np.asarray(misfit(x)),
            jacobian,
            np.log([START[name] for name in self.names]),
            np.tile(self.squares[self.kept], 2),
            np.tile(np.outer(*mean)[self.kept], 2) / 2,
            np.broadcast_to(peak / self.sigma, self.data.shape).ravel(),
        )


PLAIN = Parameters()


def by_film(
    film: Film,
    wanted: tuple[str, ...],
    fixed: dict[str, float],
    seed: int,
    length: float | None,
    progress: Callable[[int, int], None] | None,
) -> Fit:
    """Return the `Fit` of a film of u by matching runs to it."""
    free = tuple(name for name in ORDER if name not in fixed)
    names = tuple(name for name in free if name in wanted)
    assert film.u is not None
    sentence = None
    variance = noise_of(film.u, film.seen)
    noise = float(np.sqrt(variance[:, film.seen].mean()))
    peak = float(np.quantile(np.hypot(film.u[:, 0], film.u[:, 1])[:, film.seen], 0.999))
    if film.frames < LEAST + 1 or not noise > 0:
        sentence = (
            f"This film has {film.frames} frames, too few to find its noise and to follow a change; "
            f"film at least {LEAST + 1}."
        )
    elif noise > NOISY * peak:
        sentence = (
            f"The noise of u is {100 * noise / peak:.0f} % of its peak, and the fit holds up to 20 "
            f"%; average "
            "neighbouring vectors, or film at a higher magnification."
        )
    if sentence is not None:
        return refusal("film", names, fixed, film, sentence, seed, {"u": noise})
    match = _match(film, free, fixed, variance, length)
    with double():
        return _fitted(match, film, names, free, fixed, noise, seed, progress)


def _match(
    film: Film, free: tuple[str, ...], fixed: dict[str, float], variance: Array, length: float | None
) -> Match:
    assert film.u is not None
    own = film.attributes.get("length")
    span = float(film.z[-1] - film.z[0])
    if length is None:
        length = float(own) if own is not None else 1.2 * span
    period = number("length", length, max(span - 1e-9, 0.1), 1e3, "give the period of the cell, in radii")
    if (film.times[-1] - film.times[0]) / DT > LONGEST:
        rule = f"no longer than {LONGEST * DT:g} R/U for a fit of a film"
        raise InputError(
            "the film", f"{film.times[-1] - film.times[0]:.6g} R/U", rule, "take the part that changes"
        )
    grid = CylinderGrid(POINTS, POINTS, period)
    m, q = grid.m, grid.q
    around = np.exp(1j * np.outer(film.theta, m))
    along = np.exp(1j * np.outer(film.z, q))
    first = 2 * np.pi / period
    counts = int(FINEST), int(np.clip(FINEST / first, FEWEST, MOST_WAVES))
    orders = [np.concatenate([np.arange(n + 1), np.arange(1, n + 1)]) for n in counts]
    squares = orders[0][:, None] ** 2 + (orders[1] * first) ** 2
    sigma = np.sqrt(np.maximum(variance, 1e-2 * variance[:, film.seen].mean()))
    return Match(
        grid,
        free,
        {k: v for k, v in fixed.items() if k in (*ORDER, "repulsion_angle")},
        film.times - film.times[0],
        around,
        along,
        film.u[..., film.seen],
        sigma[..., film.seen],
        film.seen,
        (_real_waves(grid.theta, counts[0]), _real_waves(first * grid.z, counts[1])),
        squares,
        squares <= max(FINEST, FEWEST * first) ** 2,
    )


def _real_waves(angle: Array, most: int) -> Array:
    k = np.arange(most + 1)
    return np.concatenate([np.cos(np.outer(angle, k)), np.sin(np.outer(angle, k[1:]))], axis=1)


def _begin(match: Match, problem: Problem, size: float) -> Array:
    """Return unknowns near the film: |P|² P is about u where it was seen, and smooth elsewhere."""
    first = match.data[: min(3, len(match.data))].mean(axis=0)
    P = first / np.maximum(np.hypot(*first), 1e-12) ** (2 / 3)
    # Ridge regression of the window's values on the prior's waves.
    left, right = (
        np.einsum("am,mj->aj", there, np.fft.fft(waves, axis=0, norm="forward")).real
        for there, waves in zip((match.around, match.along), match.waves, strict=True)
    )
    design = np.einsum("am,bn->abmn", left, right)[match.seen][:, match.kept]
    scale = problem.scale(size, WIDTH)[problem.logs :][: design.shape[1]]
    design, ridge = design * scale, 0.05
    solve = np.linalg.solve(design.T @ design / ridge + np.eye(scale.size), design.T @ P.T / ridge)
    return np.concatenate([problem.begin, (scale * solve.T).ravel()])


def _fitted(
    match: Match,
    film: Film,
    names: tuple[str, ...],
    free: tuple[str, ...],
    fixed: dict[str, float],
    noise: float,
    seed: int,
    progress: Callable[[int, int], None] | None,
) -> Fit:
    n = len(free)
    done = [0]

    def told() -> None:
        done[0] += 1
        if progress is not None:
            progress(min(done[0], STAGES), STAGES + 1)

    problem = match.problem()
    # u is about |P|² P, and the film's first frames bound it from above with their noise.
    rms = np.sqrt(2 * np.mean(match.data[:2] ** 2))
    size = float(np.clip(rms, 1e-6, 1.0) ** (1 / 3))
    found = search(problem, _begin(match, problem, size), size, WIDTH, told)
    x = found.x
    ratio = found.chi2 / max(match.data.size - found.effective, 1.0)
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
        {"u": noise},
        {},
        film.scales,
        seed,
        None if len(lost) == n else lambda: _predicted(match, film, x),
    )


def _predicted(match: Match, film: Film, x: Array) -> Any:
    import xarray

    with double():
        P, u = match.fields(jnp.asarray(x), DT)
        there = [
            np.einsum(
                "am,tcmn,bn->tcab", match.around, np.fft.fft2(np.asarray(f), norm="forward"), match.along
            ).real
            for f in (P, u)
        ]
    dims = ("time", "component", "theta", "z")
    coords = {"time": film.times, "component": ["theta", "z"], "theta": film.theta, "z": film.z}
    return xarray.Dataset({"P": (dims, there[0]), "u": (dims, there[1])}, coords)
