"""The theory: growth rates, steady and drifting states, their spectra, branches and thresholds.

All of it is computed on the simulation's own right-hand side, or in closed form and tested against it.
`docs/stability.md` and `docs/stripes.md` derive it.
"""

from . import dispersion as dispersion
from . import elliptic as elliptic
from . import profile as profile
from .atlas import RegimeMap as RegimeMap
from .atlas import regime_map as regime_map
from .boundaries import Limits as Limits
from .boundaries import limits as limits
from .branch import Branch as Branch
from .branch import SpecialPoint as SpecialPoint
from .continuation import continue_branch as continue_branch
from .diagram import diagram as diagram
from .dispersion import growth_matrix as growth_matrix
from .dispersion import growth_rates as growth_rates
from .dispersion import stripes_threshold as stripes_threshold
from .dispersion import tilt_threshold as tilt_threshold
from .dispersion import unidirectional_order as unidirectional_order
from .eigenmodes import Modes as Modes
from .elliptic import elliptic_growth as elliptic_growth
from .elliptic import elliptic_profile as elliptic_profile
from .elliptic import front_threshold as front_threshold
from .equilibria import SteadyState as SteadyState
from .equilibria import steady_state as steady_state
from .modes import CellModes as CellModes
from .modes import leading_modes as leading_modes
from .multistripe import common_threshold as common_threshold
from .multistripe import stripe_modes as stripe_modes
from .onset import neighbourhood as neighbourhood
from .profile import Profile as Profile
from .profile import cyclosis as cyclosis
from .profile import stripes as stripes
from .saddle import unequal as unequal
from .saddle import unequal_branch as unequal_branch
from .states import states as states
from .thresholds import Threshold as Threshold
from .thresholds import destabilised as destabilised
from .thresholds import fold as fold
from .thresholds import fold_with_error as fold_with_error
from .thresholds import threshold as threshold
from .thresholds import threshold_with_error as threshold_with_error
from .travelling import Drifting as Drifting
from .travelling import drifting as drifting
from .uniform import orders as orders
