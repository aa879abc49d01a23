"""Angular moments: from a density of filament angles to moments and back, and states made of them.

A state holds m_n(theta, z) = ∫ e^{inφ} Ψ dφ for n = 0, ..., N, of which m_0 = c is the concentration and
m_1 = c (P_theta + i P_z); m_{-n} = m_n*. The density is Ψ = (m_0 + 2 Re Σ_n m_n e^{-inφ})/(2π).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...model import initial
from ...model.definitions import definition
from ...model.doors import door
from ...model.errors import InputError, whole
from ...model.grid import CylinderGrid
from ...model.parameters import Parameters
from ...model.spectral import pack

Moments = npt.NDArray[np.complex128]

MODES = 48
"""Angular modes N, by default: m_N is about 2e-6 in the sharpest states at the paper's parameters."""
MOST_MODES = 512
NOISY = 8
"""Modes that noise has. With more of them a density of few filaments is negative at many points; they would
decay within 1/(81 d_r)."""
NEAR_ONE = 1.0 - 1e-6
"""The largest |P| that a von Mises distribution is given: more would take more modes than there can be."""


@door
def moments(density: npt.ArrayLike, modes: int = MODES) -> Moments:
    """Return the moments (modes + 1, n_theta, n_z) of a density (n_theta, n_z, n_phi), complex.

    The density of angles is given on equally spaced angles φ_j = 2π j/n_phi from 0. Dimensionless. Raises
    `InputError` for a density that is negative, not finite or has too few angles for so many modes.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> phi = 2 * np.pi / 32 * np.arange(32)
        >>> density = np.broadcast_to((1 + 0.8 * np.cos(phi)) / (2 * np.pi), (8, 8, 32))
        >>> cy.kinetic.moments(density, 4)[:3, 0, 0].real.round(12) + 0.0
        array([1. , 0.4, 0. ])
    """
    modes = whole("modes", modes, 2, MOST_MODES, f"the default is {MODES}")
    values = np.asarray(density, dtype=np.float64)
    rule = f"an array (n_theta, n_z, n_phi) with more than {2 * modes} angles"
    if values.ndim != 3 or values.shape[2] <= 2 * modes:
        raise InputError("density", values, rule, "sample more angles, or ask for fewer modes")
    if not np.all(np.isfinite(values)) or values.min() < 0:
        raise InputError(
            "density", float(values.min()), "at least 0 everywhere", "it is a density of filaments"
        )
    found = np.conj(np.fft.rfft(values, axis=2)) * (2 * np.pi / values.shape[2])
    return np.ascontiguousarray(np.moveaxis(found[:, :, : modes + 1], 2, 0))


@door
def density(state: npt.ArrayLike, angles: int | None = None) -> npt.NDArray[np.float64]:
    """Return the density (n_theta, n_z, angles) of moments (N + 1, n_theta, n_z), on equally spaced angles.

    By default there are 2N + 2 angles, from 0. Raises `InputError` for an array that is not of moments.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> state = cy.kinetic.dressed(cy.initial.unidirectional(cy.CylinderGrid(8, 8), 0.5), modes=24)
        >>> psi = cy.kinetic.density(state)
        >>> psi.shape, bool(np.allclose(cy.kinetic.moments(psi, 24), state))
        ((8, 8, 50), True)
    """
    m = _state(state)
    n = 2 * len(m) if angles is None else whole("angles", angles, 2 * len(m) - 1, 10**6, "leave it out")
    return np.fft.irfft(np.conj(np.moveaxis(m, 0, 2)), n, axis=2) * (n / (2 * np.pi))


@door
def order(state: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return P (2, n_theta, n_z) of moments (N + 1, n_theta, n_z): m_1 = c (P_theta + i P_z).

    Raises `InputError` for an array that is not of moments.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> P = cy.initial.stripes(cy.CylinderGrid(8, 8), magnitude=0.7)
        >>> bool(np.allclose(cy.kinetic.order(cy.kinetic.dressed(P)), P))
        True
    """
    m = _state(state)
    p = m[1] / m[0].real
    return np.stack([p.real, p.imag])


@door
def dressed(P: npt.ArrayLike, modes: int = MODES) -> Moments:
    """Return the moments of the von Mises distribution with mean direction P (2, n_theta, n_z), c = 1.

    m_n = I_n(x)/I_0(x) e^{inφ_P} with I_1(x)/I_0(x) = |P|: the most even distribution of that mean. Raises
    `InputError` where |P| is not below 1.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.kinetic.dressed(cy.initial.unidirectional(cy.CylinderGrid(8, 8), 0.5))
        >>> state.shape, state[2, 0, 0].round(4)  # I_2/I_0 = 1 - 2 |P|/x
        ((49, 8, 8), np.complex128(-0.1374+0j))
    """
    modes = whole("modes", modes, 2, MOST_MODES, f"the default is {MODES}")
    p = pack(np.asarray(P, dtype=np.float64))
    magnitude = np.abs(p)
    if magnitude.max() > NEAR_ONE:
        rule = f"at most {NEAR_ONE:g}, for a distribution of angles has some width"
        raise InputError("max |P|", float(magnitude.max()), rule, "scale the state down")
    from scipy.special import ive  # loaded only here: a run of the polar model needs none of it

    x, n = _concentration(magnitude), np.arange(modes + 1)[:, None, None]
    unit = np.where(magnitude > 0, p / np.where(magnitude > 0, magnitude, 1.0), 1.0)
    return ive(n, x) / ive(0, x) * unit**n


@door
def nematic(params: Parameters, grid: CylinderGrid, modes: int = MODES) -> Moments:
    """Return the unpolarised steady state: filaments lie across the repulsive direction d, both ways alike.

    m_{2j} = (-1)^j e^{2ijb} I_j(x)/I_0(x), x = κ/(4 d_r), with b the angle of d; odd moments are 0. Raises
    `InputError` without rotational diffusion and for fields that do not match the grid.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.kinetic.nematic(cy.Parameters(), cy.CylinderGrid(8, 8))  # κ/d_r = 20
        >>> round(float((1 - state[2, 0, 0].real) / 2), 6)  # <p_z²>
        0.946692
    """
    modes = whole("modes", modes, 2, MOST_MODES, f"the default is {MODES}")
    params.require_grid(grid)
    if params.d_r == 0:
        raise InputError("d_r", params.d_r, "above 0 for a nematic state", "raise it")
    from scipy.special import ive

    x = np.broadcast_to(np.asarray(params.kappa) / (4 * params.d_r), grid.shape)
    out = np.zeros((modes + 1, *grid.shape), dtype=np.complex128)
    for j in range(modes // 2 + 1):
        out[2 * j] = (-1) ** j * np.exp(2j * j * params.repulsion_angle) * ive(j, x) / ive(0, x)
    return out


@door
def disordered(
    grid: CylinderGrid,
    filaments_per_square: float = 1000,
    seed: int = 0,
    noise_grid: tuple[int, int] | None = None,
    modes: int = MODES,
) -> Moments:
    """Return the moments of N filaments of random angles on every square of the grid, c = 1.

    m_n has independent normal real and imaginary parts of variance 1/(2N) for n = 1 to 8, and is 0 beyond.
    m_1 is drawn as `cyclosis.initial.disordered` draws P: one seed starts both models alike. Raises
    `InputError` as that does.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.kinetic.disordered(grid, seed=3)
        >>> bool(np.array_equal(cy.kinetic.order(state), cy.initial.disordered(grid, seed=3)))
        True
    """
    return with_noise(_isotropic(grid, modes), grid, filaments_per_square, seed, noise_grid)


@door
def with_noise(
    state: npt.ArrayLike,
    grid: CylinderGrid,
    filaments_per_square: float = 1000,
    seed: int = 0,
    noise_grid: tuple[int, int] | None = None,
) -> Moments:
    """Return moments (N + 1, n_theta, n_z) with the noise of `disordered` added.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> noisy = cy.kinetic.with_noise(cy.kinetic.nematic(cy.Parameters(), grid), grid, seed=1)
        >>> noisy.shape, float(noisy[0].real.max())
        ((49, 16, 16), 1.0)
    """
    out = _state(state).copy()
    count = definition("initial", "filaments_per_square").check(filaments_per_square)
    out[1] += pack(initial.noise(grid, count, seed, noise_grid))
    sequence = np.random.SeedSequence(definition("initial", "seed").check(seed), spawn_key=(1,))
    add_higher_noise(out, grid, sequence, np.sqrt(0.5 / count), noise_grid)
    return out


def add_higher_noise(
    m: Moments,
    grid: CylinderGrid,
    sequence: np.random.SeedSequence,
    size: Any,
    noise_grid: tuple[int, int] | None,
) -> None:
    """Add normal noise of standard deviation `size` to either part of m_2, ..., m_8, in place."""
    rng = np.random.default_rng(sequence)
    for n in range(2, min(NOISY, len(m) - 1) + 1):
        m[n] += size * pack(initial.standard_noise(grid, rng, noise_grid))


def _isotropic(grid: CylinderGrid, modes: int) -> Moments:
    modes = whole("modes", modes, 2, MOST_MODES, f"the default is {MODES}")
    out = np.zeros((modes + 1, *grid.shape), dtype=np.complex128)
    out[0] = 1.0
    return out


def _concentration(magnitude: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return x with I_1(x)/I_0(x) = |P|, by bracketing in s = x/(1 + x)."""
    from scipy.optimize import elementwise
    from scipy.special import ive

    def excess(s: Any, wanted: Any) -> Any:
        x = s / (1 - s)
        return ive(1, x) / ive(0, x) - wanted

    ends = (np.zeros_like(magnitude), np.full_like(magnitude, 1 - 1e-9))
    s = elementwise.find_root(excess, ends, args=(magnitude,), tolerances={"xatol": 1e-16, "xrtol": 1e-15}).x
    return np.asarray(s / (1 - s))


def _state(state: npt.ArrayLike) -> Moments:
    m = np.asarray(state, dtype=np.complex128)
    if m.ndim != 3 or len(m) < 3:
        rule = "an array of moments (N + 1, n_theta, n_z) with N of at least 2"
        raise InputError("state", m, rule, "make it with cyclosis.kinetic")
    return m
