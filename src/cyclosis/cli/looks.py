"""Options that figures have: units, width, colours, font, style sheet."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from contextvars import ContextVar
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.units import shown_in
from .options import RADIUS, SPEED, UNITS

if TYPE_CHECKING:
    from ..model.scales import Scales

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
    return _signed(function, own, _ADDED)


def _signed(
    function: Callable[..., None], own: Iterable[inspect.Parameter], options: Mapping[str, Any]
) -> Callable[..., None]:
    """Return a function that says it has these options besides its own parameters."""
    kind = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, kind, default=None, annotation=annotation)
        for name, annotation in options.items()
    ]
    signature = inspect.Signature([*own, *added])
    function.__signature__ = signature  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    return function


ALONE = {
    "radius_um": Annotated[
        float | None,
        typer.Option(
            "--radius-um",
            metavar="NUMBER",
            help="Radius of a cell in micrometres, to show results in its units too; with --speed-um-s.",
            rich_help_panel=UNITS,
        ),
    ],
    "speed_um_s": Annotated[
        float | None,
        typer.Option(
            "--speed-um-s",
            metavar="NUMBER",
            help="Its speed U in micrometres per second.",
            rich_help_panel=UNITS,
        ),
    ],
}
"""The same options for commands without a file of a run that has scales."""
_WIDTH: ContextVar[float | None] = ContextVar("width", default=None)


def within_looks(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add options of looks, by default all, and units to a command. While it runs, all figures have them."""
    chosen = {name: _ADDED[name] for name in names} if names else _ADDED
    return partial(_within, options=chosen | ALONE)


def _within(function: Callable[..., None], options: Mapping[str, Any]) -> Callable[..., None]:
    @wraps(function)
    def wrapped(*args: Any, **given: Any) -> None:
        looks = {name: given.pop(name, None) for name in options}
        before = _WIDTH.set(looks.get("width_mm"))
        try:
            with looking(looks), shown_in(scales_of(looks)):
                function(*args, **given)
        finally:
            _WIDTH.reset(before)

    own = inspect.signature(function, eval_str=True).parameters.values()
    return _signed(wrapped, own, options)


def scales_of(looks: Mapping[str, Any]) -> Scales | None:
    """Return the scales that were given, None if there are none. Raises `InputError` for one of the two."""
    from ..config import check
    from ..model.units import NAMES, of_table

    given = {name: looks[name] for name in NAMES if looks.get(name) is not None}
    return of_table(check({"scales": given})["scales"])


def chosen_width() -> dict[str, Any]:
    """Return the width of a figure as an argument within such a command, {} for its own."""
    given = _WIDTH.get()
    return {} if given is None else {"width": given}


def looking(looks: Mapping[str, Any]) -> AbstractContextManager[None]:
    """Return the context in which a figure has the looks that were asked for."""
    names = "colours", "font", "style"
    if all(looks.get(name) is None for name in names):
        return nullcontext()  # figures as they are: nothing that draws is loaded
    from ..figures.looks import chosen

    return chosen(looks.get("colours"), looks.get("font"), looks.get("style"))


def width(looks: Mapping[str, Any]) -> dict[str, Any]:
    """Return the width of a figure as an argument, {} for its own."""
    given = looks.get("width_mm")
    return {} if given is None else {"width": given}
