"""States of one dimension that drift about the axis at constant speed, or are at rest.

    P(theta, t) = P(theta - c t),     dP/dt + c P' = 0 .

At small κ filaments tilt towards the circumference: two tilted stripes, with a mean P_theta, that rotate
as a whole. In a frame that rotates with them they are steady; profile and speed c are found together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import jax
import jax.numpy as jnp
import numpy as np

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.grid import Array, CylinderGrid, interpolate
from ...model.parameters import Parameters
from ...model.precision import on_host
from .reduced import Reduced, reduced
from .steady import relax, rms, steady

if TYPE_CHECKING:
    import xarray

UNRESOLVED = 1e-2
"""A state whose interpolant has a larger |dP/dt + c P'| between its points is refused."""
UPRIGHT = 1e-6
"""Root mean square of P_theta, or of the variation of P, below which stripes are upright, or uniform."""
LENGTH = 5.0
HANDS = ("left", "right")


@shown
@dataclass(frozen=True, eq=False)
class Drifting:
    """A state P(theta) that rotates about the axis at the speed `drift` (positive towards growing theta).

    `theta` (n_theta,) in radians; `P` and `u` (2, n_theta), filament order and flow with components
    (theta, z); `residual` the largest |dP/dt + c P'| of the trigonometric interpolant on twice as many
    points. All dimensionless: lengths in R, speeds in U.

    Example:
        >>> import cyclosis as cy
        >>> found = cy.stability.drifting(cy.Parameters(kappa=0.2), n_theta=32)
        >>> found.P.shape, found.u.shape, dict(found.to_dataset().sizes)
        ((2, 32), (2, 32), {'component': 2, 'theta': 32})
        >>> found.state(cy.CylinderGrid(32, 16)).shape
        (2, 32, 16)
    """

    theta: Array
    P: Array
    u: Array
    drift: float
    residual: float
    params: Parameters

    @door
    def state(self, grid: CylinderGrid) -> Array:
        """Return the state (2, n_theta, n_z) of a whole cell, uniform along it."""
        fine = interpolate(self.P[:, :, None], (grid.n_theta, 1))
        return np.broadcast_to(fine, (2, *grid.shape)).copy()

    def to_dataset(self) -> xarray.Dataset:
        """Return the state as an `xarray.Dataset` over `component` and `theta`."""
        import xarray

        dims = ("component", "theta")
        return xarray.Dataset(
            {"P": (dims, self.P), "u": (dims, self.u)},
            coords={"component": ["theta", "z"], "theta": self.theta},
            attrs={"drift": self.drift, "residual": self.residual}
            | {name: float(value) for name, value in self.params.items()},
        )


@door
def drifting(
    params: Parameters, n_theta: int = 128, hand: str = "right", duration: float = 200.0
) -> Drifting:
    """Return the two tilted stripes that drift about the axis, profile and speed (in U) together.

    `hand` is "right" for a mean P_theta above zero and "left" for its mirror image, which drifts in the
    opposite direction. A standard guess relaxes over `duration` and is completed by Newton's method, so the
    result is stable along theta; others are on the branch through it (`continue_branch`). Raises `InputError`
    for fields, and where stripes do not stay tilted or vanish.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.2)
        >>> right, left = (cy.stability.drifting(params, n_theta=32, hand=hand) for hand in ("right", "left"))
        >>> bool(right.P[0].mean() > 0), bool(abs(right.drift + left.drift) < 1e-9)  # mirror images
        (True, True)
    """
    n = whole("n_theta", n_theta, 16, 8192, "choose a number of points")
    sign = -1 if choice("hand", hand, HANDS) == "left" else 1
    duration = number("duration", duration, 0.0, 1e6, "the default is 200")
    for name, value in params.items():
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a drifting state", "simulate a cell instead")
    problem = reduced(params, CylinderGrid(n, 8, LENGTH))
    theta = problem.turn / n * np.arange(n)
    guess = np.concatenate([np.full(n, 0.5 * sign), 0.8 * np.tanh(3 * np.sin(theta))])
    found = steady(problem, relax(problem, guess, duration).y)
    if found is None:
        raise _none(params, "the stripes reach no steady drift; try a longer duration")
    both = found.y.reshape(2, n)
    if rms(found.y - np.repeat(both.mean(axis=1), n)) < UPRIGHT:
        raise _none(params, "the stripes relax to a uniform state")
    if np.sqrt(np.mean(both[0] ** 2)) < UPRIGHT:
        raise _none(params, "the stripes straighten and stop: see cyclosis(params)")
    state = drifting_state(problem, params, found.y, found.drift)
    if state.residual > UNRESOLVED:
        rule = f"enough to resolve the zones between stripes (|dP/dt| is {state.residual:.1g} between points)"
        raise InputError("n_theta", n, rule, "double it")
    return state


def drifting_state(problem: Reduced, params: Parameters, y: Array, drift: float) -> Drifting:
    """Return the `Drifting` of a solution y (2n,) of a reduced equation along theta."""
    n = problem.n
    theta = np.asarray(problem.turn / n * np.arange(n), dtype=np.float64)
    left = between(reduced(params, CylinderGrid(2 * n, 8, LENGTH)), y, drift)
    return Drifting(theta, y.reshape(2, n), flow(problem, y), drift, left, params)


def flow(problem: Reduced, y: Array) -> Array:
    """Return the flow (2, n) that a state y (2n,) drives."""
    with on_host():
        return np.asarray(_flow(problem.line, y))


def between(finer: Reduced, y: Array, drift: float) -> float:
    """Return the largest |dP/dt + c P'| of the interpolant of y on the points of a finer equation."""
    filled = interpolate(y.reshape(2, -1, 1), (finer.n, 1)).ravel()
    left = finer.rate(filled) + drift * finer.slope(filled)
    return float(np.hypot(*left.reshape(2, -1)).max())


@jax.jit
def _flow(line: object, y: jax.Array) -> jax.Array:
    n = y.size // 2
    packed = jnp.fft.fft2(jax.lax.complex(y[:n], y[n:]).reshape(line.space.shape))  # type: ignore[attr-defined]
    u = jnp.fft.ifft2(line.at(packed).flow_spectrum).ravel()  # type: ignore[attr-defined]
    return jnp.stack([u.real, u.imag])


def _none(params: Parameters, why: str) -> InputError:
    point = ", ".join(f"{name} = {getattr(params, name):g}" for name in ("alpha_p", "alpha_u", "kappa"))
    return InputError(
        "the parameter point", point, f"where tilted stripes drift, and {why}", "change kappa or alpha_u"
    )
