"""cyclosis: how cytoplasmic streaming organises itself.

    import cyclosis as cy
    params = cy.Parameters(alpha_p=1.0, alpha_u=0.5)
    grid = cy.CylinderGrid(n_theta=64, n_z=64, length=5.0)
    state = cy.initial.disordered(grid, seed=0)
    run = cy.simulate(params, grid, state, t_end=200.0)
    print(cy.regime(params, grid, run.final_state))

The model is that of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110. Names load on
first use, so that importing the package is quick.
"""

from __future__ import annotations

from importlib import import_module
from threading import RLock
from typing import TYPE_CHECKING, Any

from .model import forks as _forks  # noqa: F401  (to notice every fork from now on)
from .version import __version__ as __version__

if TYPE_CHECKING:
    from . import ensemble as ensemble
    from . import kinetic as kinetic
    from . import models as models
    from . import observations as observations
    from . import stability as stability
    from . import traced as traced
    from . import vacuole as vacuole
    from .analysis import diagnostics as diagnostics
    from .analysis import zones as zones
    from .analysis.diagnostics import spectra as spectra
    from .analysis.regimes import REGIMES as REGIMES
    from .analysis.regimes import Regime as Regime
    from .closed.grid import ClosedGrid as ClosedGrid
    from .closed.shapes import Capsule as Capsule
    from .closed.shapes import Sphere as Sphere
    from .closed.shapes import Spheroid as Spheroid
    from .dataset import RunWriter as RunWriter
    from .dataset import load as load
    from .dataset import open_dataset as open_dataset
    from .dataset import resume_file as resume_file
    from .dataset import write as write
    from .dynamics.protocol import Protocol as Protocol
    from .dynamics.protocol import align as align
    from .dynamics.protocol import change as change
    from .dynamics.protocol import depolymerise as depolymerise
    from .dynamics.protocol import fragment as fragment
    from .dynamics.protocol import noise as noise
    from .dynamics.protocol import wash_out as wash_out
    from .dynamics.run import Snapshot as Snapshot
    from .dynamics.simulate import resume as resume
    from .dynamics.simulate import simulate as simulate
    from .dynamics.trajectory import Status as Status
    from .dynamics.trajectory import Trajectory as Trajectory
    from .fitting.fit import fit as fit
    from .model import initial as initial
    from .model import regions as regions
    from .model.errors import InputError as InputError
    from .model.filaments import TERMS as TERMS
    from .model.filaments import Term as Term
    from .model.grid import CylinderGrid as CylinderGrid
    from .model.grid import interpolate as interpolate
    from .model.parameters import Parameters as Parameters
    from .model.scales import Scales as Scales
    from .models.fields import diagnose as diagnose
    from .models.fields import flow as flow
    from .models.fields import rate_of_change as rate_of_change
    from .models.fields import regime as regime
    from .sweep.execute import run_sweep as run_sweep
    from .sweep.plan.sweep import Sweep as Sweep
    from .sweep.store.read import open_sweep as open_sweep

_HOME = {
    "Capsule": "closed.shapes",
    "ClosedGrid": "closed.grid",
    "CylinderGrid": "model.grid",
    "InputError": "model.errors",
    "Parameters": "model.parameters",
    "Protocol": "dynamics.protocol",
    "REGIMES": "analysis.regimes",
    "Regime": "analysis.regimes",
    "Scales": "model.scales",
    "RunWriter": "dataset",
    "Snapshot": "dynamics.run",
    "Status": "dynamics.trajectory",
    "Sphere": "closed.shapes",
    "Spheroid": "closed.shapes",
    "Sweep": "sweep.plan",
    "TERMS": "model.filaments",
    "Term": "model.filaments",
    "Trajectory": "dynamics.trajectory",
    "align": "dynamics.protocol",
    "change": "dynamics.protocol",
    "depolymerise": "dynamics.protocol",
    "diagnose": "models.fields",
    "fit": "fitting.fit",
    "flow": "models.fields",
    "fragment": "dynamics.protocol",
    "interpolate": "model.grid",
    "load": "dataset",
    "noise": "dynamics.protocol",
    "open_dataset": "dataset",
    "open_sweep": "sweep.store.read",
    "rate_of_change": "models.fields",
    "regime": "models.fields",
    "resume": "dynamics.simulate",
    "resume_file": "dataset",
    "run_sweep": "sweep.execute",
    "simulate": "dynamics.simulate",
    "spectra": "analysis.diagnostics",
    "wash_out": "dynamics.protocol",
    "write": "dataset",
}
_MODULES = {
    "closed": "closed",
    "diagnostics": "analysis.diagnostics",
    "ensemble": "ensemble",
    "initial": "model.initial",
    "kinetic": "kinetic",
    "models": "models",
    "observations": "observations",
    "regions": "model.regions",
    "stability": "stability",
    "traced": "traced",
    "vacuole": "vacuole",
    "zones": "analysis.zones",
}

__all__ = ["__version__", *sorted(_HOME), *sorted(_MODULES)]


_LOADING = RLock()
"""Held by the thread that loads a name: two at once could see each other's partly loaded modules."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES and name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    with _LOADING:
        module = import_module(f"{__name__}.{_MODULES.get(name) or _HOME[name]}")
    globals()[name] = value = module if name in _MODULES else getattr(module, name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
