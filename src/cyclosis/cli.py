"""The command line: parses, calls, prints; nothing else."""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .model.definitions import TABLES, Definition, definition
from .model.errors import InputError
from .version import __version__

app = typer.Typer(
    name="cyclosis",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="How cytoplasmic streaming organises itself: the model of Woodhouse & Goldstein (2013).",
)
figures = typer.Typer(no_args_is_help=True, rich_markup_mode=None, help="Draw figures from a file of a run.")
app.add_typer(figures, name="figure")

FORCE = Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")]
FILE = Annotated[Path, typer.Argument(metavar="FILE", help="NetCDF file of a run.", show_default=False)]


def _with_options(function: Callable[..., None]) -> Callable[..., None]:
    """Add one option for every definition, named as in the configuration file."""
    own = list(inspect.signature(function, eval_str=True).parameters.values())[:-1]
    added = [_option(table, item) for table, items in TABLES.items() for item in items]
    signature = inspect.Signature([*own, *added])
    function.__signature__ = signature  # type: ignore[attr-defined]
    function.__annotations__ = {p.name: p.annotation for p in signature.parameters.values()}
    return function


def _option(table: str, item: Definition) -> inspect.Parameter:
    name = f"--{item.name.replace('_', '-')}"
    default = "" if item.default is None else f" Default {_shown(item.default)}."
    text = f"{item.meaning[0].upper()}{item.meaning[1:]}: {item.rule}.{default}"
    option = typer.Option(
        name, metavar=item.kind.upper(), help=text, rich_help_panel=table, show_default=False
    )
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


PAUSE = Annotated[
    float, typer.Option("--checkpoint-seconds", min=0.0, help="Seconds on the clock between checkpoints.")
]
QUIET = Annotated[bool, typer.Option("--quiet", help="Show no progress bar.")]


@app.command()
@_with_options
def run(
    config: Annotated[
        Path | None, typer.Option(help="Configuration file run.toml; options override it.")
    ] = None,
    out: Annotated[Path, typer.Option(help="NetCDF file to write.")] = Path("run.nc"),
    force: FORCE = False,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
    **options: str | None,
) -> None:
    """Run one cell and save it to a NetCDF file."""
    from . import config as configuration

    changes: configuration.Tables = {name: {} for name in TABLES}
    for key, text in options.items():
        if text is not None:
            table, name = key.split("__")
            changes[table][name] = definition(table, name).parse(text)
    tables = configuration.read(config) if config is not None else configuration.check({})
    ready = configuration.setup(configuration.merged(tables, changes))

    from . import dataset, report
    from .dynamics.simulate import simulate
    from .progress import RunProgress

    writer = dataset.RunWriter(out, force)
    with RunProgress(ready.params, ready.grid, hidden=quiet) as progress:
        result = simulate(
            ready.params,
            ready.grid,
            ready.state,
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


@app.command()
def resume(
    file: FILE,
    t_end: Annotated[
        float | None, typer.Option(help="Time to go on to; by default the run's own end.")
    ] = None,
    quiet: QUIET = False,
    checkpoint_seconds: PAUSE = 30.0,
) -> None:
    """Continue a run, finished, interrupted or cut off, as if it had never stopped."""
    from . import dataset, report
    from .progress import RunProgress

    standing = dataset.load(file, fields=False)
    with RunProgress(standing.params, standing.grid, hidden=quiet) as progress:
        result = dataset.resume_file(file, t_end, progress=progress, checkpoint_seconds=checkpoint_seconds)
    print(report.summary(result))
    _end(result, file)


def _end(result: Any, file: Path) -> None:
    print(f"{'saved':>18}  {file}")
    if result.status == "interrupted":
        print(f"{'to go on':>18}  cyclosis resume {file}")
        raise typer.Exit(130)
    raise typer.Exit(0 if result.ok else 1)


@app.command()
def info(file: FILE) -> None:
    """Print what a file of a run holds."""
    from . import dataset, report

    with dataset.open_dataset(file) as data:
        print(report.tree(data))


@app.command()
def doctor() -> None:
    """Print what this installation computes with: versions, devices, threads, precision, disk."""
    from . import report

    print(report.machine())


TARGET = Annotated[Path | None, typer.Option("--out", help="File to write; by default beside FILE.")]


@figures.command()
def emergence(
    file: FILE,
    out: TARGET = None,
    times: Annotated[str | None, typer.Option(help="Times of the cylinders, separated by commas.")] = None,
    map_times: Annotated[str | None, typer.Option(help="Which of them to show unwrapped as well.")] = None,
    force: FORCE = False,
) -> None:
    """Draw the emergence of streaming: six times on the cylinder, three of them unwrapped (PNG or PDF)."""
    from .figures import emergence as figure

    shown, mapped = (None if text is None else _TIMES.parse(text) for text in (times, map_times))
    target = out or file.with_suffix(".png")
    _draw(file, target, force, lambda data: figure.emergence(data, times=shown, map_times=mapped))


@figures.command()
def history(file: FILE, out: TARGET = None, force: FORCE = False) -> None:
    """Draw order, speed, stripes and power over time, and the final profile against theory (PNG or PDF)."""
    from .figures import history as figure

    target = out or file.with_name(f"{file.stem}-history.png")
    _draw(file, target, force, figure.history)


def _draw(file: Path, target: Path, force: bool, figure: Callable[[Any], Any]) -> None:
    from . import dataset
    from .figures import style

    dataset.check_writable(target, force)
    with dataset.open_dataset(file) as data:
        style.save(figure(data), target)
    print(f"saved {target}")


@app.command()
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
    from . import dataset
    from .figures import movie as figure
    from .progress import Bar

    targets = out or [file.with_suffix(".mp4"), file.with_suffix(".gif")]
    for target in targets:
        dataset.check_writable(target, force)
    with dataset.open_dataset(file) as data, Bar("frames", hidden=quiet) as bar:
        figure.movie(data, targets, frames=frames, seconds=seconds, progress=bar)
    print("saved " + ", ".join(map(str, targets)))


@app.command()
def export(
    file: FILE,
    out: Annotated[Path | None, typer.Option(help="Folder to write; by default FILE without suffix.")] = None,
    force: FORCE = False,
) -> None:
    """Export every saved field to VTK files of the cylinder's surface, for ParaView."""
    from . import dataset

    folder = out or file.with_suffix("")
    with dataset.open_dataset(file) as data:
        collection = dataset.export_vtk(data, folder, force)
    print(f"saved {collection}")


_TIMES = Definition("times", "t", "times", None, "numbers", 0.0, 1e9)


def _version(show: bool) -> None:
    if show:
        print(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; every failure is one sentence and an exit code, never a traceback."""
    try:
        app()
    except InputError as error:
        _fail(str(error), 2)
    except KeyboardInterrupt:
        _fail("stopped before anything was computed.", 130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except MemoryError:
        _fail("this machine's memory is too small for that; use fewer grid points.", 1)
    except Exception as error:
        if os.environ.get("CYCLOSIS_TRACEBACK"):
            raise
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        _fail(f"unexpected error, please report it ({reason}); CYCLOSIS_TRACEBACK=1 shows where.", 1)


def _fail(sentence: str, code: int) -> None:
    print(f"cyclosis: {sentence}", file=sys.stderr)
    sys.exit(code)
