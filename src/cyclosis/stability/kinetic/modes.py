"""Leading growth rates and modes of travelling states of the kinetic model.

The Krylov method finds the eigenvalues nearest to a shift s to the right of zero, by exact solutions with
L - s (see `linear`): all within some radius r of it. So none is missing whose real part is at least x and
whose frequency is at most (r² - (s - x)²)^½. More are sought until this is the rate at which torques turn
filaments, for x the last real part that is returned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigs

from ...display.shown import shown
from ...model.errors import whole
from ...model.grid import Array
from .line import Complex, Line, mirrored
from .linear import Inverse, Linearised

if TYPE_CHECKING:
    import xarray

NEUTRAL = 1e-9
"""Growth rates no larger count as zero."""
MORE, MOST = 4, 400
"""Eigenvalues sought beside those asked for, and most of them."""
SHIFT = 0.05
"""The shift relative to the rate at which torques turn filaments."""
PARALLEL = 0.999
"""Least cosine between a mode and the slope of a state whose rotation it is."""
SEED = 0


@shown
@dataclass(frozen=True, eq=False)
class KineticModes:
    """Growth rates and modes of perturbations δ_n(θ) e^{iqz} of the moments, in the state's frame.

    `eigenvalues` (count,) are complex, the largest real part first, in units of U/R; `modes`
    (count, 2, N + 1, n_theta) hold δ_n and δ_{-n} (of m_n*) at the angles `theta`, of root mean square 1 over
    theta in P; `P` (count, 2, n_theta) their P_theta and P_z. `wavenumber` is q. `rotation` is the number of
    the mode that only turns the state about the axis (q = 0, eigenvalue 0), or None. No eigenvalue with a
    larger real part than the last is missing whose frequency |Im σ| is at most `reach`.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(kappa=0.1, d_r=0.1, d_s=0.05)
        >>> found = cy.kinetic.travelling_state(params, n_theta=16, modes=12).spectrum(3)
        >>> found.eigenvalues.shape, found.modes.shape, found.P.shape, found.rotation
        ((3,), (3, 2, 13, 16), (3, 2, 16), 0)
        >>> found.stable, dict(found.to_dataset().sizes)["mode"]
        (True, 3)
    """

    eigenvalues: Complex
    modes: Complex
    P: Complex
    theta: Array
    wavenumber: float
    rotation: int | None
    reach: float

    @property
    def stable(self) -> bool:
        """Whether all of these decay, the rotation aside."""
        rest = [value.real for k, value in enumerate(self.eigenvalues) if k != self.rotation]
        return bool(np.all(np.array(rest) < -NEUTRAL))

    def to_dataset(self) -> xarray.Dataset:
        """Return growth rates, frequencies and P of the modes, over `mode` and `theta`."""
        import xarray

        dims = ("mode", "component", "theta")
        return xarray.Dataset(
            {
                "growth": ("mode", self.eigenvalues.real),
                "frequency": ("mode", self.eigenvalues.imag),
                "v_real": (dims, self.P.real),
                "v_imag": (dims, self.P.imag),
            },
            coords={"component": ["theta", "z"], "theta": self.theta},
            attrs={"wavenumber": self.wavenumber},
        )


def modes(line: Line, a: Complex, drift: float, q: float, count: int) -> KineticModes:
    """Return the `KineticModes` of a travelling state a (N, p)."""
    size = 2 * a.size
    count = whole("count", count, 1, min(MOST // 2, size // 4), "the default is 8")
    operator = Linearised(line, a, drift, q)
    values, vectors, reach = leading(operator, count)
    fields = vectors @ line.waves.T
    none = np.zeros((len(fields), 2, 1, line.n))
    fields = np.concatenate([none, fields], axis=2)
    P = np.stack([fields[:, 0, 1] + fields[:, 1, 1], -1j * (fields[:, 0, 1] - fields[:, 1, 1])], axis=1) / 2
    weight = _weights(P)
    slope = np.stack([line.slope(a), mirrored(line.slope(a))])
    turning = [k for k in range(len(values)) if q == 0 and _parallel(vectors[k], slope)]
    return KineticModes(
        values,
        fields * weight[:, None, None, None],
        P * weight[:, None, None],
        line.theta,
        q,
        turning[0] if turning else None,
        reach,
    )


def leading(operator: Linearised, count: int) -> tuple[Complex, Complex, float]:
    """Return the `count` eigenvalues with the largest real parts, pairs (count, 2, N, p) and `reach`."""
    params, shape = operator.line.params, operator.columns.shape[:3]
    turning = float(params.alpha_p + params.alpha_u + 0.5 * params.kappa)
    shift, size = SHIFT * turning + params.d_r, int(np.prod(shape))
    inverse = Inverse(operator, shift)

    def solved(x: Any) -> Any:
        return inverse(np.asarray(x, dtype=np.complex128).reshape(shape))[0].ravel()

    mapping = LinearOperator((size, size), solved, dtype=np.complex128)
    first = np.random.default_rng(SEED).normal(size=(size, 2)) @ [1, 1j]
    sought, most = count + MORE, min(size - 2, MOST)
    while True:
        inverses, vectors = eigs(mapping, sought, which="LM", v0=first, ncv=min(size, 2 * sought + 20))
        values = shift + 1 / inverses
        # Real parts that differ by rounding count as equal, so that the upper one of a pair comes first.
        order = np.lexsort((-values.imag, -np.round(values.real, 9)))[:count]
        square = 1 / np.abs(inverses).min() ** 2 - (shift - values[order[-1]].real) ** 2
        reach = float(np.sqrt(max(square, 0.0)))
        if reach >= turning or sought == most:
            return values[order], vectors.T[order].reshape(-1, *shape), reach
        sought = min(2 * sought, most)


def _weights(P: Complex) -> Complex:
    """Return factors (count,) that make P of root mean square 1, its largest value real and positive."""
    flat = P.reshape(len(P), -1)
    largest = flat[np.arange(len(P)), np.argmax(np.abs(flat), axis=1)]
    return np.conj(largest) / np.abs(largest) / np.sqrt(2 * np.mean(np.abs(flat) ** 2, axis=1))


def _parallel(x: Complex, y: Complex) -> bool:
    return bool(abs(np.vdot(x, y)) > PARALLEL * np.linalg.norm(x) * np.linalg.norm(y))
