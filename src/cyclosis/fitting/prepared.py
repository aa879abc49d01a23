"""A film prepared for matching: what is compared with runs, and with which noise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..model.errors import InputError, number
from ..model.grid import Array, CylinderGrid
from .compared import Arrays, Layout, columns, misfit
from .film import Film
from .noise import left, shared, size, variance
from .problem import Mask, Problem
from .result import ORDER
from .search import NARROW, WIDTH
from .windows import Window, averaging

POINTS, DT, COARSE = 32, 0.125, 0.5
"""Points of the model's grid either way, and its longest steps in R/U for the misfit and for its slopes."""
QUICK = 2.0
"""Largest step of the slopes times the largest rate."""
SHORTEST = 1 / 64
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
SEEN = 0.04, 0.08, 0.16, 0.02
"""Shares of the largest rms of u from which it counts as seen, start by start."""
ACROSS, ALONG = (0.2, 0.6), 1.6
"""rms of the components of P when u is seen, as shares of what u alone shows, the first start by start:
repulsion has damped it or not, and streams against each other, or that diverge, do not show in u."""
APART = 0.5
"""Standard deviation by which later starts are shifted, as a share of the prior's. With less they end in the
same basin as the first."""
RIDGE = 0.05
"""Variance that is left of the first state where u is first seen."""
SHARE = 24
"""Columns of the Jacobian that are computed together."""
MOST = 200_000
"""Values of a film that are compared; of more, every second or third frame is left out."""
LONGEST = 400
"""Most steps of a film that is matched."""


@dataclass(frozen=True, eq=False)
class Match:
    """A film prepared for matching.

    `squares` are k² of the waves of the initial state that are used, `share` the number of vectors that count
    as one, by field, `peaks` the largest size of each field, and `shapes` those of the film's arrays. `age`
    is the time from the first frame to that in which u is first seen.
    """

    layout: Layout
    arrays: Arrays
    squares: Array
    share: dict[str, float]
    peaks: dict[str, float]
    shapes: dict[str, tuple[int, ...]]
    age: float = 0.0

    @property
    def sizes(self) -> dict[str, int]:
        """The number of values of each field."""
        return {name: int(self.arrays.data[name].size) for name in self.layout.fields}

    def problem(self) -> Problem:
        """Return what `search` minimises."""
        layout, arrays = self.layout, self.arrays
        single = jax.tree.map(_single, arrays)
        n = len(layout.free)

        last: list[Any] = []
        shortest = [DT]

        def stepped(x: Array) -> float:
            # It never grows again, so that what is minimised does not change back and forth.
            shortest[0] = self.step(x, shortest[0], QUICK * DT / COARSE)
            return shortest[0]

        def jacobian(x: Array, used: Mask) -> Array:
            if last and np.array_equal(last[0], x) and np.array_equal(last[1], used):
                return last[2]  # the next stage begins where one ended
            columns_of = np.flatnonzero(used)
            unit = np.zeros((-(-columns_of.size // SHARE) * SHARE, x.size), np.float32)
            unit[np.arange(columns_of.size), columns_of] = 1.0
            at, dt = jnp.asarray(x, jnp.float32), stepped(x) * COARSE / DT
            shares = [
                columns(layout, single, at, unit[k : k + SHARE], dt, "float32")
                for k in range(0, len(unit), SHARE)
            ]
            slopes: Any = np.zeros((x.size, sum(self.sizes.values())), np.float32)
            slopes[columns_of] = np.concatenate([np.asarray(share) for share in shares])[: columns_of.size]
            last[:] = x, used, slopes
            return np.asarray(slopes)

        mean = [np.mean(wave**2, axis=0) for wave in arrays.waves]
        peaks = [self.peaks[name] / np.asarray(arrays.sigma[name]) for name in layout.fields]
        kept = arrays.kept
        times = np.array(layout.times) - self.age
        return Problem(
            lambda x: np.asarray(misfit(layout, arrays, x, stepped(x), "float64")),
            jacobian,
            np.log([START[name] for name in layout.free[:n]]),
            np.tile(self.squares, 2),
            np.tile(mean[0][kept[0]] * mean[1][kept[1]], 2),
            np.repeat([0, 1], self.squares.size),
            np.concatenate(peaks),
            np.concatenate(
                [
                    times[np.asarray(arrays.at[name]) // int(np.prod(self.shapes[name][1:]))]
                    for name in layout.fields
                ]
            ),
            np.concatenate([np.full(size, self.share[name]) for name, size in self.sizes.items()]),
            self.growth,
        )

    def growth(self, logs: Array) -> tuple[Array, Array]:
        """Return what disorder grows by up to the age, as exponents of all waves, and their slopes."""
        given = self._values(logs)
        along = given.get("repulsion_angle", 0.0)
        across = np.repeat([np.cos(along) ** 2, np.sin(along) ** 2], self.squares.size)
        ones = np.ones(across.size)
        terms = {"alpha_p": ones, "d_r": -ones, "kappa": -across, "d_s": -np.tile(self.squares, 2)}
        terms = {name: given[name] * given["U"] * self.age * term for name, term in terms.items()}
        whole: Array = np.sum(list(terms.values()), axis=0)
        terms["U"] = whole
        slopes = np.array([terms.get(name, np.zeros(across.size)) for name in self.layout.free])
        return whole, slopes.reshape(len(self.layout.free), across.size)

    def _values(self, logs: Array) -> dict[str, Any]:
        """Return all parameters by name, kept from numbers that overflow."""
        given = dict(zip(self.layout.fixed, self.arrays.fixed, strict=True))
        return given | dict(zip(self.layout.free, np.exp(np.clip(logs, -20, 20)), strict=True))

    def step(self, x: Array, longest: float, quick: float) -> float:
        """Return a step in R/U that the rates of some parameters allow, from a ladder of halves."""
        given = self._values(x[: len(self.layout.free)])
        rate = 2 * given["U"] * (given["alpha_p"] + given["alpha_u"])
        while longest * rate > quick and longest > SHORTEST:
            longest /= 2
        return longest

    def quieter(self, x_left: Array, taken: float) -> tuple[Match, float]:
        """Return the same film with the noise that a run leaves, and by how much that is smaller.

        `taken` is the share of the values that the unknowns do not take.
        """
        sigma, share, least = {}, {}, np.inf
        for name, part in self.parts(x_left).items():
            before = np.asarray(self.arrays.sigma[name])
            field = np.full(self.shapes[name], np.nan)
            field.flat[self.arrays.at[name]] = part * before
            share[name] = shared(field)
            spread = np.broadcast_to(np.sqrt(share[name] * size(field) / taken), field.shape)
            sigma[name] = spread.flat[self.arrays.at[name]]
            unshared = before / np.sqrt(self.share[name])
            least = min(least, float(np.sqrt(np.mean(size(field)) / taken / np.mean(unshared**2))))
        return replace(self, arrays=self.arrays._replace(sigma=sigma), share=share), 1 / least

    def parts(self, left: Array) -> dict[str, Array]:
        """Return what is left of each field."""
        ends = np.cumsum(list(self.sizes.values()))[:-1]
        return dict(zip(self.layout.fields, np.split(left, ends), strict=True))


def _single(array: Any) -> Any:
    kind = np.asarray(array).dtype.kind
    return jnp.asarray(array, {"f": jnp.float32, "c": jnp.complex64, "i": jnp.int32}[kind])


def prepared(
    film: Film,
    free: tuple[str, ...],
    fixed: dict[str, float],
    length: float | None,
    window: Window | None,
) -> Match:
    """Return the `Match` of a film; `length` is the period of the cell, in radii.

    Raises `InputError` if the film is too long, or longer than the cell.
    """
    assert film.u is not None
    own = film.attributes.get("length")
    span = float(film.z[-1] - film.z[0])
    if length is None:
        length = float(own) if own is not None else 1.2 * span
    remedy = f"give the period of the cell, in radii; {span:.3g} of them were measured along it"
    period = number("length", length, max(span - 1e-9, 0.1), 1e3, remedy)
    if (film.times[-1] - film.times[0]) / DT > LONGEST:
        rule = f"no longer than {LONGEST * DT:g} R/U for a fit of a film"
        raise InputError(
            "the film", f"{film.times[-1] - film.times[0]:.6g} R/U", rule, "take the part that changes"
        )
    grid = CylinderGrid(POINTS, POINTS, period)
    first = 2 * np.pi / period
    counts = int(FINEST), int(np.clip(FINEST / first, FEWEST, MOST_WAVES))
    orders = [np.concatenate([np.arange(n + 1), np.arange(1, n + 1)]) for n in counts]
    squares = orders[0][:, None] ** 2 + (orders[1] * first) ** 2
    kept = np.nonzero(squares <= max(FINEST, FEWEST * first) ** 2)
    q = first * np.arange(POINTS // 2 + 1, dtype=np.float64)
    given = {name: value for name, value in fixed.items() if name in (*ORDER, "repulsion_angle")}
    known, data, sigma, share, peaks, shapes = _measured(film)
    layout = Layout(
        grid,
        free,
        tuple(given),
        tuple((film.times - film.times[0]).tolist()),
        tuple(data),
    )
    arrays = Arrays(
        np.array(list(given.values()), np.float64),
        (_real_waves(grid.theta, counts[0]), _real_waves(first * grid.z, counts[1])),
        (kept[0].astype(np.int32), kept[1].astype(np.int32)),
        averaging(window, film.theta, film.facing, grid.m, q),
        np.exp(1j * np.outer(film.theta, grid.m)),
        np.exp(1j * np.outer(film.z, q)),
        data,
        sigma,
        known,
    )
    return Match(layout, arrays, squares[kept], share, peaks, shapes)


def _measured(film: Film) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return places, values, deviations, vectors that count as one, peaks and shapes, by field."""
    at, data, sigma, share, peaks, shapes = {}, {}, {}, {}, {}, {}
    used = np.zeros(film.frames, bool)
    values = sum(2 * film.known.sum() for field in (film.u, film.P) if field is not None)
    used[:: max(1, int(np.ceil(values / MOST)))] = True
    for name, field in (("u", film.u), ("P", film.P), ("angle", film.angle)):
        if field is None:
            continue
        known, values = film.known, field
        if name == "angle":
            known = np.isfinite(field)
            values = np.where(known, field, 0.0)
            doubled = np.stack([np.cos(2 * values), np.sin(2 * values)], axis=1)
            noise, peaks[name] = left(doubled, film.times, known), 1.0
            power = variance(noise, doubled).sum(axis=0) / 4
        else:
            known = np.broadcast_to(known[:, None], field.shape)
            noise, peaks[name] = left(field, film.times, film.known), peak(field, film.known)
            power = variance(noise, field)
        share[name] = shared(noise)
        shapes[name] = field.shape
        power = np.maximum(power, 1e-2 * power[..., film.known.any(axis=0)].mean())
        chosen = known & used.reshape(-1, *[1] * (field.ndim - 1))
        at[name] = np.flatnonzero(chosen).astype(np.int32)
        data[name] = values[chosen]
        spread = np.sqrt(share[name] * np.maximum(power, 1e-300))
        sigma[name] = np.broadcast_to(spread, field.shape)[chosen]
    return at, data, sigma, share, peaks, shapes


def _real_waves(angle: Array, most: int) -> Array:
    k = np.arange(most + 1)
    return np.concatenate([np.cos(np.outer(angle, k)), np.sin(np.outer(angle, k[1:]))], axis=1)


def peak(field: Array, known: npt.NDArray[np.bool_]) -> float:
    """Return the largest size of a field (n, 2, n_theta, n_z), apart from outliers."""
    return float(np.quantile(np.sqrt((field**2).sum(axis=1))[known], 0.999))


def _seen_at(film: Film, share: float) -> int:
    """Return the first frame in which u is seen; 0 if P was measured, too."""
    if film.P is not None or film.u is None:
        return 0
    pairs = zip(film.u, film.known, strict=True)
    square = np.array([np.mean(u[:, known] ** 2) if known.any() else 0.0 for u, known in pairs])
    return int(np.argmax(square >= share**2 * square.max()))


def begin(match: Match, film: Film, start: int, seed: int) -> tuple[Match, Array, Array]:
    """Return where one of several searches begins: the film from another age on, y there, and sizes of P.

    |P|² P is about u where it was seen, and smooth elsewhere. All but the first two are shifted by chance.
    """
    assert film.u is not None
    at = _seen_at(film, SEEN[start % len(SEEN)])
    match = replace(match, age=float(film.times[at] - film.times[0]))
    problem, arrays = match.problem(), match.arrays
    early = slice(max(at - 1, 0), at + 2)
    count = film.known[early].sum(axis=0)
    seen = count > 0
    mean = np.where(film.known[early][:, None], film.u[early], 0.0).sum(axis=0)[:, seen] / count[seen]
    P = mean / np.maximum(np.hypot(*mean), 1e-12) ** (2 / 3)
    if film.angle is not None:
        along = np.stack([np.sin(film.angle[at]), np.cos(film.angle[at])])[:, seen]
        along = along * np.sign((along * mean).sum(axis=0))
        P = np.where(np.isfinite(along), np.hypot(*P) * along, P)
    sizes = np.array([ACROSS[start % len(ACROSS)], ALONG])
    if film.P is not None:
        P = np.where(film.known[early][:, None], film.P[early], 0.0).sum(axis=0)[:, seen] / count[seen]
        sizes = np.ones(2)
    sizes = sizes * np.clip(np.sqrt(np.mean((P**2).sum(axis=0))), 0.01, 1.0)
    # Ridge regression of the window's values on the prior's waves.
    orders = [(wave.shape[1] - 1) // 2 for wave in arrays.waves]
    left = _real_waves(film.theta, orders[0])
    right = _real_waves(2 * np.pi / match.layout.grid.length * film.z, orders[1])
    design = (left[:, None, arrays.kept[0]] * right[None, :, arrays.kept[1]])[seen]
    y, prior = [problem.begin], problem.scale(sizes, WIDTH)
    prior[: problem.logs] = NARROW
    for scale, along in zip(np.split(prior[problem.logs :], 2), P, strict=True):
        waves = design * scale
        y.append(scale * np.linalg.solve(waves.T @ waves + RIDGE * np.eye(scale.size), waves.T @ along))
    shift = APART * prior * np.random.default_rng([seed, start]).normal(size=prior.size) if start > 1 else 0.0
    return match, np.concatenate(y) + shift, sizes
