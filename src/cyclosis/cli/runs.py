"""Commands for one cell: run, resume, info, movie, doctor."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import TABLES
from ..model.errors import InputError
from ..model.units import of_table, table_of
from . import targets
from .exports import export
from .looks import COLOURS, looking
from .options import FILE, FORCE, JSON, OUTPUT, PAUSE, QUIET, RADIUS, SPEED, changes, command, with_options


def register(app: typer.Typer) -> None:
    """Add these commands to a group."""
    command(app, "run --alpha-p 1 --alpha-u 0.5 --out run.nc", "run --config run.toml --seed 3 --out run.nc")(
        run
    )
    command(app, "resume run.nc", "resume run.nc --t-end 400")(resume)
    command(app, "info run.nc", "info run.nc --json", "info run.nc --toml")(info)
    command(app)(doctor)
    command(app, "movie run.nc --out run.mp4 --seconds 8")(movie)
    command(
        app,
        "export run.nc --out surface",
        "export run.nc --as csv --out tables",
        "export run.nc --as csv --table zones --out -",
        "export run.nc --out run.xlsx",
    )(export)


@with_options(*TABLES)
def run(
    config: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Configuration file run.toml, or - for standard input; the options below override it.",
        ),
    ] = None,
    protocol: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="File of [[protocol]] steps, instead of those in the configuration."
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option(metavar="FILE", help="NetCDF file to write (.nc).", rich_help_panel=OUTPUT)
    ] = Path("run.nc"),
    force: FORCE = False,
    json_line: JSON = False,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
    **options: str | bool | None,
) -> None:
    """Run one cell and save it to a NetCDF file."""
    from ..progress import RunProgress

    with RunProgress(hidden=quiet) as progress:
        from .. import config as configuration

        tables, steps = configuration.read(config) if config is not None else (configuration.check({}), [])
        if protocol is not None:
            steps = configuration.read_protocol(protocol)
        ready = configuration.setup(configuration.merged(tables, changes(options)), steps)

        from .. import dataset
        from ..dynamics.interrupts import carried, terminable
        from ..dynamics.simulate import simulate

        targets.check(out, force, targets.RUN)
        with dataset.RunWriter(out, force) as writer:
            progress.follow(ready.model.problem(ready.params, ready.grid), ready.schedule.params_at)
            try:
                with terminable():
                    result = simulate(
                        ready.params,
                        ready.grid,
                        ready.state,
                        model=ready.model,
                        protocol=ready.protocol,
                        terms=ready.terms,
                        progress=progress,
                        checkpoint=writer,
                        checkpoint_seconds=checkpoint_seconds,
                        provenance={"initial": ready.initial},
                        scales=ready.scales,
                        **ready.settings.as_dict(),
                    )
            except KeyboardInterrupt as stopped:
                result = carried(stopped)
            progress.label("saving")
            writer.finish(result)
    _end(result, out, quiet, json_line)


def resume(
    file: FILE,
    t_end: Annotated[
        float | None,
        typer.Option(metavar="TIME", help="Time to continue to; by default the run's end."),
    ] = None,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    json_line: JSON = False,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
) -> None:
    """Continue a run, finished or interrupted in any way, as if it had never stopped."""
    from ..progress import RunProgress

    with RunProgress(hidden=quiet) as progress:
        from .. import dataset
        from ..dataset.parts import is_unfinished
        from ..dynamics.interrupts import carried, terminable

        stored = dataset.load(file, fields=False)
        given = {"radius_um": radius_um, "speed_um_s": speed_um_s}
        own = {} if stored.scales is None else table_of(stored.scales)
        scales = of_table(own | {name: value for name, value in given.items() if value is not None})
        if t_end is None and not is_unfinished(file):
            _refuse_finished(stored)
        progress.follow(stored.model.problem(stored.params, stored.grid), stored.params_at)
        try:
            with terminable():
                result = dataset.resume_file(
                    file, t_end, progress=progress, checkpoint_seconds=checkpoint_seconds, scales=scales
                )
        except KeyboardInterrupt as stopped:
            result = carried(stopped)
    _end(result, file, quiet, json_line)


def _refuse_finished(stored: Any) -> None:
    """Refuse to continue a run that has reached its end if no later time is given."""
    if stored.status in ("completed", "underresolved") and stored.t_final >= stored.settings.t_end:
        rule = f"later than the time reached, because the run is complete at t = {stored.t_final:g}"
        raise InputError("t_end", stored.settings.t_end, rule, "give --t-end to continue further")


def _end(result: Any, file: Path, quiet: bool, json_line: bool) -> None:
    """Print the outcome of a run, unless it succeeded and `quiet` is set."""
    from .. import report
    from ..report.lines import aligned

    interrupted = result.status == "interrupted"
    if json_line:
        print(json.dumps({"file": str(file), **report.facts(result)}))
    elif not (quiet and result.ok):
        print(report.summary(result))
        print(aligned({"saved": str(file)}))
        if interrupted:
            print(aligned({"to continue": f"cyclosis resume {shlex.quote(str(file))}"}))
    raise typer.Exit(0 if result.ok else 130 if interrupted else 1)


def info(
    file: FILE,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    json_line: JSON = False,
    toml: Annotated[
        bool,
        typer.Option(
            "--toml", help="Print the configuration for run --config alone.", rich_help_panel=OUTPUT
        ),
    ] = False,
) -> None:
    """Print what is in a file of a run: the cell, its regime, its start, and how to make it again."""
    from .. import dataset, report

    if json_line and toml:
        raise InputError("toml", True, "left out with --json", "give one of the two")
    with dataset.open_dataset(file) as data:
        data = dataset.with_scales(data, None, radius_um, speed_um_s)
        if toml:
            print(report.configured(data, file), end="")
        elif json_line:
            print(json.dumps({"file": str(file), **report.contents(data, file)}))
        else:
            print(report.tree(data, file))


def doctor() -> None:
    """Print the resources of this installation: versions, devices, threads, precision, disk."""
    from .. import report
    from ..model.devices import require_devices

    print(report.machine())
    require_devices()


def movie(
    file: FILE,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="File to write, .mp4 or .gif; may be repeated. By default both next to FILE.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    frames: Annotated[int, typer.Option(metavar="WHOLE", help="Number of frames.")] = 144,
    seconds: Annotated[float, typer.Option(metavar="SECONDS", help="Length of the movie in seconds.")] = 12.0,
    radius_um: RADIUS = None,
    speed_um_s: SPEED = None,
    colours: COLOURS = None,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Draw a movie: the slowly turning cell next to the unwrapped map, with the flow."""
    from .. import dataset
    from ..figures import movie as figure
    from ..progress import Bar

    paths = out or [file.with_suffix(".mp4"), file.with_suffix(".gif")]
    for target in paths:
        targets.check(target, force, targets.MOVIE)
    with dataset.open_dataset(file) as data, Bar("frames", hidden=quiet) as bar:
        data = dataset.with_scales(data, None, radius_um, speed_um_s)
        with looking({"colours": colours}):
            figure.movie(data, paths, frames=frames, seconds=seconds, progress=bar)
    if not quiet:
        print("saved " + ", ".join(map(str, paths)))
