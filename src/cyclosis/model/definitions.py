"""Every setting of a run, defined once: symbol, name, meaning, default, range.

Validation, the command line's options, the configuration file and the documentation's tables all read
these definitions. Nothing heavy is imported here.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

from . import errors
from .equation import TERM_NAMES as TERM_NAMES

Kind = Literal["number", "whole", "flag", "choice", "text", "names", "numbers", "shape"]


@dataclass(frozen=True)
class Definition:
    """One setting: what it is called, what it means and what it may be.

    `optional` settings may also be None, `needed` ones have no default; `field` marks a parameter that may
    be given as an array of shape (n_theta, n_z). `usual` is the range of a slider: where the paper's cell
    lives, and around.
    """

    name: str
    symbol: str
    meaning: str
    default: Any
    kind: Kind = "number"
    minimum: float = 0.0
    maximum: float = 1e3
    allowed: tuple[str, ...] = ()
    optional: bool = False
    field: bool = False
    needed: bool = False
    usual: tuple[float, float] | None = None

    @property
    def remedy(self) -> str:
        """What to do about a refused value."""
        if self.needed:
            return "give one, for there is no default"
        if self.default is None:
            return "leave it out for the default"
        return f"the default is {str(self.default).lower() if self.kind == 'flag' else self.default}"

    @property
    def rule(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return "one of " + ", ".join(self.allowed)
        if self.kind == "flag":
            return "true or false"
        if self.kind in ("number", "whole"):
            return errors.span(self.minimum, self.maximum)
        return {
            "text": "a text",
            "names": "a list of names",
            "numbers": "a list of numbers in increasing order",
            "shape": "two whole numbers [n_theta, n_z]",
        }[self.kind]

    def check(self, value: Any) -> Any:
        """Return `value` in its proper type, or raise `InputError` with one sentence."""
        if value is None and self.optional:
            return None
        if self.kind == "number":
            return errors.number(self.name, value, self.minimum, self.maximum, self.remedy)
        if self.kind == "whole":
            return errors.whole(self.name, value, int(self.minimum), int(self.maximum), self.remedy)
        if self.kind == "flag":
            return errors.flag(self.name, value)
        if self.kind == "choice":
            return errors.choice(self.name, value, self.allowed)
        if self.kind == "text":
            if not isinstance(value, str) or not value or "\0" in value:
                raise errors.InputError(self.name, value, self.rule, self.remedy)
            return value
        return self._check_list(value)

    def parse(self, text: str) -> Any:
        """Return the value that a text on the command line stands for, checked."""
        if self.kind in ("names", "numbers", "shape"):
            parts = [part.strip() for part in text.split(",")]
            return self.check(parts if self.kind == "names" else [_plain(part) for part in parts])
        if self.kind in ("text", "choice"):
            return self.check(text)
        return self.check(_plain(text))

    def _check_list(self, value: Any) -> tuple[Any, ...]:
        listed = isinstance(value, list | tuple)
        if self.kind == "names":
            if not listed or not value or not all(isinstance(item, str) for item in value):
                raise errors.InputError(self.name, value, "a list of at least one name", self.remedy)
            return tuple(errors.choice(self.name, item, self.allowed or (item,)) for item in value)
        if self.kind == "shape":
            if not listed or len(value) != 2:
                raise errors.InputError(self.name, value, self.rule, self.remedy)
            low, high = int(self.minimum), int(self.maximum)
            return tuple(errors.whole(self.name, item, low, high, self.remedy) for item in value)
        if not listed or not value:
            raise errors.InputError(self.name, value, self.rule, self.remedy)
        times = tuple(
            errors.number(self.name, item, self.minimum, self.maximum, self.remedy) for item in value
        )
        if any(b <= a for a, b in pairwise(times)):
            raise errors.InputError(self.name, value, self.rule, "sort them and leave out repeats")
        return times


def _plain(text: str) -> Any:
    """Return a text as bool, int or float where it is one, else as it is."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


PARAMETERS = (
    Definition("alpha_p", "α_p", "spontaneous alignment (bundling) rate", 1.0, field=True, usual=(0.0, 1.0)),
    Definition(
        "alpha_u", "α_u", "polar alignment of filaments with the flow", 0.5, field=True, usual=(0.0, 1.0)
    ),
    Definition(
        "epsilon",
        "ε",
        "passive advection and shear alignment left by restriction",
        0.1,
        maximum=10.0,
        usual=(0.0, 1.0),
    ),
    Definition("d_s", "d⁽ˢ⁾", "spatial diffusion constant", 0.025, maximum=10.0, usual=(0.0, 0.1)),
    Definition("d_r", "d⁽ʳ⁾", "rotational diffusion constant", 0.025, maximum=10.0, usual=(0.0, 0.2)),
    Definition("kappa", "κ", "strength of the repulsive direction", 0.5, field=True, usual=(0.0, 1.0)),
    Definition(
        "mu",
        "μ",
        "viscosity of the layer relative to its wall friction",
        0.05,
        maximum=100.0,
        usual=(0.0, 1.0),
    ),
    Definition(
        "repulsion_angle",
        "φ_d",
        "angle of the repulsive direction d from e_theta, in radians",
        0.0,
        minimum=-10.0,
        maximum=10.0,
        field=True,
        usual=(-1.6, 1.6),
    ),
    Definition(
        "zero_theta_flux",
        "-",
        "also hold the mean circumferential flow at zero",
        False,
        kind="flag",
    ),
    Definition(
        "force_exponent", "n", "exponent of the force law F = |P|^n P", 2.0, maximum=10.0, usual=(0.0, 4.0)
    ),
)

GRID = (
    Definition("n_theta", "n_θ", "grid points around the axis", 64, "whole", 8, 8192),
    Definition("n_z", "n_z", "grid points along the axis", 64, "whole", 8, 8192),
    Definition("length", "ℓ", "axial period in units of the radius", 5.0, "number", 1e-2, 1e4),
)

INITIAL = (
    Definition(
        "kind",
        "P(0)",
        "initial state",
        "disordered",
        "choice",
        allowed=("disordered", "unidirectional", "circumferential", "stripes", "file"),
    ),
    Definition("seed", "s", "seed of the random numbers", 0, "whole", 0, 2**63 - 1),
    Definition(
        "filaments_per_square",
        "N",
        "filaments per grid square, noise variance 1/(2N); in ordered states left out for no noise",
        1000.0,
        "number",
        1e-3,
        1e15,
    ),
    Definition(
        "noise_grid",
        "-",
        "grid [n_theta, n_z] on which the noise is drawn",
        None,
        "shape",
        8,
        8192,
        optional=True,
    ),
    Definition("magnitude", "|P|", "magnitude of an ordered initial state", 0.9, "number", 0.0, 1.0),
    Definition("stripes", "-", "number of stripes of an initial state of stripes", 2, "whole", 2, 512),
    Definition("path", "-", "file that an initial state is read from", None, "text", optional=True),
    Definition(
        "frame",
        "-",
        "frame of that file, counted from 0, or from the end if negative",
        -1,
        "whole",
        -(10**9),
        10**9,
    ),
)

STEPPERS = ("adaptive", "etdrk4", "rk4")
"""The time steppers, that with adaptive steps first; `dynamics.steppers.METHODS` says how each steps."""

RUN = (
    Definition("t_end", "t", "time at which the run ends", 200.0, "number", 0.0, 1e9),
    Definition("save_every", "-", "time between saved fields", 1.0, "number", 1e-6, 1e9),
    Definition(
        "save_at",
        "-",
        "times of saved fields, instead of save_every",
        None,
        "numbers",
        0.0,
        1e9,
        optional=True,
    ),
    Definition(
        "record_every",
        "-",
        "time between recorded scalars (default: where fields are saved)",
        None,
        "number",
        1e-6,
        1e9,
        optional=True,
    ),
    Definition("stepper", "-", "time stepper", STEPPERS[0], "choice", allowed=STEPPERS),
    Definition(
        "rtol", "-", "relative error allowed in a step of the adaptive stepper", 1e-4, "number", 1e-13, 1e-1
    ),
    Definition(
        "atol", "-", "absolute error allowed in a step (root mean square of P)", 1e-10, "number", 0.0, 1e-1
    ),
    Definition(
        "dt",
        "Δt",
        "time step of the fixed steppers (default: 0.1, or rk4's stability bound)",
        None,
        "number",
        1e-9,
        1e3,
        optional=True,
    ),
    Definition(
        "dealias",
        "-",
        "padding of products against aliasing",
        "none",
        "choice",
        allowed=("none", "quadratic", "cubic", "full"),
    ),
    Definition(
        "precision", "-", "floating-point precision", "float64", "choice", allowed=("float64", "float32")
    ),
    Definition(
        "terms", "-", "terms of the filament equation that act", TERM_NAMES, "names", allowed=TERM_NAMES
    ),
    Definition(
        "steady_rate",
        "-",
        "stop as steady once |dP/dt| / |P| falls below this",
        None,
        "number",
        1e-14,
        1.0,
        optional=True,
    ),
)

TABLES = {"parameters": PARAMETERS, "grid": GRID, "initial": INITIAL, "run": RUN}


def definition(table: str, name: str) -> Definition:
    """Return the definition of `name` in one of `TABLES`."""
    return next(item for item in TABLES[table] if item.name == name)


def defaults(table: str) -> dict[str, Any]:
    """Return every default of one of `TABLES`."""
    return {item.name: item.default for item in TABLES[table]}
