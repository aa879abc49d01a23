"""A visitor's cell: a live run that is looked at, acted on, and told to others."""

from __future__ import annotations

import copy
import hashlib
import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..analysis.regimes import regime
from ..config import Setup
from ..dynamics.live import Live
from ..dynamics.protocol import Change, Protocol, Step, change, step_from_table, wash_out
from ..dynamics.schedule import Schedule
from ..model.errors import InputError
from ..model.grid import CylinderGrid
from .messages import Brush
from .setup import MOST_FRAMES, SetUp, check_memory

TRACES = ("order", "mean_P_theta", "mean_P_z", "peak_speed", "power_input")
"""What is recorded at every frame, after the time."""
RELAXATION = 2.0
"""Time over which the rate of relaxation is measured, dimensionless."""
DRUGS = {"cytochalasin": {"alpha_p": 0.0}, "inhibit_myosin": {"alpha_u": 0.0}}
"""What a drug makes of parameters: no bundling; filaments that no flow turns."""


Kind = tuple[tuple[int, int], frozenset[str], frozenset[str], bool]
"""What compiled programs depend on: the grid, which parameters are fields or on ramps, and a cubic force."""


def kinds(schedule: Schedule, grid: CylinderGrid, done: int = 0) -> set[Kind]:
    """Return the kinds of a cell after some events and after the next."""
    now = schedule.stages[done : done + 2]
    return {(grid.shape, stage.fields, frozenset(stage.moving), stage.cubic) for stage in now}


class Session:
    """A cell under way. Raises `InputError` for a set-up that cannot be used.

    `ready` is what `setup.ready()` returns, where that is known already.
    """

    def __init__(self, setup: SetUp, ready: Setup | None = None) -> None:
        ready = ready or setup.ready()
        self.setup = setup
        self.live = Live(ready.params, ready.grid, ready.state, setup.every, ready.protocol)
        self.rates: list[tuple[float, float]] = []
        self.fresh: list[list[float]] = []
        self._record()

    def kinds(self) -> set[Kind]:
        """Return the kinds that computing on to the next frame needs."""
        schedule, t = self.live.course.schedule, self.live.t
        done = schedule.done(t)
        changes = done < len(schedule.times) and schedule.times[done] <= t + self.live.every
        return kinds(schedule, self.live.grid, done) if changes else {self.kind}

    @property
    def kind(self) -> Kind:
        """The kind of the cell now."""
        schedule = self.live.course.schedule
        stage = schedule.stage(self.live.t)
        return self.live.grid.shape, stage.fields, frozenset(stage.moving), stage.cubic

    def rehearse(self) -> None:
        """Compile what computing on and looking at the cell needs, and leave the cell as it is."""
        double = copy.copy(self.live)
        double.forward()
        double.record()
        double.flow()

    def forward(self) -> bool:
        """Compute on for a moment; return whether the next frame is reached."""
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

    def change(self, values: Mapping[str, Any]) -> None:
        """Give parameters other values from now on; several at one time are one step."""
        t, steps = self.live.t, list(self.live.protocol)
        last = max((k for k, step in enumerate(steps) if step.at == t), default=-1)
        if last >= 0 and isinstance(steps[last], Change) and _everywhere(steps[last]):
            values = dict(getattr(steps[last], "values", ())) | dict(values)
            del steps[last]
        self._do(change(t, **values), steps)

    def drug(self, name: str) -> None:
        """Give a drug, or wash all out."""
        if name in DRUGS:
            self.change(DRUGS[name])
        else:
            self._do(wash_out(self.live.t), list(self.live.protocol))

    def brush(self, stroke: Brush) -> None:
        """Do what a stroke does to the patch under it, now."""
        table = stroke.step(self.live.t, self.live.grid.length)
        self._do(step_from_table(table), list(self.live.protocol))

    def special(self) -> dict[str, str]:
        """Return which parameters are on a ramp or differ from place to place now."""
        stage = self.live.course.schedule.stage(self.live.t)
        fields = {name: "field" for name, value in self.live.params_now.items() if getattr(value, "ndim", 0)}
        return fields | dict.fromkeys(stage.moving, "ramp")

    def told(self) -> SetUp:
        """Return the set-up that comes to this very state."""
        return SetUp(self.setup.tables, tuple(self.live.protocol.as_tables()), self.live.t)

    def digest(self) -> str:
        """Return the SHA-256 of the state's bytes."""
        return hashlib.sha256(np.ascontiguousarray(self.live.state).tobytes()).hexdigest()

    def picture(self) -> bytes:
        """Return what the page draws: a JSON header, then records and fields (see `web/src/protocol.ts`)."""
        P, u = self.live.state, self.live.flow()
        found = regime(self.live.params_now, self.live.grid, P)
        header = {
            "t": self.live.t,
            "frame": self.live.frame,
            "n_theta": self.live.grid.n_theta,
            "n_z": self.live.grid.n_z,
            "length": self.live.grid.length,
            "peak_speed": float(np.hypot(*u).max()),
            "records": sum(map(len, self.fresh)),
            "regime": {
                "name": found.name,
                "reason": self._reason(found.reason, found.widths),
                "zones": found.zones.tolist(),
                "widths": found.widths.tolist(),
            },
        }
        text = json.dumps(header).encode()
        head = struct.pack("<II", len(text), 0) + text.ljust(-(-len(text) // 8) * 8)
        records = np.array(self.fresh, dtype="<f8").tobytes()
        self.fresh = []
        fields = (*P, *u, P[1].mean(axis=1), u[1].mean(axis=1))
        return head + records + b"".join(np.ascontiguousarray(field, "<f4").tobytes() for field in fields)

    def _reason(self, reason: str, widths: Any) -> str:
        """Return the reason of a regime with the stripes' widths and how fast the cell settles."""
        words = [reason]
        if 0 < len(widths) <= 4:
            words = [f"{len(widths)} zones, widths " + " : ".join(f"{width:.2f}" for width in widths)]
        old = next((pair for pair in self.rates if pair[0] >= self.live.t - RELAXATION), None)
        if old is not None and self.live.t - old[0] > 0.5 * RELAXATION:
            rate, now = old[1], self.rates[-1][1]
            if now < 1e-9:
                words.append("steady")
            elif rate > 0:
                growth = float(np.log(now / rate)) / (self.live.t - old[0])
                words.append(
                    f"relaxing at {growth:.3f}" if growth < 0 else f"changing faster, at {growth:.3f}"
                )
        return ", ".join(words)

    def _record(self) -> None:
        now = self.live.record()
        mean = np.asarray(now["mean_P"])
        values = (now["order"], mean[0], mean[1], now["peak_speed"], now["power_input"])
        self.fresh.append([self.live.t, *map(float, values)])
        self.rates.append((self.live.t, float(now["rate_of_change"])))
        self.rates = [pair for pair in self.rates if pair[0] >= self.live.t - RELAXATION]

    def _do(self, step: Step, steps: list[Step]) -> None:
        earlier = [each for each in steps if each.at <= step.at]
        later = [each for each in steps if each.at > step.at]
        protocol = Protocol(*earlier, step, *later, seed=self.live.protocol.seed)
        check_memory(protocol, self.live.grid)
        self.live.do(protocol)
        self.rates = []


def _everywhere(step: Step) -> bool:
    return getattr(step, "where", None) is None and not getattr(step, "over", 0.0)
