"""Axes over the steps of a protocol, `protocol.STEP.KEY`: one value of a step, or of the region it acts in.

STEP is the number of a step, from 1 in the order in which the steps are written, or its name. Steps may share
a name: the axis then sets the key of all that have it, such as the radius of a wound and of the drug in it.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ...dynamics.protocol import Protocol, step_from_table
from ...model.definitions import Definition
from ...model.errors import InputError, closest
from ...model.interventions import ACTIONS, AT, SHAPES
from . import axes
from .definitions import AXES

PREFIX = "protocol."
TABLE = "protocol"
MOST_CHECKED = 1000
"""Protocols that are checked before a sweep with axes over steps is computed."""

Steps = list[dict[str, Any]]
_KINDS = ("number",)


def is_step_axis(name: Any) -> bool:
    """Return whether an axis is over the steps of a protocol."""
    return isinstance(name, str) and name.startswith(PREFIX)


def place(name: str) -> str | None:
    """Return the table that holds a swept setting in a run; None if it cannot be swept."""
    return TABLE if is_step_axis(name) else AXES.get(name, (None,))[0]


def setting(name: str, steps: Any) -> Definition:
    """Return the definition of a swept setting, given the steps of the protocol."""
    return definition(name, steps) if is_step_axis(name) else AXES[name][1]


def written(given: Any) -> Steps:
    """Return the steps of a configuration, copied. Raises `InputError` for anything but tables."""
    if not isinstance(given, list | tuple) or not all(isinstance(step, Mapping) for step in given):
        raise InputError(TABLE, given, "a list of tables", "write [[protocol]] above each step")
    return [copy.deepcopy(dict(step)) for step in given]


def definition(name: str, given: Any) -> Definition:
    """Return what an axis sets, under the name of the axis.

    Raises `InputError` for a step that is not in the protocol, a key that none of them has, and one that a
    step gives as well.
    """
    steps = written(given)
    found = [item for step, path in _addressed(name, steps) for item in [_item(step, path)] if item]
    if not found:
        known = sorted({key for step in _named(name, steps) for key in _keys(step)})
        rule = f"a key with a number, one of {', '.join(known)}"
        raise InputError("axes key", name, rule, closest(name.rpartition(".")[2], known))
    low, high = max(item.minimum for item in found), min(item.maximum for item in found)
    _refuse_second_value(name, steps)
    meaning = f"{found[0].meaning}, in step {_parts(name)[0]} of the protocol"
    return replace(found[0], name=name, meaning=meaning, minimum=low, maximum=high)


def placed(given: Any, point: Mapping[str, float]) -> Steps:
    """Return the steps of a protocol, as tables, at a point of the axes."""
    steps = written(given)
    for name in filter(is_step_axis, point):
        for step, path in _addressed(name, steps):
            if _item(step, path) is not None:
                _holder(step, path)[path[-1]] = point[name]
    return steps


def completed(given: Any, swept: Mapping[str, Any]) -> Steps:
    """Return the steps with values checked, in the order in which they are written, without what is swept."""
    first = {name: axes.ends(table)[0] for name, table in swept.items() if is_step_axis(name)}
    steps = [step_from_table(table).as_table() for table in placed(given, first)]
    for name in first:
        for step, path in _addressed(name, steps):
            _holder(step, path).pop(path[-1], None)
    return steps


def protocols(given: Any, swept: Mapping[str, Any]) -> Iterator[Protocol]:
    """Yield the protocols at all combinations of the values of the axes over steps; at their ends if many."""
    own = {name: axes.values(table) for name, table in swept.items() if is_step_axis(name)}
    if math.prod(len(values) for values in own.values()) > MOST_CHECKED:
        own = {name: (values[0], values[-1]) for name, values in own.items()}
    for combination in itertools.product(*own.values()):
        point = dict(zip(own, combination, strict=True))
        try:
            yield Protocol.from_tables(placed(given, point))
        except InputError as error:
            at = ", ".join(f"{name} = {value:g}" for name, value in point.items())
            where = f"{error.field} at {at}" if at else error.field
            raise InputError(where, error.value, error.rule, error.remedy) from error


def _parts(name: str) -> tuple[str, tuple[str, ...]]:
    """Return the step that an axis names, and the path to its key. Raises `InputError` for another form."""
    step, *path = name.removeprefix(PREFIX).split(".")
    if not step or len(path) not in (1, 2) or not all(path) or (len(path) == 2 and path[0] != "where"):
        rule = "protocol.STEP.KEY or protocol.STEP.where.KEY, with the number or the name of a step"
        raise InputError("axes key", name, rule, "write protocol.1.at, for example")
    return step, tuple(path)


def _named(name: str, steps: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the steps that an axis names."""
    step, _ = _parts(name)
    if step.isdecimal():
        found = list(steps[int(step) - 1 : int(step)]) if int(step) else []
    else:
        found = [table for table in steps if table.get("name") == step]
    if not found:
        names = sorted({str(table["name"]) for table in steps if table.get("name")})
        known = [*(str(number + 1) for number in range(len(steps))), *names]
        rule = "of a step of the protocol: " + ", ".join(known) if steps else "left out without a protocol"
        raise InputError("axes key", name, rule, "number steps from 1, or give them a name")
    return found


def _addressed(name: str, steps: Steps) -> list[tuple[dict[str, Any], tuple[str, ...]]]:
    return [(step, _parts(name)[1]) for step in _named(name, steps)]


def _item(step: Mapping[str, Any], path: tuple[str, ...]) -> Definition | None:
    """Return the definition of a key of a step, or None if the step does not have it."""
    items = _region(step) if len(path) == 2 else _own(step)
    return next((item for item in items if item.name == path[-1] and item.kind in _KINDS), None)


def _region(step: Mapping[str, Any]) -> tuple[Definition, ...]:
    where = step.get("where")
    return SHAPES.get(str(where.get("shape")), ("", ()))[1] if isinstance(where, Mapping) else ()


def _own(step: Mapping[str, Any]) -> tuple[Definition, ...]:
    action = ACTIONS.get(str(step.get("action")))
    return () if action is None else (AT, *action.keys)


def _keys(step: Mapping[str, Any]) -> list[str]:
    """Return the keys of a step that an axis may set, as they are written behind its name."""
    parts = [f"where.{item.name}" for item in _region(step) if item.kind in _KINDS]
    return [*(item.name for item in _own(step) if item.kind in _KINDS), *parts]


def _holder(step: dict[str, Any], path: tuple[str, ...]) -> dict[str, Any]:
    """Return the table that holds the key of a path: the step itself, or that of its region."""
    if len(path) == 1:
        return step
    step["where"] = dict(step["where"])
    where: dict[str, Any] = step["where"]
    return where


def _refuse_second_value(name: str, steps: Steps) -> None:
    for step, path in _addressed(name, steps):
        if _item(step, path) is not None and path[-1] in _holder(step, path):
            rule = "either in [[protocol]] or in [axes]"
            raise InputError(name, _holder(step, path)[path[-1]], rule, "remove one of the two")
