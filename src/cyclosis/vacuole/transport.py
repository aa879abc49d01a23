"""A scalar that the flow carries and diffusion spreads: c_t + ∇·(v c) = ∇²c / Pe, over time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..model.grid import Array
from .flow import VacuoleFlow
from .sampled import Sampled, beginning, instants, is_flow, on_points, peclet_number
from .unsteady import UnsteadyFlow
from .walls import Sealed, Wall, pattern_on

if TYPE_CHECKING:
    import xarray

    from .spectral_scalar import ScalarSystem, Space

Start = float | npt.ArrayLike | Callable[[Array, Array, Array], npt.ArrayLike]
COURANT = 2.0
"""Steps are at most this over the fastest rate of advection; the method is stable up to 2.8."""


@shown
@dataclass(frozen=True, eq=False)
class Transport:
    """A scalar over time. All dimensionless: lengths in R, times in R/U, c in the unit of the start.

    Arrays over the times `t`: `mean` and `variance` over the vacuole, `gradient` = <|∇c|²>, `wall_flux`, the
    mean of -c_r over the wall, in units of D c/R (positive outwards), `minimum` and `maximum` on the points,
    and `unresolved`, the share of <c²> in the shortest third of the waves kept. `frames` (n, n_r, n_theta,
    n_z) are c at `frame_times`, `r`, `theta`, `z` the points and `weights` those of the mean over r.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 8, length=5.0)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> run = cy.vacuole.transport(flow, peclet=10.0, wall=cy.vacuole.Absorbing(), t_end=4.0, n_r=12)
        >>> round(float(run.sherwood[-1]), 2)  # 5.78 in the end: uniform walls do not feel a straight flow
        5.78
    """

    t: Array
    mean: Array
    variance: Array
    gradient: Array
    wall_flux: Array
    minimum: Array
    maximum: Array
    unresolved: Array
    frame_times: Array
    frames: Array
    r: Array
    theta: Array
    z: Array
    weights: Array
    peclet: float
    outside: float

    @property
    def sherwood(self) -> Array:
        """2 wall_flux / (mean - mean outside) over time: 2 k R/D with the transfer coefficient k."""
        gap = self.mean - self.outside
        safe = np.where(gap == 0, 1.0, gap)
        return np.where(gap == 0, np.nan, 2 * self.wall_flux / safe)

    def to_dataset(self) -> xarray.Dataset:
        """Return everything as an xarray Dataset, over `t` and over `frame`.

        Example:
            >>> import cyclosis as cy
            >>> grid = cy.CylinderGrid(16, 8, length=5.0)
            >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
            >>> run = cy.vacuole.transport(flow, 10.0, start=lambda r, theta, z: r, t_end=1.0, n_r=8)
            >>> sorted(run.to_dataset().sizes)
            ['frame', 'r', 't', 'theta', 'z']
        """
        import xarray

        names = ("mean", "variance", "gradient", "wall_flux", "minimum", "maximum", "unresolved", "sherwood")
        dims = ("frame", "r", "theta", "z")
        return xarray.Dataset(
            {name: ("t", getattr(self, name)) for name in names}
            | {"c": (dims, self.frames), "weights": ("r", self.weights)},
            coords={
                "t": self.t,
                "frame_time": ("frame", self.frame_times),
                "r": self.r,
                "theta": self.theta,
                "z": self.z,
            },
            attrs={"peclet": self.peclet, "outside": self.outside},
        )


@door
def transport(
    flow: VacuoleFlow | UnsteadyFlow,
    peclet: float,
    wall: Wall = Sealed(),  # noqa: B008  (immutable)
    start: Start = 1.0,
    t_end: float = 10.0,
    times: npt.ArrayLike | None = None,
    frames: npt.ArrayLike | None = None,
    n_r: int = 32,
    shape: tuple[int, int] | None = None,
    dt: float | None = None,
) -> Transport:
    """Return a scalar that begins as `start` and is carried by `flow` until `t_end`.

    c_t + ∇·(v c) = ∇²c / Pe in r < 1, with Pe = `peclet` = U R/D and one of the walls `Sealed`, `Absorbing`,
    `Exchange`, `Held`. `start` is a number, an array (n_r, n_theta, n_z), or a function of r, θ and z that
    takes arrays of these shapes. Points are `n_r` along the radius and `shape`, by default the grid of the
    flow; two thirds of the waves they could show are kept. Quantities are recorded at `times`, 101 by
    default, and c is kept at `frames`, by default the end. Diffusion is exact in time, advection of fourth
    order in steps of `dt`, by default the largest that is safely stable. Dimensionless; raises `InputError`
    for values out of range, and if the result does not stay finite because `dt` is too long.

    Example: dye in one half of the cell, in a sealed vacuole:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16, length=5.0)
        >>> flow = cy.vacuole.flow(grid, cy.flow(cy.Parameters(), grid, cy.initial.stripes(grid)))
        >>> dye = lambda r, theta, z: 1 + np.cos(2 * np.pi * z / 5) + 0 * r * theta
        >>> run = cy.vacuole.transport(flow, peclet=50.0, start=dye, t_end=3.0, n_r=12)
        >>> bool(abs(run.mean - 1).max() < 1e-12), bool(run.variance[-1] < run.variance[0])
        (True, True)
    """
    from ..model.precision import double

    is_flow(flow)
    pe = peclet_number(peclet)
    first, end = beginning(flow, t_end)
    n_r = whole("n_r", n_r, 4, 512, "give the number of points along the radius")
    grid = flow.grid if shape is None else flow.grid.resized(*shape)
    recorded = instants("times", times, first, end, np.linspace(first, end, 101))
    kept = instants("frames", frames, first, end, np.array([end]))
    with double():
        from .spectral_scalar import space

        where = space(grid, n_r, wall.biot if isinstance(wall, Wall) else 0.0)
        sampled = Sampled(flow, on_points(where.functions.r, grid.shape))
        system, outside = equation(where, sampled.window(first, first), pe, wall)
        c = _start(start, where) - np.asarray(system.lift)
        longest = None if dt is None else number("dt", dt, 1e-9, 1e9, "give a step in R/U")
        course = _Course(where, sampled, system, wall, outside, pe)
        return course.follow(c, first, recorded, kept, longest)


def equation(where: Space, window: tuple[Array, Array], pe: float, wall: Wall) -> tuple[ScalarSystem, float]:
    """Return the system, with the frames and times of the velocity, and the mean outside the wall."""
    import jax.numpy as jnp

    from .spectral_scalar import ScalarSystem

    f, grid = where.functions, where.grid
    pattern = pattern_on(wall, grid.theta, grid.z)
    lift = np.zeros((f.r.size, *grid.shape))
    forcing = np.zeros(where.rates.shape, complex)
    if np.isinf(wall.biot) and np.any(pattern):
        lift = where.harmonic(pattern)
    elif wall.biot > 0 and np.any(pattern):
        edge = f.at_wall[np.abs(where.m)].T[:, :, None]
        forcing = 2 * wall.biot / pe * edge * where.spectrum(pattern)
    arrays = (where.rates / pe, forcing, lift, *window)
    return ScalarSystem(where.tables, *(jnp.asarray(one) for one in arrays)), float(pattern.mean())


def fastest(where: Space, velocity: Any) -> float:
    """Return a bound of the fastest rate of advection that the modes can show, in U/R."""
    r = where.functions.r[:, None, None]
    degree = 2 * where.rates.shape[0]
    u = np.abs(np.asarray(velocity)).max(axis=0)
    rate = u[0] * degree / np.sqrt(1 - r**2) + u[1] * np.minimum(where.m_max / r, degree) + u[2] * where.q[-1]
    return max(float(rate.max()), 1e-6)


def _start(start: Start, where: Space) -> Array:
    r, theta, z = where.functions.r[:, None, None], where.grid.theta[:, None], where.grid.z
    shape = (r.size, *where.grid.shape)
    given = start(r, theta, z) if callable(start) else start
    rule = f"a number, an array of shape {shape} (r, theta, z), or a function of r, theta and z"
    remedy = "give the concentration on the points of the transport"
    found = numbers("start", given, rule, remedy)
    try:
        found = np.broadcast_to(found, shape).copy()
    except ValueError as error:
        raise InputError("start", found, rule, remedy) from error
    if not np.all(np.isfinite(found)):
        raise InputError("start", found, "finite everywhere", "remove NaN and infinite entries")
    return found


@dataclass(frozen=True)
class _Course:
    """What a run of a scalar needs at every instant."""

    where: Space
    sampled: Sampled
    system: ScalarSystem
    wall: Wall
    outside: float
    peclet: float

    def follow(self, c: Array, t: float, recorded: Array, kept: Array, longest: float | None) -> Transport:
        """Return the result of following c, without the part that carries the wall's pattern, from time t."""
        import jax.numpy as jnp

        where, end = self.where, max(recorded[-1], kept[-1])
        pattern = pattern_on(self.wall, where.grid.theta, where.grid.z)
        y, rows, frames = jnp.asarray(where.analyse(c)), [], []
        for instant in np.unique(np.concatenate([recorded, kept, self.sampled.breaks(t, end)])):
            if instant > t:
                y = self._advanced(y, t, float(instant), longest)
                t = float(instant)
            modes = np.asarray(y)
            if not np.all(np.isfinite(modes)):
                rule = "short enough for the flow on these points"
                raise InputError("dt", longest, rule, "leave dt out, or give a smaller one")
            if instant in recorded or instant in kept:
                values = where.synthesise(modes) + np.asarray(self.system.lift)
            if instant in recorded:
                rows.append(measures(where, self.wall, pattern, modes, values))
            if instant in kept:
                frames.append(values)
        f, grid = where.functions, where.grid
        return Transport(
            recorded,
            **dict(zip(MEASURES, np.array(rows).T, strict=True)),
            frame_times=kept,
            frames=np.stack(frames),
            r=f.r,
            theta=grid.theta,
            z=grid.z,
            weights=f.weights,
            peclet=self.peclet,
            outside=self.outside,
        )

    def _advanced(self, y: Any, t: float, after: float, longest: float | None) -> Any:
        import jax.numpy as jnp

        velocity, times = self.sampled.window(t, after)
        system = self.system._replace(velocity=jnp.asarray(velocity), times=jnp.asarray(times))
        step = COURANT / fastest(self.where, velocity) if longest is None else longest
        steps = int(np.ceil((after - t) / step - 1e-9))
        return _advance(system, y, t, (after - t) / steps, steps)


MEASURES = ("mean", "variance", "gradient", "wall_flux", "minimum", "maximum", "unresolved")


def measures(where: Space, wall: Wall, pattern: Array, modes: npt.NDArray[Any], values: Array) -> list[float]:
    """Return mean, variance, gradient, wall flux, minimum, maximum and the share of unresolved waves."""
    f = where.functions
    mean = float(f.weights @ values.mean(axis=(1, 2)))
    variance = float(f.weights @ ((values - mean) ** 2).mean(axis=(1, 2)))
    energy = np.abs(modes) ** 2 * where.twice
    gradient = float(np.sum(where.rates * energy))
    axial = modes[:, 0, 0].real
    if np.isinf(wall.biot):
        slopes, waves = where.harmonic_slope(pattern), where.spectrum(pattern)
        gradient += 2 * float(np.sum((np.conj(waves) * slopes).real * where.twice))
        flux = -float(f.wall_slope[0] @ axial + slopes[0, 0].real)
    else:
        edge = np.einsum("mk,kmq->mq", f.at_wall[np.abs(where.m)], modes)
        gradient -= 2 * wall.biot * float(np.sum(np.abs(edge) ** 2 * where.twice))
        flux = wall.biot * (edge[0, 0].real - pattern.mean())
    degree = np.abs(where.m) + 2 * np.arange(modes.shape[0])[:, None]
    short = (degree > 2 / 3 * degree[-1, 0])[:, :, None] | (where.q > 2 / 3 * where.q[-1])
    short = short | (np.abs(where.m)[:, None] > 2 / 3 * where.m_max)
    total = float(energy.sum())
    share = float(energy[short].sum()) / total if total else 0.0
    return [mean, variance, gradient, flux, float(values.min()), float(values.max()), share]


def _advance(system: ScalarSystem, y: Any, t: float, h: float, steps: int) -> Any:
    return _loop()(system, y, t, h, steps)


@cache
def _loop() -> Any:
    import jax

    from ..dynamics.steppers import step, tableau

    @jax.jit
    def loop(system: Any, y: Any, t: Any, h: Any, steps: Any) -> Any:
        coefficients = tableau(system.linear(), h)

        def body(k: Any, now: Any) -> Any:
            after = step(system, coefficients, t + k * h, h, *now)
            return after.spectrum, after.nonlinear

        return jax.lax.fori_loop(0, steps, body, (y, system.nonlinear((y, t))))[0]

    return loop
