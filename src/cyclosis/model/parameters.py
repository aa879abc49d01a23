"""The parameters of a cell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from ..display.notebook import alignments, tree
from .arrays import CLOSE, FIELD_DIMS, SURFACE_DIMS, by_names, dimensions, even, numbers
from .carried import labelled
from .definitions import PARAMETERS, defaults, definition
from .errors import InputError

if TYPE_CHECKING:
    from .grid import CylinderGrid

Coupling = float | npt.NDArray[np.float64]

_DEFAULT = defaults("parameters")


@dataclass(frozen=True, eq=False)
class Parameters:
    """Dimensionless parameters of the filament and flow equations.

        dP/dt + ε (u·∇)P = d⁽ˢ⁾ ∇²P - d⁽ʳ⁾ P
                           + (I - PP)·[ε (∇u)·P + α_p P + α_u u - κ (P·d) d]
        -μ ∇²u + u + Π₀ e_z + ∇Π' = |P|ⁿ P,   ∇·u = 0,   <u_z> = 0

    Every value is dimensionless: lengths in radii R, times in R/U with U = Φ/ν (see `Scales`). The
    defaults are those of Woodhouse & Goldstein, PNAS 110 (2013), Fig. 4. Each may be a number;
    `alpha_p`, `alpha_u`, `kappa` and `repulsion_angle` may also be an array (n_theta, n_z).
    Ranges are in `cyclosis.model.definitions`; anything outside raises `InputError`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.3)
        >>> params.alpha_p, params.alpha_u, params.shape
        (0.3, 0.5, None)
        >>> cy.Parameters(kappa=np.full((16, 16), 0.2)).shape
        (16, 16)
    """

    alpha_p: Coupling = _DEFAULT["alpha_p"]
    alpha_u: Coupling = _DEFAULT["alpha_u"]
    epsilon: float = _DEFAULT["epsilon"]
    d_s: float = _DEFAULT["d_s"]
    d_r: float = _DEFAULT["d_r"]
    kappa: Coupling = _DEFAULT["kappa"]
    mu: float = _DEFAULT["mu"]
    repulsion_angle: Coupling = _DEFAULT["repulsion_angle"]
    zero_theta_flux: bool = _DEFAULT["zero_theta_flux"]
    force_exponent: float = _DEFAULT["force_exponent"]
    _length: ClassVar[float | None]
    """The length of the cell on which fields were given, if their coordinates contain it."""

    def __post_init__(self) -> None:
        lengths: set[float] = set()
        for item in PARAMETERS:
            value = getattr(self, item.name)
            if item.field and dimensions(value) > 0:
                z = even(by_names(value)).get("z")
                lengths |= set() if z is None else {float(f"{z[1] * z.size:.6g}")}
                value = _field(item.name, value)
            else:
                value = item.check(value)
            object.__setattr__(self, item.name, value)
        shapes = {value.shape for _, value in self.items() if isinstance(value, np.ndarray)}
        if len(shapes) > 1:
            raise InputError("fields", sorted(shapes), "given on one grid", "give all of them one shape")
        if len(lengths) > 1:
            raise InputError("z of the fields", sorted(lengths), "that of one cell", "give all on one grid")
        object.__setattr__(self, "_length", next(iter(lengths), None))

    def items(self) -> Iterator[tuple[str, Any]]:
        """Iterate over (name, value) in the order of definition.

        Example:
            >>> import cyclosis as cy
            >>> dict(cy.Parameters().items())["d_s"]
            0.025
        """
        return ((item.name, getattr(self, item.name)) for item in fields(self))

    def replace(self, **changes: Any) -> Parameters:
        """Return a copy with some values changed (the same checks apply).

        Example:
            >>> import cyclosis as cy
            >>> cy.Parameters().replace(alpha_u=0.1) == cy.Parameters(alpha_u=0.1)
            True
        """
        unknown = set(changes) - {item.name for item in fields(self)}
        if unknown:
            raise InputError("parameter", min(unknown), "one of " + ", ".join(_DEFAULT), "check the spelling")
        changes = {name: value for name, value in changes.items() if value is not getattr(self, name)}
        changed = replace(self, **changes)
        for name in dict(self.items()).keys() - changes.keys():
            object.__setattr__(changed, name, getattr(self, name))  # fields are read-only: shared, not copied
        if self._length is not None and changed._length is None and changed.shape is not None:
            object.__setattr__(changed, "_length", self._length)
        return changed

    @property
    def shape(self) -> tuple[int, ...] | None:
        """The shape of the field-valued parameters, or None when all are numbers."""
        return next((v.shape for _, v in self.items() if isinstance(v, np.ndarray)), None)

    def require_shape(self, shape: tuple[int, int]) -> None:
        """Raise `InputError` unless the field-valued parameters have the shape of a grid.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> cy.Parameters(alpha_u=np.zeros((16, 16))).require_shape((32, 32))
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: shape of the parameter fields = (16, 16) cannot be used: ...
        """
        if self.shape not in (None, shape):
            raise InputError(
                "shape of the parameter fields",
                self.shape,
                f"that of the grid, {shape}",
                "give the fields on the grid that is used",
            )

    def require_grid(self, grid: CylinderGrid) -> None:
        """Raise `InputError` unless the shape and coordinates of field-valued parameters match a grid.

        Example:
            >>> import numpy as np
            >>> import xarray
            >>> import cyclosis as cy
            >>> short, long = cy.CylinderGrid(16, 16, length=5.0), cy.CylinderGrid(16, 16, length=10.0)
            >>> ones = np.ones((16, 16))
            >>> field = xarray.DataArray(ones, {"theta": short.theta, "z": short.z}, ("theta", "z"))
            >>> cy.Parameters(kappa=field).require_grid(long)
            Traceback (most recent call last):
                ...
            cyclosis.model.errors.InputError: length of the parameter fields = 5.0 cannot be used: ...
        """
        self.require_shape(grid.shape)
        if self._length is not None and not hasattr(grid, "length"):
            rule, remedy = "left out on a closed surface, which has no z", "give plain arrays (theta, s)"
            raise InputError("length of the parameter fields", self._length, rule, remedy)
        if self._length is not None and abs(self._length - grid.length) > CLOSE * grid.length / grid.n_z:
            rule, remedy = f"that of the grid, {grid.length:g}", "give the fields on the grid that is used"
            raise InputError("length of the parameter fields", self._length, rule, remedy)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Parameters):
            return NotImplemented
        return all(np.array_equal(a, b) for (_, a), (_, b) in zip(self.items(), other.items(), strict=True))

    def __hash__(self) -> int:
        return hash(tuple((v + 0.0).tobytes() if isinstance(v, np.ndarray) else v for _, v in self.items()))

    def _repr_html_(self) -> str:
        rows = [
            (
                item.symbol if item.symbol != "-" else item.name,
                f"{_text(getattr(self, item.name))}  {item.meaning}",
            )
            for item in PARAMETERS
        ]
        place = alignments(*(float(np.mean(value)) for value in (self.alpha_p, self.alpha_u)))
        return tree("Parameters", rows, place)

    def __repr__(self) -> str:
        return "Parameters(" + ", ".join(f"{name}={_text(value)}" for name, value in self.items()) + ")"


def _text(value: Any) -> str:
    return f"<field {value.shape}>" if isinstance(value, np.ndarray) else f"{value!r}"


def _dims_of(value: Any) -> tuple[str, ...]:
    """Return the order of a field's dimensions: those of a closed surface where one of them is its s."""
    return SURFACE_DIMS if labelled(value) and "s" in map(str, value.dims) else FIELD_DIMS


def _field(name: str, value: Any) -> npt.NDArray[np.float64]:
    item = definition("parameters", name)
    rule = f"a number or an array (n_theta, n_z) of numbers {item.rule}"
    array = numbers(name, value, rule, "give a two-dimensional array of real numbers", _dims_of(value))
    if array.ndim != 2 or not array.size:
        raise InputError(name, array, rule, "give a two-dimensional array of real numbers")
    if not np.all(np.isfinite(array)) or array.min() < item.minimum or array.max() > item.maximum:
        raise InputError(name, array, rule, "change the entries that are outside or not finite")
    array.setflags(write=False)
    return array
