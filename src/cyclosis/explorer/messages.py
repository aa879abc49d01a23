"""What a page may ask, checked before anything is done with it."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from ..model.errors import InputError, shown

LONGEST = 65_536
"""Bytes of a message."""
MOST_POINTS = 64
"""Points of one stroke of the brush."""
SLOWEST, FASTEST = 0.1, 100.0
"""Time units per second."""

Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]


class _Ask(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class Begin(_Ask):
    """Begin a cell: a preset, what a link holds, or tables."""

    do: Literal["begin"]
    preset: str | None = None
    link: str | None = None
    setup: dict[str, Any] | None = None


class Plain(_Ask):
    """Something that needs no more words."""

    do: Literal["play", "pause", "step", "tell", "hash", "new_seed", "curves"]


class Speed(_Ask):
    """Time units to compute in a second."""

    do: Literal["speed"]
    value: Annotated[float, Field(ge=SLOWEST, le=FASTEST, strict=False)]


class Change(_Ask):
    """Give parameters other values."""

    do: Literal["change"]
    values: Annotated[dict[str, bool | int | float], Field(min_length=1, max_length=20)]


class Drug(_Ask):
    """Give a drug, or wash it out."""

    do: Literal["drug"]
    name: Literal["cytochalasin", "wash_out", "inhibit_myosin"]


class Brush(_Ask):
    """Do something to the patch under a stroke."""

    do: Literal["brush"]
    tool: Literal["wound", "fragment", "align"]
    points: Annotated[
        list[Annotated[list[Number], Field(min_length=2, max_length=2)]],
        Field(min_length=1, max_length=MOST_POINTS),
    ]
    radius: Annotated[float, Field(ge=0.02, le=10.0, strict=False)]
    angle: Number = 1.5707963267948966

    def step(self, t: float, length: float) -> dict[str, Any]:
        """Return the stroke as the table of a step at a time, on a cell of some length."""
        discs = [
            {
                "shape": "disc",
                "theta": round(theta % 6.283185, 3),
                "z": round(z % length, 3),
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


class Seen(_Ask):
    """A frame has been drawn."""

    do: Literal["seen"]
    frame: int


Ask = Begin | Plain | Speed | Change | Drug | Brush | Seen
_ADAPTER: TypeAdapter[Ask] = TypeAdapter(Annotated[Ask, Field(discriminator="do")])


def understood(text: str) -> Ask:
    """Return what a message asks. Raises `InputError` for one that is malformed."""
    try:
        return _ADAPTER.validate_python(json.loads(text))
    except (ValueError, RecursionError) as error:
        why = "JSON that says what to do"
        if isinstance(error, ValidationError):
            first = error.errors(include_url=False)[0]
            why = f"a known request ({'.'.join(map(str, first['loc']))}: {first['msg'].lower()})"
        raise InputError("message", shown(text), why, "reload the page") from error
