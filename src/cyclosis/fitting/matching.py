"""Parameters from a film of u alone: runs from an unknown initial state are matched to it.

The unknowns are the logarithms of the parameters and the Fourier coefficients of P at the first frame. The
cost is half of

    Σ (u_model - u)²/σ² + Σ ξ² + Σ ln²(p/p_0),

with P_k = s_k ξ_k, where s_k falls off beyond the waves that diffusion leaves: that is the smooth prior.
L-BFGS
comes near the minimum, and Gauss-Newton steps with the exact Jacobian, by forward differentiation, end there.
Its inverse gives the intervals: the initial state is integrated out with the parameters' posterior.
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
from .result import ORDER, Direction, Fit

POINTS, DT, MODES = 32, 0.1, 8
"""Points of the model's grid either way, its step in R/U, and the highest waves of the initial state."""
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
SMOOTH = 3.0
"""Waves beyond which the prior of P falls off, as (1 + k²/SMOOTH²)^-2."""
FIRST, SECOND, STEPS = 60, 250, 4
"""Iterations for the initial state alone, for everything, and Gauss-Newton steps."""
LEAST, LONGEST = 4, 400
"""Frames and steps of a film that is matched."""
GOOD = (0.6, 1.5)
"""Values of χ²/N of a model that fits."""
LOST = 0.5
"""Posterior deviation of a logarithm at which the prior, 1, decides."""
SHARE = 24
"""Columns of the Jacobian that are computed together."""


@dataclass(frozen=True, eq=False)
class Match:
    """A film prepared for matching: `names` are the free parameters, in the order of the first unknowns."""

    grid: CylinderGrid
    names: tuple[str, ...]
    fixed: dict[str, float]
    times: Array
    around: Array
    along: Array
    data: Array
    sigma: Array
    seen: npt.NDArray[np.bool_]
    size: Array
    waves: tuple[Array, Array]

    def initial(self, xi: Any) -> Any:
        """Return P (2, n_theta, n_z) of the unknowns (2, 2 MODES + 1, 2 MODES + 1), cosines and sines."""
        left, right = self.waves
        return jnp.einsum("am,cmn,bn->cab", left, self.size * xi, right)

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

    def flow(self, unknowns: Any, frames: int | None = None) -> Any:
        """Return u (n, 2, points) where it was seen, at the first `frames` times."""
        logs, xi = unknowns[: len(self.names)], unknowns[len(self.names) :]
        values = self.values(logs)
        unit = values.pop("U")
        P0 = self.initial(xi.reshape(2, 2 * MODES + 1, 2 * MODES + 1))
        times = self.times[:frames]
        P = traced.rollout(PLAIN, self.grid, P0, times, DT, **values)
        u = jax.vmap(lambda p: traced.flow(PLAIN, self.grid, p, mu=values["mu"]))(P)
        wave = jnp.fft.fft2(u, norm="forward")
        there = jnp.einsum("am,tcmn,bn->tcab", self.around, wave, self.along).real
        return unit * there[..., self.seen]

    def misfit(self, unknowns: Any, frames: int | None = None) -> Any:
        """Return (u_model - u)/σ as one vector."""
        return ((self.flow(unknowns, frames) - self.data[:frames]) / self.sigma).ravel()

    def prior(self, unknowns: Any) -> Any:
        """Return what the prior adds to the vector of the misfit."""
        begin = jnp.log(jnp.array([START[name] for name in self.names]))
        return jnp.concatenate([unknowns[: len(self.names)] - begin, unknowns[len(self.names) :]])


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
    step = span / (film.z.size - 1)
    if length is None:
        length = float(own) if own is not None else 1.2 * span
    period = number("length", length, max(span - 1e-9, 0.1), 1e3, "give the period of the cell, in radii")
    if (film.times[-1] - film.times[0]) / DT > LONGEST:
        rule = f"no longer than {LONGEST * DT:g} R/U for a fit of a film"
        raise InputError(
            "the film", f"{film.times[-1] - film.times[0]:.6g} R/U", rule, "take the part that changes"
        )
    del step
    grid = CylinderGrid(POINTS, POINTS, period)
    m, q = grid.m, grid.q
    around = np.exp(1j * np.outer(film.theta, m))
    along = np.exp(1j * np.outer(film.z, q))
    rms = np.sqrt(np.mean(film.u[:2][..., film.seen] ** 2) * 2)
    size = np.clip(rms, 1e-6, 1.0) ** (1 / 3)
    k2 = np.arange(MODES + 1) ** 2
    both = np.concatenate([k2, k2[1:]])
    square = both[:, None] + both[None, :] * (2 * np.pi / period) ** 2
    fall = (1 + square / SMOOTH**2) ** -2.0
    left, right = _real_waves(grid.theta), _real_waves(2 * np.pi * grid.z / period)
    total = np.einsum("am,mn,bn->ab", left**2, fall**2, right**2).mean()
    fall *= size / np.sqrt(2 * total)
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
        fall,
        (left, right),
    )


def _real_waves(angle: Array) -> Array:
    k = np.arange(MODES + 1)
    return np.concatenate([np.cos(np.outer(angle, k)), np.sin(np.outer(angle, k[1:]))], axis=1)


def _begin(match: Match) -> Array:
    """Return unknowns near the film: |P|² P is about u where it was seen, and smooth elsewhere."""
    n = len(match.names)
    first = match.data[: min(3, len(match.data))].mean(axis=0)
    P = first / np.maximum(np.hypot(*first), 1e-12) ** (2 / 3)
    # Ridge regression of the window's values on the prior's waves.
    left = np.asarray(
        np.einsum("am,mj->aj", match.around, np.fft.fft(match.waves[0], axis=0, norm="forward")).real
    )
    right = np.asarray(
        np.einsum("bn,nj->bj", match.along, np.fft.fft(match.waves[1], axis=0, norm="forward")).real
    )
    design = np.einsum("am,bn,mn->abmn", left, right, match.size)[match.seen].reshape(len(P[0]), -1)
    ridge = 0.05
    solve = np.linalg.solve(design.T @ design / ridge + np.eye(design.shape[1]), design.T @ P.T / ridge)
    return (
        np.concatenate([np.log([START[name] for name in match.names]), solve.T.ravel()])
        if n
        else solve.T.ravel()
    )


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
    from scipy.optimize import minimize

    n = len(free)
    total = FIRST + SECOND + STEPS * 10
    done = [0]

    def told(*_: Any) -> None:
        done[0] += 1
        if progress is not None:
            progress(min(done[0], total), total)

    def cost(x: Any, frames: int | None) -> Any:
        return 0.5 * (match.misfit(x, frames) ** 2).sum() + 0.5 * (match.prior(x) ** 2).sum()

    x = _begin(match)
    few = max(2, min(len(match.times), 4))
    short = jax.jit(jax.value_and_grad(lambda x: cost(x, few)))
    held = np.r_[np.zeros(n), np.ones(x.size - n)]

    def first(x: Array) -> tuple[float, Array]:
        value, slope = short(jnp.asarray(x))
        return float(value), np.asarray(slope) * held

    options = {"maxcor": 30, "maxfun": 10 * FIRST}
    x = minimize(first, x, jac=True, method="L-BFGS-B", callback=told, options=options | {"maxiter": FIRST}).x
    done[0] = FIRST
    whole = jax.jit(jax.value_and_grad(lambda x: cost(x, None)))

    def second(x: Array) -> tuple[float, Array]:
        value, slope = whole(jnp.asarray(x))
        found = float(value)
        return (found, np.asarray(slope)) if np.isfinite(found) else (1e30, np.zeros_like(x))

    options = {"maxcor": 30, "maxfun": 2 * SECOND, "maxiter": SECOND}
    x = minimize(second, x, jac=True, method="L-BFGS-B", callback=told, options=options).x
    done[0] = FIRST + SECOND
    x, hessian, chi2, effective = _newton(match, x, told)
    covariance: Array = np.asarray(np.linalg.inv(hessian)[:n, :n], dtype=np.float64)
    deviation = np.sqrt(np.diag(covariance))
    values = np.exp(x[:n])
    count = match.data.size
    ratio = chi2 / max(count - effective, 1.0)
    logs = dict(zip(free, deviation.tolist(), strict=True))
    found = dict(zip(free, values.tolist(), strict=True))
    lost = [name for name in free if logs[name] > LOST]
    sentence = None
    if not GOOD[0] < ratio < GOOD[1]:
        sentence = (
            f"No run of the model matches this film (chi²/N is {ratio:.3g}, the noise alone gives "
            f"1); take a part "
            "of the film in which streaming appears, and check the geometry."
        )
        lost = list(free)
    elif any(name in names for name in lost):
        told_of = ", ".join(name for name in lost if name in names)
        sentence = f"This film cannot tell {told_of}; film the hours in which streaming appears, or fix them."
    if progress is not None:
        progress(total, total)
    return Fit(
        "film",
        {name: float("nan") if name in lost else found[name] for name in names},
        {
            name: (0.0, float("inf"))
            if name in lost
            else (found[name] * np.exp(-1.96 * logs[name]), found[name] * np.exp(1.96 * logs[name]))
            for name in names
        },
        sentence,
        _by_names(covariance * np.outer(values, values), free, names, lost),
        () if len(lost) == n else _directions(free, covariance),
        float(np.sqrt(np.divide(*np.linalg.eigvalsh(covariance)[[-1, 0]]))) if n else 1.0,
        float(np.sqrt(ratio)),
        fixed,
        {"u": noise},
        {},
        film.scales,
        seed,
        None if len(lost) == n else lambda: _predicted(match, film, x),
    )


def _newton(match: Match, x: Array, told: Callable[..., None]) -> tuple[Array, Array, float, float]:
    """Return the minimum near x, the Gauss-Newton matrix there, χ² and the effective number of unknowns."""
    misfit = jax.jit(match.misfit)
    columns = jax.jit(lambda x, v: jax.vmap(lambda one: jax.jvp(match.misfit, (x,), (one,))[1])(v))

    def cost(x: Array) -> tuple[Array, float]:
        left = np.asarray(misfit(jnp.asarray(x)))
        value = 0.5 * float(left @ left) + 0.5 * float((np.asarray(match.prior(jnp.asarray(x))) ** 2).sum())
        return left, value if np.isfinite(value) else np.inf

    unit = np.eye(x.size)
    left, value = cost(x)
    damping = 0.0
    for _ in range(STEPS):
        J = np.concatenate(
            [
                np.asarray(columns(jnp.asarray(x), jnp.asarray(_padded(unit[k : k + SHARE]))))[: x.size - k]
                for k in range(0, x.size, SHARE)
            ]
        )
        told()
        JJ = J @ J.T
        hessian = JJ + unit
        slope = J @ left + np.asarray(match.prior(jnp.asarray(x)))
        step = -np.linalg.solve(hessian + damping * np.diag(np.diag(JJ)), slope)
        predicted = -float(slope @ step)
        for _ in range(8):
            trial, after = cost(x + step)
            if after < value:
                break
            step = 0.4 * step
        else:
            break
        moved = value - after
        x, left, value = x + step, trial, after
        if predicted < 1e-2 or moved < 1e-3:
            break
    effective = float(np.trace(np.linalg.solve(hessian, JJ)))
    return x, hessian, float(left @ left), effective


def _padded(rows: Array) -> Array:
    """Return rows with zeros below, so that every batch has one shape and is compiled once."""
    return np.concatenate([rows, np.zeros((SHARE - len(rows), rows.shape[1]))])


def _directions(free: tuple[str, ...], covariance: Array) -> tuple[Direction, ...]:
    from .result import directions

    return directions(free, np.ones(len(free)), covariance)


def _by_names(covariance: Array, free: tuple[str, ...], names: tuple[str, ...], lost: list[str]) -> Array:
    at = [free.index(name) for name in names]
    out = covariance[np.ix_(at, at)].copy()
    gone = [k for k, name in enumerate(names) if name in lost]
    out[gone] = np.nan
    out[:, gone] = np.nan
    return out


def _predicted(match: Match, film: Film, x: Array) -> Any:
    import xarray

    with double():
        values = match.values(jnp.asarray(x[: len(match.names)]))
        unit = values.pop("U")
        P0 = match.initial(jnp.asarray(x[len(match.names) :]).reshape(2, 2 * MODES + 1, 2 * MODES + 1))
        P = traced.rollout(PLAIN, match.grid, P0, match.times, DT, **values)
        u = jax.vmap(lambda p: traced.flow(PLAIN, match.grid, p, mu=values["mu"]))(P) * unit
        there = [
            np.einsum(
                "am,tcmn,bn->tcab", match.around, np.fft.fft2(np.asarray(f), norm="forward"), match.along
            ).real
            for f in (P, u)
        ]
    dims = ("time", "component", "theta", "z")
    coords = {"time": film.times, "component": ["theta", "z"], "theta": film.theta, "z": film.z}
    return xarray.Dataset({"P": (dims, there[0]), "u": (dims, there[1])}, coords)
