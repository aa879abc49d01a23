"""Cells by the density of filament angles and by closures of it, from the same random filaments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import models
from ..analysis.regimes import judged
from ..contract.model import Model
from ..dynamics.simulate import simulate
from ..model import initial
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..models.kinetic import angular

RING, SQUARE = CylinderGrid(36, 1), CylinderGrid(32, 32)
"""A cell that varies around its axis only, and a whole one, for the density of angles."""
RING_MODES, SQUARE_MODES = 40, 48
"""Angular modes in each: with 48 the order of a ring differs by 1e-7."""
POLAR_RING, POLAR_SQUARE = CylinderGrid(48, 1), CylinderGrid(48, 48)
"""The same for the polar model, whose zones are narrower."""
AROUND = 48
"""Squares along a ring: it has the noise of the mean over so many squares of 1000 filaments."""
RTOL = 1e-3
OUTCOMES = ("disorder", "around the axis", "one direction", "two stripes", "more stripes", "other")
_OF_REGIME = {
    "disordered": 0,
    "circumferential": 1,
    "unidirectional": 2,
    "cyclosis": 3,
    "multistripe": 4,
}
SMALL = 1e-4
"""Polarity whose growth is measured."""
HALF = 0.5
"""Order at which a cell counts as ordered."""


class End(NamedTuple):
    """What became of a cell: outcome, a number in `OUTCOMES`, and numbers of its last state, dimensionless.

    `order` is <|P|²>^½, `along` <P_z²>^½, `around` <P_theta>, `weakest` min |P|, `speed` max |u|, `when` the
    time at which order passed a half, NaN if it did not; `drift` (around, along) is that of a rigid pattern.
    """

    outcome: float
    order: float
    along: float
    around: float
    weakest: float
    speed: float
    when: float
    drift: float


def is_kinetic(model: Model) -> bool:
    """Whether states of a model are densities of angles."""
    return model.name == models.kinetic.name


def order_of(model: Model, state: Array) -> Array:
    """Return P (2, n_theta, n_z) of a state."""
    return angular.order(state) if is_kinetic(model) else np.asarray(state)


def disordered(model: Model, seed: int, whole: bool) -> tuple[CylinderGrid, Any]:
    """Return the grid and the random state of a `whole` cell or of a ring.

    P of one seed is the same in every model, on one grid of noise.
    """
    kinetic = is_kinetic(model)
    grid = (SQUARE if kinetic else POLAR_SQUARE) if whole else RING if kinetic else POLAR_RING
    filaments = 1000.0 if whole else 1000.0 * AROUND
    noise = SQUARE.shape if whole else RING.shape
    if not kinetic:
        return grid, initial.disordered(grid, filaments, seed, noise)
    return grid, angular.disordered(grid, filaments, seed, noise, SQUARE_MODES if whole else RING_MODES)


def grown(model: Model, values: dict[str, Any], seed: int, t_end: float, whole: bool = False) -> Array:
    """Return the `End`, as an array, of a cell that begins in disorder."""
    grid, state = disordered(model, seed, whole)
    run = simulate(
        Parameters(**values),
        grid,
        state,
        t_end,
        save_every=t_end,
        record_every=1.0,
        rtol=RTOL,
        model=model,
    )
    return np.array(ended(run, model))


def ended(run: Any, model: Model) -> End:
    """Return what became of the cell of a run."""
    assert model.regime is not None
    P = order_of(model, run.frames[-1])
    found = model.regime(model.problem(run.params, run.grid, shape=np.shape(run.frames[-1])), run.frames[-1])
    # Its name without regard to a drift: travelling stripes are stripes.
    name = judged(run.grid, P, np.zeros_like(P)).name
    order = np.asarray(run.records["order"])
    times = np.asarray(run.record_times)
    passed = np.flatnonzero(order >= HALF)[:1]
    return End(
        _OF_REGIME.get(name, 5),
        found.order,
        float(np.sqrt(np.mean(P[1] ** 2))),
        float(P[0].mean()),
        float(np.hypot(*P).min()),
        float(np.asarray(run.records["peak_speed"])[-1]),
        _crossing(times, order, int(passed[0])) if passed.size else np.nan,
        float(found.drift[0]),
    )


def _crossing(times: Array, order: Array, at: int) -> float:
    """Return the time at which order reaches a half, between two records."""
    if at == 0:
        return float(times[0])
    share = (HALF - order[at - 1]) / (order[at] - order[at - 1])
    return float(times[at - 1] + share * (times[at] - times[at - 1]))


def course(
    model: Model, values: dict[str, Any], seed: int, times: Sequence[float]
) -> tuple[Array, Array, Array, Array]:
    """Return the `End` of a whole cell, order and mean |P_theta| at all times, and P at `times`."""
    grid, state = disordered(model, seed, whole=True)
    run = simulate(
        Parameters(**values), grid, state, times[-1], save_at=times, record_every=1.0, rtol=RTOL, model=model
    )
    shown = np.stack([order_of(model, frame) for frame in list(run.frames)[-len(times) :]])
    mean = np.asarray(run.records["mean_P"])
    return np.array(ended(run, model)), np.asarray(run.records["order"]), np.abs(mean[:, 0]), shown


def fading(model: Model, values: dict[str, Any], times: Sequence[float]) -> Array:
    """Return <P_z²>^½ and |<P_theta>| (2, times) of established stripes at later times.

    The stripes have zones in which P turns the same way, as cells from disorder do.
    """
    grid = RING if is_kinetic(model) else POLAR_RING
    P = established(grid)
    state = angular.dressed(P, RING_MODES) if is_kinetic(model) else P
    run = simulate(Parameters(**values), grid, state, times[-1], save_at=times, rtol=RTOL, model=model)
    shown = np.stack([order_of(model, frame) for frame in list(run.frames)[-len(times) :]])
    return np.stack([np.sqrt(np.mean(shown[:, 1] ** 2, axis=(1, 2))), np.abs(shown[:, 0].mean(axis=(1, 2)))])


def established(grid: CylinderGrid) -> Array:
    """Return P (2, n_theta, n_z) of two stripes with |P| = 0.95 outside zones that P turns through."""
    wave = np.sin(grid.theta)[:, None] * np.ones(grid.n_z)
    along = np.tanh(3.0 * wave) / np.tanh(3.0)
    return 0.95 * np.stack([0.5 * (1 - along**2), along])


def growth(model: Model, values: dict[str, Any], direction: int, until: float = 300.0) -> float:
    """Return the rate at which uniform polarity, P_theta (0) or P_z (1), grows in the state without any.

    It is measured over the second half of the time, when slower modes than the fastest have been left behind.
    """
    params, grid = Parameters(**values), CylinderGrid(8, 1)
    P = np.zeros((2, *grid.shape))
    P[direction] = SMALL
    state: Any = P
    if is_kinetic(model):
        state = angular.nematic(params, grid)
        state[1] += P[0] + 1j * P[1]
    run = simulate(
        params, grid, state, until, save_at=(0.5 * until, until), rtol=1e-10, atol=1e-12, model=model
    )
    one, two = (order_of(model, frame)[direction].mean() for frame in list(run.frames)[-2:])
    return float(np.log(two / one) / (0.5 * until))


def threshold(model: Model, values: dict[str, Any], direction: int, near: float) -> float:
    """Return the α_p at which polarity begins to grow, from measured rates on both sides of `near`."""
    sides = np.array([0.98, 1.02]) * near
    rates = [growth(model, values | {"alpha_p": float(side)}, direction) for side in sides]
    return float(sides[0] - rates[0] * (sides[1] - sides[0]) / (rates[1] - rates[0]))
