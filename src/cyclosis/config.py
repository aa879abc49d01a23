"""A run described in a file: `run.toml` and the command line's options, checked and prepared."""

from __future__ import annotations

import gc
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .model.definitions import ADAPTIVE, INITIAL, STEPPERS, TABLES, Definition
from .model.errors import InputError, closest
from .model.starts import USED_BY as USED_BY
from .model.starts import check_initial as check_initial
from .model.starts import initial_state as initial_state
from .model.units import of_table

if TYPE_CHECKING:
    from .contract.model import Array, Model
    from .dynamics.protocol import Protocol
    from .dynamics.schedule import Schedule
    from .dynamics.settings import Settings
    from .model.scales import Scales

Tables = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Setup:
    """A prepared run: the arguments of `simulate`."""

    params: Any
    grid: Any
    state: Array
    settings: Settings
    terms: tuple[str, ...] | None
    initial: dict[str, Any]
    schedule: Schedule
    model: Model
    scales: Scales | None = None

    @property
    def protocol(self) -> Protocol:
        """What is done during the run."""
        return self.schedule.protocol


def read(path: str | Path) -> tuple[Tables, list[Any]]:
    """Return the checked tables of a configuration file, and the steps under [[protocol]] unchecked.

    Raises `InputError` for any mistake in the tables; those in the steps are found by `setup`.
    """
    found = load(path)
    steps = found.pop("protocol", [])
    return check(found), steps


def read_protocol(path: str | Path) -> list[Any]:
    """Return the steps of a file that contains only [[protocol]], unchecked.

    Raises `InputError` for a file without them, or with something else.
    """
    found = load(path)
    for name in found:
        if name != "protocol":
            raise InputError("table", name, "only [[protocol]]", "put it into the file of --config")
    if not found:
        raise InputError("protocol", str(path), "a file with [[protocol]] tables", "write one for each step")
    steps: list[Any] = found["protocol"]
    return steps


def load(path: str | Path) -> dict[str, Any]:
    """Return the contents of a TOML file, or of standard input for "-", unchecked.

    Raises `InputError` if it is not TOML.
    """
    try:
        with _opened(path) as file, _uncollected():
            return tomllib.load(file)
    except tomllib.TOMLDecodeError as error:
        raise InputError("config", str(path), "valid TOML", f"correct this: {error}") from error
    except UnicodeDecodeError as error:
        raise InputError("config", str(path), "a text file in UTF-8", "choose a TOML file") from error
    except RecursionError as error:
        raise InputError("config", str(path), "nested at most a few levels", "flatten its values") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            "config", str(path), "a file that can be read", f"check the path ({reason})"
        ) from error


def _opened(path: str | Path) -> AbstractContextManager[Any]:
    if str(path) != "-":
        return open(path, "rb")
    if sys.stdin is None:
        raise InputError("config", "-", "a file where there is no standard input", "name a file")
    return nullcontext(sys.stdin.buffer)


@contextmanager
def _uncollected() -> Iterator[None]:
    """Collect no garbage meanwhile: at the bottom of a deep recursion that fails too, and prints so."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def check(tables: Mapping[str, Any], known: Mapping[str, Iterable[Definition]] = TABLES) -> Tables:
    """Return the tables, defined by `known`, with every value checked and no defaults filled in."""
    out: Tables = {name: {} for name in known}
    for name, table in tables.items():
        if name not in known:
            rule = "one of " + ", ".join([*(f"[{t}]" for t in known), "[[protocol]]"])
            raise InputError("table", name, rule, closest(name, known))
        if not isinstance(table, Mapping):
            raise InputError(name, table, "a table", f"write [{name}] on a line of its own")
        items = {item.name: item for item in known[name]}
        for key, value in table.items():
            if key not in items:
                rule = f"a key of [{name}]: " + ", ".join(items)
                raise InputError(f"{name} key", key, rule, closest(key, items))
            out[name][key] = _checked(items[key], value)
    return out


_INSTEAD = {"save_at": "save_every", "save_every": "save_at"}
"""Keys of [run] that exclude each other: changing one removes the other."""


def merged(base: Tables, changes: Tables) -> Tables:
    """Return `base` with the values of `changes` taking precedence."""
    idle = {_INSTEAD.get(key) for key in changes.get("run", {})}
    kept = base | {"run": {key: value for key, value in base.get("run", {}).items() if key not in idle}}
    return {name: kept.get(name, {}) | changes.get(name, {}) for name in TABLES}


def setup(tables: Tables, steps: Any = ()) -> Setup:
    """Return what checked tables and the steps of a protocol describe.

    The seed of [initial] is also that of the protocol. Raises `InputError` for values that contradict each
    other, and for any mistake in the steps.
    """
    from .dynamics.protocol import Protocol
    from .dynamics.schedule import Schedule
    from .dynamics.settings import Settings
    from .models import of_tables, starts_of

    model = of_tables(tables)
    run = dict(tables["run"])
    _refuse_idle(run)
    terms = run.pop("terms", None)
    grid = model.grid_from(tables["grid"])
    params = model.parameters(**tables["parameters"])
    given = tables["initial"]
    initial = {"kind": INITIAL[0].default} | given
    protocol = Protocol.from_tables(steps, given.get("seed", 0))
    schedule = Schedule(params, grid, protocol)
    if protocol.random and "filaments_per_square" not in given and initial["kind"] != "disordered":
        given = {key: value for key, value in given.items() if key != "seed"}  # used by the protocol alone
    state = starts_of(model).make(given, grid)
    scales = of_table(tables.get("scales", {}))
    return Setup(params, grid, state, Settings(**run), terms, initial, schedule, model, scales)


def _refuse_idle(run: Mapping[str, Any]) -> None:
    """Refuse settings that would do nothing."""
    fixed = run.get("stepper", STEPPERS[0]) not in ADAPTIVE
    chosen = "used with stepper = " + " or ".join(ADAPTIVE)
    for key, idle, rule in (
        ("rtol", fixed, chosen),
        ("atol", fixed, chosen),
        ("dt", not fixed, "used with a stepper of fixed steps, " + " or ".join(STEPPERS[len(ADAPTIVE) :])),
        ("save_every", run.get("save_at") is not None, "used without save_at"),
    ):
        if idle and run.get(key) is not None:
            raise InputError(key, run[key], rule, "remove one of the two")


def _checked(item: Definition, value: Any) -> Any:
    if item.field and isinstance(value, list):
        return value  # `Parameters` checks fields
    return item.check(value)
