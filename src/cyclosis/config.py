"""A run described in a file: `run.toml` and the command line's options, checked and made ready."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .model.definitions import INITIAL, STEPPERS, TABLES, Definition
from .model.errors import InputError, closest

if TYPE_CHECKING:
    from .dynamics.protocol import Protocol
    from .dynamics.schedule import Schedule
    from .dynamics.settings import Settings
    from .model.grid import Array, CylinderGrid
    from .model.parameters import Parameters

Tables = dict[str, dict[str, Any]]

_NOISE = ("seed", "filaments_per_square", "noise_grid")
USED_BY = {
    "disordered": _NOISE,
    "unidirectional": ("magnitude", *_NOISE),
    "circumferential": ("magnitude", *_NOISE),
    "stripes": ("magnitude", "stripes", *_NOISE),
    "file": ("path", "frame", *_NOISE),
}
"""The keys of [initial] that each kind of initial state uses."""


@dataclass(frozen=True)
class Setup:
    """A run made ready: the arguments of `simulate`."""

    params: Parameters
    grid: CylinderGrid
    state: Array
    settings: Settings
    terms: tuple[str, ...] | None
    initial: dict[str, Any]
    schedule: Schedule

    @property
    def protocol(self) -> Protocol:
        """What is done on the way."""
        return self.schedule.protocol


def read(path: str | Path) -> tuple[Tables, list[Any]]:
    """Return the checked tables of a configuration file, and the steps under [[protocol]] as they stand.

    Raises `InputError` for any mistake in the tables; those in the steps are found by `setup`.
    """
    found = load(path)
    steps = found.pop("protocol", [])
    return check(found), steps


def read_protocol(path: str | Path) -> list[Any]:
    """Return the steps of a file that holds nothing but [[protocol]], as they stand.

    Raises `InputError` for a file without them, or with something else.
    """
    found = load(path)
    for name in found:
        if name != "protocol":
            raise InputError(
                "table", name, "[[protocol]] and nothing else", "put it into the file of --config"
            )
    if not found:
        raise InputError("protocol", str(path), "a file with [[protocol]] tables", "write one for each step")
    steps: list[Any] = found["protocol"]
    return steps


def load(path: str | Path) -> dict[str, Any]:
    """Return what stands in a TOML file, unchecked. Raises `InputError` for a file that is none."""
    try:
        with open(path, "rb") as file:
            return tomllib.load(file)
    except tomllib.TOMLDecodeError as error:
        raise InputError("config", str(path), "valid TOML", f"mend this: {error}") from error
    except UnicodeDecodeError as error:
        raise InputError("config", str(path), "a text file in UTF-8", "choose a TOML file") from error
    except RecursionError as error:
        raise InputError("config", str(path), "nested at most a few levels", "flatten its values") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            "config", str(path), "a file that can be read", f"check the path ({reason})"
        ) from error


def check(tables: Mapping[str, Any], known: Mapping[str, Iterable[Definition]] = TABLES) -> Tables:
    """Return the tables, defined by `known`, with every value checked; what is not given stays away."""
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


def merged(base: Tables, changes: Tables) -> Tables:
    """Return `base` with the values of `changes` taking precedence."""
    return {name: base.get(name, {}) | changes.get(name, {}) for name in TABLES}


def setup(tables: Tables, steps: Any = ()) -> Setup:
    """Return what checked tables and the steps of a protocol describe.

    The seed of [initial] is also that of the protocol. Raises `InputError` for values that contradict each
    other, and for any mistake in the steps.
    """
    from .dynamics.protocol import Protocol
    from .dynamics.schedule import Schedule
    from .dynamics.settings import Settings
    from .model.grid import CylinderGrid
    from .model.parameters import Parameters

    run = dict(tables["run"])
    _refuse_idle(run)
    terms = run.pop("terms", None)
    grid = CylinderGrid(**tables["grid"])
    params = Parameters(**tables["parameters"])
    given = tables["initial"]
    initial = {"kind": INITIAL[0].default} | given
    protocol = Protocol.from_tables(steps, given.get("seed", 0))
    schedule = Schedule(params, grid, protocol)
    if protocol.random and "filaments_per_square" not in given and initial["kind"] != "disordered":
        given = {key: value for key, value in given.items() if key != "seed"}  # used by the protocol alone
    return Setup(params, grid, initial_state(given, grid), Settings(**run), terms, initial, schedule)


def check_initial(given: Mapping[str, Any]) -> None:
    """Raise `InputError` for an [initial] table with a value that its kind does not use, or needs."""
    kind = given.get("kind", INITIAL[0].default)
    for key, value in given.items():
        if key != "kind" and key not in USED_BY[kind]:
            users = ", ".join(k for k, keys in USED_BY.items() if key in keys)
            raise InputError(
                key, value, f"used only where initial kind is {users}", f"remove it, or change kind = {kind}"
            )
    if kind == "file" and given.get("path") is None:
        raise InputError("path", None, "given where initial kind is file", "name the file")
    noise = [key for key in _NOISE if given.get(key) is not None]
    if kind != "disordered" and noise and given.get("filaments_per_square") is None:
        rule = f"given with filaments_per_square for kind = {kind}"
        raise InputError(noise[0], given[noise[0]], rule, "add it, for noise")


def initial_state(given: Mapping[str, Any], grid: CylinderGrid) -> Array:
    """Return the state that an [initial] table describes."""
    from .model import initial

    check_initial(given)
    kind = given.get("kind", INITIAL[0].default)
    noise = {key: given[key] for key in _NOISE if key in given}
    if kind == "disordered":
        return initial.disordered(grid, **noise)
    if kind == "file":
        state = initial.from_file(given["path"], grid, given.get("frame", -1))
    else:
        magnitude = {key: given[key] for key in ("magnitude",) if key in given}
        if kind == "stripes":
            state = initial.stripes(grid, given.get("stripes", 2), **magnitude)
        else:
            state = getattr(initial, kind)(grid, **magnitude)
    if "filaments_per_square" in noise:
        return initial.with_noise(state, grid, **noise)
    return state


def _refuse_idle(run: Mapping[str, Any]) -> None:
    """Refuse settings that would do nothing."""
    fixed = run.get("stepper", "adaptive") != "adaptive"
    for key, idle, rule in (
        ("rtol", fixed, "used with stepper = adaptive"),
        ("atol", fixed, "used with stepper = adaptive"),
        ("dt", not fixed, "used with a stepper of fixed steps, " + " or ".join(STEPPERS[1:])),
        ("save_every", run.get("save_at") is not None, "used without save_at"),
    ):
        if idle and run.get(key) is not None:
            raise InputError(key, run[key], rule, "remove one of the two")


def _checked(item: Definition, value: Any) -> Any:
    if item.field and isinstance(value, list):
        return value  # `Parameters` checks fields
    return item.check(value)
