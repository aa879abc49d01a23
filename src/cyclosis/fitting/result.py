"""What a fit found, how surely, and what it refuses to say."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..display.shown import shown
from ..model.errors import InputError
from ..model.grid import Array
from ..model.scales import Scales

if TYPE_CHECKING:
    import xarray

ORDER = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu", "U")
"""The names that a fit may report, in the order in which they are listed."""


@shown
@dataclass(frozen=True)
class Direction:
    """A combination of parameters and how well the measurement fixes it.

    `deviation` is the standard deviation of Σ share · ln(parameter), dimensionless, and `shares` are by
    name, of unit length. A combination with a deviation of 0.05 is known to 5 %.

    Example:
        >>> from cyclosis.fitting import Direction
        >>> print(Direction(0.02, {"alpha_p": 0.8, "d_s": -0.6}))
        2.0 %: +0.80 alpha_p -0.60 d_s
    """

    deviation: float
    shares: dict[str, float]

    def __str__(self) -> str:
        known = "not at all" if not self.deviation < 1e3 else f"{100 * self.deviation:.2g} %"
        known = f"{100 * self.deviation:.1f} %" if self.deviation < 0.1 else known
        large = sorted(self.shares.items(), key=lambda item: -abs(item[1]))
        return f"{known}: " + " ".join(f"{share:+.2f} {name}" for name, share in large if abs(share) > 0.1)


@shown
@dataclass(frozen=True, eq=False)
class Fit:
    """The parameters of a measured cell, by `cyclosis.fit`. All are dimensionless, in R, U and R/U.

    * `estimate`: values by parameter name, and `U`, the unit of speed that was found in units of that in
      which the data are given; NaN where the measurement cannot tell.
    * `interval`: (low, high) by name, 95 %; (0, inf) where the measurement cannot tell.
    * `refused`: one sentence that says what cannot be told and what to do, or None.
    * `covariance` (n, n) of the values in the order of `estimate`, NaN where they are.
    * `identifiable`: combinations of the logarithms of parameters, stiff to sloppy, each a `Direction`.
    * `condition`: how many times less the least known combination shows than the best known one.
    * `residual`: what the model leaves, root mean square, in units of the noise; 1 for a model that fits.
    * `noise`: standard deviations of the noise that was found, by field.
    * `strength`: of the instruments by parameter, an F statistic; 10 is the least that is trusted.
    * `notes`: sentences about what the data lack, and what was assumed.

    Example:
        >>> import numpy as np
        >>> import xarray
        >>> import cyclosis as cy
        >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
        >>> u = np.stack([0 * state.u, state.u])[:, :, None]
        >>> places = {"theta": state.theta, "z": [0.0]}
        >>> data = xarray.Dataset({"u": (("component", "theta", "z"), u)}, places)
        >>> fit = cy.fit(data, method="profile")
        >>> fit.method, bool(np.isnan(fit.estimate["alpha_p"])), fit.refused is not None
        ('profile', True, True)
    """

    method: str
    estimate: dict[str, float]
    interval: dict[str, tuple[float, float]]
    refused: str | None
    covariance: Array
    identifiable: tuple[Direction, ...]
    condition: float
    residual: float
    fixed: dict[str, float] = field(default_factory=dict)
    noise: dict[str, float] = field(default_factory=dict)
    strength: dict[str, float] = field(default_factory=dict)
    scales: Scales | None = None
    seed: int = 0
    _predict: Callable[[], Any] | None = None
    notes: tuple[str, ...] = ()

    def predict(self) -> xarray.Dataset:
        """Return what the fitted model gives where the measurement was made, in units of the model.

        Of a film u and P over time, component, theta and z, of a profile u and P over theta. Raises
        `InputError` for a fit by `equation`, which integrates no model, and for one that was refused.

        Example:
            >>> import numpy as np
            >>> import xarray
            >>> import cyclosis as cy
            >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
            >>> u = np.stack([0 * state.u, state.u])[:, :, None]
            >>> places = {"theta": state.theta, "z": [0.0]}
            >>> data = xarray.Dataset({"u": (("component", "theta", "z"), u)}, places)
            >>> fit = cy.fit(data, method="profile", fix={"alpha_p": 1.0})
            >>> bool(abs(fit.predict()["u"] - state.u).max() < 0.05)
            True
        """
        if self._predict is None:
            rule = "one that integrates the model and was not refused"
            remedy = "fit by film, or simulate a cell with the estimates"
            raise InputError("the fit", self.method, rule, remedy)
        return self._predict()

    def to_dataset(self) -> xarray.Dataset:
        """Return the fit as an `xarray.Dataset` over `parameter` and `direction`, dimensionless.

        Example:
            >>> import numpy as np
            >>> import xarray
            >>> import cyclosis as cy
            >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
            >>> u = np.stack([0 * state.u, state.u])[:, :, None]
            >>> places = {"theta": state.theta, "z": [0.0]}
            >>> data = xarray.Dataset({"u": (("component", "theta", "z"), u)}, places)
            >>> sorted(cy.fit(data, method="profile").to_dataset().data_vars)[:3]
            ['covariance', 'deviation', 'estimate']
        """
        import xarray

        names = list(self.estimate)
        shares = [[d.shares.get(name, 0.0) for name in names] for d in self.identifiable]
        return xarray.Dataset(
            {
                "estimate": ("parameter", list(self.estimate.values())),
                "low": ("parameter", [self.interval[name][0] for name in names]),
                "high": ("parameter", [self.interval[name][1] for name in names]),
                "covariance": (("parameter", "other"), self.covariance),
                "share": (("direction", "parameter"), np.reshape(shares, (-1, len(names)))),
                "deviation": ("direction", [d.deviation for d in self.identifiable]),
            },
            coords={"parameter": names, "other": names},
            attrs={
                "method": self.method,
                "refused": self.refused or "",
                "notes": "; ".join(self.notes),
                "condition": self.condition,
                "residual": self.residual,
                "seed": self.seed,
                **{f"fixed_{name}": value for name, value in self.fixed.items()},
                **{f"noise_{name}": value for name, value in self.noise.items()},
            },
        )

    def __repr__(self) -> str:
        lines = [
            f"Fit by {self.method}: condition {self.condition:.3g}, residual {self.residual:.3g} of the noise"
        ]
        for name, value in self.estimate.items():
            low, high = self.interval[name]
            known = "not known" if np.isnan(value) else f"{value:<10.4g} {low:.4g} to {high:.4g}"
            lines.append(f"  {name:8s} {known}{self.in_units(name)}")
        lines += [f"  {name:8s} {value:<10.4g} (given)" for name, value in self.fixed.items()]
        if self.identifiable:
            lines.append("stiff to sloppy:")
            lines += [f"  {direction}" for direction in self.identifiable]
        lines += [f"Note: {note}." for note in self.notes]
        return "\n".join([*lines, *([f"Refused: {self.refused}"] if self.refused else [])])

    def in_units(self, name: str) -> str:
        """Return an estimate in physical units, in brackets, "" where the scales of the cell are not known.

        Example:
            >>> import numpy as np
            >>> import xarray
            >>> import cyclosis as cy
            >>> state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
            >>> u = np.stack([0 * state.u, state.u])[:, :, None]
            >>> places = {"theta": state.theta, "z": [0.0]}
            >>> data = xarray.Dataset({"u": (("component", "theta", "z"), u)}, places)
            >>> found = cy.fit(data, method="profile", scales=cy.Scales(500.0, 75.0))
            >>> "Pa s m" in found.in_units("mu"), found.in_units("kappa")
            (True, '')
        """
        value = self.estimate[name]
        if self.scales is None or np.isnan(value):
            return ""
        unit = self.estimate.get("U", self.fixed.get("U", 1.0))
        R, U = self.scales.radius_um, self.scales.speed_um_per_s * (1.0 if np.isnan(unit) else unit)
        units = {
            **dict.fromkeys(("alpha_p", "kappa", "d_r"), (U / R, "per s")),
            "alpha_u": (1 / R, "per µm"),
            "d_s": (R * U, "µm²/s"),
            "mu": (self.scales.friction_Pa_s_per_m * (R * 1e-6) ** 2, "Pa s m at this friction"),
            "U": (self.scales.speed_um_per_s, "µm/s"),
        }
        return f"  ({value * units[name][0]:.4g} {units[name][1]})" if name in units else ""


def of_logarithms(
    names: tuple[str, ...], values: dict[str, float], deviations: dict[str, float], lost: Collection[str]
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Return estimates and intervals of 95 % of values whose logarithms have these standard deviations."""
    estimate = {name: float("nan") if name in lost else values[name] for name in names}
    interval = {
        name: (0.0, float("inf"))
        if name in lost
        else (values[name] * np.exp(-1.96 * deviations[name]), values[name] * np.exp(1.96 * deviations[name]))
        for name in names
    }
    return estimate, interval


def masked(covariance: Array, free: tuple[str, ...], names: tuple[str, ...], lost: Collection[str]) -> Array:
    """Return the covariance of `names` among `free` parameters, NaN where one of them is lost."""
    at = [free.index(name) for name in names]
    out = covariance[np.ix_(at, at)].copy()
    gone = [k for k, name in enumerate(names) if name in lost]
    out[gone] = np.nan
    out[:, gone] = np.nan
    return out


def directions(names: tuple[str, ...], values: Array, covariance: Array) -> tuple[Direction, ...]:
    """Return the `Direction`s of a covariance matrix of values, in their logarithms, stiff to sloppy."""
    if not names:
        return ()
    relative = covariance / np.outer(values, values)
    sizes, vectors = np.linalg.eigh(0.5 * (relative + relative.T))
    found = []
    for size, vector in zip(sizes, vectors.T, strict=True):
        sign = np.sign(vector[np.argmax(np.abs(vector))])
        found.append(
            Direction(float(np.sqrt(max(size, 0.0))), dict(zip(names, (sign * vector).tolist(), strict=True)))
        )
    return tuple(found)
