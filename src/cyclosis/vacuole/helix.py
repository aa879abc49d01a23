"""Helical flows: bands that wind around the cell, and the stream function of the circulation they drive.

A field that depends on φ = θ - Qz alone has waves (m, -mQ). Its flow depends on r and φ, and

    r v_r = ∂_φ ψ,   v_θ - Q r v_z = -∂_r ψ,   ψ(r = 1) = 0

so that ψ is constant along every trajectory. A band e^{inφ} of speed f along the helix has
ψ = f sin α I_n(κr)/I_n(κ) κ² T [2 r² t τ' + (T - T') (1 - r²)] / D with tan α = Q and κ = n|Q|; for small Q
this is -Q³ f n r^n (1 - r²)² / (4 (n + 1)(n + 2)). docs/theory_vacuole.md derives both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.bessel import ratios
from ..model.doors import door
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.interior import constants
from .flow import VacuoleFlow
from .points import checked_points, checked_radii
from .tables import Complex, field_of, waves

ROUNDING = 1e-10
"""Share of the largest wave below which another counts as rounding."""
WHOLE = 1e-9
"""How far from a whole number the turns of a harmonic may be by rounding."""


@door
def helical_bands(
    grid: CylinderGrid, profile: Callable[[Array], Array] | npt.ArrayLike, pitch: float
) -> Array:
    """Return the velocity u (2, n_theta, n_z) of bands that wind along helices, in units of U.

        u = f(θ - Qz) (sin α, cos α),   tan α = Q = 2π / pitch

    The direction is that of the helix, the speed |f|, and the divergence is 0. `profile` is f: a function of
    angles (n,), or its values at the n evenly spaced angles from 0. `pitch` is the advance along z in one
    turn, in R; it is negative for the other handedness, and infinite for straight bands. Harmonics of f that
    the grid does not resolve are left out. Raises `InputError` if the bands do not fit the periodic cell.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(32, 32, length=5.0)
        >>> u = cy.vacuole.helical_bands(grid, np.sin, pitch=5.0)
        >>> flow = cy.vacuole.flow(grid, u)
        >>> flow.solenoidal, round(float(np.hypot(*flow.cartesian_at([[0.0, 0.0, 0.0]])[0, :2])), 9)
        (True, 0.03476694)
        >>> cy.vacuole.helical_bands(grid, np.sin, pitch=4.0)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: pitch = 4.0 cannot be used: ...
    """
    f = _harmonics(profile, grid.n_theta)
    Q = _wavenumber(pitch)
    highest, q = waves(grid)
    modes = np.zeros((2, 2 * highest + 1, q.size), np.complex128)
    along = np.array([Q, 1.0]) / np.hypot(Q, 1.0)
    turns = Q * grid.length / (2 * np.pi)
    present = np.abs(f) > ROUNDING * np.max(np.abs(f), initial=0.0)
    for n in np.flatnonzero(present).tolist():
        place = n * turns
        j = round(place)
        if abs(place - j) > WHOLE * max(1.0, abs(place)):
            rule = "one that fits the length of the cell a whole number of times"
            raise InputError("pitch", pitch, rule, "choose length / 1, length / 2, ..., or infinity")
        if n > highest or abs(j) >= q.size:
            continue
        # Waves with q >= 0 are kept; (n, -j) is the conjugate of (-n, j).
        if j <= 0:
            modes[:, n, -j] += along * f[n]
        if n > 0 and j >= 0:
            modes[:, -n, j] += along * f[n].conj()
    return field_of(modes, grid.shape)


def _harmonics(profile: Callable[[Array], Array] | npt.ArrayLike, count: int) -> Complex:
    """Return the complex amplitudes f_n of a real profile, n = 0, 1, ..., without its Nyquist mode."""
    rule = "a function of angles, or a row of at least 3 finite numbers"
    sampled = (
        profile(2 * np.pi / count * np.arange(count, dtype=np.float64)) if callable(profile) else profile
    )
    values = numbers("profile", sampled, rule, "give f(phi)")
    if values.ndim != 1 or values.size < 3 or not np.all(np.isfinite(values)):
        raise InputError("profile", values, rule, "give f(phi)")
    return np.fft.rfft(values, norm="forward")[: (values.size + 1) // 2]


def _wavenumber(pitch: float) -> float:
    """Return Q = 2π / pitch."""
    value = _pitches(pitch)
    if value.ndim:
        raise InputError("pitch", value, *_PITCH)
    return 2 * np.pi / float(value)


_PITCH = ("one number other than 0", "give the advance along z in one turn, in R")


def _pitches(pitch: npt.ArrayLike) -> Array:
    values = numbers("pitch", pitch, *_PITCH)
    if np.any(values == 0) or np.any(np.isnan(values)):
        raise InputError("pitch", pitch, *_PITCH)
    return values


@shown
@dataclass(frozen=True, eq=False)
class StreamFunction:
    """ψ of a helical flow: r v_r = ∂_φ ψ and v_θ - Q r v_z = -∂_r ψ, with φ = θ - Qz and ψ = 0 at the wall.

    It is constant along every trajectory of the steady flow. Dimensionless, in UR. `Q` is 2π over the pitch.
    Make one with `cyclosis.vacuole.stream_function`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(32, 32, length=5.0)
        >>> flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, np.sin, pitch=5.0))
        >>> psi = cy.vacuole.stream_function(flow)
        >>> round(psi.pitch, 9), psi.at([[0.5, np.pi / 2, 0.0], [1.0, 1.0, 1.0]]).round(6) + 0.0
        (5.0, array([-0.010025,  0.      ]))
        >>> psi.on([0.0, 0.5], [0.0, 1.0, 2.0]).shape  # radii times angles φ
        (2, 3)
    """

    Q: float
    harmonics: Complex
    mean: tuple[float, float, bool]
    """<u_θ>, <u_z>, and whether the cell has no pressure drop."""

    @property
    def pitch(self) -> float:
        """The advance along z in one turn, in R; infinite for straight bands."""
        return 2 * np.pi / self.Q if self.Q else np.inf

    def at(self, points: npt.ArrayLike) -> Array:
        """Return ψ (n,) at points (n, 3) of (r, θ, z)."""
        r, theta, z = checked_points(points).T
        n = np.arange(1, self.harmonics.size)
        waves = np.exp(1j * np.outer(theta - self.Q * z, n))
        return 2 * np.sum((self._radial(r) * waves).real, axis=1) + self._axisymmetric(r)

    def on(self, radii: npt.ArrayLike, phi: npt.ArrayLike) -> Array:
        """Return ψ (n_r, n_phi) at radii times angles φ = θ - Qz."""
        r = checked_radii(radii)
        angles = numbers("phi", phi, "a row of numbers", "give angles in radians")
        waves = np.exp(1j * np.outer(np.arange(1, self.harmonics.size), np.atleast_1d(angles)))
        return 2 * (self._radial(r) @ waves).real + self._axisymmetric(r)[:, None]

    def _radial(self, r: Array) -> Complex:
        """Return ψ_n (n_r, n_max), n = 1, 2, ..."""
        n = np.arange(1, self.harmonics.size)
        return radial_stream(self.harmonics.size - 1, self.Q, r) * self.harmonics[n]

    def _axisymmetric(self, r: Array) -> Array:
        swirl, along, free = self.mean
        driven = self.Q * along * (1.0 if free else r**2)
        return 0.5 * (1 - r**2) * (swirl - driven)


def radial_stream(highest: int, Q: float, r: Array) -> Array:
    """Return ψ_n(r) (n_r, highest), n = 1, 2, ..., of a wall that moves with u_θ = Q u_z = e^{inφ}.

    It has no cancellation: at small Q it is exactly the law of the third power (u_θ holds one of them).
    """
    from scipy.special import i0e  # needed only here, and slow to load

    n = np.arange(highest + 1)
    kappa = abs(Q) * n.astype(np.float64)
    k = constants(highest, kappa)
    T, T1 = k.T[n, n], k.T1[n, n]
    D = k.nu[n, n] * (k.Lam[n, n] + 2) - 2
    x = np.outer(r, kappa)
    t = ratios(highest + 1, x)  # (highest + 2, n_r, highest + 1)
    wall = ratios(highest + 1, kappa)
    growth = np.cumprod(t[:-2] / wall[:-2, None, :], axis=0)  # of I_{m+1}/(x^{m+1}) over that of I_0
    g = i0e(x) / i0e(kappa) * np.exp(-np.multiply.outer(1 - r, kappa))
    g[:, 1:] *= growth[n[1:] - 1, :, n[1:]].T * r[:, None] ** n[1:]
    t0, t1 = t[n, :, n].T, t[n + 1, :, n].T
    square, inside = r[:, None] ** 2, 1 - r[:, None] ** 2
    shape = 2 * square * t0 * (square * t1 - T1) + (T - T1) * inside
    D[0] = 1.0  # not used
    return (g * kappa**2 * T * shape / D)[:, 1:]


@door
def stream_function(flow: VacuoleFlow) -> StreamFunction:
    """Return the `StreamFunction` of a helical flow, in units of UR.

    Raises `InputError` if the wall's velocity is not helical, that is, if its waves do not all have the same
    -q/m, and if it has a divergence.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> P = cy.initial.disordered(grid, seed=0)
        >>> cy.vacuole.stream_function(cy.vacuole.flow_of_state(cy.Parameters(), grid, P))
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: u = an array of shape (2, 16, 16) cannot be used: ...
    """
    flow.require_solenoidal("a stream function")
    highest, q = waves(flow.grid)
    size = np.hypot(*np.abs(flow.modes))
    m = np.roll(np.arange(-highest, highest + 1), -highest)
    present = size > ROUNDING * np.max(size, initial=0.0)
    present[0, 0] = False
    rows, columns = np.nonzero(present)
    if np.any(m[rows] == 0):
        raise _not_helical(flow)
    strongest = np.argmax(size[rows, columns]) if rows.size else 0
    slopes = -q[columns] / m[rows] if rows.size else np.zeros(1)
    Q = float(slopes[strongest])
    if np.any(np.abs(slopes - Q) > 1e-9 * max(1.0, abs(Q))):
        raise _not_helical(flow)
    harmonics = np.zeros(highest + 1, np.complex128)
    # ψ is odd under reversal of the flow and has the phase of u_θ = Q u_z.
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        n, wave = int(m[row]), flow.modes[0, row, column]
        harmonics[abs(n)] = wave if n > 0 else wave.conj()
    mean = flow.modes[:, 0, 0].real
    return StreamFunction(Q, harmonics, (float(mean[0]), float(mean[1]), flow.closure == "no_pressure_drop"))


def _not_helical(flow: VacuoleFlow) -> InputError:
    rule = "helical, a function of θ - Qz alone, for a stream function"
    return InputError("u", flow.surface, rule, "use helical bands, or the velocity itself")


@door
def axis_speed(pitch: npt.ArrayLike) -> Array:
    """Return the speed across the axis, on the axis, of helical bands sin φ, in units of their speed.

        |v_⊥| = κ³ (T - T') T sin α / (2 I_1(κ) |D|),   κ = |Q| = 2π/|pitch|

    `pitch` (...) is in R. Only the first harmonic of bands reaches the axis. The largest value, 0.0579498, is
    at a pitch of 2.8223. Raises `InputError` for values that are not numbers, or 0.

    Example:
        >>> import cyclosis as cy
        >>> cy.vacuole.axis_speed([5.0, 2.8222629826, 1.5]).round(7)
        array([0.0347669, 0.0579498, 0.0240902])
    """
    values = _pitches(pitch)
    Q = 2 * np.pi / np.abs(values)
    from scipy.special import i1e

    flat = np.asarray(Q.ravel(), dtype=np.float64)
    k = constants(1, flat)
    T, T1 = k.T[1], k.T1[1]
    D = k.nu[1] * (k.Lam[1] + 2) - 2
    fall = np.where(flat > 0, flat * np.exp(-flat) / (2 * i1e(np.where(flat > 0, flat, 1.0))), 1.0)
    speed = fall * flat**3 * T * (T - T1) / (-D * np.hypot(1.0, flat))
    return speed.reshape(values.shape)
