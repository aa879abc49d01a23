"""Options that every figure of a run has: units, width, colours, font, style sheet."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Annotated, Any

import typer

from .options import RADIUS, SPEED

LOOK = "Look"
COLOURS = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Colours of P_z: purple-green (the default), blue-orange, berlin, managua, vanimo; "
        "or direction, for the direction of P and its magnitude. All suit every colour vision.",
        rich_help_panel=LOOK,
    ),
]
_ADDED: dict[str, Any] = {
    "radius_um": RADIUS,
    "speed_um_s": SPEED,
    "width_mm": Annotated[
        float | None,
        typer.Option(
            metavar="NUMBER",
            help="Width in millimetres, as 89 or 183 for one or two columns.",
            rich_help_panel=LOOK,
        ),
    ],
    "colours": COLOURS,
    "font": Annotated[
        str | None, typer.Option(metavar="NAME", help="Name of an installed font.", rich_help_panel=LOOK)
    ],
    "style": Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Style sheet of matplotlib, or the name of one that it has.",
            rich_help_panel=LOOK,
        ),
    ],
}


def with_looks(function: Callable[..., None]) -> Callable[..., None]:
    """Add these options to a command, in the place of its last argument `**looks`."""
    own = list(inspect.signature(function, eval_str=True).parameters.values())[:-1]
    kind = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, kind, default=None, annotation=annotation)
        for name, annotation in _ADDED.items()
    ]
    signature = inspect.Signature([*own, *added])
    function.__signature__ = signature  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    return function


def looking(looks: Mapping[str, Any]) -> AbstractContextManager[None]:
    """Return the context in which a figure has the looks that were asked for."""
    from ..figures.looks import chosen

    return chosen(looks.get("colours"), looks.get("font"), looks.get("style"))


def width(looks: Mapping[str, Any]) -> dict[str, Any]:
    """Return the width of a figure as an argument, {} for its own."""
    given = looks.get("width_mm")
    return {} if given is None else {"width": given}
