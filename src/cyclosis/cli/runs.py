"""Commands for one cell: run, resume, info, movie, export, doctor."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import TABLES
from ..model.errors import InputError
from . import targets
from .options import FILE, FORCE, OUTPUT, PAUSE, QUIET, changes, command, with_options


def register(app: typer.Typer) -> None:
    """Add these commands to a group."""
    command(app, "run --alpha-p 1 --alpha-u 0.5 --out run.nc", "run --config run.toml --seed 3 --out run.nc")(
        run
    )
    command(app, "resume run.nc", "resume run.nc --t-end 400")(resume)
    command(app, "info run.nc")(info)
    command(app)(doctor)
    command(app, "movie run.nc --out run.mp4 --seconds 8")(movie)
    command(app, "export run.nc --out surface")(export)


@with_options(*TABLES)
def run(
    config: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Configuration file run.toml; the options below override it."),
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
                        **ready.settings.as_dict(),
                    )
            except KeyboardInterrupt as stopped:
                result = carried(stopped)
            progress.label("saving")
            writer.finish(result)
    _end(result, out, quiet)


def resume(
    file: FILE,
    t_end: Annotated[
        float | None,
        typer.Option(metavar="TIME", help="Time to continue to; by default the run's end."),
    ] = None,
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
        if t_end is None and not is_unfinished(file):
            _refuse_finished(stored)
        progress.follow(stored.model.problem(stored.params, stored.grid), stored.params_at)
        try:
            with terminable():
                result = dataset.resume_file(
                    file, t_end, progress=progress, checkpoint_seconds=checkpoint_seconds
                )
        except KeyboardInterrupt as stopped:
            result = carried(stopped)
    _end(result, file, quiet)


def _refuse_finished(stored: Any) -> None:
    """Refuse to continue a run that has reached its end if no later time is given."""
    if stored.status in ("completed", "underresolved") and stored.t_final >= stored.settings.t_end:
        rule = f"later than the time reached, because the run is complete at t = {stored.t_final:g}"
        raise InputError("t_end", stored.settings.t_end, rule, "give --t-end to continue further")


def _end(result: Any, file: Path, quiet: bool) -> None:
    """Print the outcome of a run, unless it succeeded and `quiet` is set."""
    from .. import report
    from ..report.lines import aligned

    if quiet and result.ok:
        return
    print(report.summary(result))
    print(aligned({"saved": str(file)}))
    if result.status == "interrupted":
        print(aligned({"to continue": f"cyclosis resume {shlex.quote(str(file))}"}))
        raise typer.Exit(130)
    raise typer.Exit(0 if result.ok else 1)


def info(file: FILE) -> None:
    """Print the contents of a file of a run."""
    from .. import dataset, report

    with dataset.open_dataset(file) as data:
        print(report.tree(data))


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
        figure.movie(data, paths, frames=frames, seconds=seconds, progress=bar)
    if not quiet:
        print("saved " + ", ".join(map(str, paths)))


def export(
    file: FILE,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Folder to write; by default FILE without suffix.", rich_help_panel=OUTPUT
        ),
    ] = None,
    force: FORCE = False,
) -> None:
    """Export every saved field to VTK files of the cell's surface, for ParaView."""
    from .. import dataset

    if out is not None:
        targets.check_folder(out)
    folder = out or file.with_suffix("")
    with dataset.open_dataset(file) as data:
        collection = dataset.export_vtk(data, folder, force)
    print(f"saved {collection}")
