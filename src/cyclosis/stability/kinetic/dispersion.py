"""Growth rates of the waves that fit a cell, about uniform states of the kinetic model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ...display.shown import shown
from ...model.doors import door
from ...model.errors import InputError, choice, number, whole
from ...model.parameters import Parameters
from ...models.kinetic.angular import MODES
from ...models.kinetic.quantities import ANGULAR_TAIL
from ...models.kinetic.theory import ANGLES, matrix, uniform_state
from ..dispersion_table import DispersionTable, cell_waves
from ..profiles.travelling import LENGTH
from .torques import with_torques

if TYPE_CHECKING:
    import xarray

BASES = ("nematic", "z", "theta")
"""The uniform states by name: without polarity, and polarised along an axis."""
LEADING = 2
"""Growth rates that are kept for each wave."""


@shown
@dataclass(frozen=True, eq=False)
class KineticDispersion(DispersionTable):
    """Growth rates of waves about a uniform state of the kinetic model, as in `DispersionTable`.

    `rates` (waves, 2) are the two leading ones of the 2N of each wave. `modes` is N, `torques` the
    convention, and `tail` the size of the last moment of the state over that of the first or second one.

    Example:
        >>> import cyclosis as cy
        >>> table = cy.kinetic.dispersion(cy.Parameters(), waves=1, modes=40)
        >>> dict(table.to_dataset().sizes), table.resolved
        ({'wave': 4}, True)
    """

    modes: int
    torques: str
    tail: float

    @property
    def resolved(self) -> bool:
        """Whether there are enough modes: `tail` is at most 1e-4."""
        return self.tail <= ANGULAR_TAIL

    def to_dataset(self) -> xarray.Dataset:
        """Return the table as an `xarray.Dataset` over `wave`."""
        own = {"modes": self.modes, "torques": self.torques, "angular_tail": self.tail}
        return super().to_dataset().assign_attrs(own)


@door
def dispersion(
    params: Parameters,
    base: str = "nematic",
    waves: int = 3,
    length: float = LENGTH,
    modes: int = MODES,
    torques: str = "literal",
) -> KineticDispersion:
    """Return the `KineticDispersion` of up to `waves` waves around and along a cell of a `length`, in radii.

    `base` is the uniform state: "nematic", which is the kinetic disorder, or polarised along "z" or "theta".
    A wave e^{i(mθ + qz) + σt} of the angular moments up to `modes` obeys a matrix (2N, 2N), of which σ are
    the eigenvalues, in units of U/R: see `growth_rates`. Unless d is oblique, waves that are mirror images
    grow alike, and one of the two is listed. Raises `InputError` for fields, without rotational diffusion,
    and where there is no such state.

    Example:
        >>> import cyclosis as cy
        >>> table = cy.kinetic.dispersion(cy.Parameters(alpha_p=1.0), length=5.0)
        >>> [(int(m), int(j)) for m, j in zip(table.m[:3], table.j[:3])]  # polarity along d, then its waves
        [(0, 0), (1, 0), (0, 1)]
        >>> table.rates[0, 0].real.round(4)
        np.float64(0.499)
    """
    scaled = with_torques(params, torques)
    state = base_state(scaled, base, modes)
    waves = whole("waves", waves, 0, 1024, "the default is 3")
    length = number("length", length, 1e-6, 1e4, "choose another length")
    m, j, q = cell_waves(params, waves, length)
    rates = leading_rates(scaled, state, m, q)
    first = np.argsort(-np.round(rates[:, 0].real, 12), kind="stable")
    order = 0.0 if base == "nematic" else float(abs(state[1]))
    listed = (m[first], j[first], q[first], rates[first])
    return KineticDispersion(base, order, length, *listed, len(state) - 1, torques, angular_tail(state))


def base_state(scaled: Parameters, base: str, modes: int = MODES) -> npt.NDArray[np.complex128]:
    """Return the moments (modes + 1,) of one of `BASES`."""
    modes = whole("modes", modes, 2, ANGLES // 2 - 2, f"the default is {MODES}")
    return np.asarray(uniform_state(scaled, choice("base", base, BASES), modes))


def existing(scaled: Parameters) -> list[str]:
    """Return those of `BASES` that exist."""
    found = []
    for base in BASES:
        try:
            base_state(scaled, base, 2)
        except InputError as error:
            if error.field != "alpha_p":
                raise
        else:
            found.append(base)
    return found


def leading_rates(scaled: Parameters, state: Any, m: Any, q: Any) -> npt.NDArray[np.complex128]:
    """Return the two leading growth rates (waves, 2) of waves (m, q), the larger real part first."""
    found = np.empty((len(m), LEADING), dtype=np.complex128)
    for k, (around, along) in enumerate(zip(m, q, strict=True)):
        values = np.linalg.eigvals(matrix(scaled, state, around, along))
        # Real parts that differ by rounding count as equal, so that the upper one of a pair comes first.
        found[k] = values[np.lexsort((-values.imag, -np.round(values.real, 12)))[:LEADING]]
    return found


def angular_tail(moments: Any) -> float:
    """Return the size of the last moments over that of the first or second one: a nematic has no odd ones."""
    return float(np.abs(moments[-2:]).max() / np.abs(moments[1:3]).max())
