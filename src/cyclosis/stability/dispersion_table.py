"""Growth rates of the waves that fit a cell, fastest growing first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ..model.errors import number, whole
from ..model.grid import Array
from ..model.parameters import Parameters
from .existence.fastest_growing import LONGEST_CELL
from .profiles.travelling import LENGTH
from .uniform.dispersion import Complex, growth_rates
from .uniform.uniform import OBLIQUE, check_numbers, uniform

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

    Unless d is oblique, waves that are mirror images grow alike, and one of the two is listed. Raises
    `InputError` as `growth_rates` does.
    """
    waves = whole("waves", waves, 0, 1024, "the default is 3")
    length = number("length", length, 1e-6, LONGEST_CELL, "choose another length")
    check_numbers(params)
    m, j, q = cell_waves(params, waves, length)
    rates = growth_rates(params, base, m, q)
    first = np.argsort(-rates[:, 0].real, kind="stable")
    order = uniform(params, base).order
    return DispersionTable(base, order, length, m[first], j[first], q[first], rates[first])


def cell_waves(
    params: Parameters, waves: int, length: float
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Array]:
    """Return m, j and q = 2πj/length of up to `waves` waves around and along a cell.

    One of each pair that d makes mirror images of each other.
    """
    m, j = (axis.ravel() for axis in np.indices((waves + 1, waves + 1)))
    if params.kappa > 0 and abs(np.sin(2 * params.repulsion_angle)) > OBLIQUE:
        both = (m > 0) & (j > 0)
        m, j = np.append(m, m[both]), np.append(j, -j[both])
    return m, j, np.asarray(2 * np.pi / length * j, dtype=np.float64)
