"""What is common to the functions that rewrite traced programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from jax.extend import core

INLINED = ("jit", "pjit")
"""Primitives that are programs of their own."""


def alone(jaxpr: Any, equation: Any) -> Callable[..., Sequence[Any]]:
    """Return the function of one primitive of a program: its arguments in order to its results."""
    places: dict[Any, int] = {}
    for place, atom in enumerate(equation.invars):
        if isinstance(atom, core.Var):
            places.setdefault(atom, place)
    one = jaxpr.replace(constvars=[], invars=list(places), outvars=equation.outvars, eqns=[equation])
    function = core.jaxpr_as_fun(core.ClosedJaxpr(one, []))
    return lambda *arguments: function(*(arguments[place] for place in places.values()))
