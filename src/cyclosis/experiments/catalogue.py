"""The experiments by name; each is in its own file and is loaded on demand."""

from __future__ import annotations

from importlib import import_module

from ..model.errors import choice
from .experiment import Experiment

NAMES = (
    "emergence",
    "shear-straightening",
    "equal-stripes",
    "recovery",
    "surviving-seeds",
    "cytochalasin",
    "myosin-inhibition",
    "coalescence",
    "circumferential",
    "weak-repulsion",
    "force-law",
    "wound",
    "ablation",
    "timescales",
    "cell-shape",
    "twist",
    "closure",
    "vacuole-passive",
    "ends",
    "droplet",
    "mixing",
    "streaming-transport",
)
"""Every experiment: the claims of the paper in its order, then two of the literature on the vacuole."""


def experiment(name: str) -> Experiment:
    """Return an experiment by name. Raises `InputError` for a name that is not in `NAMES`.

    Example:
        >>> from cyclosis.experiments import NAMES, experiment
        >>> len(NAMES), experiment("recovery").source
        (22, 'Introduction (Foissner & Wasteneys 2000, 2007) and Figure 2')
    """
    chosen = choice("experiment", name, NAMES)
    module = import_module(f"{__package__}.{chosen.replace('-', '_')}")
    found: Experiment = module.EXPERIMENT
    return found
