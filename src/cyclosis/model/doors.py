"""The checks that every public function makes on its arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, TypeVar, cast

from .carried import NOT_TRACED, traced
from .errors import InputError

Function = TypeVar("Function", bound=Callable[..., Any])

KINDS = {"params": "Parameters", "grid": "CylinderGrid", "run": "Trajectory"}
"""Arguments that have one type wherever they occur."""
GRIDS = ("CylinderGrid", "ClosedGrid")
"""The classes of grids; which of them a function takes, the annotation of its argument says."""
OF_MODEL = {"params": "parameters", "grid": "grid"}
"""Those whose type is that of a model where one is given, by the field of `Model` that holds it."""


def door(function: Function) -> Function:
    """Refuse swapped arguments, and values that JAX traces.

    Raises `InputError` with one sentence: which argument is wrong, and the order of the arguments.
    """
    return _door(function, False)


def traced_door(function: Function) -> Function:
    """Refuse swapped arguments of a function that JAX may trace."""
    return _door(function, True)


def _door(function: Function, traceable: bool) -> Function:
    signature = inspect.signature(function)
    names = [item.name for item in signature.parameters.values() if item.kind is item.POSITIONAL_OR_KEYWORD]
    needed = [name for name in names if signature.parameters[name].default is inspect.Parameter.empty]
    order = ", ".join(name for name in needed if name != "self")
    call = f"write {function.__name__}({order})"
    grids = _grids(signature)

    @functools.wraps(function)
    def checked(*args: Any, **kwargs: Any) -> Any:
        for name, value in (*zip(names, args, strict=False), *kwargs.items()):
            kind = KINDS.get(name)
            if kind is not None:
                required(name, value, call, kwargs.get("model"), grids)
            if not traceable and kind is None and not callable(value) and traced(value):
                raise InputError(name, value, *NOT_TRACED)
        return function(*args, **kwargs)

    return cast(Function, checked)


def is_a(value: Any, kind: str) -> bool:
    """Return whether a value is of a class of this package, by the name of the class."""
    return any(c.__name__ == kind and c.__module__.startswith("cyclosis.") for c in type(value).__mro__)


def _grids(signature: inspect.Signature) -> tuple[str, ...]:
    """Return the classes of grids that a function takes."""
    if "grid" not in signature.parameters:
        return GRIDS[:1]
    annotation = str(signature.parameters["grid"].annotation)
    if annotation == "Any":
        return GRIDS
    return tuple(kind for kind in GRIDS if kind in annotation) or GRIDS[:1]


def required(name: str, value: Any, call: str, model: Any = None, grids: tuple[str, ...] = GRIDS[:1]) -> None:
    """Raise `InputError` if an argument is not of the class for its name: the model's, if one is given.

    `grids` are the classes that a grid may have without a model.
    """
    own = getattr(model, OF_MODEL.get(name, ""), None)
    if own is not None and not isinstance(value, own):
        raise InputError(name, value, f"a {own.__name__}", call)
    kinds = grids if name == "grid" else (KINDS[name],)
    if own is None and not any(is_a(value, kind) for kind in kinds):
        raise InputError(name, value, "a cyclosis." + " or ".join(kinds), call)
