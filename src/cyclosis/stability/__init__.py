"""The theory: growth rates, steady and drifting states, their eigenvalues, branches and thresholds.

All of it is computed on the simulation's own right-hand side, or in closed form and tested against it.
`docs/stability.md` and `docs/stripes.md` derive it.
"""

import sys

from .branches.branch import Branch as Branch
from .branches.branch import SpecialPoint as SpecialPoint
from .branches.continuation import continue_branch as continue_branch
from .branches.diagram import diagram as diagram
from .cell.equilibria import SteadyState as SteadyState
from .cell.equilibria import steady_state as steady_state
from .cell.modes import CellModes as CellModes
from .cell.modes import leading_modes as leading_modes
from .closed_cells import AxialState as AxialState
from .closed_cells import AzimuthalMode as AzimuthalMode
from .closed_cells import azimuthal_mode as azimuthal_mode
from .closed_cells import azimuthal_rates as azimuthal_rates
from .closed_cells import source_to_sink as source_to_sink
from .existence.boundaries import Limits as Limits
from .existence.boundaries import limits as limits
from .existence.multistripe import common_threshold as common_threshold
from .existence.multistripe import stripe_modes as stripe_modes
from .existence.onset import neighbourhood as neighbourhood
from .existence.saddle import unequal as unequal
from .existence.saddle import unequal_branch as unequal_branch
from .existence.thresholds import Threshold as Threshold
from .existence.thresholds import destabilised as destabilised
from .existence.thresholds import fold as fold
from .existence.thresholds import fold_with_error as fold_with_error
from .existence.thresholds import threshold as threshold
from .existence.thresholds import threshold_with_error as threshold_with_error
from .profiles import elliptic as elliptic
from .profiles import profile as profile
from .profiles.eigenmodes import Modes as Modes
from .profiles.elliptic import elliptic_growth as elliptic_growth
from .profiles.elliptic import elliptic_profile as elliptic_profile
from .profiles.elliptic import front_threshold as front_threshold
from .profiles.profile import Profile as Profile
from .profiles.profile import cyclosis as cyclosis
from .profiles.profile import stripes as stripes
from .profiles.travelling import Drifting as Drifting
from .profiles.travelling import drifting as drifting
from .regime_map import RegimeMap as RegimeMap
from .regime_map import regime_map as regime_map
from .states import states as states
from .uniform import dispersion as dispersion
from .uniform.dispersion import growth_matrix as growth_matrix
from .uniform.dispersion import growth_rates as growth_rates
from .uniform.dispersion import stripes_threshold as stripes_threshold
from .uniform.dispersion import tilt_threshold as tilt_threshold
from .uniform.dispersion import unidirectional_order as unidirectional_order
from .uniform.uniform import orders as orders

__all__ = [
    "AxialState",
    "AzimuthalMode",
    "Branch",
    "CellModes",
    "Drifting",
    "Limits",
    "Modes",
    "Profile",
    "RegimeMap",
    "SpecialPoint",
    "SteadyState",
    "Threshold",
    "azimuthal_mode",
    "azimuthal_rates",
    "common_threshold",
    "continue_branch",
    "cyclosis",
    "destabilised",
    "diagram",
    "dispersion",
    "drifting",
    "elliptic",
    "elliptic_growth",
    "elliptic_profile",
    "fold",
    "fold_with_error",
    "front_threshold",
    "growth_matrix",
    "growth_rates",
    "leading_modes",
    "limits",
    "neighbourhood",
    "orders",
    "profile",
    "regime_map",
    "source_to_sink",
    "states",
    "steady_state",
    "stripe_modes",
    "stripes",
    "stripes_threshold",
    "threshold",
    "threshold_with_error",
    "tilt_threshold",
    "unequal",
    "unequal_branch",
    "unidirectional_order",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Public modules keep the paths under which they can be imported.
for _module in (dispersion, elliptic, profile):
    sys.modules[f"{__name__}.{_module.__name__.rpartition('.')[2]}"] = _module
