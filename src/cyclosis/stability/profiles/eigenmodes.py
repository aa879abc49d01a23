"""The eigenvalues and modes of stripes P(θ) e_z, from the right-hand side of the simulation.

About a state P(θ) e_z, with d along an axis, perturbations v(θ) e^{iqz} of wavenumber q along the cell obey a
matrix. At q = 0 it is triangular: P_theta evolves independently of P_z (and acts on it through ε), and P_z
obeys the paper's non-local Sturm-Liouville problem

    L v = d_s v'' + [-d_r + α_p (1 - 3P²) - 2 α_u P u] v + 3 α_u (1 - P²) [G(P² v) - <P² v>],

G = (1 - μ ∂²)⁻¹, written here for the cubic force. L P' = 0: the rotation is neutral. L is not self-adjoint,
so that its eigenvalues may be complex.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...display.shown import shown
from ...model.arrays import numbers
from ...model.doors import door
from ...model.errors import InputError, choice, whole
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from .reduced import reduced

if TYPE_CHECKING:
    import xarray

Vector = npt.NDArray[np.complex128]

COMPONENTS = ("both", "z", "theta")
LARGEST = 2048
"""Most points around for which the eigenvalues of the whole matrix are computed."""


@shown
@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenvalues and modes of perturbations v(θ) e^{iqz} of a state, dimensionless.

    `eigenvalues` (count,) are complex, the largest real part first, and the upper one of a conjugate pair;
    `modes` (count, 2, n_theta) are their (v_theta, v_z), of root mean square 1, the largest value of all
    real and positive; `theta` (n_theta,) are the angles in radians, `wavenumber` is q.

    Example:
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
        >>> found = state.spectrum(3, axial_mode=1, length=5.0)
        >>> found.eigenvalues.shape, found.modes.shape, round(found.wavenumber, 4)  # 2π/5
        ((3,), (3, 2, 64), 1.2566)
        >>> dict(found.to_dataset().sizes)
        {'mode': 3, 'component': 2, 'theta': 64}
    """

    eigenvalues: Vector
    modes: Vector
    theta: Array
    wavenumber: float

    def to_dataset(self) -> xarray.Dataset:
        """Return eigenvalues and modes, in real and imaginary parts, over `mode` and `theta`."""
        import xarray

        dims = ("mode", "component", "theta")
        return xarray.Dataset(
            {
                "growth": ("mode", self.eigenvalues.real),
                "frequency": ("mode", self.eigenvalues.imag),
                "v_real": (dims, self.modes.real),
                "v_imag": (dims, self.modes.imag),
            },
            coords={"component": ["theta", "z"], "theta": self.theta},
            attrs={"wavenumber": self.wavenumber},
        )


@door
def profile_modes(
    params: Parameters,
    P: Array,
    count: int = 8,
    axial_mode: int = 0,
    length: float = 5.0,
    components: str = "both",
) -> Modes:
    """Return the `count` leading `Modes` of a steady state P(θ) e_z given by P (n_theta,).

    `axial_mode` is the number of waves along a cell of the given `length`; `components` restricts the modes
    to perturbations of P_z alone ("z") or to those driven by P_theta ("theta"), which separate only for
    axial_mode 0. Raises `InputError` for settings out of range.
    """
    components = choice("components", components, COMPONENTS)
    P = numbers("P", P, "an array of real numbers of shape (n_theta,)", "give P_z of a profile", ("theta",))
    n = P.size
    if P.ndim != 1 or n < 16 or not np.all(np.isfinite(P)):
        rule = "a finite array of shape (n_theta,) with at least 16 points"
        raise InputError("P", P, rule, "give P_z of a profile")
    if n > LARGEST:
        raise InputError("n_theta", n, f"at most {LARGEST} to find all eigenvalues", "use fewer points")
    count = whole("count", count, 1, n if components != "both" else 2 * n, "the default is 8")
    j = whole("axial_mode", axial_mode, -4000, 4000, "the default is 0")
    if j != 0 and components != "both":
        rule = 'axial_mode 0 with components "z" or "theta": a wave along the cell mixes them'
        raise InputError("axial_mode", j, rule, 'choose components "both"')
    line = reduced(params, CylinderGrid(n, max(8, 2 * abs(j) + 2), length))
    y = np.concatenate([np.zeros(n), P])
    if j == 0:
        values, vectors = _uniform(line.jacobian(y), components, count)
    else:
        values, vectors = np.linalg.eig(line.waves(y, j))
        first = _first(values, count)
        values, vectors = values[first], vectors[:, first]
    modes = _normalised(vectors).T.reshape(count, 2, n)
    theta = CylinderGrid(n, 8).theta
    return Modes(values, modes, theta, j * line.wavenumber)


def _uniform(matrix: Array, components: str, count: int) -> tuple[Vector, Vector]:
    """Return leading eigenvalues and modes of the triangular matrix [[A, 0], [B, L]] on (v_theta, v_z)."""
    n = matrix.shape[0] // 2
    tilting, across, axial = matrix[:n, :n], matrix[n:, :n], matrix[n:, n:]
    parts = {}
    if components != "theta":
        parts["z"] = np.linalg.eig(axial)
    if components != "z":
        parts["theta"] = np.linalg.eig(tilting)
    values = np.concatenate([part[0] for part in parts.values()]).astype(np.complex128)
    places = [(name, k) for name, part in parts.items() for k in range(part[0].size)]
    first = _first(values, count)
    columns = []
    for name, k in (places[place] for place in first):
        value, vector = parts[name][0][k], parts[name][1][:, k]
        if name == "z":
            columns.append(np.concatenate([np.zeros(n), vector]))
        else:
            # The response of P_z, (L - λ) v_z = -B v_theta, completes the mode.
            answer = np.linalg.solve(axial - value * np.eye(n), -across @ vector)
            columns.append(np.concatenate([vector, answer]))
    return values[first], np.stack(columns, axis=1).astype(np.complex128)


def _first(values: Any, count: int) -> npt.NDArray[np.int64]:
    # Real parts that differ by rounding count as equal, so that conjugates keep their order.
    return np.lexsort((-values.imag, -np.round(values.real, 12)))[:count]


def _normalised(vectors: Any) -> Vector:
    """Return columns (2n, k) with a root mean square of |v| of 1, their largest value real and positive."""
    largest = np.take_along_axis(vectors, np.argmax(np.abs(vectors), axis=0)[None], axis=0)
    size = np.sqrt(2 * np.mean(np.abs(vectors) ** 2, axis=0))
    return np.asarray(vectors * np.conj(largest) / np.abs(largest) / size, dtype=np.complex128)
