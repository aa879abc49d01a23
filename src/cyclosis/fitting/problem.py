"""What the search of a film minimises, and the coordinates in which it is nearly convex.

The unknowns x are logarithms of parameters and Fourier coefficients p of P at the first frame. A film often
begins before u is seen. Then another rate of growth asks for another amplitude of all waves at the first
frame, and steps in x are long only if both change together. In its first stages the search therefore takes
y = p exp(σ τ) for p, with σ = α_p - d_r - κ - d_s k² (no κ along the filaments) the growth rate of disorder
and τ the age at which u is seen: what linear growth makes of p when it is first measured, whatever the
parameters are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..model.grid import Array

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Problem:
    """What is minimised: `misfit(x)` is (u_model - u)/σ, `jacobian(x, used)` its slopes, one row per unknown.

    Rows of unknowns that are not used are 0. The first `logs` unknowns have the prior mean `begin` and
    deviation 1, all others mean 0. `squares` are k² of those, `weights` the mean square of their waves, 1 or
    1/2 or 1/4, and `component` (0, 1, ...) says to which component of P they belong. `peak` is that of u in
    σ, `since` (values,) the time of each value after u is first seen, and `alike` how many values share
    noise. `growth(logs)` is σ τ of all waves, and its slopes (logs, waves).
    """

    misfit: Callable[[Array], Array]
    jacobian: Callable[[Array, Mask], Array]
    begin: Array
    squares: Array
    weights: Array
    component: npt.NDArray[np.intp]
    peak: Array
    since: Array
    alike: Array
    growth: Callable[[Array], tuple[Array, Array]]

    @property
    def logs(self) -> int:
        """The number of parameters."""
        return self.begin.size

    @property
    def components(self) -> int:
        """The number of components of P."""
        return int(self.component.max()) + 1

    @property
    def mean(self) -> Array:
        """The prior mean of all unknowns."""
        return np.concatenate([self.begin, np.zeros(self.squares.size)])

    def scale(self, sizes: Array, width: float) -> Array:
        """Return the deviations of all unknowns.

        `sizes` are the root mean squares of the components of P, and `width` is up to where waves reach.
        """
        fall = np.exp(-self.squares / (2 * width**2))
        power = np.bincount(self.component, self.weights * fall**2)
        return np.concatenate([np.ones(self.logs), fall * (sizes / np.sqrt(power))[self.component]])

    def sizes(self, scale: Array) -> Array:
        """Return the root mean squares of the components of P whose coefficients have some deviations."""
        return np.sqrt(np.bincount(self.component, self.weights * scale[self.logs :] ** 2))

    def first(self, y: Array) -> Array:
        """Return the unknowns x of what the growth of disorder makes of them."""
        return y * self.shrinkage(y)

    def shrinkage(self, y: Array) -> Array:
        """Return by what the unknowns x are smaller than y."""
        return np.concatenate([np.ones(self.logs), np.exp(-self.growth(y[: self.logs])[0])])

    def later(self) -> Problem:
        """Return the problem in y."""
        n = self.logs

        def jacobian(y: Array, used: Mask) -> Array:
            x = self.first(y)
            slopes = self.jacobian(x, used)
            turn = self.growth(y[:n])[1] * x[n:]
            found: Array = slopes * self.shrinkage(y)[:, None]
            found[:n] -= turn @ slopes[n:]
            return found

        return replace(self, misfit=lambda y: self.misfit(self.first(y)), jacobian=jacobian)
