"""The steps of a protocol: what each does to a cell and when. Only values; `schedule` gives them meaning."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

from ..display.shown import shown
from ..model.definitions import PARAMETERS, Definition
from ..model.errors import InputError, choice, closest
from ..model.instants import DIGITS, instant
from ..model.interventions import ACTIONS, AT, NAME, SHORTEST_RAMP
from ..model.region_tables import from_table
from ..model.regions import Region

_BY_NAME = {item.name: item for item in PARAMETERS}
_NAMES = re.compile(r"[A-Za-z][\w-]*")


@shown
@dataclass(frozen=True)
class Step:
    """One step of a protocol. Make one with the functions of `protocol`, not with these classes.

    Example:
        >>> import cyclosis as cy
        >>> step = cy.change(at=100.0, over=20.0, kappa=0.1)
        >>> print(step)
        t = 100 to 120: kappa = 0.1
        >>> step.until, step.what
        (120.0, 'kappa = 0.1')
        >>> step.as_table()
        {'at': 100.0, 'action': 'change', 'kappa': 0.1, 'over': 20.0}
    """

    at: float
    action: ClassVar[str]
    random: ClassVar[bool] = False
    acts_on_state: ClassVar[bool] = False
    name: str | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        items = {item.name: item for item in (AT, NAME, *ACTIONS[self.action].keys)}
        for own in fields(self):
            if own.name in items:
                object.__setattr__(self, own.name, _checked(items[own.name], getattr(self, own.name)))
        object.__setattr__(self, "at", instant(self.at))
        if self.name is not None and not _NAMES.fullmatch(self.name):
            rule = "a letter, then letters, digits, - and _"
            raise InputError("name", self.name, rule, "shorten it to one word")
        region = getattr(self, "where", None)
        if region is not None and not isinstance(region, Region):
            raise InputError(
                "where", region, "a region of cyclosis.regions", "make it with regions.disc, for example"
            )
        over = getattr(self, "over", 0.0)
        if 0 < over < SHORTEST_RAMP:
            raise InputError("over", over, f"0 or at least {SHORTEST_RAMP:g}", "leave it out for a jump")
        if over and self.until == self.at:
            rule = f"long enough to differ from 0 in the {DIGITS} digits of a time near {self.at!r}"
            raise InputError("over", over, rule, "lengthen the ramp, or leave it out for a jump")

    @property
    def until(self) -> float:
        """The time at which the step has ended."""
        return instant(self.at + getattr(self, "over", 0.0))

    @property
    def what(self) -> str:
        """What the step does, in words."""
        raise NotImplementedError

    def as_table(self) -> dict[str, Any]:
        """Return the step as a plain table, as it would be in a file, without settings that are None or 0."""
        out: dict[str, Any] = {"at": self.at, "action": self.action}
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "values":
                out |= dict(value)
            elif isinstance(value, Region):
                out[item.name] = value.as_table()
            elif value is not None and item.name != "at" and (item.name != "over" or value):
                out[item.name] = list(value) if isinstance(value, tuple) else value
        return out

    def __str__(self) -> str:
        region = getattr(self, "where", None)
        over = getattr(self, "over", 0.0)
        span = f"t = {self.at:g} to {self.until:g}" if over else f"t = {self.at:g}"
        return f"{span}: {self.what}" + (f", in {region}" if region is not None else "")


@dataclass(frozen=True)
class Change(Step):
    """Parameters take other values, at once or linearly over a time."""

    action = "change"
    values: tuple[tuple[str, Any], ...]
    over: float = 0.0
    where: Region | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        given = dict(self.values)
        for name in given:
            if name not in _BY_NAME:
                rule = "one of " + ", ".join(_BY_NAME)
                raise InputError("parameter", name, rule, closest(name, _BY_NAME))
        if not given:
            raise InputError("change", {}, "given at least one parameter", "add alpha_p = 0, for example")
        for name, value in given.items():
            self._refuse_impossible(name, value)
        checked = ((item.name, item.check(given[item.name])) for item in PARAMETERS if item.name in given)
        object.__setattr__(self, "values", tuple(checked))

    def _refuse_impossible(self, name: str, value: Any) -> None:
        item = _BY_NAME[name]
        if getattr(value, "ndim", 0) or isinstance(value, list | tuple):
            raise InputError(name, value, "one number in a protocol", "limit the step to regions with where")
        if self.where is not None and not item.field:
            able = ", ".join(other.name for other in PARAMETERS if other.field)
            rule = f"changed on the whole surface; only {able} may differ from place to place"
            raise InputError(name, value, rule, "leave out where")
        if self.over and item.kind == "flag":
            raise InputError(name, value, "changed at once, because it is true or false", "leave out over")

    @property
    def what(self) -> str:
        """The new values, in words."""
        return ", ".join(f"{name} = {_text(value)}" for name, value in self.values)


@dataclass(frozen=True)
class Fragment(Step):
    """P becomes fresh disorder, as that of `cyclosis.initial.disordered`."""

    action = "fragment"
    random = True
    acts_on_state = True
    filaments_per_square: float = 1000.0
    noise_grid: tuple[int, int] | None = None
    seed: int | None = None
    where: Region | None = None

    @property
    def what(self) -> str:
        """The action in words."""
        return f"fragment to {self.filaments_per_square:g} filaments per square"


@dataclass(frozen=True)
class Depolymerise(Step):
    """P is multiplied by a factor."""

    action = "depolymerise"
    acts_on_state = True
    keep: float = 0.0
    where: Region | None = None

    @property
    def what(self) -> str:
        """The action in words."""
        return f"depolymerise to {self.keep:g} of P"


@dataclass(frozen=True)
class Align(Step):
    """P becomes a vector of one direction and magnitude."""

    action = "align"
    acts_on_state = True
    angle: float = 0.0
    magnitude: float = 0.9
    where: Region | None = None

    @property
    def what(self) -> str:
        """The action in words."""
        return f"align to {self.magnitude:g} at angle {self.angle:g}"


@dataclass(frozen=True)
class Noise(Step):
    """Noise of standard deviation `size` is added to either component of P."""

    action = "noise"
    random = True
    acts_on_state = True
    size: float = 0.0
    noise_grid: tuple[int, int] | None = None
    seed: int | None = None
    where: Region | None = None

    @property
    def what(self) -> str:
        """The action in words."""
        return f"add noise of size {self.size:g}"


@dataclass(frozen=True)
class WashOut(Step):
    """All parameters return to what they were before the protocol."""

    action = "wash_out"
    over: float = 0.0

    @property
    def what(self) -> str:
        """The action in words."""
        return "wash out"


_MADE: dict[str, type[Step]] = {
    kind.action: kind for kind in (Change, Fragment, Depolymerise, Align, Noise, WashOut)
}


def step_from_table(table: Any) -> Step:
    """Return the step that a table describes, as it would be under [[protocol]].

    Raises `InputError` for any mistake in it.

    Example:
        >>> from cyclosis.dynamics.protocol import step_from_table
        >>> print(step_from_table({"at": 5.0, "action": "depolymerise", "keep": 0.5}))
        t = 5: depolymerise to 0.5 of P
    """
    if not isinstance(table, Mapping):
        raise InputError("step", table, "a table", "write at = ..., action = ...")
    given = dict(table)
    action = choice("action", given.pop("action", None), tuple(ACTIONS))
    about = ACTIONS[action]
    items = {item.name: item for item in (AT, NAME, *about.keys)}
    known = [*items, *(["where"] if about.regional else [])]
    for name in given:
        if name not in known:
            rule = f"a key of action {action}: " + ", ".join(known)
            raise InputError("key", name, rule, closest(name, known))
    for item in items.values():
        if item.needed and given.get(item.name) is None:
            raise InputError(item.name, None, f"given for action {action}", f"add {item.name}, {item.rule}")
    if "where" in given:
        given["where"] = from_table(given["where"])
    if action == "change":
        values = tuple((name, given.pop(name)) for name in list(given) if name in _BY_NAME)
        given["values"] = values
    return _MADE[action](**given)


def _checked(item: Definition, value: Any) -> Any:
    return item.check(list(value) if isinstance(value, tuple) else value)


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value).lower()
