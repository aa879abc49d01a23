"""The command line: parses, calls, prints; nothing else."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from ..model.errors import InputError
from ..version import __version__
from . import runs
from .experiments import experiment
from .explorer import explore
from .figures import figures
from .options import commands
from .sweeps import sweeps
from .theory import theory

app = commands(
    "How cytoplasmic streaming organises itself: the model of Woodhouse & Goldstein (2013).", "cyclosis"
)
runs.register(app)
app.add_typer(figures, name="figure")
app.add_typer(sweeps, name="sweep")
app.add_typer(theory, name="stability")
app.command()(experiment)
app.command()(explore)


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
    """Run the command line; every failure is one sentence and an exit code, never a traceback.

    Typer itself answers options that do not exist, interruptions and closed pipes.
    """
    try:
        app()
    except InputError as error:
        _fail(str(error), 2)
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
