"""States of the kinetic model: angular moments, made from densities, order vectors or noise, and read back.

    params, grid = cy.Parameters(), cy.CylinderGrid(32, 32)
    state = cy.kinetic.disordered(grid, seed=0)
    run = cy.simulate(params, grid, state, t_end=60.0, model=cy.models.kinetic)
    P = cy.kinetic.order(run.final_state)

A state is a complex array (N + 1, n_theta, n_z) of m_n = ∫ e^{inφ} Ψ dφ, with m_0 = c first.
"""

from .models.kinetic.angular import density as density
from .models.kinetic.angular import disordered as disordered
from .models.kinetic.angular import dressed as dressed
from .models.kinetic.angular import moments as moments
from .models.kinetic.angular import nematic as nematic
from .models.kinetic.angular import order as order
from .models.kinetic.angular import with_noise as with_noise
from .models.kinetic.model import kinetic_model as kinetic_model
from .models.kinetic.theory import NematicThresholds as NematicThresholds
from .models.kinetic.theory import growth_rates as growth_rates
from .models.kinetic.theory import thresholds as thresholds
from .models.kinetic.theory import uniform_state as uniform_state
from .stability.kinetic.branch import KineticBranch as KineticBranch
from .stability.kinetic.branch import continuation as continuation
from .stability.kinetic.dispersion import KineticDispersion as KineticDispersion
from .stability.kinetic.dispersion import dispersion as dispersion
from .stability.kinetic.modes import KineticModes as KineticModes
from .stability.kinetic.travelling import TravellingState as TravellingState
from .stability.kinetic.travelling import travelling_state as travelling_state

__all__ = [
    "KineticBranch",
    "KineticDispersion",
    "KineticModes",
    "NematicThresholds",
    "TravellingState",
    "continuation",
    "density",
    "disordered",
    "dispersion",
    "dressed",
    "growth_rates",
    "kinetic_model",
    "moments",
    "nematic",
    "order",
    "thresholds",
    "travelling_state",
    "uniform_state",
    "with_noise",
]


def __dir__() -> list[str]:
    return sorted(__all__)
