"""Options that several commands share, and those made from the definitions of settings."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from ..model.definitions import TABLES, Definition, definition
from ..model.definitions import option as option_name
from .sources import of_run
from .usage import OUTPUT as OUTPUT
from .usage import Command, Group

F = TypeVar("F", bound=Callable[..., Any])

UNITS = "Physical units"
FORCE = Annotated[bool, typer.Option("--force", help="Overwrite an existing file.", rich_help_panel=OUTPUT)]
FILE = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="NetCDF file of a run.", show_default=False, callback=of_run),
]
TARGET = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="FILE",
        help="File to write: .png, .pdf, .svg or .eps; by default next to FILE.",
        rich_help_panel=OUTPUT,
    ),
]
QUIET = Annotated[
    bool, typer.Option("--quiet", help="Print nothing if all goes well.", rich_help_panel=OUTPUT)
]
"""For commands that write files."""
NO_PROGRESS = Annotated[
    bool, typer.Option("--quiet", help="Print only the result, no progress.", rich_help_panel=OUTPUT)
]
"""For commands that print their result."""
JSON = Annotated[
    bool,
    typer.Option("--json", help="Print the outcome as one line of JSON.", rich_help_panel=OUTPUT),
]
"""For commands that print their result."""
RADIUS = Annotated[
    float | None,
    typer.Option(
        "--radius-um",
        metavar="NUMBER",
        help="Radius of the cell in micrometres, to show results in units; by default that in FILE.",
        rich_help_panel=UNITS,
    ),
]
SPEED = Annotated[
    float | None,
    typer.Option(
        "--speed-um-s",
        metavar="NUMBER",
        help="Speed U in micrometres per second; by default that in FILE.",
        rich_help_panel=UNITS,
    ),
]
PAUSE = Annotated[
    float,
    typer.Option(
        "--checkpoint-seconds",
        metavar="SECONDS",
        min=0.0,
        help="Seconds of real time between checkpoints.",
        rich_help_panel=OUTPUT,
    ),
]
_GROUPS = {
    "model": "Cell, [parameters]",
    "parameters": "Cell, [parameters]",
    "grid": "Grid, [grid]",
    "initial": "Initial state, [initial]",
    "run": "Run, [run]",
    "scales": "Physical units, [scales]",
}
"""Headings in the help for the options of each table."""
_FORMS = {"numbers": "X,Y,...", "names": "A,B,...", "shape": "N,M", "choice": "NAME", "text": "FILE"}
"""How a value of each kind is written; others by the name of their kind."""


def commands(help: str, name: str | None = None, epilog: str | None = None) -> typer.Typer:
    """Return an empty group of commands."""
    return typer.Typer(
        name=name,
        cls=Group,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        help=help,
        epilog=epilog,
    )


def command(group: typer.Typer, *examples: str, name: str | None = None) -> Callable[[F], F]:
    """Add a function to a group as a command, with examples below its help."""
    lines = "\n".join(f"  cyclosis {line}" for line in examples)
    return group.command(name, cls=Command, epilog=f"\b\nFor example:\n{lines}" if lines else None)


def with_options(*tables: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add one option for every definition of some of `TABLES`, named as in the configuration file."""
    return partial(_with_options, tables)


def changes(options: Mapping[str, str | bool | None]) -> dict[str, dict[str, Any]]:
    """Return the tables of checked values given by such options."""
    found: dict[str, dict[str, Any]] = {name: {} for name in TABLES}
    for key, text in options.items():
        if text is not None:
            table, name = key.split("__")
            item = definition(table, name)
            found[table][name] = item.parse(text) if isinstance(text, str) else item.check(text)
    return found


def _with_options(tables: tuple[str, ...], function: Callable[..., None]) -> Callable[..., None]:
    own = list(inspect.signature(function, eval_str=True).parameters.values())[:-1]
    added = [_option(table, item) for table in tables for item in TABLES[table]]
    signature = inspect.Signature([*own, *added])
    function.__signature__ = signature  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    return function


def _option(table: str, item: Definition) -> inspect.Parameter:
    name = option_name(table, item)
    default = "" if item.default is None else f" Default {_shown(item.default)}."
    flag = item.kind == "flag"
    rule = "" if item.kind in ("flag", "text") else f": {item.written}"
    option = typer.Option(
        f"{name}/--no-{name[2:]}" if flag else name,
        metavar=None if flag else _FORMS.get(item.kind, item.kind.upper()),
        help=f"{item.meaning[0].upper()}{item.meaning[1:]}{rule}.{default}",
        show_default=False,
        rich_help_panel=_GROUPS[table],
    )
    annotation: Any = Annotated[bool | None, option] if flag else Annotated[str | None, option]
    return inspect.Parameter(
        f"{table}__{item.name}", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation
    )


def _shown(default: Any) -> str:
    return (
        "all"
        if isinstance(default, tuple)
        else str(default).lower()
        if isinstance(default, bool)
        else f"{default}"
    )
