"""Commands that draw figures from files of runs and stores of sweeps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import Definition
from ..model.errors import InputError, choice
from . import targets
from .options import FILE, FORCE, OUTPUT, RADIUS, SPEED, TARGET, command, commands
from .sources import of_sweep

figures = commands("Draw figures from a file of a run, or from the store of a sweep.")
_TIMES = Definition("times", "t", "times", None, "numbers", 0.0, 1e9)


def emergence(
    file: FILE,
    out: TARGET = None,
    times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Times of the cells, six, as 0,3,6,12,21,30.")
    ] = None,
    map_times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Which of them to show unwrapped as well, three.")
    ] = None,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    force: FORCE = False,
) -> None:
    """Draw the emergence of streaming: the cell at six times, three of them unwrapped (PNG or PDF)."""
    from ..figures import emergence as figure

    shown, mapped = (None if text is None else _TIMES.parse(text) for text in (times, map_times))
    target, units = out or file.with_suffix(".png"), (radius_um, speed_um_s)
    _draw(file, target, force, lambda data: figure.emergence(data, times=shown, map_times=mapped), units)


def history(
    file: FILE,
    out: TARGET = None,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    force: FORCE = False,
) -> None:
    """Draw order, speed, stripes or defects, and power over time, and the final profile (PNG or PDF)."""
    from ..figures import history as figure

    target = out or file.with_name(f"{file.stem}-history.png")
    _draw(file, target, force, figure.history, (radius_um, speed_um_s))


def roses(
    file: FILE,
    times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Times to show, by default four, as 0,5,10,50.")
    ] = None,
    out: TARGET = None,
    force: FORCE = False,
) -> None:
    """Draw the density of filament angles of a kinetic run, around and across a zone (PNG or PDF)."""
    from ..figures import roses as figure

    shown = None if times is None else _TIMES.parse(times)
    target = out or file.with_name(f"{file.stem}-roses.png")
    _draw(file, target, force, lambda data: figure.roses(data, shown))


def _draw(
    file: Path,
    target: Path,
    force: bool,
    figure: Callable[[Any], Any],
    units: tuple[float | None, float | None] = (None, None),
) -> None:
    from .. import dataset
    from ..figures import style

    targets.check(target, force, targets.FIGURE)
    with dataset.open_dataset(file) as data:
        style.save(figure(dataset.with_scales(data, None, *units)), target)
    print(f"saved {target}")


KINDS = ("share", "regimes", "basins")
_DRAWN_FROM = ["regime", "status", "t_order", "initial_k0", "initial_m1"]
_CUTS = Definition("cuts", "-", "values of the second axis", None, "numbers", -1e9, 1e9)


def phase_diagram(
    store: Annotated[
        Path,
        typer.Argument(
            metavar="STORE",
            help="Folder of a sweep's results, or an export of it (.nc, .zarr).",
            callback=of_sweep,
        ),
    ],
    kind: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="share: percentage of cyclosis (the paper's Figure 5); regimes: every regime, and the "
            "median time to order; basins: outcomes against initial amplitudes.",
        ),
    ] = "share",
    select: Annotated[
        list[str] | None, typer.Option(metavar="AXIS=VALUE", help="Value of a further axis; may be repeated.")
    ] = None,
    cuts: Annotated[
        str | None,
        typer.Option(metavar="X,Y,...", help="Values of the second axis to cut at (share only)."),
    ] = None,
    log: Annotated[
        list[str] | None, typer.Option(metavar="AXIS", help="Axis on a logarithmic scale; may be repeated.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="File to write, .png or .pdf; by default next to STORE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    force: FORCE = False,
) -> None:
    """Draw the outcomes of a sweep over its parameters (PNG or PDF)."""
    from ..figures import basins, style
    from ..figures import phase_diagram as figure
    from ..sweep.store.read import open_sweep

    choice("kind", kind, KINDS)
    if cuts is not None and kind != KINDS[0]:
        raise InputError("cuts", cuts, "given with kind = share", "leave it out")
    name = store.stem if kind == KINDS[0] else f"{store.stem}-{kind}"
    target = out or store.with_name(f"{name}.png")
    targets.check(target, force, targets.FIGURE)
    chosen: dict[str, Any] = {"select": dict(map(_selected, select or [])) or None, "log": log}
    with open_sweep(store, variables=_DRAWN_FROM) as data:
        if kind == KINDS[0]:
            drawn = figure.phase_diagram(data, cuts=None if cuts is None else _CUTS.parse(cuts), **chosen)
        else:
            drawn = (figure.regimes_and_time if kind == KINDS[1] else basins.basins)(data, **chosen)
        style.save(drawn, target)
    print(f"saved {target}")


def _selected(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise InputError("select", text, "an axis and a value", "write it as kappa=0.5") from None


command(figures, "figure emergence run.nc", "figure emergence run.nc --times 0,5,10,20,50,200 --out run.pdf")(
    emergence
)
command(figures, "figure history run.nc --out run-history.png")(history)
command(figures, "figure roses kinetic.nc --times 0,10,20,200")(roses)
command(
    figures,
    "figure phase-diagram store --kind regimes --out regimes.png",
    "figure phase-diagram store --select kappa=0.5 --log alpha_p",
    name="phase-diagram",
)(phase_diagram)
