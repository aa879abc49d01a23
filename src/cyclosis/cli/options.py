"""Options that several commands share, and those made from the definitions of settings."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import TABLES, Definition, definition

FORCE = Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")]


def named(path: Path) -> Path:
    """Return a path that ends in a name, so that something can be put beside it."""
    return path if path.name else path.resolve()


FILE = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="NetCDF file of a run.", show_default=False, callback=named),
]
TARGET = Annotated[Path | None, typer.Option("--out", help="File to write; by default beside FILE.")]
QUIET = Annotated[bool, typer.Option("--quiet", help="Show no progress.")]
PAUSE = Annotated[
    float, typer.Option("--checkpoint-seconds", min=0.0, help="Seconds on the clock between checkpoints.")
]


def commands(help: str, name: str | None = None) -> typer.Typer:
    """Return an empty group of commands."""
    return typer.Typer(
        name=name,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        help=help,
    )


def with_options(*tables: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add one option for every definition of some of `TABLES`, named as in the configuration file."""
    return partial(_with_options, tables)


def changes(options: Mapping[str, str | None]) -> dict[str, dict[str, Any]]:
    """Return the tables of values, checked, that such options give."""
    found: dict[str, dict[str, Any]] = {name: {} for name in TABLES}
    for key, text in options.items():
        if text is not None:
            table, name = key.split("__")
            found[table][name] = definition(table, name).parse(text)
    return found


def _with_options(tables: tuple[str, ...], function: Callable[..., None]) -> Callable[..., None]:
    own = list(inspect.signature(function, eval_str=True).parameters.values())[:-1]
    added = [_option(table, item) for table in tables for item in TABLES[table]]
    signature = inspect.Signature([*own, *added])
    function.__signature__ = signature  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    return function


def _option(table: str, item: Definition) -> inspect.Parameter:
    name = f"--{item.name.replace('_', '-')}"
    default = "" if item.default is None else f" Default {_shown(item.default)}."
    text = f"{item.meaning[0].upper()}{item.meaning[1:]}: {item.rule}.{default}"
    option = typer.Option(name, metavar=item.kind.upper(), help=text, show_default=False)
    return inspect.Parameter(
        f"{table}__{item.name}",
        inspect.Parameter.KEYWORD_ONLY,
        default=None,
        annotation=Annotated[str | None, option],
    )


def _shown(default: Any) -> str:
    return (
        "all"
        if isinstance(default, tuple)
        else str(default).lower()
        if isinstance(default, bool)
        else f"{default}"
    )
