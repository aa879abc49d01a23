"""Growth rates of the waves that fit a cell, fastest growing first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ..model.errors import number, whole
from ..model.grid import Array
from ..model.parameters import Parameters
from .dispersion import Complex, growth_rates
from .travelling import LENGTH
from .uniform import OBLIQUE, check_numbers, uniform
from .weakest import LONGEST_CELL

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False)
class DispersionTable:
    """Growth rates of waves about a uniform state of some `base` and `order` |P|, dimensionless.

    `m` and `j` (waves,) count waves around and along a cell of `length`, `q` (waves,) = 2πj/length;
    `rates` (waves, 2) as `growth_rates` gives them; the fastest growing wave comes first.
    """

    base: str
    order: float
    length: float
    m: npt.NDArray[np.int64]
    j: npt.NDArray[np.int64]
    q: Array
    rates: Complex

    def to_dataset(self) -> xarray.Dataset:
        """Return the table as an `xarray.Dataset` over `wave`."""
        import xarray

        data = {"m": self.m, "j": self.j, "q": self.q}
        for k, name in enumerate(("stronger", "weaker")):
            data |= {f"growth_{name}": self.rates[:, k].real, f"frequency_{name}": -self.rates[:, k].imag}
        attrs = {"base": self.base, "order": self.order, "length": self.length}
        return xarray.Dataset({name: ("wave", values) for name, values in data.items()}, attrs=attrs)


def dispersion_table(
    params: Parameters, base: str, waves: int = 3, length: float = LENGTH
) -> DispersionTable:
    """Return the growth rates of up to `waves` waves around and along a cell of a length.

    Of waves that are mirror images, which grow alike unless d is oblique, one is listed. Raises `InputError`
    as `growth_rates`.
    """
    waves = whole("waves", waves, 0, 1024, "the default is 3")
    length = number("length", length, 1e-6, LONGEST_CELL, "choose another length")
    m, j = (axis.ravel() for axis in np.indices((waves + 1, waves + 1)))
    check_numbers(params)
    if params.kappa > 0 and abs(np.sin(2 * params.repulsion_angle)) > OBLIQUE:
        both = (m > 0) & (j > 0)
        m, j = np.append(m, m[both]), np.append(j, -j[both])
    q: Array = np.asarray(2 * np.pi / length * j, dtype=np.float64)
    rates = growth_rates(params, base, m, q)
    first = np.argsort(-rates[:, 0].real, kind="stable")
    order = uniform(params, base).order
    return DispersionTable(base, order, length, m[first], j[first], q[first], rates[first])
