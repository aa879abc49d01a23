"""Where a program is cut: what follows from the transforms so far, then the next transforms, and so on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from .operations import Operation


class Stage(NamedTuple):
    """Operations that are compiled together with the numbers of their results; then those that run apart."""

    together: list[Operation]
    gives: tuple[int, ...]
    apart: list[Operation]


def stages(operations: list[Operation], wanted: set[int]) -> list[Stage]:
    """Return operations in stages, of which the results `wanted` follow.

    A large cell is limited by memory. Hence what follows from one field, such as its parts, is computed again
    in every stage that needs it: it would otherwise be written and read. What follows from several fields is
    computed once.
    """
    cut = _Cut(operations)
    last = max(cut.stage.values(), default=0)
    targets: list[set[int]] = [set() for _ in range(last + 1)]
    for item in wanted & cut.source.keys():
        targets[cut.stage[item]].add(item)
    found: list[Stage] = []
    for number in range(last, -1, -1):
        apart = [each for each in operations if each.apart and cut.stage[each.gives[0]] == number + 1]
        needs = [item for operation in apart for item in operation.needs]
        own, early = cut.what_follows([*targets[number], *needs], number)
        for item in early:
            targets[cut.stage[item]].add(item)
        together = [each for each in operations if own.intersection(each.gives)]
        asked = targets[number].union(needs)
        gives = tuple(item for each in together for item in each.gives if item in asked)
        found.append(Stage(together, gives, apart))
    return found[::-1]


class _Cut:
    """The stage of every value, the number of transforms before it, and the fields it follows from."""

    def __init__(self, operations: list[Operation]) -> None:
        self.source = {item: each for each in operations if not each.apart for item in each.gives}
        self.stage: dict[int, int] = {}
        self.fields: dict[int, frozenset[int]] = {}
        for each in operations:
            stage = max((self.stage.get(item, 0) for item in each.needs), default=0) + each.apart
            above = frozenset[int]().union(*(self.fields.get(item, frozenset()) for item in each.needs))
            for item in each.gives:
                self.stage[item] = stage
                self.fields[item] = frozenset([item]) if each.apart else above

    def what_follows(self, items: Iterable[int], number: int) -> tuple[set[int], set[int]]:
        """Return what a stage computes for some values, and what earlier ones have to compute for it."""
        own, early, left = set[int](), set[int](), list(items)
        while left:
            item = left.pop()
            if item in own or item not in self.source:
                continue
            if self.stage[item] < number and len(self.fields[item]) > 1:
                early.add(item)
                continue
            own.update(self.source[item].gives)
            left.extend(self.source[item].needs)
        return own, early
