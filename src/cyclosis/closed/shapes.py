"""Smooth closed surfaces of revolution: a sphere, spheroids, and capsules.

A meridian is a curve (r, z) of the latitude τ from the south pole, τ = 0, to the north pole, τ = π. Its
tangent makes the angle χ with the equatorial plane, so that with the arc length s

    r' = cos χ,   z' = sin χ,   k_s = χ',   k_θ = sin χ / r.

Lengths are in units of the largest radius, R; the normal points outwards, and a sphere has k_s = k_θ = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.errors import InputError, choice, number

Array = npt.NDArray[np.float64]

LONGEST = 60.0
"""The longest straight part of a capsule, in radii."""
FLATTEST, SLIMMEST = 0.2, 20.0
"""The range of aspect ratios of a spheroid."""
SHARPEST, ROUNDEST = 0.1, 1.0
"""The range of the smoothing of a capsule, in radii."""


class Meridian(NamedTuple):
    """A meridian at some latitudes, every entry an array of their shape (n,), dimensionless.

    `s` is the arc length from the south pole, `speed` ds/dτ, `slope` r' = cos χ, `rise` z' = sin χ, and
    `k_s` and `k_theta` are the principal curvatures.
    """

    s: Array
    r: Array
    z: Array
    speed: Array
    slope: Array
    rise: Array
    k_s: Array
    k_theta: Array


@shown
@dataclass(frozen=True)
class Spheroid:
    """A spheroid of equatorial radius 1 and half height `aspect`: r = sin τ, z = -aspect cos τ.

    Its poles are pointed for an aspect above 1 (curvature `aspect` in every direction) and flat below.
    Dimensionless. Raises `InputError` for an aspect outside 0.2 to 20.

    Example:
        >>> import cyclosis as cy
        >>> shape = cy.Spheroid(aspect=2.0)
        >>> round(shape.meridian_length, 6), shape.half_height  # half the perimeter of an ellipse
        (4.844224, 2.0)
        >>> shape.table, round(float(shape.meridian([0.0]).k_s[0]), 6)  # the curvature of its pole
        ({'kind': 'spheroid', 'aspect': 2.0}, 2.0)
    """

    aspect: float = 2.0
    kind: ClassVar[str] = "spheroid"

    def __post_init__(self) -> None:
        rule = "the default is 2, and a sphere has 1"
        object.__setattr__(self, "aspect", number("aspect", self.aspect, FLATTEST, SLIMMEST, rule))

    @property
    def meridian_length(self) -> float:
        """The length S of a meridian from pole to pole, in radii."""
        from scipy.special import ellipe

        return float(2 * self.aspect * ellipe(1 - 1 / self.aspect**2))

    @property
    def half_height(self) -> float:
        """The distance of a pole from the equatorial plane, in radii."""
        return self.aspect

    def meridian(self, tau: npt.ArrayLike) -> Meridian:
        """Return the `Meridian` at latitudes τ (n,), radians from the south pole."""
        from scipy.special import ellipe, ellipeinc

        at, c = np.asarray(tau, dtype=np.float64), self.aspect
        sin, cos = np.sin(at), np.cos(at)
        speed = np.hypot(cos, c * sin)
        # The arc from the pole is that of the ellipse from the end of its axis of length c.
        m = 1 - 1 / c**2
        s = c * (ellipe(m) - ellipeinc(np.pi / 2 - at, m))
        return Meridian(s, sin, -c * cos, speed, cos / speed, c * sin / speed, c / speed**3, c / speed)

    @property
    def table(self) -> dict[str, Any]:
        """The shape as a table of a configuration."""
        return {"kind": self.kind, "aspect": self.aspect}


@shown
@dataclass(frozen=True)
class Sphere:
    """A sphere of radius 1: a droplet. Dimensionless.

    Example:
        >>> import cyclosis as cy
        >>> cy.Sphere().table, float(cy.Sphere().meridian([1.0]).k_theta[0])
        ({'kind': 'sphere'}, 1.0)
    """

    kind: ClassVar[str] = "sphere"
    meridian_length: ClassVar[float] = float(np.pi)
    half_height: ClassVar[float] = 1.0

    def meridian(self, tau: npt.ArrayLike) -> Meridian:
        """Return the `Meridian` at latitudes τ (n,), radians from the south pole."""
        at = np.asarray(tau, dtype=np.float64)
        sin, cos, one = np.sin(at), np.cos(at), np.ones_like(at)
        return Meridian(at, sin, -cos, one, cos, sin, one, one)

    @property
    def table(self) -> dict[str, Any]:
        """The shape as a table of a configuration."""
        return {"kind": self.kind}


@shown
@dataclass(frozen=True)
class Capsule:
    """A capsule: a straight part of the given `length` between two rounded ends, of largest radius 1.

    Hemispheres would meet the straight part with a jump in curvature, at which spectral methods lose their
    accuracy. Here the curvature of the meridian is that of a box of half width a about each pole, smoothed
    with a Gaussian of width w, the `smoothing`, which is an entire function:

        χ'(s) = (π/4a) Σ_n [erf((s - nS + a)/w) - erf((s - nS - a)/w)],   S = length + 2a

    with a such that the largest radius is 1; hemispheres are w → 0, a → π/2. τ = π s/S. Dimensionless:
    lengths in radii. Raises `InputError` for a length outside 0 to 60 and a smoothing outside 0.1 to 1.

    Example:
        >>> import cyclosis as cy
        >>> cell = cy.Capsule(length=5.0, smoothing=0.4)
        >>> round(cell.half_width, 9), round(cell.meridian_length, 8), round(cell.half_height, 3)
        (1.506123625, 8.01224725, 3.454)
        >>> round(float(cell.meridian([1.5]).r[0]), 3), cell.table["smoothing"]
        (1.0, 0.4)
    """

    length: float = 5.0
    smoothing: float = 0.4
    kind: ClassVar[str] = "capsule"

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", number("length", self.length, 0.0, LONGEST, "the default is 5"))
        smoothing = number("smoothing", self.smoothing, SHARPEST, ROUNDEST, "the default is 0.4")
        object.__setattr__(self, "smoothing", smoothing)

    @property
    def half_width(self) -> float:
        """a, half the arc over which each end bends, in radii."""
        return _half_width(self.length, self.smoothing)

    @property
    def meridian_length(self) -> float:
        """The length S of a meridian from pole to pole, in radii."""
        return self.length + 2 * self.half_width

    @property
    def half_height(self) -> float:
        """The distance of a pole from the equatorial plane, in radii."""
        return float(-self.meridian(np.zeros(1)).z[0])

    def meridian(self, tau: npt.ArrayLike) -> Meridian:
        """Return the `Meridian` at latitudes τ (n,), radians from the south pole."""
        at = np.asarray(tau, dtype=np.float64)
        S, w, a = self.meridian_length, self.smoothing, self.half_width
        speed = S / np.pi
        cosines, sines = _turning_series(self.length, w, a)
        order = 2 * np.arange(len(cosines)) + 1
        waves = order * at[..., None]
        r = speed * np.sin(waves) @ (cosines / order)
        z = -speed * np.cos(waves) @ (sines / order)
        slope, rise = np.cos(waves) @ cosines, np.sin(waves) @ sines
        k_s = _curvature(speed * at, S, w, a)
        at_pole = np.abs(r) < 1e-9
        k_theta = np.where(at_pole, k_s, rise / np.where(at_pole, 1.0, r))
        return Meridian(speed * at, r, z, np.full_like(at, speed), slope, rise, k_s, k_theta)

    @property
    def table(self) -> dict[str, Any]:
        """The shape as a table of a configuration."""
        return {"kind": self.kind, "length": self.length, "smoothing": self.smoothing}


Shape = Spheroid | Sphere | Capsule
KINDS: dict[str, type[Any]] = {shape.kind: shape for shape in (Capsule, Spheroid, Sphere)}
"""The shapes by the `kind` of their table."""


def shape_of(table: dict[str, Any]) -> Shape:
    """Return the shape of a table. Raises `InputError` for a kind or a setting that there is not.

    Example:
        >>> from cyclosis.closed.shapes import shape_of
        >>> shape_of({"kind": "capsule", "length": 3.0})
        Capsule(length=3.0, smoothing=0.4)
    """
    given = dict(table)
    kind = given.pop("kind", None)
    choice("shape", kind, tuple(KINDS))
    known = tuple(getattr(KINDS[kind], "__dataclass_fields__", {}))
    for name in given:
        if name not in known:
            rule = f"a setting of a {kind}: {', '.join(known) or 'it has none'}"
            raise InputError(f"shape.{name}", given[name], rule, "remove it")
    made: Shape = KINDS[kind](**given)
    return made


def _curvature(s: Array, S: float, w: float, a: float) -> Array:
    """Return χ'(s) of a capsule."""
    from scipy.special import erf

    poles = S * np.arange(-_IMAGES, _IMAGES + 2)
    from_pole = s[..., None] - poles
    return np.pi / (4 * a) * np.sum(erf((from_pole + a) / w) - erf((from_pole - a) / w), axis=-1)


_IMAGES = 3
"""Periodic images of each pole that are summed; 2 are needed at the largest smoothing."""


def _turning(s: Array, S: float, w: float, a: float) -> Array:
    """Return χ(s), the integral of the curvature from the south pole."""
    from scipy.special import erf

    def integral(s: Array) -> Array:
        poles = S * np.arange(-_IMAGES, _IMAGES + 2)
        above, below = (s[..., None] - poles + a) / w, (s[..., None] - poles - a) / w
        each = [x * erf(x) + np.exp(-(x**2)) / np.sqrt(np.pi) for x in (above, below)]
        return np.pi * w / (4 * a) * np.sum(each[0] - each[1], axis=-1)

    return integral(s) - integral(np.zeros(1))


@lru_cache(maxsize=64)
def _turning_series(length: float, w: float, a: float) -> tuple[Array, Array]:
    """Return the coefficients of cos χ in cos((2k + 1)τ) and of sin χ in sin((2k + 1)τ).

    χ grows by π from pole to pole, so that only odd waves of period 2S occur.
    """
    S = length + 2 * a
    n = 64 * int(np.ceil((S / w + 4) / 4))
    tau = 2 * np.pi * np.arange(n) / n
    spectrum = np.fft.fft(np.exp(1j * _turning(S / np.pi * tau, S, w, a))) / n
    positive, negative = spectrum[1 : n // 4 : 2], spectrum[-1 : -n // 4 : -2]
    return (positive + negative).real, (positive - negative).real


@lru_cache(maxsize=64)
def _half_width(length: float, w: float) -> float:
    """Return a such that the largest radius, at the middle, is 1."""
    from scipy.optimize import brentq

    def excess(a: float) -> float:
        cosines, _ = _turning_series.__wrapped__(length, w, a)
        order = 2 * np.arange(len(cosines)) + 1
        return float((length + 2 * a) / np.pi * np.sum(cosines / order * (-1.0) ** np.arange(len(order)))) - 1

    return float(brentq(excess, 0.2, np.pi, xtol=1e-15, rtol=1e-15))
