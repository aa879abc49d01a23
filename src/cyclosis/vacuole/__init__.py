"""The flow inside the cell: exact Stokes flow in the vacuole, driven by the cytoplasm at its wall.

    flow = cy.vacuole.flow(grid, u)              # u (2, n_theta, n_z): velocity (theta, z) at r = 1
    flow.at(points)                              # (n, 3) of (r, theta, z) -> (n, 3) velocity (r, theta, z)
    flow.cartesian_at(points)                    # the same points -> (n, 3) velocity (x, y, z)
    flow.volume(radii)                           # (3, n_r, n_theta, n_z): on radii x grid, by tables and FFT
    flow = cy.vacuole.flow(run)                  # a whole run, or its dataset: flow.at_time(t) is one flow
    flow = cy.vacuole.flow(run, t=20.0)          # the flow at one time
    flow = cy.vacuole.flow_of_state(params, grid, P)

The vacuole fills r < 1 with a fluid of viscosity η = 1. Lengths are in R, speeds in U, times in R/U, pressure
and traction in ηU/R. It is passive: it does not act back on the cytoplasm. It is periodic along z, as the
cell.
"""

from .flow import CLOSURES as CLOSURES
from .flow import VacuoleFlow as VacuoleFlow
from .helix import StreamFunction as StreamFunction
from .helix import axis_speed as axis_speed
from .helix import helical_bands as helical_bands
from .helix import stream_function as stream_function
from .lagrangian import Crossings as Crossings
from .lagrangian import Stretching as Stretching
from .lagrangian import poincare as poincare
from .lagrangian import residence_times as residence_times
from .lagrangian import stretching as stretching
from .sources import flow as flow
from .sources import flow_of_state as flow_of_state
from .steady import Steady as Steady
from .steady import steady as steady
from .taylor import Dispersion as Dispersion
from .taylor import dispersion as dispersion
from .tracers import Paths as Paths
from .tracers import trace as trace
from .transport import Transport as Transport
from .transport import transport as transport
from .unsteady import UnsteadyFlow as UnsteadyFlow
from .uptake import band_exchange as band_exchange
from .uptake import mixing_rate as mixing_rate
from .uptake import uptake as uptake
from .walls import Absorbing as Absorbing
from .walls import Exchange as Exchange
from .walls import Held as Held
from .walls import Sealed as Sealed
from .waves import Wave as Wave
from .waves import drag as drag
from .waves import wave as wave

__all__ = [
    "CLOSURES",
    "Absorbing",
    "Crossings",
    "Dispersion",
    "Exchange",
    "Held",
    "Paths",
    "Sealed",
    "Steady",
    "StreamFunction",
    "Stretching",
    "Transport",
    "UnsteadyFlow",
    "VacuoleFlow",
    "Wave",
    "axis_speed",
    "band_exchange",
    "dispersion",
    "drag",
    "flow",
    "flow_of_state",
    "helical_bands",
    "mixing_rate",
    "poincare",
    "residence_times",
    "steady",
    "stream_function",
    "stretching",
    "trace",
    "transport",
    "uptake",
    "wave",
]


def __dir__() -> list[str]:
    return sorted(__all__)
