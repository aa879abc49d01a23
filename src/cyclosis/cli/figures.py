"""Commands that draw figures from files of runs and stores of sweeps."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import Definition
from ..model.errors import InputError
from .options import FILE, FORCE, TARGET, commands, named

figures = commands("Draw figures from a file of a run, or from the store of a sweep.")
_TIMES = Definition("times", "t", "times", None, "numbers", 0.0, 1e9)


@figures.command()
def emergence(
    file: FILE,
    out: TARGET = None,
    times: Annotated[str | None, typer.Option(help="Times of the cylinders, separated by commas.")] = None,
    map_times: Annotated[str | None, typer.Option(help="Which of them to show unwrapped as well.")] = None,
    force: FORCE = False,
) -> None:
    """Draw the emergence of streaming: six times on the cylinder, three of them unwrapped (PNG or PDF)."""
    from ..figures import emergence as figure

    shown, mapped = (None if text is None else _TIMES.parse(text) for text in (times, map_times))
    target = out or file.with_suffix(".png")
    _draw(file, target, force, lambda data: figure.emergence(data, times=shown, map_times=mapped))


@figures.command()
def history(file: FILE, out: TARGET = None, force: FORCE = False) -> None:
    """Draw order, speed, stripes and power over time, and the final profile against theory (PNG or PDF)."""
    from ..figures import history as figure

    target = out or file.with_name(f"{file.stem}-history.png")
    _draw(file, target, force, figure.history)


def _draw(file: Path, target: Path, force: bool, figure: Callable[[Any], Any]) -> None:
    from .. import dataset
    from ..figures import style

    dataset.check_writable(target, force)
    with dataset.open_dataset(file) as data:
        style.save(figure(data), target)
    print(f"saved {target}")


class Kind(StrEnum):
    """Which figure of a sweep."""

    SHARE = "share"
    REGIMES = "regimes"
    BASINS = "basins"


_DRAWN_FROM = ["regime", "status", "t_order", "initial_k0", "initial_m1"]
_CUTS = Definition("cuts", "-", "values of the second axis", None, "numbers", -1e9, 1e9)


@figures.command("phase-diagram")
def phase_diagram(
    store: Annotated[
        Path,
        typer.Argument(metavar="STORE", help="Folder of a sweep's results, or an export of it (.nc, .zarr)."),
    ],
    out: Annotated[Path | None, typer.Option("--out", help="File to write; by default beside STORE.")] = None,
    kind: Annotated[
        Kind,
        typer.Option(
            help="share: percentage of cyclosis (the paper's Figure 5); regimes: every regime, and the "
            "median time to order; basins: outcomes against initial amplitudes."
        ),
    ] = Kind.SHARE,
    select: Annotated[
        list[str] | None, typer.Option(metavar="AXIS=VALUE", help="Value of a further axis; may be repeated.")
    ] = None,
    cuts: Annotated[
        str | None, typer.Option(help="Values of the second axis to cut at (share only).")
    ] = None,
    log: Annotated[
        list[str] | None, typer.Option(metavar="AXIS", help="Axis on a logarithmic scale; may be repeated.")
    ] = None,
    force: FORCE = False,
) -> None:
    """Draw what a sweep's members became, over its parameters (PNG or PDF)."""
    from .. import dataset
    from ..figures import basins, style
    from ..figures import phase_diagram as figure
    from ..sweep.collect import open_sweep

    store = named(store)
    if cuts is not None and kind is not Kind.SHARE:
        raise InputError("cuts", cuts, "given with kind = share", "leave it out")
    name = store.stem if kind is Kind.SHARE else f"{store.stem}-{kind}"
    target = out or store.with_name(f"{name}.png")
    dataset.check_writable(target, force)
    chosen: dict[str, Any] = {"select": dict(map(_selected, select or [])) or None, "log": log}
    with open_sweep(store, variables=_DRAWN_FROM) as data:
        if kind is Kind.SHARE:
            drawn = figure.phase_diagram(data, cuts=None if cuts is None else _CUTS.parse(cuts), **chosen)
        else:
            drawn = (figure.regimes_and_time if kind is Kind.REGIMES else basins.basins)(data, **chosen)
        style.save(drawn, target)
    print(f"saved {target}")


def _selected(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise InputError("select", text, "an axis and a value, as kappa=0.5", "write it so") from None
