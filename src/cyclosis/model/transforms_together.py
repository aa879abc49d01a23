"""Transforms that do not depend on each other in one batch.

On a small grid half the time of a transform goes into starting it and into the last columns, which do not
fill a vector register. A batch pays that once. A term asks for the fields that it needs, one at a time;
`transforms_together` rewrites a traced function so that transforms of one kind run side by side when they
wait for the same ones. Each field is transformed as it would be alone.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import jax
import jax.numpy as jnp

from .operations import TRANSFORM, Operation, Operations, Values, read


def transforms_together(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function of arrays, with independent transforms of one kind in batches."""

    @wraps(function)
    def rewritten(*arguments: Any) -> Any:
        traced, shapes = jax.make_jaxpr(function, return_shape=True)(*arguments)
        operations = Operations(traced)
        known = operations.constants | dict(zip(operations.inputs, jax.tree.leaves(arguments), strict=True))
        for ready, transforms in _rounds(operations.needed()):
            for each in ready:
                _keep(known, each, each.act(*(read(known, source) for source in each.takes)))
            for alike in transforms:
                _transform(known, alike)
        return jax.tree.unflatten(
            jax.tree.structure(shapes), [read(known, out) for out in operations.outputs]
        )

    return rewritten


Round = tuple[list[Operation], list[list[Operation]]]
"""Operations that follow from the transforms so far, and the next transforms, those of one kind together."""


def _rounds(operations: list[Operation]) -> list[Round]:
    """Return operations in rounds, by the number of transforms that one waits for after another."""
    depth: dict[int, int] = {}
    for each in operations:
        before = max((depth.get(item, 0) for item in each.needs), default=0)
        for item in each.gives:
            depth[item] = before + (each.name == TRANSFORM)
    rounds: list[Round] = [([], []) for _ in range(1 + max(depth.values(), default=0))]
    for each in operations:
        at = depth[each.gives[0]]
        if each.name != TRANSFORM:
            rounds[at][0].append(each)
            continue
        alike = next((found for found in rounds[at - 1][1] if _kind(found[0]) == _kind(each)), None)
        if alike is None:
            rounds[at - 1][1].append([each])
        else:
            alike.append(each)
    return rounds


def _kind(transform: Operation) -> Any:
    (field,) = transform.equation.invars
    return field.aval.shape, field.aval.dtype, str(transform.equation.params)


def _keep(known: Values, operation: Operation, found: Any) -> None:
    known.update(zip(operation.gives, found, strict=True))


def _transform(known: Values, alike: list[Operation]) -> None:
    """Transform the fields of several operations of one kind."""
    fields = [read(known, each.takes[0]) for each in alike]
    if len(fields) == 1:
        _keep(known, alike[0], alike[0].act(*fields))
        return
    equation = alike[0].equation
    found = equation.primitive.bind(jnp.stack(fields), **equation.params)
    for each, one in zip(alike, found, strict=True):
        _keep(known, each, [one])
