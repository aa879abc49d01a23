"""Commands that draw figures from files of runs and stores of sweeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import Definition
from ..model.errors import InputError, choice
from . import targets
from .looks import looking, width, with_looks
from .options import FILE, FORCE, OUTPUT, TARGET, command, commands
from .sources import of_run, of_sweep

figures = commands("Draw figures from a file of a run, or from the store of a sweep.")
_TIMES = Definition("times", "t", "times", None, "numbers", 0.0, 1e9)


@with_looks
def emergence(
    file: FILE,
    out: TARGET = None,
    times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Times of the cells, six, as 0,3,6,12,21,30.")
    ] = None,
    map_times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Which of them to show unwrapped as well, three.")
    ] = None,
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw the emergence of streaming: the cell at six times, three of them unwrapped."""
    from ..figures import emergence as figure

    shown, mapped = (None if text is None else _TIMES.parse(text) for text in (times, map_times))
    how: dict[str, Any] = {"times": shown, "map_times": mapped, **width(looks)}
    target = out or file.with_suffix(".png")
    _draw(file, target, force, lambda data: figure.emergence(data, **how), looks)


@with_looks
def history(file: FILE, out: TARGET = None, force: FORCE = False, **looks: Any) -> None:
    """Draw order, speed, stripes or defects, and power over time, and the final profile."""
    from ..figures import history as figure

    target = out or file.with_name(f"{file.stem}-history.png")
    _draw(file, target, force, lambda data: figure.history(data, **width(looks)), looks)


@with_looks
def snapshot(
    file: FILE,
    at: Annotated[
        float | None, typer.Option(metavar="TIME", help="Time to show, as 22; by default the end.")
    ] = None,
    view: Annotated[
        str, typer.Option(metavar="NAME", help="What to show: both, cylinder (the cell), or map.")
    ] = "both",
    out: TARGET = None,
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw one moment of a run, also of a closed cell: the cell, its unwrapped map, or both."""
    from ..figures import snapshot as figure

    choice("view", view, ("both", "cylinder", "map"))
    target = out or file.with_name(f"{file.stem}-snapshot.png")
    _draw(file, target, force, lambda data: figure.snapshot(data, at, view, **width(looks)), looks)


@with_looks
def compare(
    first: FILE,
    second: Annotated[
        Path,
        typer.Argument(metavar="OTHER", help="NetCDF file of the other run.", callback=of_run),
    ],
    at: Annotated[
        float | None, typer.Option(metavar="TIME", help="Time to show; by default the last of both.")
    ] = None,
    out: TARGET = None,
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw two runs on cylinders at one time, side by side, and their difference."""
    from .. import dataset
    from ..figures import compare as figure

    target = out or first.with_name(f"{first.stem}-{second.stem}.png")
    with dataset.open_dataset(second) as other:
        names = first.stem, second.stem
        how: dict[str, Any] = {"time": at, "names": names, **width(looks)}
        _draw(first, target, force, lambda data: figure.compare(data, other, **how), looks, other)


@with_looks
def roses(
    file: FILE,
    times: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="Times to show, by default four, as 0,5,10,50.")
    ] = None,
    out: TARGET = None,
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw the density of filament angles of a kinetic run, around and across a zone."""
    from ..figures import roses as figure

    shown = None if times is None else _TIMES.parse(times)
    target = out or file.with_name(f"{file.stem}-roses.png")
    _draw(file, target, force, lambda data: figure.roses(data, shown, **width(looks)), looks)


def _draw(
    file: Path,
    target: Path,
    force: bool,
    figure: Callable[[Any], Any],
    looks: Mapping[str, Any],
    *others: Any,
) -> None:
    from .. import dataset
    from ..figures import style

    targets.check(target, force, targets.FIGURE)
    units = looks.get("radius_um"), looks.get("speed_um_s")
    with dataset.open_dataset(file) as data, looking(looks):
        drawn = figure(dataset.with_scales(data, None, *units))
        style.save(style.signed(drawn, data, *others), target)
    print(f"saved {target}")


KINDS = ("share", "regimes", "basins")
_DRAWN_FROM = ["regime", "status", "t_order", "initial_k0", "initial_m1"]
_CUTS = Definition("cuts", "-", "values of the second axis", None, "numbers", -1e9, 1e9)


@with_looks
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
            help="File to write: .png, .pdf, .svg or .eps; by default next to STORE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    force: FORCE = False,
    **looks: Any,
) -> None:
    """Draw the outcomes of a sweep over its parameters."""
    from .. import dataset
    from ..figures import basins, style
    from ..figures import phase_diagram as figure
    from ..sweep.store.read import open_sweep

    choice("kind", kind, KINDS)
    if cuts is not None and kind != KINDS[0]:
        raise InputError("cuts", cuts, "given with kind = share", "leave it out")
    name = store.stem if kind == KINDS[0] else f"{store.stem}-{kind}"
    target = out or store.with_name(f"{name}.png")
    targets.check(target, force, targets.FIGURE)
    chosen: dict[str, Any] = {
        "select": dict(map(_selected, select or [])) or None,
        "log": log,
        **width(looks),
    }
    with open_sweep(store, variables=_DRAWN_FROM) as found, looking(looks):
        data = dataset.with_scales(found, None, looks["radius_um"], looks["speed_um_s"])
        if kind == KINDS[0]:
            drawn = figure.phase_diagram(data, cuts=None if cuts is None else _CUTS.parse(cuts), **chosen)
        else:
            drawn = (figure.regimes_and_time if kind == KINDS[1] else basins.basins)(data, **chosen)
        style.save(style.signed(drawn, data), target)
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
command(figures, "figure history run.nc --out run-history.svg --width-mm 183")(history)
command(
    figures,
    "figure snapshot run.nc --at 22",
    "figure snapshot run.nc --view map --width-mm 89 --out panel.pdf",
    "figure snapshot run.nc --colours direction --view cylinder",
)(snapshot)
command(figures, "figure compare a.nc b.nc --at 30")(compare)
command(figures, "figure roses kinetic.nc --times 0,10,20,200")(roses)
command(
    figures,
    "figure phase-diagram store --kind regimes --out regimes.png",
    "figure phase-diagram store --select kappa=0.5 --log alpha_p",
    name="phase-diagram",
)(phase_diagram)
