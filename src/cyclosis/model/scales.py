"""Physical units: from a measured cell to the dimensionless model, and back.

The equations fix the scales: length R, speed U = Φ/ν, time R/U and pressure Φ R, so that

    μ* = μ/(ν R²),  d⁽ˢ⁾ = D_s/(R U),  d⁽ʳ⁾ = D_r R/U,  α_p = A_p R/U,  κ = K R/U,  α_u = A_u R

and ε is unchanged. (Reconstructed from the dimensionless equations of Woodhouse & Goldstein 2013.)
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from ..display.shown import shown
from .doors import door
from .errors import InputError, number
from .parameters import Coupling, Parameters

PEAK_SPEED = 0.9714276568
"""Steady peak speed in units of U at the parameters of the paper's Figure 4."""


@shown
@dataclass(frozen=True)
class PhysicalParameters:
    """The parameters of a cell in the physical units that their suffixes name.

    `bundling_per_s` is A_p, `flow_alignment_per_um` A_u, `repulsion_per_s` K,
    `spatial_diffusion_um2_per_s` D_s, `rotational_diffusion_per_s` D_r, `layer_viscosity_Pa_s_m` the
    two-dimensional μ. The last four have no unit and the same meaning as in `Parameters`.

    Example:
        >>> import cyclosis as cy
        >>> cell = cy.Scales(radius_um=500.0, speed_um_per_s=100.0).to_physical(cy.Parameters())
        >>> cell.bundling_per_s, cell.spatial_diffusion_um2_per_s, cell.epsilon
        (0.2, 1250.0, 0.1)
    """

    bundling_per_s: Coupling
    flow_alignment_per_um: Coupling
    spatial_diffusion_um2_per_s: float
    rotational_diffusion_per_s: float
    repulsion_per_s: Coupling
    layer_viscosity_Pa_s_m: float
    epsilon: float
    repulsion_angle: Coupling
    zero_theta_flux: bool
    force_exponent: float


@shown
@dataclass(frozen=True)
class Scales:
    """Units of a cell: radius R (µm), speed U = Φ/ν (µm/s) and wall friction ν (Pa s/m).

    All must be positive and finite, otherwise `InputError` is raised. In *Chara* R is 500 µm and the
    streaming speed 50 to 100 µm/s.

    Example:
        >>> import cyclosis as cy
        >>> chara = cy.Scales(radius_um=500.0, speed_um_per_s=100.0, friction_Pa_s_per_m=2e4)
        >>> chara.time_s, round(chara.force_Pa, 6), f"{chara.pressure_Pa_m:.0e}"
        (5.0, 2.0, '1e-03')
        >>> chara.seconds(200.0), chara.micrometres(5.0), chara.micrometres_per_second(0.5)
        (1000.0, 2500.0, 50.0)
        >>> chara.dimensionless_time(60.0), chara.dimensionless_length(250.0), chara.dimensionless_speed(50.0)
        (12.0, 0.5, 0.5)
    """

    radius_um: float = 500.0
    speed_um_per_s: float = 100.0
    friction_Pa_s_per_m: float = 1.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = _positive(item.name, getattr(self, item.name))
            object.__setattr__(self, item.name, value)

    @classmethod
    def from_layer(
        cls,
        radius_um: float,
        speed_um_per_s: float,
        viscosity_Pa_s: float,
        thickness_um: float,
        no_slip_walls: int = 1,
    ) -> Scales:
        """Return the scales of a layer of thickness h and viscosity η between R and the vacuole.

        ν = 3 η/h with one no-slip wall, 12 η/h with two. With μ = η h this makes μ* = h²/(3 R²) or
        h²/(12 R²): see `layer_mu`.

        Example:
            >>> import cyclosis as cy
            >>> layer = cy.Scales.from_layer(500.0, 100.0, viscosity_Pa_s=0.01, thickness_um=10.0)
            >>> round(layer.friction_Pa_s_per_m), round(layer.force_Pa, 6)
            (3000, 0.3)
        """
        friction = _wall_factor(no_slip_walls) * _positive("viscosity_Pa_s", viscosity_Pa_s)
        return cls(radius_um, speed_um_per_s, friction / (_positive("thickness_um", thickness_um) * 1e-6))

    @classmethod
    def from_peak_speed(
        cls,
        radius_um: float,
        peak_speed_um_per_s: float,
        friction_Pa_s_per_m: float = 1.0,
        peak_speed: float = PEAK_SPEED,
    ) -> Scales:
        """Return the scales that turn a computed `peak_speed` (units of U) into the measured one.

        Example:
            >>> import cyclosis as cy
            >>> scales = cy.Scales.from_peak_speed(500.0, peak_speed_um_per_s=80.0)
            >>> round(scales.speed_um_per_s, 2), round(scales.micrometres_per_second(0.9714276568), 6)
            (82.35, 80.0)
        """
        measured = _positive("peak_speed_um_per_s", peak_speed_um_per_s)
        return cls(radius_um, measured / _positive("peak_speed", peak_speed), friction_Pa_s_per_m)

    @property
    def time_s(self) -> float:
        """The unit of time R/U in seconds."""
        return self.radius_um / self.speed_um_per_s

    @property
    def force_Pa(self) -> float:
        """The force per area Φ = ν U of perfectly aligned filaments, in pascals."""
        return self.friction_Pa_s_per_m * self.speed_um_per_s * 1e-6

    @property
    def pressure_Pa_m(self) -> float:
        """The unit Φ R of the layer's two-dimensional pressure, in Pa m."""
        return self.force_Pa * self.radius_um * 1e-6

    @property
    def _viscosity_Pa_s_m(self) -> float:
        return self.friction_Pa_s_per_m * (self.radius_um * 1e-6) ** 2

    def peclet(self, diffusivity_um2_per_s: float) -> float:
        """Return Pe = U R/D of a substance with a diffusivity D (µm²/s) in the vacuole. Dimensionless.

        Raises `InputError` for a diffusivity that is not positive.

        Example: a small molecule, and a protein.
            >>> import cyclosis as cy
            >>> chara = cy.Scales(radius_um=500.0, speed_um_per_s=100.0)
            >>> chara.peclet(diffusivity_um2_per_s=1000.0), chara.peclet(50.0)
            (50.0, 1000.0)
        """
        D = _positive("diffusivity_um2_per_s", diffusivity_um2_per_s)
        return self.speed_um_per_s * self.radius_um / D

    def to_physical(self, params: Parameters) -> PhysicalParameters:
        """Return dimensionless parameters in physical units.

        Example:
            >>> import cyclosis as cy
            >>> cell = cy.Scales(500.0, 100.0).to_physical(cy.Parameters(d_r=0.025))
            >>> round(cell.rotational_diffusion_per_s, 6), round(cell.flow_alignment_per_um, 6)
            (0.005, 0.001)
        """
        return PhysicalParameters(
            bundling_per_s=params.alpha_p / self.time_s,
            flow_alignment_per_um=params.alpha_u / self.radius_um,
            spatial_diffusion_um2_per_s=params.d_s * self.radius_um * self.speed_um_per_s,
            rotational_diffusion_per_s=params.d_r / self.time_s,
            repulsion_per_s=params.kappa / self.time_s,
            layer_viscosity_Pa_s_m=params.mu * self._viscosity_Pa_s_m,
            epsilon=params.epsilon,
            repulsion_angle=params.repulsion_angle,
            zero_theta_flux=params.zero_theta_flux,
            force_exponent=params.force_exponent,
        )

    def from_physical(self, physical: PhysicalParameters) -> Parameters:
        """Return the dimensionless `Parameters` of a cell; `to_physical` undoes it to rounding.

        Example:
            >>> from dataclasses import replace
            >>> import cyclosis as cy
            >>> scales = cy.Scales(500.0, 100.0)
            >>> cell = replace(scales.to_physical(cy.Parameters()), rotational_diffusion_per_s=0.01)
            >>> round(scales.from_physical(cell).d_r, 6)
            0.05
        """
        return Parameters(
            alpha_p=physical.bundling_per_s * self.time_s,
            alpha_u=physical.flow_alignment_per_um * self.radius_um,
            epsilon=physical.epsilon,
            d_s=physical.spatial_diffusion_um2_per_s / (self.radius_um * self.speed_um_per_s),
            d_r=physical.rotational_diffusion_per_s * self.time_s,
            kappa=physical.repulsion_per_s * self.time_s,
            mu=physical.layer_viscosity_Pa_s_m / self._viscosity_Pa_s_m,
            repulsion_angle=physical.repulsion_angle,
            zero_theta_flux=physical.zero_theta_flux,
            force_exponent=physical.force_exponent,
        )

    def seconds(self, time: Any) -> Any:
        """Return a dimensionless time in seconds."""
        return time * self.time_s

    def micrometres(self, length: Any) -> Any:
        """Return a dimensionless length in micrometres."""
        return length * self.radius_um

    def micrometres_per_second(self, speed: Any) -> Any:
        """Return a dimensionless speed in micrometres per second."""
        return speed * self.speed_um_per_s

    def dimensionless_time(self, seconds: Any) -> Any:
        """Return a time in seconds in units of R/U."""
        return seconds / self.time_s

    def dimensionless_length(self, micrometres: Any) -> Any:
        """Return a length in micrometres in radii."""
        return micrometres / self.radius_um

    def dimensionless_speed(self, micrometres_per_second: Any) -> Any:
        """Return a speed in micrometres per second in units of U."""
        return micrometres_per_second / self.speed_um_per_s


@door
def layer_mu(thickness_to_radius: float, no_slip_walls: int = 1) -> float:
    """Return μ* = (h/R)²/3 (one no-slip wall) or (h/R)²/12 (two) of a layer of thickness h.

    The paper's μ* = 0.05 means h/R = 0.39 or 0.77: a representative value, not literally a thin layer.
    Dimensionless. Raises `InputError` for a thickness that is not positive and for other numbers of walls.

    Example:
        >>> from cyclosis.model.scales import layer_mu
        >>> round(layer_mu(0.39), 2), round(layer_mu(0.77, no_slip_walls=2), 2)
        (0.05, 0.05)
    """
    return _positive("thickness_to_radius", thickness_to_radius) ** 2 / _wall_factor(no_slip_walls)


def _wall_factor(no_slip_walls: int) -> float:
    if no_slip_walls not in (1, 2):
        raise InputError("no_slip_walls", no_slip_walls, "1 or 2", "count the no-slip sides of the layer")
    return 3.0 if no_slip_walls == 1 else 12.0


def _positive(field: str, value: Any) -> float:
    return number(field, value, 1e-30, 1e30, "give a positive number in the unit of its name")
