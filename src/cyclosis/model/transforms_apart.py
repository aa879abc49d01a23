"""Programs in pieces, so that every Fourier transform runs by itself, on all cores.

Within one compiled program XLA computes Fourier transforms on one core of a processor: a point-wise
operation moves the program to a thread of the very pool that would share the next transform. Called from
outside, a transform uses the whole pool. `transforms_apart` cuts a traced function there; what lies between
two transforms is a compiled program. Calling a piece takes some hundredths of a millisecond, so that this
pays for large fields. Results are those of one program, to rounding, on any number of cores.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, wraps
from typing import Any, NamedTuple

import jax
import numpy as np
from jax import lax
from jax.extend import core

from .traced_programs import INLINED, alone

MOST_KEPT = 32
"""Programs in pieces that are kept, one for each shape of the arguments."""
TRANSFORM, CHOICE = "fft", "cond"

Values = dict[int, Any]
"""The values that are known so far, by number."""


class Given(NamedTuple):
    """A value that is written in the program."""

    value: Any


Source = int | Given
"""Where an operation takes a value from: the number of another's result, or what is written."""


@dataclass(frozen=True, eq=False)
class Operation:
    """One primitive of a program, with the numbers of its arguments and of its results."""

    equation: Any
    act: Callable[..., Sequence[Any]]
    takes: tuple[Source, ...]
    gives: tuple[int, ...]

    @property
    def needs(self) -> Iterator[int]:
        """The numbers of results of others that it takes."""
        return (source for source in self.takes if isinstance(source, int))

    @property
    def apart(self) -> bool:
        """Whether it runs by itself: a transform, or a choice between branches that have some."""
        name = self.equation.primitive.name
        return name == TRANSFORM or (name == CHOICE and _has_transforms(self.equation))

    def run(self, known: Values) -> None:
        """Compute the results from what is known."""
        known.update(zip(self.gives, self.act(*(_read(known, source) for source in self.takes)), strict=True))


@dataclass(frozen=True, eq=False)
class Piece:
    """Operations between transforms, as one compiled program."""

    takes: tuple[int, ...]
    gives: tuple[int, ...]
    compiled: Callable[..., Sequence[Any]]

    @property
    def needs(self) -> tuple[int, ...]:
        """The numbers of results of others that it takes."""
        return self.takes

    def run(self, known: Values) -> None:
        """Compute the results from what is known."""
        known.update(zip(self.gives, self.compiled(*(known[item] for item in self.takes)), strict=True))


class Program:
    """A traced program cut into pieces that run one after another."""

    def __init__(self, traced: core.ClosedJaxpr) -> None:
        found = _Flat(traced)
        self.inputs, self.outputs, self.constants = found.inputs, found.outputs, found.constants
        wanted = {source for source in self.outputs if isinstance(source, int)}
        self.pieces = _pieces(_needed(found.operations, wanted), wanted)
        # A field is forgotten after the last piece that needs it.
        last = {item: number for number, piece in enumerate(self.pieces) for item in piece.needs}
        self.drops = [
            [item for item, number in last.items() if number == place and item not in wanted]
            for place in range(len(self.pieces))
        ]

    def run(self, arguments: Sequence[Any]) -> list[Any]:
        """Return the results for arguments, which are arrays."""
        known = self.constants | dict(zip(self.inputs, arguments, strict=True))
        for piece, drops in zip(self.pieces, self.drops, strict=True):
            piece.run(known)
            # Fields that are dropped are free before the next piece needs room.
            jax.block_until_ready([known[item] for item in piece.gives])
            for item in drops:
                del known[item]
        return [_read(known, source) for source in self.outputs]


def transforms_apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function of arrays, run in pieces; the last argument is compiled in."""

    @lru_cache(maxsize=MOST_KEPT)
    def prepared(structure: Any, kinds: tuple[Any, ...], fixed: Hashable) -> tuple[Program, Any]:
        shapes = [jax.ShapeDtypeStruct(shape, kind, weak_type=weak) for shape, kind, weak in kinds]
        trace = jax.make_jaxpr(lambda *arguments: function(*arguments, fixed), return_shape=True)
        traced, results = trace(*jax.tree.unflatten(structure, shapes))
        return Program(traced), jax.tree.structure(results)

    @wraps(function)
    def in_pieces(*arguments: Any) -> Any:
        *arrays, fixed = arguments
        leaves, structure = jax.tree.flatten(tuple(arrays))
        values = [leaf if isinstance(leaf, jax.Array) else np.asarray(leaf) for leaf in leaves]
        kinds = tuple((np.shape(value), value.dtype, getattr(value, "weak_type", False)) for value in values)
        program, results = prepared(structure, kinds, fixed)
        return jax.tree.unflatten(results, program.run(values))

    return in_pieces


class _Flat:
    """The operations of a program with those of its inner programs, every value with a number of its own."""

    def __init__(self, traced: core.ClosedJaxpr) -> None:
        self.operations: list[Operation] = []
        self.constants: Values = {}
        self.count = 0
        self.inputs = [self._fresh() for _ in traced.jaxpr.invars]
        self.outputs = self._add(traced.jaxpr, traced.consts, self.inputs)

    def _fresh(self) -> int:
        self.count += 1
        return self.count

    def _add(self, jaxpr: Any, constants: Sequence[Any], inputs: Sequence[Source]) -> list[Source]:
        known: dict[Any, Source] = dict(zip(jaxpr.invars, inputs, strict=True))
        for variable, value in zip(jaxpr.constvars, constants, strict=True):
            known[variable] = number = self._fresh()
            self.constants[number] = value

        def source(atom: Any) -> Source:
            return Given(np.asarray(atom.val, atom.aval.dtype)) if isinstance(atom, core.Literal) else known[atom]

        for equation in jaxpr.eqns:
            takes = [source(atom) for atom in equation.invars]
            if equation.primitive.name in INLINED:
                inner = equation.params["jaxpr"]
                gives = self._add(inner.jaxpr, inner.consts, takes)
            else:
                numbers = [self._fresh() for _ in equation.outvars]
                act = _act(jaxpr, equation)
                self.operations.append(Operation(equation, act, tuple(takes), tuple(numbers)))
                gives = list(numbers)
            known.update(zip(equation.outvars, gives, strict=True))
        return [source(atom) for atom in jaxpr.outvars]


def _act(jaxpr: Any, equation: Any) -> Callable[..., Sequence[Any]]:
    """Return what an operation does, of as many arguments as it takes."""
    if equation.primitive.name == TRANSFORM:
        kind, lengths = equation.params["fft_type"], tuple(equation.params["fft_lengths"])
        return lambda field: (_transform(field, kind, lengths),)
    if equation.primitive.name == CHOICE and _has_transforms(equation):
        branches = [Program(branch) for branch in equation.params["branches"]]
        return lambda which, *rest: branches[min(max(int(which), 0), len(branches) - 1)].run(rest)
    return alone(jaxpr, equation)


@partial(jax.jit, static_argnums=(1, 2))
def _transform(field: Any, kind: Any, lengths: tuple[int, ...]) -> jax.Array:
    return lax.fft(field, kind, lengths)


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


def _needed(operations: list[Operation], wanted: set[int]) -> list[Operation]:
    """Return the operations that results follow from."""
    needed, kept = set(wanted), []
    for operation in reversed(operations):
        if needed.intersection(operation.gives):
            needed.update(operation.needs)
            kept.append(operation)
    return kept[::-1]


def _pieces(operations: list[Operation], wanted: set[int]) -> list[Operation | Piece]:
    """Return operations in stages: what follows from the transforms so far, and then the next transforms.

    A large cell is limited by memory. Hence what follows from one field, such as its parts, is computed again
    in every piece that needs it: it would otherwise be written and read. What follows from several
    fields is computed once.
    """
    stage, fields = _stages(operations)
    source = {item: operation for operation in operations for item in operation.gives}
    last = max(stage.values(), default=0)
    targets: list[set[int]] = [set() for _ in range(last + 1)]
    for item in wanted & source.keys():
        if not source[item].apart:
            targets[stage[item]].add(item)

    def follow(items: Iterable[int], number: int, found: set[int]) -> None:
        """Add to `found` what a piece has to compute for some values; earlier pieces compute the others."""
        for item in items:
            if item in found or item not in source or source[item].apart:
                continue
            if stage[item] < number and fields[item] > 1:
                targets[stage[item]].add(item)
                continue
            found.update(source[item].gives)
            follow(source[item].needs, number, found)

    pieces: list[Operation | Piece] = []
    for number in range(last, -1, -1):
        apart = [each for each in operations if each.apart and stage[each.gives[0]] == number + 1]
        for operation in apart:
            for item in operation.needs:
                if item in source and not source[item].apart:
                    early = stage[item] < number and fields[item] > 1
                    targets[stage[item] if early else number].add(item)
        found: set[int] = set()
        follow(targets[number], number, found)
        own = [each for each in operations if found.intersection(each.gives)]
        gives = tuple(item for each in own for item in each.gives if item in targets[number])
        pieces[:0] = [*([_piece(own, gives)] if gives else []), *apart]
    return pieces


def _stages(operations: list[Operation]) -> tuple[dict[int, int], dict[int, int]]:
    """Return how many transforms precede every value, and from how many fields it follows."""
    stage: dict[int, int] = {}
    roots: dict[int, frozenset[int]] = {}
    for operation in operations:
        own = max((stage.get(item, 0) for item in operation.needs), default=0) + operation.apart
        stage.update(dict.fromkeys(operation.gives, own))
        above = frozenset[int]().union(*(roots.get(item, frozenset()) for item in operation.needs))
        for item in operation.gives:
            roots[item] = frozenset([item]) if operation.apart else above
    return stage, {item: len(each) for item, each in roots.items()}


def _piece(operations: list[Operation], gives: tuple[int, ...]) -> Piece:
    made = {item for operation in operations for item in operation.gives}
    takes = tuple(dict.fromkeys(i for operation in operations for i in operation.needs if i not in made))

    def together(*arguments: Any) -> list[Any]:
        known: Values = dict(zip(takes, arguments, strict=True))
        for operation in operations:
            operation.run(known)
        return [known[item] for item in gives]

    return Piece(takes, gives, jax.jit(together))


def _read(known: Values, source: Source) -> Any:
    return source.value if isinstance(source, Given) else known[source]
