"""The command line: it parses, calls and prints, and does nothing else."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Annotated

import typer

from ..display.progress import leave_to_the_command
from ..model.errors import InputError
from ..model.forks import ForkedError
from ..version import __version__
from . import runs, terminal
from .compared import compare
from .experiments import experiment
from .explorer import explore
from .figures import figures
from .fitting import fit
from .measured import measure
from .observe import observe
from .options import command, commands
from .sweeps import sweeps
from .theory import theory
from .usage import USAGE_ERROR, asks_for_help, sentence
from .vacuole import vacuole

app = commands(
    "How cytoplasmic streaming organises itself: the model of Woodhouse & Goldstein (2013).",
    "cyclosis",
    "Exit codes: 0, done; 1, a run or a sweep did not complete, or something is damaged, and the output "
    "says how; 2, the input cannot be used; 130, interrupted.",
)
runs.register(app)
app.add_typer(figures, name="figure")
app.add_typer(sweeps, name="sweep")
app.add_typer(theory, name="stability")
command(app, "experiment list", "experiment recovery --quick")(experiment)
command(
    app,
    "measure field.txt --y down --speed px/s",
    "measure f.vec --radius-um 500 --axis 17 --centre 30,225 -o cell.nc",
    "measure film.avi --frame-s 0.3 --radius-px 99 --axis 17 -o c.png",
)(measure)
command(app, "compare cell.nc run.nc --out compared.png")(compare)
command(app, "explore")(explore)
command(
    app,
    "fit cell.nc",
    "fit cell.nc --parameters alpha_p,kappa --fix mu=0.05 -o fit.png",
    "fit cell.nc --geometry axis_deg=0.5 --method equation",
)(fit)
command(
    app,
    "vacuole run.nc",
    "vacuole run.nc --time 20 --section 2.5 --out inside --volume",
    "vacuole run.nc --uptake --dispersion --poincare --dye 50 --gif",
)(vacuole)
command(
    app,
    "observe run.nc --as piv --axis 17 --times 6,40 --format pivlab",
    "observe run.nc --as film --depth-um 120 --format mp4 --out film",
    "observe run.nc --as kymograph --at 20 --frames 200 --mirrored",
)(observe)


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
    terminal.settle()
    leave_to_the_command()
    try:
        code = app(prog_name="cyclosis", standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()  # here, where a failure can still be reported
    except BrokenPipeError:
        _silence()
        sys.exit(1)
    except InputError as error:
        _fail(error.at_terminal, 2)
    except ForkedError as error:
        _fail(str(error), 1)
    except USAGE_ERROR as error:
        if asks_for_help(error):
            print(error.format_message(), file=sys.stderr)
            sys.exit(2)
        _fail(sentence(error), 2)
    except typer.Abort:
        _fail("stopped.", 130)
    except MemoryError:
        _fail("this machine does not have enough memory; use fewer grid points.", 1)
    except Exception as error:
        if os.environ.get("CYCLOSIS_TRACEBACK"):
            raise
        if isinstance(error, OSError) and _is_full(error):
            _silence()
            _fail(f"the output cannot be written ({error.strerror}); free some space and try again.", 1)
        refused = _refused_by_jax(error)
        if refused is not None:
            _fail(str(refused), 2)
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        _fail(f"unexpected error, please report it ({reason}); CYCLOSIS_TRACEBACK=1 shows where.", 1)
    sys.exit(code if isinstance(code, int) else 0)


def _is_full(error: OSError) -> bool:
    from ..dataset.whole import FULL

    return error.errno in FULL


def _silence() -> None:
    """Drop output that cannot be written, so that the interpreter does not try again as it ends."""
    with suppress(OSError, ValueError, AttributeError):  # there may be no output, or no file number
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _refused_by_jax(error: Exception) -> InputError | None:
    """Return the error for an environment variable that JAX does not accept, if that is the cause."""
    said = " ".join(str(error).split())
    for name in os.environ:
        if name.startswith(("JAX_", "XLA_")) and name in said:
            return InputError(name, os.environ[name], "a value that JAX accepts", f"unset it ({said[:120]})")
    return None


def _fail(sentence: str, code: int) -> None:
    print(f"cyclosis: {sentence}", file=sys.stderr)
    sys.exit(code)
