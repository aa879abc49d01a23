"""A visitor's cell: a live run that can be watched, acted on, and shared."""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..config import Setup
from ..contract.model import Array
from ..dynamics.live import Live
from ..dynamics.protocol import Change, Protocol, Step, change, step_from_table, wash_out
from ..dynamics.schedule import Schedule
from ..model.errors import InputError
from ..models.polar_cylinder import stays_cubic
from .messages import Brush
from .setup import MOST_FRAMES, SetUp, check_memory
from .surfaces import surface_of
from .undo import Before, Undo

RELAXATION = 2.0
"""Time over which the rate of relaxation is measured, dimensionless."""
STILL = 1e-9
"""Rate of change <|dP/dt|²>^½ below which the state counts as steady, dimensionless."""
DRUGS = {"cytochalasin": {"alpha_p": 0.0}, "inhibit_myosin": {"alpha_u": 0.0}}
"""The effect of drugs on parameters: no bundling; no alignment by flow."""


Kind = tuple[tuple[Any, ...], frozenset[str], frozenset[str], bool]
"""What compiled programs depend on: the grid, which parameters are fields or ramps, and a cubic force."""


def kind_at(schedule: Schedule, grid: Any, t: float = 0.0) -> Kind:
    """Return the kind of a cell at a time, after the steps at that time."""
    stage = schedule.stage(t)
    cubic = stays_cubic(stage.first, stage.last)
    return surface_of(grid).program(grid), stage.fields, frozenset(stage.moving), cubic


class Session:
    """A live cell. Raises `InputError` for a set-up that cannot be used.

    `ready` is the result of `setup.ready()`, if it is known already.
    """

    def __init__(self, setup: SetUp, ready: Setup | None = None) -> None:
        ready = ready or setup.ready()
        self.setup, self.surface = setup, surface_of(ready.grid)
        self.live = Live(ready.params, ready.grid, ready.state, setup.every, ready.protocol, ready.model)
        self.rates: list[tuple[float, float]] = []
        self.fresh: list[list[float]] = []
        self.own: dict[str, Any] = {}
        """Parameters that the visitor has changed, as they are now."""
        self.done = Undo()
        self.shown: Array | None = None
        """The flow of the last picture, on the grid."""
        self._record()

    def kinds(self) -> set[Kind]:
        """Return the kinds that computing the next frame needs."""
        schedule, t = self.live.course.schedule, self.live.t
        ahead = (time for time in schedule.times if t < time <= t + self.live.every)
        return {self.kind, *(kind_at(schedule, self.live.grid, time) for time in ahead)}

    @property
    def kind(self) -> Kind:
        """The kind of the cell now."""
        return kind_at(self.live.course.schedule, self.live.grid, self.live.t)

    def rehearse(self) -> None:
        """Compile everything that computing and showing the cell needs, without changing the cell."""
        double = self.live.copy()
        double.forward()
        double.record()
        double.flow()

    def forward(self) -> bool:
        """Compute for a moment; return whether the next frame is reached."""
        if self.live.frame >= MOST_FRAMES:
            raise InputError("t", self.live.t, f"less than {MOST_FRAMES} frames long", "begin a new cell")
        if self.live.forward():
            self._record()
            return True
        if self.live.failed:
            raise InputError(
                "this cell", "diverged", "one that the grid resolves", "use more points, or begin again"
            )
        return False

    def change(self, values: Mapping[str, Any], drug: str = "") -> None:
        """Change parameters from now on, by hand or by a drug; several changes at one time are one step."""
        t, steps, given = self.live.t, list(self.live.protocol), dict(values)
        last = max((k for k, step in enumerate(steps) if step.at == t), default=-1)
        if last >= 0 and isinstance(steps[last], Change) and _everywhere(steps[last]):
            values = dict(getattr(steps[last], "values", ())) | dict(values)
            del steps[last]
        self._do(change(t, **values), steps, ("change", drug, *given))
        self.own |= given

    def drug(self, name: str) -> None:
        """Give a drug, or wash out all drugs."""
        if name in DRUGS:
            self.change(DRUGS[name], name)
        else:
            self._do(wash_out(self.live.t), list(self.live.protocol), ("wash_out",))
            self.own = {}

    def brush(self, stroke: Brush) -> None:
        """Apply a stroke to the patch under it, now."""
        table = stroke.step(self.live.t, lambda z: self.surface.nearest(self.live.grid, z))
        self._do(step_from_table(table), list(self.live.protocol), (stroke.tool, stroke.radius))

    def undo(self) -> None:
        """Return to the state before the visitor's last intervention. Raises `InputError` without one."""
        self.live, self.own = self.done.back()
        self.fresh = until(self.live.t, self.fresh)
        self.rates = []

    def again(self) -> SetUp:
        """Return the set-up of the cell at t = 0: its first protocol, with the visitor's parameters."""
        parameters = self.setup.tables["parameters"] | self.own
        return SetUp(self.setup.tables | {"parameters": parameters}, self.setup.steps)

    def special(self) -> dict[str, str]:
        """Return which parameters are on a ramp or vary in space now."""
        stage = self.live.course.schedule.stage(self.live.t)
        fields = {name: "field" for name, value in self.live.params_now.items() if getattr(value, "ndim", 0)}
        return fields | dict.fromkeys(stage.moving, "ramp")

    def setup_now(self) -> SetUp:
        """Return the set-up that leads to exactly this state."""
        return SetUp(self.setup.tables, tuple(self.live.protocol.as_tables()), self.live.t)

    def words(self, end: float) -> dict[str, Any]:
        """Return the description of the cell for the page; its link keeps a later target time `end`."""
        now = self.setup_now()
        return {
            "setup": self.setup.filled(),
            "outline": self.surface.outline(self.live.grid),
            "parameters": {
                name: float(value.mean()) if getattr(value, "ndim", 0) else value
                for name, value in self.live.params_now.items()
            },
            "special": self.special(),
            "protocol": [{"at": step.at, "text": str(step)} for step in self.live.protocol],
            "link": replace(now, t=max(now.t, end)).link(),
            "t": self.live.t,
            "undo": len(self.done),
        }

    def digest(self) -> str:
        """Return the SHA-256 of the state's bytes."""
        return hashlib.sha256(np.ascontiguousarray(self.live.state).tobytes()).hexdigest()

    def picture(self) -> bytes:
        """Return the data of a picture: a JSON header, records and fields (see `web/src/protocol.ts`)."""
        surface, grid = self.surface, self.live.grid
        P, u = self.live.state, self.live.flow()
        self.shown = u
        found, pace = surface.judged(self.live.params_now, grid, P), self._pace()
        n_theta, n_z, length = surface.size(grid)
        header = {
            "t": self.live.t,
            "frame": self.live.frame,
            "n_theta": n_theta,
            "n_z": n_z,
            "length": length,
            "peak_speed": float(np.hypot(*u).max()),
            "records": sum(map(len, self.fresh)),
            "regime": {
                "name": found.name,
                "reason": _reason(found.reason, found.widths, pace),
                "widths": found.widths.tolist(),
                **found.numbers,
                "pace": pace,
            },
        }
        text = json.dumps(header).encode()
        head = struct.pack("<II", len(text), 0) + text.ljust(-(-len(text) // 8) * 8)
        records = np.array(self.fresh, dtype="<f8").tobytes()
        self.fresh = []
        P, u = surface.drawn(grid, P), surface.drawn(grid, u)
        fields = (*P, *u, P[1].mean(axis=1), u[1].mean(axis=1))
        return head + records + b"".join(np.ascontiguousarray(field, "<f4").tobytes() for field in fields)

    def _pace(self) -> float | str | None:
        """Return the rate at which changes grow, "steady" if there are none, None if it is unknown yet."""
        old = next((pair for pair in self.rates if pair[0] >= self.live.t - RELAXATION), None)
        if old is None or self.live.t - old[0] <= 0.5 * RELAXATION:
            return None
        rate, now = old[1], self.rates[-1][1]
        if now < STILL:
            return "steady"
        return float(np.log(now / rate)) / (self.live.t - old[0]) if rate > 0 else None

    def _record(self) -> None:
        now = self.live.record()
        self.fresh.append([self.live.t, *self.surface.row(now)])
        self.rates.append((self.live.t, float(now["rate_of_change"])))
        self.rates = [pair for pair in self.rates if pair[0] >= self.live.t - RELAXATION]

    def _do(self, step: Step, steps: list[Step], gesture: tuple[Any, ...]) -> None:
        earlier = [each for each in steps if each.at <= step.at]
        later = [each for each in steps if each.at > step.at]
        protocol = Protocol(*earlier, step, *later, seed=self.live.protocol.seed)
        check_memory(protocol, self.live.grid)
        before = Before(self.live.copy(), dict(self.own))
        self.live.do(protocol)
        self.done.keep(before, gesture)
        self.rates = []


def until(t: float, rows: list[list[float]]) -> list[list[float]]:
    """Return the records up to a time."""
    return [row for row in rows if row[0] <= t]


def _everywhere(step: Step) -> bool:
    return getattr(step, "where", None) is None and not getattr(step, "over", 0.0)


def _reason(reason: str, widths: Array, pace: float | str | None) -> str:
    """Return the reason for a regime with the stripes' widths and how fast the cell relaxes."""
    words = [reason]
    if 0 < len(widths) <= 4:
        words = [f"{len(widths)} zones, widths " + " : ".join(f"{width:.2f}" for width in widths)]
    if isinstance(pace, str):
        words.append(pace)
    elif pace is not None:
        words.append(f"relaxing at {pace:.3f}" if pace < 0 else f"changing faster, at {pace:.3f}")
    return ", ".join(words)
