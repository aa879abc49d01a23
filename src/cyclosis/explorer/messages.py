"""The requests that a page may send, checked before they are used."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from ..model.errors import InputError, shown

LONGEST = 65_536
"""Most bytes of a message."""
MOST_POINTS = 64
"""Most points of one stroke of the brush."""
MOST_TRACERS = 1000
"""Most tracers inside the cell."""
SLOWEST, FASTEST = 0.1, 100.0
"""Time units per second."""

Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]


class _Ask(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    n: Annotated[int, Field(ge=0, le=2**53)] | None = None
    """The page numbers its requests, to repeat those that never arrived after a connection is lost."""


class Scales(BaseModel):
    """Radius (µm) and speed (µm/s) of a cell, by which results are shown in units."""

    model_config = ConfigDict(extra="forbid", strict=True)

    radius_um: Annotated[float, Field(allow_inf_nan=False, strict=False)]
    speed_um_s: Annotated[float, Field(allow_inf_nan=False, strict=False)]


class Begin(_Ask):
    """Begin a cell: a preset, the contents of a link, or tables.

    A page whose session has been lost also gives the time `t` that it has shown, later than that of its link,
    and whether the cell was `playing`. `scales` are those of a cell that has none of its own.
    """

    do: Literal["begin"]
    preset: str | None = None
    link: str | None = None
    setup: dict[str, Any] | None = None
    t: Annotated[float, Field(ge=0.0, le=1e6, allow_inf_nan=False, strict=False)] | None = None
    playing: bool | None = None
    scales: Scales | None = None


class Resume(_Ask):
    """Continue the session with this token over another connection."""

    do: Literal["resume"]
    token: Annotated[str, Field(max_length=64)]


class Sign(_Ask):
    """The page is there (alive), checks that the server is (ping), or will not come back (leave)."""

    do: Literal["alive", "ping", "leave"]


class Plain(_Ask):
    """A request without arguments."""

    do: Literal["play", "pause", "step", "tell", "hash", "new_seed", "curves", "undo", "again"]


class Speed(_Ask):
    """Time units to compute per second."""

    do: Literal["speed"]
    value: Annotated[float, Field(ge=SLOWEST, le=FASTEST, strict=False)]


class Reach(_Ask):
    """Compute up to a frame as fast as possible, and stand still there, as cells that are compared do."""

    do: Literal["reach"]
    frame: Annotated[int, Field(ge=0, le=1_000_000)]


class Set(_Ask):
    """Change the values of parameters."""

    do: Literal["change"]
    values: Annotated[dict[str, bool | int | float], Field(min_length=1, max_length=20)]


class Drug(_Ask):
    """Give a drug, or wash it out."""

    do: Literal["drug"]
    name: Literal["cytochalasin", "wash_out", "inhibit_myosin"]


class Brush(_Ask):
    """Act on the patch under a stroke."""

    do: Literal["brush"]
    tool: Literal["wound", "fragment", "align"]
    points: Annotated[
        list[Annotated[list[Number], Field(min_length=2, max_length=2)]],
        Field(min_length=1, max_length=MOST_POINTS),
    ]
    radius: Annotated[float, Field(ge=0.02, le=10.0, strict=False)]
    angle: Number = 1.5707963267948966

    def step(self, t: float, nearest: Callable[[float], float]) -> dict[str, Any]:
        """Return the stroke as a step's table at time `t`; `nearest` gives the place on the cell of z."""
        discs = [
            {
                "shape": "disc",
                "theta": round(theta % 6.283185, 3),
                "z": nearest(z),
                "radius": round(self.radius, 3),
            }
            for theta, z in self.points
        ]
        where = discs[0] if len(discs) == 1 else {"shape": "union", "parts": discs}
        action: dict[str, dict[str, Any]] = {
            "wound": {"action": "depolymerise"},
            "fragment": {"action": "fragment"},
            "align": {"action": "align", "angle": self.angle},
        }
        return {"at": t, "where": where} | action[self.tool]


class Vacuole(_Ask):
    """Show the flow inside the cell, or no longer: `tracers` that move `pace` radii a second at its peak."""

    do: Literal["vacuole"]
    on: bool
    tracers: Annotated[int, Field(ge=1, le=MOST_TRACERS)] = 600
    pace: Annotated[float, Field(ge=0.05, le=2.0, strict=False)] = 0.6


class Units(_Ask):
    """Show results in the units of these scales, or dimensionless without; the cell stays as it is."""

    do: Literal["units"]
    scales: Scales | None = None


class Seen(_Ask):
    """A frame has been drawn."""

    do: Literal["seen"]
    frame: int


Ask = Begin | Resume | Sign | Plain | Speed | Reach | Set | Drug | Brush | Vacuole | Units | Seen
_ADAPTER: TypeAdapter[Ask] = TypeAdapter(Annotated[Ask, Field(discriminator="do")])


def understood(text: str) -> Ask:
    """Return the request in a message. Raises `InputError` if it is malformed."""
    try:
        return _ADAPTER.validate_python(json.loads(text))
    except (ValueError, RecursionError) as error:
        why = "JSON that says what to do"
        if isinstance(error, ValidationError):
            first = error.errors(include_url=False)[0]
            why = f"a known request ({'.'.join(map(str, first['loc']))}: {first['msg'].lower()})"
        raise InputError("message", shown(text), why, "reload the page") from error
