"""Commands for one cell: run, resume, info, movie, export, doctor."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from ..model.definitions import TABLES
from .options import FILE, FORCE, PAUSE, QUIET, changes, with_options


def register(app: typer.Typer) -> None:
    """Add these commands to a group."""
    for command in (run, resume, info, doctor, movie, export):
        app.command()(command)


@with_options(*TABLES)
def run(
    config: Annotated[
        Path | None, typer.Option(help="Configuration file run.toml; options override it.")
    ] = None,
    protocol: Annotated[
        Path | None, typer.Option(help="File of [[protocol]] steps, instead of those in the configuration.")
    ] = None,
    out: Annotated[Path, typer.Option(help="NetCDF file to write.")] = Path("run.nc"),
    force: FORCE = False,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
    **options: str | None,
) -> None:
    """Run one cell and save it to a NetCDF file."""
    from .. import config as configuration

    tables, steps = configuration.read(config) if config is not None else (configuration.check({}), [])
    if protocol is not None:
        steps = configuration.read_protocol(protocol)
    ready = configuration.setup(configuration.merged(tables, changes(options)), steps)

    from .. import dataset, report
    from ..dynamics.simulate import simulate
    from ..progress import RunProgress

    writer = dataset.RunWriter(out, force)
    with RunProgress(ready.schedule.params_at, ready.grid, hidden=quiet) as progress:
        result = simulate(
            ready.params,
            ready.grid,
            ready.state,
            protocol=ready.protocol,
            terms=ready.terms,
            progress=progress,
            checkpoint=writer,
            checkpoint_seconds=checkpoint_seconds,
            provenance={"initial": ready.initial},
            **ready.settings.as_dict(),
        )
        writer.finish(result)
    print(report.summary(result))
    _end(result, out)


def resume(
    file: FILE,
    t_end: Annotated[
        float | None, typer.Option(help="Time to go on to; by default the run's own end.")
    ] = None,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
) -> None:
    """Continue a run, finished, interrupted or cut off, as if it had never stopped."""
    from .. import dataset, report
    from ..progress import RunProgress

    standing = dataset.load(file, fields=False)
    with RunProgress(standing.params_at, standing.grid, hidden=quiet) as progress:
        result = dataset.resume_file(file, t_end, progress=progress, checkpoint_seconds=checkpoint_seconds)
    print(report.summary(result))
    _end(result, file)


def _end(result: Any, file: Path) -> None:
    from ..report.lines import aligned

    print(aligned({"saved": str(file)}))
    if result.status == "interrupted":
        print(aligned({"to go on": f"cyclosis resume {shlex.quote(str(file))}"}))
        raise typer.Exit(130)
    raise typer.Exit(0 if result.ok else 1)


def info(file: FILE) -> None:
    """Print what a file of a run holds."""
    from .. import dataset, report

    with dataset.open_dataset(file) as data:
        print(report.tree(data))


def doctor() -> None:
    """Print what this installation computes with: versions, devices, threads, precision, disk."""
    from .. import report

    print(report.machine())


def movie(
    file: FILE,
    out: Annotated[
        list[Path] | None, typer.Option(help="MP4 or GIF; may be repeated. By default both beside FILE.")
    ] = None,
    frames: Annotated[int, typer.Option(help="Number of frames.")] = 144,
    seconds: Annotated[float, typer.Option(help="Length of the movie in seconds.")] = 12.0,
    force: FORCE = False,
    quiet: QUIET = False,
) -> None:
    """Draw a movie: the slowly turning cylinder beside the unwrapped map, with the flow."""
    from .. import dataset
    from ..figures import movie as figure
    from ..progress import Bar

    targets = out or [file.with_suffix(".mp4"), file.with_suffix(".gif")]
    for target in targets:
        dataset.check_writable(target, force)
    with dataset.open_dataset(file) as data, Bar("frames", hidden=quiet) as bar:
        figure.movie(data, targets, frames=frames, seconds=seconds, progress=bar)
    print("saved " + ", ".join(map(str, targets)))


def export(
    file: FILE,
    out: Annotated[Path | None, typer.Option(help="Folder to write; by default FILE without suffix.")] = None,
    force: FORCE = False,
) -> None:
    """Export every saved field to VTK files of the cylinder's surface, for ParaView."""
    from .. import dataset

    folder = out or file.with_suffix("")
    with dataset.open_dataset(file) as data:
        collection = dataset.export_vtk(data, folder, force)
    print(f"saved {collection}")
