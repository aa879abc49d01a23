"""A protocol: what is done to a running cell, and when. Only values; `schedule` says what they mean.

    protocol = Protocol(
        change(at=100.0, alpha_p=0.0),
        fragment(at=120.0, where=regions.disc(theta=3.1, z=2.5, radius=0.5)),
        wash_out(at=150.0, over=5.0),
    )

Times are dimensionless (R/U). Steps at the same time act in the order in which they are written.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar

from ..model.definitions import PARAMETERS, Definition
from ..model.errors import InputError, choice, closest, whole
from ..model.interventions import ACTIONS, AT, SHORTEST_RAMP
from ..model.region_tables import from_table
from ..model.regions import Region

MOST_STEPS = 1000
LONGEST = 50_000
"""Characters that a protocol may take in a file: all that was asked for stands in one attribute of 64 kB."""
_BY_NAME = {item.name: item for item in PARAMETERS}


@dataclass(frozen=True)
class Step:
    """One step of a protocol. Make one with the functions of this module, not with its classes."""

    at: float
    action: ClassVar[str]
    random: ClassVar[bool] = False
    acts_on_state: ClassVar[bool] = False

    def __post_init__(self) -> None:
        items = {item.name: item for item in (AT, *ACTIONS[self.action].keys)}
        for own in fields(self):
            if own.name in items:
                object.__setattr__(self, own.name, _checked(items[own.name], getattr(self, own.name)))
        region = getattr(self, "where", None)
        if region is not None and not isinstance(region, Region):
            raise InputError(
                "where", region, "a region of cyclosis.regions", "make it with regions.disc, say"
            )
        over = getattr(self, "over", 0.0)
        if 0 < over < SHORTEST_RAMP:
            raise InputError("over", over, f"0 or at least {SHORTEST_RAMP:g}", "leave it out for a jump")

    @property
    def until(self) -> float:
        """The time at which the step has ended."""
        # Rounding makes 0.1 + 0.2 the time 0.3 at which a user would begin the next.
        over = getattr(self, "over", 0.0)
        return round(self.at + over, 12) if over else self.at

    @property
    def what(self) -> str:
        """What the step does, in words."""
        raise NotImplementedError

    def as_table(self) -> dict[str, Any]:
        """Return the step as a plain table, as it would stand in a file, without what is left at nothing."""
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
            raise InputError("change", {}, "given at least one parameter", "add alpha_p = 0, say")
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
            raise InputError(name, value, "changed at once, for it is true or false", "leave out over")

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


def change(at: float, *, over: float = 0.0, where: Region | None = None, **values: Any) -> Step:
    """Return the step that gives parameters other values at a time, or linearly from then on over a time.

    In a region only `alpha_p`, `alpha_u`, `kappa` and `repulsion_angle` can change. Raises `InputError` for
    values that `Parameters` would refuse.
    """
    return Change(at, tuple(values.items()), over, where)


def fragment(
    at: float,
    *,
    filaments_per_square: float = 1000.0,
    noise_grid: tuple[int, int] | None = None,
    seed: int | None = None,
    where: Region | None = None,
) -> Step:
    """Return the step that sets P to fresh disorder: normal, of variance 1/(2N) in either component.

    Where |P| would exceed 1 it is scaled back to 1. See `Protocol` for how random numbers are drawn.
    """
    return Fragment(at, filaments_per_square, noise_grid, seed, where)


def depolymerise(at: float, *, keep: float = 0.0, where: Region | None = None) -> Step:
    """Return the step that multiplies P by `keep`, from 0 to 1."""
    return Depolymerise(at, keep, where)


def align(at: float, *, angle: float, magnitude: float = 0.9, where: Region | None = None) -> Step:
    """Return the step that sets P to one direction, `angle` radians from e_theta: π/2 is up the cell."""
    return Align(at, angle, magnitude, where)


def noise(
    at: float,
    *,
    size: float,
    noise_grid: tuple[int, int] | None = None,
    seed: int | None = None,
    where: Region | None = None,
) -> Step:
    """Return the step that adds normal noise of standard deviation `size` to either component of P.

    Where |P| would exceed 1 it is scaled back to 1. See `Protocol` for how random numbers are drawn.
    """
    return Noise(at, size, noise_grid, seed, where)


def wash_out(at: float, *, over: float = 0.0) -> Step:
    """Return the step that returns all parameters to those of the run, at once or linearly over a time.

    What is true or false (`zero_theta_flux`) returns at once.
    """
    return WashOut(at, over)


@dataclass(frozen=True, init=False)
class Protocol:
    """Steps in the order of their times, and the seed of their random numbers.

    A step of seed k (by default 1, 2, ... for the random steps in turn) draws from
    `numpy.random.default_rng(SeedSequence(seed, spawn_key=(k,)))`: none of these streams is that of the
    initial state of the same seed. In a sweep `seed` is the member's. Raises `InputError` for what is no
    step, for more than 1000 of them or more than a file can hold, and for a parameter that is changed while a
    ramp of it is under way.
    """

    steps: tuple[Step, ...]
    seed: int

    def __init__(self, *steps: Step, seed: int = 0) -> None:
        for step in steps:
            if not isinstance(step, Step):
                raise InputError("protocol", step, "made of steps", "make them with cyclosis.change, say")
        if len(steps) > MOST_STEPS:
            raise InputError(
                "protocol", f"{len(steps)} steps", f"at most {MOST_STEPS} steps", "leave out some"
            )
        ordered = sorted(steps, key=lambda step: step.at)
        seeded = _seeded(ordered)
        _refuse_overlaps(seeded)
        object.__setattr__(self, "steps", seeded)
        size = len(json.dumps(self.as_tables()))
        if size > LONGEST:
            rule = f"at most {LONGEST} characters long as it is stored"
            raise InputError(
                "protocol", f"{size} characters", rule, "use fewer or simpler images and regions"
            )
        object.__setattr__(self, "seed", whole("seed", seed, 0, 2**63 - 1, "the default is 0"))

    @classmethod
    def from_tables(cls, tables: Any, seed: int = 0) -> Protocol:
        """Return the protocol that a list of tables describes, as [[protocol]] would hold them.

        Raises `InputError` for any mistake in it, naming the step.
        """
        if not isinstance(tables, list | tuple):
            raise InputError("protocol", tables, "a list of tables", "write [[protocol]] above each step")
        steps = []
        for number, table in enumerate(tables, 1):
            try:
                steps.append(step_from_table(table))
            except InputError as error:
                field = f"{error.field} in step {number} of the protocol"
                raise InputError(field, error.value, error.rule, error.remedy) from error
        return cls(*steps, seed=seed)

    def as_tables(self) -> list[dict[str, Any]]:
        """Return the steps as plain tables (fit for JSON), from which `from_tables` makes them again."""
        return [step.as_table() for step in self.steps]

    def with_seed(self, seed: int) -> Protocol:
        """Return the same protocol with the random numbers of another seed."""
        return Protocol(*self.steps, seed=seed)

    @property
    def random(self) -> bool:
        """Whether any step draws random numbers."""
        return any(step.random for step in self.steps)

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)

    def __len__(self) -> int:
        return len(self.steps)

    def __repr__(self) -> str:
        marks = ["├─"] * (len(self) - 1) + ["└─"]
        lines = (f"{mark} {step}" for mark, step in zip(marks, self.steps, strict=False))
        return "\n".join([f"Protocol: {len(self)} steps, seed {self.seed}", *lines])


def _seeded(steps: list[Step]) -> tuple[Step, ...]:
    """Give the random steps that have no seed the first numbers that no other step has."""
    taken = {getattr(step, "seed", None) for step in steps}
    free = (number for number in range(1, 2 * MOST_STEPS + 2) if number not in taken)
    return tuple(
        replace(step, seed=next(free)) if isinstance(step, Fragment | Noise) and step.seed is None else step
        for step in steps
    )


def step_from_table(table: Any) -> Step:
    """Return the step that a table describes, as it would stand under [[protocol]].

    Raises `InputError` for any mistake in it.
    """
    if not isinstance(table, Mapping):
        raise InputError("step", table, "a table", "write at = ..., action = ...")
    given = dict(table)
    action = choice("action", given.pop("action", None), tuple(ACTIONS))
    about = ACTIONS[action]
    items = {item.name: item for item in (AT, *about.keys)}
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


def _refuse_overlaps(steps: tuple[Step, ...]) -> None:
    changed = set[str]()
    ends: dict[str, tuple[float, float]] = {}
    for step in steps:
        own = dict(getattr(step, "values", ()))
        changed |= own.keys()
        names = changed if isinstance(step, WashOut) else own
        for name in (item.name for item in PARAMETERS if item.name in names):
            begin, end = ends.get(name, (0.0, 0.0))
            if step.at < end:
                rule = f"at least {end:g}, the end of the ramp of {name} that begins at {begin:g}"
                raise InputError(f"at of {step.action}", step.at, rule, "let one change end before the next")
            if step.until > end:
                ends[name] = (step.at, step.until)


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value).lower()
