"""Wounds of an established cell: how order comes back in a disc of fragmented filaments."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import scipy.integrate

from ..analysis.zones import DISORDER, crossings
from ..dynamics.protocol import Protocol, Step, change, fragment
from ..dynamics.simulate import simulate
from ..dynamics.trajectory import Trajectory
from ..model import initial, regions
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from .recovery import rising
from .survivors import wrapped

GRID = CylinderGrid(48, 48, 5.0)
MIDDLE = 0.5 * GRID.length
SETTLING, BEGIN = 20.0, 1.0
"""Time that stripes settle before, and the time at which the cell is wounded."""
SINCE = np.concatenate([np.arange(0.0, 8.0, 0.25), np.arange(8.0, 20.0, 1.0), [20.0, 30.0, 45.0, 60.0]])
"""Times since the wound at which it is looked at."""
HEALED = 0.9
"""Order inside, along that of a cell without the wound and relative to it, from which on it is healed."""
DRUGS = ("none", "everywhere", "in the wound")
"""Where bundling is inhibited, from the time of the wound on."""
MEASURES = ("healed after", "fall", "coherence", "shift", "stripes", "order left")


@cache
def established() -> Array:
    """Return two stripes (2, n_theta, n_z) as they stream with the paper's parameters."""
    run = simulate(Parameters(), GRID, initial.stripes(GRID), SETTLING, save_at=(SETTLING,), rtol=1e-3)
    return run.final_state


def place(seed: int) -> float:
    """Return the angle of the wound of a seed, anywhere around the cell."""
    return float(np.random.default_rng((seed, 1)).uniform(0, 2 * np.pi))


def wounded(seed: int, radius: float, drug: str, theta: float | None = None) -> Trajectory:
    """Run an established cell with a wound of a radius, at its seed's angle unless `theta` is given."""
    disc = regions.disc(place(seed) if theta is None else theta, MIDDLE, radius)
    return _run([fragment(BEGIN, where=disc)], disc, drug, seed)


@cache
def _unwounded(drug: str, seed: int, radius: float) -> Trajectory:
    return _run([], regions.disc(place(seed), MIDDLE, radius), drug, seed)


def _run(steps: list[Step], disc: regions.Region, drug: str, seed: int) -> Trajectory:
    if drug == "everywhere":
        steps = [change(BEGIN, alpha_p=0.0), *steps]
    elif drug == "in the wound":
        steps = [change(BEGIN, alpha_p=0.0, where=disc), *steps]
    protocol = Protocol(*steps, seed=seed)
    times = [0.5 * BEGIN, *(BEGIN + SINCE)]
    return simulate(Parameters(), GRID, established(), times[-1], save_at=times, rtol=1e-3, protocol=protocol)


def healing(seed: int, radius: float, drug: str) -> Array:
    """Return `MEASURES` of a wound, then the course of order along that without it, over `SINCE`.

    Without the drug the cell without a wound stays as it is; else it is run beside, so that what the drug
    does by itself is no part of the answer.
    """
    run = wounded(seed, radius, drug)
    inside = regions.disc(place(seed), MIDDLE, radius).mask(GRID)
    states = np.stack([run.frames[k] for k in _looked_at(run)])
    if drug == "none":
        control = np.broadcast_to(established(), states.shape)
    else:
        # Everywhere, it is the same for all seeds and sizes.
        same = _unwounded(drug, *((0, 1.0) if drug == "everywhere" else (seed, radius)))
        control = np.stack([same.frames[k] for k in _looked_at(same)])
    along = np.sum(states * control, axis=1)[:, inside].mean(axis=1)
    usual = np.sum(control**2, axis=1)[:, inside].mean(axis=1)
    own = np.sum(states**2, axis=1)[:, inside].mean(axis=1)
    course = along / usual
    shift = wrapped(rising(states[-1, 1].mean(axis=1)) - rising(control[-1, 1].mean(axis=1)))
    two = striped(states[-1])
    fall = float(np.max(np.maximum.accumulate(course) - course))
    half = int(np.argmax(own >= 0.25 * usual)) if (own >= 0.25 * usual).any() else -1
    coherence = float(along[half] / np.sqrt(own[half] * usual[half]))
    measured = (healed_after(SINCE, course), fall, coherence, float(shift), float(two), float(course[-1]))
    return np.array([*measured, *course])


def striped(state: Array) -> bool:
    """Return whether every circle around the cell is crossed by two zones, of an ordered state."""
    return bool(np.all(crossings(state) == 2) and np.sqrt(np.mean(np.sum(state**2, axis=0))) >= DISORDER)


def _looked_at(run: Trajectory) -> npt.NDArray[np.int64]:
    return np.searchsorted(run.times, BEGIN + SINCE - 1e-6)


def healed_after(times: npt.ArrayLike, course: npt.ArrayLike) -> float:
    """Return the time since which a course (n,) is at least `HEALED`, between those given; NaN if never."""
    t, order = np.asarray(times, dtype=np.float64), np.asarray(course, dtype=np.float64)
    low = np.flatnonzero(order < HEALED)
    if low.size == 0:
        return float(t[0])
    k = int(low[-1])
    if k + 1 == t.size:
        return np.nan
    return float(t[k] + (HEALED - order[k]) * (t[k + 1] - t[k]) / (order[k + 1] - order[k]))


def by_old_flow(radius: float, seeds: int) -> float:
    """Return the median time, over the places of seeds, in which the flow of before would heal wounds.

    Each point inside by itself, without diffusion: dP/dt = -d_r P + (1 - P²)(α_p P + α_u u) from P = 0, with
    the flow u that the cell has without a wound.
    """
    params, state = Parameters(), established()
    u, old = flow(params, GRID, state)[1].mean(axis=1), state[1].mean(axis=1)

    def rate(t: float, P: Array) -> Array:
        return np.asarray(-params.d_r * P + (1 - P**2) * (params.alpha_p * P + params.alpha_u * u))

    P = scipy.integrate.solve_ivp(
        rate, (0.0, SINCE[-1]), np.zeros(GRID.n_theta), t_eval=SINCE, rtol=1e-6, atol=1e-9
    ).y
    times = []
    for seed in range(seeds):
        weight = regions.disc(place(seed), MIDDLE, radius).mask(GRID).sum(axis=1)
        times.append(healed_after(SINCE, (weight * old) @ P / (weight @ old**2)))
    return float(np.median(times))
