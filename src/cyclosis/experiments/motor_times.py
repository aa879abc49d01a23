"""Times of a motor-laden vesicle on a filament, in stated units: walking off, turning it, letting go.

The paper gives two of them by numbers, and of the third, reorientation, says that it lies between. Three
readings of it are here: the mechanism that the paper describes, a vesicle whose drag turns the filament;
the strain of the flow, as in microfluidic channels; and heat. All functions take numbers or arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array

BOLTZMANN_PN_UM_PER_K = 1.380649e-5
FILAMENT_DIAMETER_UM = 0.008
"""Of F-actin; it enters by a logarithm."""
READINGS = ("vesicle", "strain", "heat")


class Estimate(NamedTuple):
    """The times in seconds, arrays of one shape: τ_p, τ_r by the three readings, and τ_d."""

    procession_s: Array
    vesicle_s: Array
    strain_s: Array
    heat_s: Array
    detachment_s: Array

    def margin(self, reading: str = "vesicle") -> Array:
        """Return the smaller of τ_r/τ_p and τ_d/τ_r: above 1 the three are in the order that is needed."""
        turning = self.reorientation_s(reading)
        return np.minimum(turning / self.procession_s, self.detachment_s / turning)

    def reorientation_s(self, reading: str = "vesicle") -> Array:
        """Return τ_r by one of `READINGS`."""
        found: Array = getattr(self, f"{reading}_s")
        return found

    def best_margin(self) -> Array:
        """Return the largest margin that any τ_r could have: (τ_d/τ_p)^½."""
        return np.sqrt(self.detachment_s / self.procession_s)


def estimate(
    filament_um: npt.ArrayLike = 10.0,
    speed_um_per_s: npt.ArrayLike = 100.0,
    dwell_s: npt.ArrayLike = 1.0,
    viscosity_Pa_s: npt.ArrayLike = 0.01,
    temperature_K: npt.ArrayLike = 293.0,
    vesicle_um: npt.ArrayLike = 1.0,
    crowding: npt.ArrayLike = 10.0,
    strain_per_s: npt.ArrayLike = 2.0,
) -> Estimate:
    """Return the `Estimate` of a vesicle on a filament.

    The first three defaults are the paper's; `dwell_s`, how long a stalled motor stays, is its lower bound.
    `crowding` is how much more drag walls and network put on the filament than the fluid does: 1/ε in the
    model, in which a filament follows the flow by ε of its speed. Raises `InputError` unless all are
    positive.
    """
    L = _positive("filament_um", filament_um)
    speed = _positive("speed_um_per_s", speed_um_per_s)
    dwell = _positive("dwell_s", dwell_s)
    held = restriction(L, vesicle_um, crowding)
    return Estimate(
        *np.broadcast_arrays(
            L / speed,
            (1 + held) * 0.5 * L / speed,
            1 / _positive("strain_per_s", strain_per_s),
            heat_s(L, viscosity_Pa_s, temperature_K),
            dwell,
        )
    )


def rotational_drag(filament_um: npt.ArrayLike, viscosity_Pa_s: npt.ArrayLike) -> Array:
    """Return the drag (pN µm s) of a thin rod against turning about its middle: π η L³/(3 [ln(L/d) - 0.66]).

    Of length L (µm) and the thickness of F-actin, in a fluid of viscosity η (Pa s, which is pN s/µm²).
    """
    L = _positive("filament_um", filament_um)
    slender = np.log(L / FILAMENT_DIAMETER_UM) - 0.66
    if np.any(slender <= 0):
        raise InputError("filament_um", filament_um, "much longer than F-actin is thick", "take 0.1 or more")
    return np.asarray(np.pi * _positive("viscosity_Pa_s", viscosity_Pa_s) * L**3 / (3 * slender))


def heat_s(
    filament_um: npt.ArrayLike, viscosity_Pa_s: npt.ArrayLike, temperature_K: npt.ArrayLike = 293.0
) -> Array:
    """Return the time (s) in which heat turns a free filament: 1/(2 D_r), D_r = kT over its drag."""
    thermal = BOLTZMANN_PN_UM_PER_K * _positive("temperature_K", temperature_K)
    return np.asarray(rotational_drag(filament_um, viscosity_Pa_s) / (2 * thermal))


def restriction(
    filament_um: npt.ArrayLike, vesicle_um: npt.ArrayLike, crowding: npt.ArrayLike = 1.0
) -> Array:
    """Return the drag of a filament against turning, over that of a vesicle of a diameter (µm) at its end.

    A stalled vesicle drifts with the flow on an arm of L/2, less what the filament holds it back: it turns
    the filament by a radian in τ_r = (1 + restriction) L/2 over the speed. Viscosity cancels.
    """
    arm = 0.5 * _positive("filament_um", filament_um)
    vesicle = 3 * np.pi * _positive("vesicle_um", vesicle_um) * arm**2
    return np.asarray(_positive("crowding", crowding) * rotational_drag(filament_um, 1.0) / vesicle)


def _positive(field: str, value: npt.ArrayLike) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if not np.all(np.isfinite(array) & (array > 0)):
        raise InputError(field, value, "positive", "give it in the unit of its name")
    return array
