"""All models by name: what `model=`, `[model] kind` and `--model` choose from.

Example:
    >>> import cyclosis as cy
    >>> cy.models.MODELS
    {'polar': cyclosis.models.polar, 'kinetic': cyclosis.models.kinetic, ...}
    >>> cy.models.polar.title
    'Self-organised cytoplasmic streaming on a cylinder'
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

from ..contract.members import Starts
from ..contract.model import Model
from ..model.errors import InputError, choice
from .closed.model import closed as closed
from .closed.model import closed_model as closed_model
from .coupled import coupled as coupled
from .coupled import coupled_model as coupled_model
from .kinetic.model import kinetic as kinetic
from .kinetic.model import kinetic_model
from .polar_cylinder import polar as polar
from .polar_model import polar_model as polar_model

__all__ = [
    "FREE",
    "MAKERS",
    "MODELS",
    "closed",
    "closed_model",
    "coupled",
    "coupled_model",
    "kinetic",
    "kinetic_model",
    "named",
    "of_grid",
    "of_tables",
    "polar",
    "polar_model",
    "starts_of",
]


def __dir__() -> list[str]:
    return sorted(__all__)


MODELS = {item.name: item for item in (polar, kinetic, coupled, closed)}
"""All models by name."""


MAKERS: dict[str, Callable[..., Model]] = {
    polar.name: polar_model,
    kinetic.name: kinetic_model,
    coupled.name: coupled_model,
    closed.name: closed_model,
}
"""What makes a model of the other settings of its [model] table, by name."""
FREE = ("modes",)
"""Settings that need not be the same to continue a run: its state decides."""


def of_tables(tables: Mapping[str, Any], given: Model | None = None) -> Model:
    """Return the model of a configuration's [model] table, as `named` does; polar if the table is missing.

    Raises `InputError` for settings that the model does not have, and if a model that is `given` has others.

    Example:
        >>> import cyclosis as cy
        >>> cy.models.of_tables({}), cy.models.of_tables({"model": {"kind": "polar"}})
        (cyclosis.models.polar, cyclosis.models.polar)
        >>> cy.models.of_tables({"model": {"kind": "kinetic", "closure": "weak"}})
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: closure = 'weak' cannot be used: ...
    """
    table = dict(tables.get("model", {}))
    kind = table.pop("kind", polar.name)
    options = {key: value for key, value in table.items() if value is not None}
    if kind not in MAKERS:
        return named(kind, given)
    for key in options:
        owners = [name for name, make in MAKERS.items() if key in signature(make).parameters]
        if kind not in owners:
            rule = f"used only where [model] kind is {' or '.join(owners)}"
            raise InputError(key, options[key], rule, "remove it")
    made: Model = MAKERS[kind](**options)
    if given is None:
        return made
    same = named(kind, given)
    for key in sorted({*made.options, *same.options} - {*FREE}):
        if made.options.get(key) != same.options.get(key):
            rule = f"{made.wording}, as in the file"
            raise InputError("model", same.wording, rule, "give that model, or none")
    return same


def of_grid(grid: Any) -> Model:
    """Return the model that a grid has by default: polar on a cylinder, closed on a closed surface.

    Example:
        >>> import cyclosis as cy
        >>> cy.models.of_grid(cy.CylinderGrid(16, 16)), cy.models.of_grid(cy.ClosedGrid(cy.Sphere(), k_max=8))
        (cyclosis.models.polar, cyclosis.models.closed)
    """
    return next((model for model in (closed,) if isinstance(grid, model.grid)), polar)


def starts_of(model: Model) -> Starts:
    """Return how a model makes initial states from tables. Raises `InputError` if it does not.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> cy.models.starts_of(cy.models.polar).make({"kind": "stripes"}, grid).shape
        (2, 16, 16)
    """
    if model.starts is None:
        raise InputError("model", model.name, "one whose initial states have tables", "choose another")
    return model.starts


def named(name: Any, given: Model | None = None) -> Model:
    """Return the model of a name; if a model is `given`, it must have that name.

    Raises `InputError` for a name that no model has.

    Example:
        >>> import cyclosis as cy
        >>> cy.models.named("bipolar")
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: model = 'bipolar' cannot be used: ...
    """
    if given is None:
        choice("model", name, tuple(MODELS))
        return MODELS[name]
    if given.name != name:
        raise InputError("model", given.name, f"that of the file, {name}", "give that model")
    return given
