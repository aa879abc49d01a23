"""Programs in pieces, so that every Fourier transform runs by itself, on all cores.

Within one compiled program XLA computes Fourier transforms on one core of a processor: a point-wise
operation moves the program to a thread of the very pool that would share the next transform. Called from
outside, a transform uses the whole pool. `transforms_apart` cuts a traced function there; what lies between
two transforms is a compiled program. Calling a piece takes some hundredths of a millisecond, so that this
pays for large fields. Results are those of one program, to rounding, on any number of cores.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, wraps
from typing import Any

import jax
import numpy as np
from jax import lax
from jax.extend import core

from .operations import CHOICE, Operation, Operations, Values, read
from .room import Room
from .stages import stages

MOST_KEPT = 32
"""Programs in pieces that are kept, one for each shape of the arguments."""
Run = Callable[[Sequence[Any], Room], Sequence[Any]]
"""Computes results from arguments, which are arrays."""
overwriting = partial(jax.jit, donate_argnums=0, keep_unused=True)
"""Compile a function that writes its results into its first argument, arrays that it does not read."""


def transforms_apart(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same function of arrays, run in pieces; the last argument is compiled in.

    Its first argument is a `Room`. `given_up` are arrays among the others that nothing else refers to: their
    room is used again.
    """

    @lru_cache(maxsize=MOST_KEPT)
    def prepared(structure: Any, kinds: tuple[Any, ...], fixed: Hashable) -> tuple[Run, Any]:
        blank: Any = jax.ShapeDtypeStruct
        shapes = [blank(shape, kind, weak_type=weak) for shape, kind, weak in kinds]
        trace = jax.make_jaxpr(lambda *arguments: function(*arguments, fixed), return_shape=True)
        traced, results = trace(*jax.tree.unflatten(structure, shapes))
        return _run(traced), jax.tree.structure(results)

    @wraps(function)
    def in_pieces(room: Room, *arguments: Any, given_up: Any = ()) -> Any:
        *arrays, fixed = arguments
        leaves, structure = jax.tree.flatten(tuple(arrays))
        values = [leaf if isinstance(leaf, jax.Array) else np.asarray(leaf) for leaf in leaves]
        kinds = tuple((value.shape, value.dtype, getattr(value, "weak_type", False)) for value in values)
        run, results = prepared(structure, kinds, fixed)
        found = run(values, room)
        _keep_room(room, jax.tree.leaves(given_up), found)
        return jax.tree.unflatten(results, found)

    return in_pieces


class Program:
    """A traced program cut into pieces that run one after another."""

    def __init__(self, traced: core.ClosedJaxpr) -> None:
        operations = Operations(traced)
        self.inputs, self.outputs, self.constants = (
            operations.inputs,
            operations.outputs,
            operations.constants,
        )
        wanted = {source for source in self.outputs if isinstance(source, int)}
        self.pieces: list[Piece] = []
        for together, gives, apart in stages(operations.needed(), wanted):
            self.pieces += [_compiled(together, gives)] if gives else []
            self.pieces += [_apart(operation) for operation in apart]
        # A field is forgotten after the last piece that needs it.
        last = {item: number for number, piece in enumerate(self.pieces) for item in piece.uses}
        self.drops = [
            [item for item, number in last.items() if number == place and item not in wanted]
            for place in range(len(self.pieces))
        ]

    def run(self, arguments: Sequence[Any], room: Room) -> list[Any]:
        """Return the results for arguments, which are arrays."""
        known = self.constants | dict(zip(self.inputs, arguments, strict=True))
        fixed = list(known.values())
        for piece, drops in zip(self.pieces, self.drops, strict=True):
            known.update(zip(piece.gives, piece.run(known, room), strict=True))
            dropped = [known.pop(item) for item in drops]
            _keep_room(room, dropped, [*fixed, *known.values()])
        return [read(known, source) for source in self.outputs]


def _run(traced: core.ClosedJaxpr) -> Run:
    """Return what runs a program: as a whole if it prints, or does anything else besides computing."""
    if not traced.effects:
        return Program(traced).run
    whole = jax.jit(core.jaxpr_as_fun(traced))
    return lambda arguments, _: whole(*arguments)


@dataclass(frozen=True, eq=False)
class Piece:
    """Operations that run together: the numbers of what they use and give."""

    uses: tuple[int, ...]
    gives: tuple[int, ...]
    run: Callable[[Values, Room], Sequence[Any]]


def _compiled(operations: Sequence[Operation], gives: tuple[int, ...]) -> Piece:
    """Return operations as one compiled program."""
    made = {item: kind for each in operations for item, kind in zip(each.gives, each.kinds, strict=True)}
    uses = tuple(dict.fromkeys(i for each in operations for i in each.needs if i not in made))

    @overwriting
    def together(_: Any, *arguments: Any) -> list[Any]:
        known: Values = dict(zip(uses, arguments, strict=True))
        for each in operations:
            found = each.act(*(read(known, source) for source in each.takes))
            known.update(zip(each.gives, found, strict=True))
        return [known[item] for item in gives]

    def run(known: Values, room: Room) -> Sequence[Any]:
        return together([room.take(made[item]) for item in gives], *(known[item] for item in uses))

    return Piece(uses, gives, run)


def _apart(operation: Operation) -> Piece:
    """Return a transform, or a choice between branches, as a piece of its own."""
    run: Callable[[Values, Room], Sequence[Any]]
    parameters = operation.equation.params
    if operation.name == CHOICE:
        branches = [Program(branch) for branch in parameters["branches"]]

        def run(known: Values, room: Room) -> Sequence[Any]:
            which, *rest = (read(known, source) for source in operation.takes)
            return branches[int(which)].run(rest, room)
    else:
        (kind,), (source,) = operation.kinds, operation.takes
        how = parameters["fft_type"], tuple(parameters["fft_lengths"])

        def run(known: Values, room: Room) -> Sequence[Any]:
            return [_transform(room.take(kind), read(known, source), *how)]

    return Piece(tuple(operation.needs), operation.gives, run)


@partial(overwriting, static_argnums=(2, 3))
def _transform(_: Any, field: Any, kind: Any, lengths: tuple[int, ...]) -> jax.Array:
    return lax.fft(field, kind, lengths)


def _keep_room(room: Room, dropped: Sequence[Any], kept: Sequence[Any]) -> None:
    """Keep the room of arrays that are dropped, unless they are known by another number too."""
    names = {id(value) for value in kept}
    for number, value in {id(value): value for value in dropped}.items():
        if number not in names:
            room.add(value)
