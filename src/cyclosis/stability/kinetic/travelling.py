"""States of the kinetic model that do not vary along the cell and travel around it, or are at rest.

    Ψ(θ, φ, t) = Ψ(θ - V t, φ),     dm_n/dt + V dm_n/dθ = 0 .

From disorder cyclosis ends in such a state: two stripes whose polarity turns through the circumference, in
the same direction at either boundary, so that filaments keep a mean P_theta and all of it drifts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ...models.kinetic.angular import MODES, MOST_MODES, density, dressed, order
from ..profiles.travelling import HANDS, LENGTH
from .line import Complex, Line
from .modes import KineticModes, modes
from .newton import largest, residual, size, travelling
from .torques import with_torques

if TYPE_CHECKING:
    import xarray

POINTS = 64
UNIFORM = 1e-6
"""Root mean square of what varies of P, or of P itself, below which a state is uniform, or not polar."""


@shown
@dataclass(frozen=True, eq=False)
class TravellingState:
    """A state of the kinetic model that travels around the axis at the speed `drift`, dimensionless.

    `theta` (n_theta,) in radians; `moments` (N + 1, n_theta), complex, with m_0 = 1; `P` and `u`
    (2, n_theta) with components (theta, z); `drift` in U, positive towards growing theta. `residual` is the
    largest |dm_n/dt + V dm_n/dθ| at the points, `between` that of the interpolant on twice as many points
    with two more moments: how well the state is resolved. `torques` is the convention for `params`.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.1, d_r=0.1, d_s=0.05)
        >>> found = cy.kinetic.travelling_state(params, n_theta=16, modes=12)
        >>> found.moments.shape, found.P.shape, found.u.shape, found.density(64).shape
        ((13, 16), (2, 16), (2, 16), (16, 64))
        >>> found.state(cy.CylinderGrid(32, 16)).shape, dict(found.to_dataset().sizes)["moment"]
        ((13, 32, 16), 13)
        >>> round(found.drift, 4), round(found.mirrored.drift, 4), found.at([0.0, 1.0])[0].shape
        (0.011, -0.011, (2, 2))
        >>> found.growth_rates(3).real.round(4) + 0.0, found.spectrum(3).stable  # 0: its rotation
        (array([ 0.    , -0.0274, -0.23  ]), True)
    """

    theta: Array
    moments: Complex
    P: Array
    u: Array
    drift: float
    residual: float
    between: float
    params: Parameters
    torques: str

    @property
    def mirrored(self) -> TravellingState:
        """The mirror image (theta -> -theta), which travels the other way."""
        sign = (-1.0) ** np.arange(len(self.moments))[:, None]

        def turned(values: Any) -> Any:
            return np.roll(values[:, ::-1], 1, axis=1)

        moments, flip = sign * np.conj(turned(self.moments)), np.array([[-1.0], [1.0]])
        P, u = flip * turned(self.P), flip * turned(self.u)
        kept = (self.residual, self.between, self.params, self.torques)
        return TravellingState(self.theta, moments, P, u, -self.drift, *kept)

    def state(self, grid: CylinderGrid) -> Complex:
        """Return the moments (N + 1, n_theta, n_z) of a whole cell, uniform along it."""
        line = self._line
        there = Line(line.params, grid.n_theta, line.modes)
        m = there.moments(line.resampled(there, line.state(self.moments)))
        return np.broadcast_to(m[:, :, None], (len(m), *grid.shape)).copy()

    def density(self, angles: int | None = None) -> Array:
        """Return the density Ψ (n_theta, angles) on equally spaced angles φ from 0; by default 2N + 2."""
        return density(self.moments[:, :, None], angles)[:, 0]

    def at(self, theta: Any) -> tuple[Array, Array]:
        """Return P and u, (2, many) each, between the points, at angles (many,) in radians."""
        waves = np.exp(1j * np.outer(np.asarray(theta), self._line.k))
        seen = self._line.waves.conj().T / self.theta.size
        p, u = (waves @ (seen @ (both[0] + 1j * both[1])) for both in (self.P, self.u))
        return np.stack([p.real, p.imag]), np.stack([u.real, u.imag])

    @door
    def spectrum(self, count: int = 8, axial_mode: int = 0, length: float = LENGTH) -> KineticModes:
        """Return the `count` leading `KineticModes`, with `axial_mode` waves along a cell of a `length`.

        Growth rates are in the frame of the state; a wave's is the same in the cell's frame. Raises
        `InputError` for settings out of range.
        """
        j = whole("axial_mode", axial_mode, -4000, 4000, "the default is 0")
        length = number("length", length, 1e-6, 1e4, "the default is 5")
        line = self._line
        return modes(line, line.state(self.moments), self.drift, 2 * np.pi * j / length, count)

    @door
    def growth_rates(self, count: int = 8, axial_mode: int = 0, length: float = LENGTH) -> Complex:
        """Return the eigenvalues (count,) of `spectrum`."""
        return self.spectrum(count, axial_mode, length).eigenvalues

    def to_dataset(self) -> xarray.Dataset:
        """Return the state as an `xarray.Dataset`, moments in real and imaginary parts."""
        import xarray

        dims = ("component", "theta")
        parts = np.stack([self.moments.real, self.moments.imag])
        return xarray.Dataset(
            {"P": (dims, self.P), "u": (dims, self.u), "moments": (("part", "moment", "theta"), parts)},
            coords={
                "component": ["theta", "z"],
                "theta": self.theta,
                "part": ["real", "imaginary"],
                "moment": np.arange(len(self.moments)),
            },
            attrs={"drift": self.drift, "residual": self.residual, "between": self.between}
            | {"torques": self.torques}
            | {name: float(value) for name, value in self.params.items()},
        )

    @property
    def _line(self) -> Line:
        scaled = with_torques(self.params, self.torques)
        return Line(scaled, self.theta.size, len(self.moments) - 1)


@door
def travelling_state(
    params: Parameters,
    n_theta: int = POINTS,
    modes: int = MODES,
    torques: str = "literal",
    hand: str = "right",
    start: Any = None,
    duration: float = 60.0,
) -> TravellingState:
    """Return the `TravellingState` that two stripes relax to, state and drift together.

    Stripes tilted to the `hand` relax over `duration` and Newton's method completes them to
    |dm_n/dt + V dm_n/dθ| < 1e-11. `hand` is "right" for a mean P_theta above zero and "left" for its mirror
    image, which travels the other way. `start` replaces the stripes: a `TravellingState`, from which
    Newton's method starts at once, so that also an unstable state is found; or moments (N + 1, n_theta) or
    (N + 1, n_theta, n_z), uniform along z. Raises `InputError` for fields, without rotational diffusion, and
    where no such state is found.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=1.0, alpha_u=0.5, kappa=0.1, d_r=0.1, d_s=0.05)
        >>> right = cy.kinetic.travelling_state(params, n_theta=16, modes=12)
        >>> left = cy.kinetic.travelling_state(params, n_theta=16, modes=12, hand="left")
        >>> bool(right.P[0].mean() > 0), bool(abs(right.drift + left.drift) < 1e-9), right.residual < 1e-11
        (True, True, True)
    """
    scaled = with_torques(params, torques)
    n = whole("n_theta", n_theta, 16, 1024, f"the default is {POINTS}")
    line = Line(scaled, n, whole("modes", modes, 3, MOST_MODES, f"the default is {MODES}"))
    hand = choice("hand", hand, HANDS)
    duration = number("duration", duration, 0.0, 1e6, "the default is 60")
    drift = 0.0
    if isinstance(start, TravellingState):
        a, drift = start._line.resampled(line, start._line.state(start.moments)), start.drift
    else:
        guess = stripes(line, hand) if start is None else _given(start)
        there = line if start is None else Line(scaled, guess.shape[1], line.modes)
        a = line.relaxed(there.resampled(line, there.state(guess)), duration)
    return completed(line, a, drift, params, torques)


def completed(line: Line, a: Complex, drift: float, params: Parameters, torques: str) -> TravellingState:
    """Return the travelling state next to a state (N, p), or refuse what is none."""
    if size(a[0]) < UNIFORM:
        raise _none(params, "filaments do not stay polarised")
    found = travelling(line, a, drift or _speed(line, a)) if varying(line, a) > UNIFORM else None
    if varying(line, a if found is None else found.a) <= UNIFORM:
        raise _none(params, "the stripes relax to a uniform state")
    if found is None:
        raise _none(params, "the state has not settled; try a longer duration or more points or modes")
    return value(line, found.a, found.drift, found.residual, params, torques)


def value(
    line: Line, a: Complex, drift: float, left: float, params: Parameters, torques: str
) -> TravellingState:
    """Return the `TravellingState` of a solution a (N, p)."""
    m = line.moments(a)
    finer = Line(line.params, 2 * line.n, line.modes + 2)
    between = largest(finer, residual(finer, line.resampled(finer, a), drift))
    P = order(m[:, :, None])[:, :, 0]
    return TravellingState(line.theta, m, P, line.flow(a), drift, left, between, params, torques)


def varying(line: Line, a: Complex) -> float:
    """Return the root mean square of what varies of P."""
    return size(np.where(line.k == 0, 0.0, a[0]))


def stripes(line: Line, hand: str) -> Complex:
    """Return moments (N + 1, n) of two stripes whose filaments tilt to one side."""
    P = np.stack([np.full(line.n, 0.3), 0.8 * np.tanh(3 * np.sin(line.theta))])
    P[0] *= -1 if hand == "left" else 1
    return dressed(P[:, :, None], line.modes)[:, :, 0]


def _speed(line: Line, a: Complex) -> float:
    """Return the drift that fits a state best."""
    slope = line.slope(a)
    return float(-np.vdot(slope, line.rate(a)).real / np.vdot(slope, slope).real)


def _given(start: Any) -> Complex:
    rule = "a TravellingState or moments (N + 1, n_theta) or (N + 1, n_theta, n_z), uniform along z, m_0 = 1"
    remedy = "make them with cyclosis.kinetic: kinetic.dressed(P) of an order vector, say"
    try:
        m = np.asarray(start, dtype=np.complex128)
    except (TypeError, ValueError) as error:
        raise InputError("start", start, rule, remedy) from error
    if m.ndim == 3 and np.abs(m - m[:, :, :1]).max(initial=0.0) < 1e-12:
        m = m[:, :, 0]
    usable = m.ndim == 2 and len(m) >= 3 and m.shape[1] >= 8 and np.all(np.isfinite(m))
    if not usable or np.abs(m[0] - 1).max() > 1e-12:
        raise InputError("start", m, rule, remedy)
    return m


def _none(params: Parameters, why: str) -> InputError:
    point = ", ".join(f"{name} = {getattr(params, name):g}" for name in ("alpha_p", "alpha_u", "kappa"))
    return InputError(
        "the parameter point", point, f"where stripes travel, and {why}", "change alpha_p or kappa"
    )
