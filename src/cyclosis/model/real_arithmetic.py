"""Complex arithmetic in pairs of real arrays.

Terms are written with packed complex fields. On a processor XLA does not vectorise complex arithmetic: with
real and imaginary parts in arrays of their own the point-wise work of a right-hand side takes about half as
long. `in_real_arithmetic` rewrites a traced function in this way; only its Fourier transforms stay complex.
Results are the same to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.extend import core

from .traced_programs import INLINED, alone


class Pair(NamedTuple):
    """A complex array by its parts; `imag` is None where it is zero."""

    real: Any
    imag: Any


def in_real_arithmetic(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function of arrays, with its point-wise complex arithmetic in real arrays."""

    @wraps(function)
    def rewritten(*arguments: Any) -> Any:
        traced, shapes = jax.make_jaxpr(function, return_shape=True)(*arguments)
        found = _evaluated(traced.jaxpr, traced.consts, jax.tree.leaves(arguments))
        return jax.tree.unflatten(jax.tree.structure(shapes), [_joined(value) for value in found])

    return rewritten


def _evaluated(jaxpr: core.Jaxpr, constants: Any, arguments: Any) -> list[Any]:
    """Return the results of a traced program; values are arrays, or `Pair`s of complex ones."""
    known: dict[core.Var, Any] = dict(
        zip([*jaxpr.constvars, *jaxpr.invars], [*constants, *arguments], strict=True)
    )

    def read(atom: Any, split: bool = False) -> Any:
        if isinstance(atom, core.Literal):
            return _split(atom.val) if split else atom.val
        if split and not isinstance(known[atom], Pair):
            known[atom] = _split(known[atom])
        return known[atom]

    for equation in jaxpr.eqns:
        name, inputs = equation.primitive.name, equation.invars
        several = equation.primitive.multiple_results
        found: Any = NotImplemented
        if name in INLINED:
            inner = equation.params["jaxpr"]
            found = _evaluated(inner.jaxpr, inner.consts, [read(atom) for atom in inputs])
        elif name in RULES and any(_complex(atom) for atom in (*inputs, *equation.outvars)):
            found = RULES[name](*(read(atom, _complex(atom)) for atom in inputs), **equation.params)
        if found is NotImplemented:
            values = alone(jaxpr, equation)(*(_joined(read(atom)) for atom in inputs))
            found = values if several else values[0]
        known.update(zip(equation.outvars, found if several else [found], strict=True))
    return [read(atom) for atom in jaxpr.outvars]


def _complex(atom: Any) -> bool:
    return bool(jnp.issubdtype(atom.aval.dtype, jnp.complexfloating))


def _split(value: Any) -> Pair:
    if isinstance(value, jax.Array):
        return Pair(lax.real(value), lax.imag(value))
    return Pair(np.real(value), np.imag(value) if np.any(np.imag(value)) else None)  # a constant


def _joined(value: Any) -> Any:
    if not isinstance(value, Pair):
        return value
    return lax.complex(value.real, jnp.zeros_like(value.real) if value.imag is None else value.imag)


def _sum(a: Any, b: Any) -> Any:
    if a is None:
        return b
    return a if b is None else a + b


def _product(a: Any, b: Any) -> Any:
    return None if a is None or b is None else a * b


def _minus(a: Any) -> Any:
    return None if a is None else -a


def _add(a: Pair, b: Pair, **_: Any) -> Pair:
    return Pair(a.real + b.real, _sum(a.imag, b.imag))


def _sub(a: Pair, b: Pair, **_: Any) -> Pair:
    return Pair(a.real - b.real, _sum(a.imag, _minus(b.imag)))


def _mul(a: Pair, b: Pair, **_: Any) -> Pair:
    across = _product(a.imag, b.imag)
    real = a.real * b.real if across is None else a.real * b.real - across
    return Pair(real, _sum(_product(a.real, b.imag), _product(a.imag, b.real)))


def _div(a: Pair, b: Pair, **_: Any) -> Any:
    if b.imag is not None:
        return NotImplemented
    return Pair(a.real / b.real, None if a.imag is None else a.imag / b.real)


def _power(a: Pair, *, y: int, **_: Any) -> Any:
    return _mul(a, a) if y == 2 else NotImplemented


def _converted(a: Any, *, new_dtype: Any, **_: Any) -> Any:
    if not jnp.issubdtype(new_dtype, jnp.complexfloating):
        return NotImplemented
    real = np.finfo(new_dtype).dtype
    if not isinstance(a, Pair):
        return Pair(lax.convert_element_type(a, real), None)
    return Pair(*(None if part is None else lax.convert_element_type(part, real) for part in a))


def _each(name: str) -> Callable[..., Any]:
    """Return the rule of a primitive that moves numbers: it acts on both parts alike."""

    def rule(a: Pair, *others: Any, **params: Any) -> Any:
        primitive = getattr(lax, f"{name}_p")
        return Pair(*(None if part is None else primitive.bind(part, *others, **params) for part in a))

    return rule


def _whole(parts: tuple[Pair, ...]) -> list[Pair]:
    """Return pairs with both parts in memory."""
    return [a if a.imag is not None else Pair(a.real, jnp.zeros_like(a.real)) for a in parts]


def _concatenated(*parts: Pair, dimension: int) -> Pair:
    if all(a.imag is None for a in parts):
        return Pair(lax.concatenate([a.real for a in parts], dimension), None)
    full = _whole(parts)
    return Pair(*(lax.concatenate([a[k] for a in full], dimension) for k in (0, 1)))


def _divided(a: Pair, **params: Any) -> list[Pair]:
    primitive: Any = lax.split_p
    real = primitive.bind(a.real, **params)
    imag = [None] * len(real) if a.imag is None else primitive.bind(a.imag, **params)
    return [Pair(*parts) for parts in zip(real, imag, strict=True)]


def _selected(which: Any, *cases: Pair) -> Pair:
    full = _whole(cases)
    return Pair(*(lax.select_n(which, *(a[k] for a in full)) for k in (0, 1)))


RULES: dict[str, Callable[..., Any]] = {
    "add": _add,
    "add_any": _add,
    "sub": _sub,
    "mul": _mul,
    "div": _div,
    "neg": lambda a, **_: Pair(-a.real, _minus(a.imag)),
    "conj": lambda a, **_: Pair(a.real, _minus(a.imag)) if isinstance(a, Pair) else Pair(a, None),
    "real": lambda a, **_: a.real,
    "imag": lambda a, **_: jnp.zeros_like(a.real) if a.imag is None else a.imag,
    "complex": lambda real, imag, **_: Pair(real, imag),
    "integer_pow": _power,
    "square": lambda a, **_: _mul(a, a),
    "convert_element_type": _converted,
    "concatenate": _concatenated,
    "select_n": _selected,
    "split": _divided,
    **{
        name: _each(name)
        for name in (
            "broadcast_in_dim",
            "reshape",
            "rev",
            "slice",
            "squeeze",
            "transpose",
            "reduce_sum",
            "copy",
        )
    },
}
"""How primitives act on pairs; all others act on complex arrays."""
