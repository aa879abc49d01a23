"""A traced program as a list of operations, with those of its inner programs; values are numbered."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.extend import core

from .traced_programs import INLINED, alone

TRANSFORM, CHOICE = "fft", "cond"


class Given(NamedTuple):
    """A value that is written in the program."""

    value: Any


Source = int | Given
"""Where an operation takes a value from: the number of another's result, or what is written."""
Values = dict[int, Any]
"""The values that are known so far, by number."""


@dataclass(frozen=True, eq=False)
class Operation:
    """One primitive of a program, with the numbers of its arguments and of its results."""

    equation: Any
    takes: tuple[Source, ...]
    gives: tuple[int, ...]
    act: Callable[..., Sequence[Any]]

    @property
    def needs(self) -> Iterator[int]:
        """The numbers of results of others that it takes."""
        return (source for source in self.takes if isinstance(source, int))

    @property
    def name(self) -> str:
        """The name of the primitive."""
        return str(self.equation.primitive.name)

    @property
    def kinds(self) -> list[Any]:
        """The shapes and types of its results."""
        return [variable.aval for variable in self.equation.outvars]

    @property
    def apart(self) -> bool:
        """Whether it runs by itself: a transform, or a choice between branches that have some."""
        return self.name == TRANSFORM or (self.name == CHOICE and _has_transforms(self.equation))


class Operations:
    """The operations of a traced program in order; numbers of its arguments, constants, results."""

    def __init__(self, traced: core.ClosedJaxpr) -> None:
        self.all: list[Operation] = []
        self.constants: Values = {}
        self._count = 0
        self.inputs = [self._fresh() for _ in traced.jaxpr.invars]
        self.outputs = self._add(traced.jaxpr, traced.consts, self.inputs)

    def needed(self) -> list[Operation]:
        """Return the operations that results follow from."""
        needed = {source for source in self.outputs if isinstance(source, int)}
        kept = []
        for operation in reversed(self.all):
            if needed.intersection(operation.gives):
                needed.update(operation.needs)
                kept.append(operation)
        return kept[::-1]

    def _fresh(self) -> int:
        self._count += 1
        return self._count

    def _add(self, jaxpr: Any, constants: Sequence[Any], inputs: Sequence[Source]) -> list[Source]:
        known: dict[Any, Source] = dict(zip(jaxpr.invars, inputs, strict=True))
        for variable, value in zip(jaxpr.constvars, constants, strict=True):
            known[variable] = number = self._fresh()
            self.constants[number] = jnp.asarray(value)

        def source(atom: Any) -> Source:
            kind: Any = atom.aval
            return Given(np.asarray(atom.val, kind.dtype)) if isinstance(atom, core.Literal) else known[atom]

        for equation in jaxpr.eqns:
            takes = [source(atom) for atom in equation.invars]
            if equation.primitive.name in INLINED:
                inner = equation.params["jaxpr"]
                gives = self._add(inner.jaxpr, inner.consts, takes)
            else:
                numbers = [self._fresh() for _ in equation.outvars]
                self.all.append(Operation(equation, tuple(takes), tuple(numbers), alone(jaxpr, equation)))
                gives = list(numbers)
            known.update(zip(equation.outvars, gives, strict=True))
        return [source(atom) for atom in jaxpr.outvars]


def read(known: Values, source: Source) -> Any:
    """Return a value that is known or written."""
    return source.value if isinstance(source, Given) else known[source]


def _has_transforms(equation: Any) -> bool:
    inner = [part for value in equation.params.values() for part in _programs(value)]
    return any(
        each.primitive.name == TRANSFORM or _has_transforms(each) for part in inner for each in part.eqns
    )


def _programs(value: Any) -> Iterator[Any]:
    for part in value if isinstance(value, (tuple, list)) else (value,):
        part = getattr(part, "jaxpr", part)
        if isinstance(part, core.Jaxpr):
            yield part
