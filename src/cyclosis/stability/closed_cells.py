"""Axisymmetric steady states of closed cells, and the growth of their perturbations.

A state that does not depend on θ couples only the modes e^{imθ} and e^{-imθ} of a perturbation, so that its
growth rates are eigenvalues of a small matrix: the derivative of the right-hand side itself, by automatic
differentiation, in the surface harmonics of ±m.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..closed import initial
from ..closed.grid import Array, ClosedGrid
from ..closed.system import PRINCIPAL, ClosedSystem
from ..display.shown import shown
from ..model.doors import door
from ..model.errors import InputError, whole
from ..model.filaments import TermLike
from ..model.parameters import Parameters
from ..model.precision import on_host
from ..model.system import rate_spectrum
from ..models import closed_model

STEPS = 40
CLOSE = 1e-12
"""Newton's method ends when a step is smaller than this root mean square of P."""


@shown
@dataclass(frozen=True, eq=False)
class AxialState:
    """A steady state that does not depend on θ: `P` (2, n_theta, n_s), its `modes`, and the rest of dP/dt.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Sphere(), k_max=4)
        >>> cy.stability.source_to_sink(cy.Parameters(), grid).P.shape
        (2, 20, 10)
    """

    P: Array
    modes: npt.NDArray[np.complex128]
    residual: float


def _system(
    params: Parameters, grid: ClosedGrid, repulsion: str, terms: Iterable[TermLike] | None = None
) -> ClosedSystem:
    model = closed_model(repulsion)
    made: Any = model.system(model.problem(params, grid, terms), True)
    return made


@door
def source_to_sink(params: Parameters, grid: ClosedGrid, repulsion: str = PRINCIPAL) -> AxialState:
    """Return the steady state in which filaments run from the south pole to the north: P = P(s) e_s.

    Its force is a gradient, so that nothing flows. Found by Newton's method from a relaxed guess. Raises
    `InputError` where there is none: order must grow, α_p > d_r.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.ClosedGrid(cy.Capsule(2.0), k_max=8)
        >>> found = cy.stability.source_to_sink(cy.Parameters(alpha_p=0.5, alpha_u=0.05), grid)
        >>> found.residual < 1e-11, bool(abs(cy.flow(cy.Parameters(), grid, found.P)).max() < 1e-11)
        (True, True)
    """
    system = _system(params, grid, repulsion)
    count = int(grid.tables.modes[0])
    guess = system.spectrum(initial.source_to_sink(grid, 0.9))[0, 0, :count].imag

    with on_host():
        placed = jax.device_put(system)
        y = _relaxed(placed, guess)
        for _ in range(STEPS):
            step = np.linalg.solve(np.asarray(_slope(placed, y)), np.asarray(_rate(placed, y)))
            y = y - step
            if float(np.linalg.norm(step)) < CLOSE:
                break
        rest = float(np.linalg.norm(np.asarray(_rate(placed, y))))
    modes = np.zeros(system.space.keep.shape, complex)
    modes[0, 0, :count] = 1j * y
    P = system.state(modes)
    order = float(np.sqrt(grid.mean(np.sum(P**2, axis=0))))
    if not rest < 1e-8 or order < 0.05:
        rule = "where filaments from pole to pole stay in order, and here none were found"
        raise InputError("the parameter point", f"order {order:.2g}", rule, "raise alpha_p")
    return AxialState(P, modes, rest)


@jax.jit
def _rate(system: ClosedSystem, y: Any) -> Any:
    """Return the change of P = P(s) e_s, given and returned as the imaginary parts of its modes m = 0."""
    count = y.shape[0]
    modes = jnp.zeros(system.space.keep.shape, complex).at[0, 0, :count].set(1j * y)
    return system.rate(system.at(modes))[0, 0, :count].imag


_slope = jax.jit(jax.jacfwd(_rate, argnums=1))


def _relaxed(system: ClosedSystem, y: Any) -> Any:
    """Return a guess relaxed by linearly implicit steps of growing length, up to t = 200."""
    h, t = 0.2, 0.0
    eye = np.eye(len(y))
    while t < 200.0:
        y = y + h * np.linalg.solve(eye - h * np.asarray(_slope(system, y)), np.asarray(_rate(system, y)))
        t, h = t + h, min(1.2 * h, 5.0)
    return y


@door
def azimuthal_rates(
    params: Parameters,
    grid: ClosedGrid,
    state: npt.ArrayLike,
    m: int,
    terms: Iterable[TermLike] | None = None,
    repulsion: str = PRINCIPAL,
) -> npt.NDArray[np.complex128]:
    """Return the growth rates of all perturbations e^{±imθ} of a state that does not depend on θ.

    Complex, in decreasing order of their real parts; dimensionless (per R/U). `terms` linearises a part of
    the equation alone. Raises `InputError` for a state that depends on θ, and for an m without harmonics.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> state = cy.stability.source_to_sink(params, grid)
        >>> rates = cy.stability.azimuthal_rates(params, grid, state.P, m=1)
        >>> bool(rates[0].real > 0.1)  # a source that is displaced goes on moving
        True
    """
    P = _checked(grid, state, m)
    matrix = _matrix(_system(params, grid, repulsion, terms), P, _places(grid, m))
    rates = np.linalg.eigvals(matrix).astype(np.complex128)
    return rates[np.argsort(-rates.real)]


@shown
@dataclass(frozen=True, eq=False)
class AzimuthalMode:
    """A perturbation that grows or decays: its `rate`, itself, `P` (2, n_theta, n_s), and the rate's `parts`.

    `parts` has what every term contributes to its real part. P has a root mean square of 1.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> found = cy.stability.AzimuthalMode(0.1 + 0j, np.zeros((2, 8, 8)), {"shear": 0.1})
        >>> sum(found.parts.values()) == found.rate
        True
    """

    rate: complex
    P: Array
    parts: dict[str, float]


@door
def azimuthal_mode(
    params: Parameters,
    grid: ClosedGrid,
    state: npt.ArrayLike,
    m: int,
    rank: int = 0,
    repulsion: str = PRINCIPAL,
) -> AzimuthalMode:
    """Return a perturbation e^{±imθ} of a state that is the same at all θ, of a `rank` in `azimuthal_rates`.

    With m > 0 each comes twice, turned by a quarter of its wave: ranks 0 and 2 are two different ones. The
    rate is Σ l·L r over the terms' linear operators L, with l and r its left and right vectors, l·r = 1.
    Raises `InputError` as `azimuthal_rates` does, and for a rank that there is not.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.ClosedGrid(cy.Sphere(), k_max=8)
        >>> state = cy.stability.source_to_sink(params, grid)
        >>> found = cy.stability.azimuthal_mode(params, grid, state.P, m=1)
        >>> found.P.shape, bool(abs(sum(found.parts.values()) - found.rate.real) < 1e-9)
        ((2, 36, 18), True)
    """
    P, places = _checked(grid, state, m), _places(grid, m)
    rank = whole("rank", rank, 0, 2 * len(places) - 1, "0 is the one that grows fastest")
    system = _system(params, grid, repulsion)
    rates, vectors = np.linalg.eig(_matrix(system, P, places))
    chosen = int(np.argsort(-rates.real)[rank])
    left, right = np.linalg.inv(vectors)[chosen], vectors[:, chosen]
    parts = {}
    for term in system.terms:
        alone = _system(params, grid, repulsion, [term])
        real, imaginary = (
            _columns(alone, P, [_modes(alone, places, part)]) for part in (right.real, right.imag)
        )
        parts[term.name] = float((left @ (_rows(real, places) + 1j * _rows(imaginary, places)))[0].real)
    perturbation = system.state(_modes(system, places, right.real))
    size = np.sqrt(grid.mean(np.sum(perturbation**2, axis=0)))
    return AzimuthalMode(complex(rates[chosen]), perturbation / size, parts)


def _checked(grid: ClosedGrid, state: npt.ArrayLike, m: int) -> Array:
    most = len(grid.tables.modes) - 1
    whole("m", m, 0, most, "m = 0 is a perturbation that does not depend on theta either")
    P = grid.check_state(state)
    if np.abs(P - P.mean(axis=1, keepdims=True)).max() > 1e-8:
        remedy = "take one of cyclosis.stability.source_to_sink"
        raise InputError("state", P, "one that does not depend on theta", remedy)
    return P


def _places(grid: ClosedGrid, m: int) -> list[tuple[int, int, int]]:
    """Return where the harmonics of ±m are among all."""
    return [(side, m, j) for side in ((0, 1) if m else (0,)) for j in range(int(grid.tables.modes[m]))]


def _matrix(system: ClosedSystem, P: Array, places: list[tuple[int, int, int]]) -> Array:
    """Return the derivative of the rate of change of harmonics, as real and imaginary parts in turn."""
    directions = [_modes(system, places, direction) for direction in np.eye(2 * len(places))]
    return _rows(_columns(system, P, directions), places)


def _modes(system: ClosedSystem, places: list[tuple[int, int, int]], parts: Array) -> Any:
    """Return modes that have real and imaginary parts (2 n,) at n places."""
    modes = np.zeros(system.space.keep.shape, complex)
    for place, (real, imaginary) in zip(places, parts.reshape(-1, 2), strict=True):
        modes[place] = complex(real, imaginary)
    return modes


def _columns(system: ClosedSystem, P: Array, directions: list[Any]) -> Any:
    with on_host():
        return np.asarray(_pushed(jax.device_put(system), system.spectrum(P), np.array(directions)))


def _rows(columns: Any, places: list[tuple[int, int, int]]) -> Array:
    """Return real and imaginary parts (2 n, columns) of modes (columns, ...) at n places."""
    rows = np.array([columns[(slice(None), *place)] for place in places])
    return np.stack([rows.real, rows.imag], axis=1).reshape(2 * len(places), -1)


@jax.jit
def _pushed(system: ClosedSystem, modes: Any, directions: Any) -> Any:
    """Return the derivative of the rate of change in several directions."""
    return jax.lax.map(
        lambda one: jax.jvp(lambda at: rate_spectrum(system, at), (modes,), (one,))[1], directions
    )
