"""A protocol: what is done to a running cell, and when. Only values; `schedule` gives them meaning.

    protocol = Protocol(
        change(at=100.0, alpha_p=0.0),
        fragment(at=120.0, where=regions.disc(theta=3.1, z=2.5, radius=0.5)),
        wash_out(at=150.0, over=5.0),
    )

Times are dimensionless (R/U). Steps at the same time act in the order in which they are written.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from ..display.shown import shown
from ..model.definitions import PARAMETERS
from ..model.errors import InputError, whole
from ..model.regions import Region
from ..model.wording import beside
from .steps import Align as Align
from .steps import Change as Change
from .steps import Depolymerise as Depolymerise
from .steps import Fragment as Fragment
from .steps import Noise as Noise
from .steps import Step as Step
from .steps import WashOut as WashOut
from .steps import step_from_table as step_from_table

MOST_STEPS = 1000
LONGEST = 50_000
"""Characters that a protocol may take in a file: the whole configuration is in one attribute of 64 kB."""


def change(at: float, *, over: float = 0.0, where: Region | None = None, **values: Any) -> Step:
    """Return the step that sets parameters to other values at a time, or linearly over a time from then on.

    `at` and `over` are in R/U, here and below. In a region only `alpha_p`, `alpha_u`, `kappa` and
    `repulsion_angle` can change. Raises `InputError` for values that `Parameters` would refuse.

    Example:
        >>> import cyclosis as cy
        >>> end = cy.regions.band("z", 0.0, 2.0)
        >>> print(cy.change(at=100.0, alpha_u=0.0, where=end))
        t = 100: alpha_u = 0, in band (axis = z, start = 0, stop = 2)
        >>> cy.change(at=100.0, mu=0.1, where=end)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: mu = 0.1 cannot be used: ...
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

    Where |P| would exceed 1 it is scaled back to 1. See `Protocol` for how random numbers are drawn. Raises
    `InputError` for values out of range.

    Example:
        >>> import cyclosis as cy
        >>> wound = cy.regions.disc(theta=3.1, z=2.5, radius=0.5)
        >>> print(cy.fragment(at=120.0, where=wound))
        t = 120: fragment to 1000 filaments per square, in disc (theta = 3.1, z = 2.5, radius = 0.5)
    """
    return Fragment(at, filaments_per_square, noise_grid, seed, where)


def depolymerise(at: float, *, keep: float = 0.0, where: Region | None = None) -> Step:
    """Return the step that multiplies P by `keep`, from 0 to 1; other values raise `InputError`.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> half = cy.Protocol(cy.depolymerise(at=0.0, keep=0.5))
        >>> run = cy.simulate(params, grid, cy.initial.unidirectional(grid, 0.8), t_end=0.1, protocol=half)
        >>> round(float(run.interventions[0].after.max()), 6)
        0.4
    """
    return Depolymerise(at, keep, where)


def align(at: float, *, angle: float, magnitude: float = 0.9, where: Region | None = None) -> Step:
    """Return the step that sets P to one direction, `angle` radians from e_theta: π/2 is along e_z.

    Raises `InputError` for values out of range.

    Example:
        >>> import math
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> down = cy.Protocol(cy.align(at=0.0, angle=-math.pi / 2))
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=0.1, protocol=down)
        >>> cy.regime(params, grid, run.final_state).name
        'unidirectional'
    """
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

    Where |P| would exceed 1 it is scaled back to 1. See `Protocol` for how random numbers are drawn. Raises
    `InputError` for values out of range.

    Example:
        >>> import cyclosis as cy
        >>> protocol = cy.Protocol(cy.noise(at=10.0, size=0.05), cy.noise(at=20.0, size=0.05))
        >>> [step.seed for step in protocol]  # two draws, neither that of the initial state
        [1, 2]
    """
    return Noise(at, size, noise_grid, seed, where)


def wash_out(at: float, *, over: float = 0.0) -> Step:
    """Return the step that returns all parameters to those of the run, at once or linearly over a time.

    A flag (`zero_theta_flux`) returns at once. Raises `InputError` for times out of range.

    Example:
        >>> import cyclosis as cy
        >>> drug = cy.Protocol(cy.change(at=1.0, alpha_p=0.0), cy.wash_out(at=2.0, over=1.0))
        >>> params, grid = cy.Parameters(alpha_p=1.0), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=0.1, protocol=drug)
        >>> [run.params_at(t).alpha_p for t in (0.5, 1.5, 2.5, 3.0)]
        [1.0, 0.0, 0.5, 1.0]
    """
    return WashOut(at, over)


@shown
@dataclass(frozen=True, init=False)
class Protocol:
    """Steps in the order of their times (dimensionless, R/U), and the seed of their random numbers.

    A step of seed k (by default 1, 2, ... for the random steps in turn) draws from
    `numpy.random.default_rng(SeedSequence(seed, spawn_key=(k,)))`: none of these streams is that of the
    initial state of the same seed. In a sweep `seed` is the member's. Raises `InputError` for anything that
    is not a step, for more than 1000 steps or more than a file can hold, and for a parameter that is changed
    during its ramp.

    Example:
        >>> import cyclosis as cy
        >>> steps = cy.change(at=10.0, alpha_p=0.0), cy.fragment(at=12.0), cy.wash_out(at=15.0)
        >>> drug = cy.Protocol(*steps, seed=1)
        >>> drug
        Protocol: 3 steps, seed 1
        ├─ t = 10: alpha_p = 0
        ├─ t = 12: fragment to 1000 filaments per square
        └─ t = 15: wash out
        >>> len(drug), drug.random, drug.with_seed(2).seed
        (3, True, 2)
        >>> cy.Protocol.from_tables(drug.as_tables(), seed=1) == drug
        True
    """

    steps: tuple[Step, ...]
    seed: int

    def __init__(self, *steps: Step, seed: int = 0) -> None:
        for step in steps:
            if not isinstance(step, Step):
                raise InputError(
                    "protocol", step, "made of steps", "make them with cyclosis.change, for example"
                )
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
            rule = f"at most {LONGEST} characters long when stored"
            raise InputError(
                "protocol", f"{size} characters", rule, "use fewer or simpler images and regions"
            )
        object.__setattr__(self, "seed", whole("seed", seed, 0, 2**63 - 1, "the default is 0"))

    @classmethod
    def from_tables(cls, tables: Any, seed: int = 0) -> Protocol:
        """Return the protocol that a list of tables describes, as [[protocol]] would contain them.

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
        """Return the steps as plain tables (fit for JSON), from which `from_tables` recreates them."""
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
        steps = "1 step" if len(self) == 1 else f"{len(self)} steps"
        return "\n".join([f"Protocol: {steps}, seed {self.seed}", *lines])


def _seeded(steps: list[Step]) -> tuple[Step, ...]:
    """Give the random steps that have no seed the first numbers that no other step has."""
    taken = {getattr(step, "seed", None) for step in steps}
    free = (number for number in range(1, 2 * MOST_STEPS + 2) if number not in taken)
    return tuple(
        replace(step, seed=next(free)) if isinstance(step, Fragment | Noise) and step.seed is None else step
        for step in steps
    )


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
                least = beside(end, step.at)
                rule = f"at least {least}, the end of the ramp of {name} that begins at {begin:g}"
                raise InputError(f"at of {step.action}", step.at, rule, "let one change end before the next")
            until = step.at if name == "zero_theta_flux" else step.until  # a flag changes at once
            if until > end:
                ends[name] = (step.at, until)
