"""A run described in a file: `run.toml` and the command line's options, checked and made ready."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .model.definitions import INITIAL, TABLES, Definition
from .model.errors import InputError

if TYPE_CHECKING:
    from .dynamics.settings import Settings
    from .model.grid import Array, CylinderGrid
    from .model.parameters import Parameters

Tables = dict[str, dict[str, Any]]

_NOISE = ("seed", "filaments_per_square", "noise_grid")
_USED_BY = {
    "disordered": _NOISE,
    "unidirectional": ("magnitude", *_NOISE),
    "circumferential": ("magnitude", *_NOISE),
    "stripes": ("magnitude", "stripes", *_NOISE),
    "file": ("path", "frame", *_NOISE),
}


@dataclass(frozen=True)
class Setup:
    """A run made ready: the arguments of `simulate`."""

    params: Parameters
    grid: CylinderGrid
    state: Array
    settings: Settings
    terms: tuple[str, ...] | None
    initial: dict[str, Any]


def read(path: str | Path) -> Tables:
    """Return the checked tables of a configuration file. Raises `InputError` for any mistake in it."""
    try:
        with open(path, "rb") as file:
            return check(tomllib.load(file))
    except tomllib.TOMLDecodeError as error:
        raise InputError("config", str(path), "valid TOML", f"mend this: {error}") from error
    except UnicodeDecodeError as error:
        raise InputError("config", str(path), "a text file in UTF-8", "choose a TOML file") from error
    except RecursionError as error:
        raise InputError("config", str(path), "nested at most a few levels", "flatten its values") from error
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            "config", str(path), "a file that can be read", f"check the path ({reason})"
        ) from error


def check(tables: Mapping[str, Any]) -> Tables:
    """Return the tables with every value checked; what is not given stays away."""
    out: Tables = {name: {} for name in TABLES}
    for name, table in tables.items():
        if name not in TABLES:
            raise InputError(
                "table", name, "one of " + ", ".join(f"[{t}]" for t in TABLES), _closest(name, TABLES)
            )
        if not isinstance(table, Mapping):
            raise InputError(name, table, "a table", f"write [{name}] on a line of its own")
        known = {item.name: item for item in TABLES[name]}
        for key, value in table.items():
            if key not in known:
                rule = f"a key of [{name}]: " + ", ".join(known)
                raise InputError(f"{name} key", key, rule, _closest(key, known))
            out[name][key] = _checked(known[key], value)
    return out


def merged(base: Tables, changes: Tables) -> Tables:
    """Return `base` with the values of `changes` taking precedence."""
    return {name: base.get(name, {}) | changes.get(name, {}) for name in TABLES}


def setup(tables: Tables) -> Setup:
    """Return what checked tables describe. Raises `InputError` for values that contradict each other."""
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
    return Setup(params, grid, initial_state(given, grid), Settings(**run), terms, initial)


def initial_state(given: Mapping[str, Any], grid: CylinderGrid) -> Array:
    """Return the state that an [initial] table describes."""
    from .model import initial

    kind = given.get("kind", INITIAL[0].default)
    for key, value in given.items():
        if key != "kind" and key not in _USED_BY[kind]:
            users = ", ".join(k for k, keys in _USED_BY.items() if key in keys)
            raise InputError(
                key, value, f"used only where initial kind is {users}", f"remove it, or change kind = {kind}"
            )
    noise = {key: given[key] for key in _NOISE if key in given}
    if kind == "disordered":
        return initial.disordered(grid, **noise)
    if kind == "file":
        if "path" not in given:
            raise InputError("path", None, "given where initial kind is file", "name the file")
        state = initial.from_file(given["path"], grid, given.get("frame", -1))
    else:
        magnitude = {key: given[key] for key in ("magnitude",) if key in given}
        if kind == "stripes":
            state = initial.stripes(grid, given.get("stripes", 2), **magnitude)
        else:
            state = getattr(initial, kind)(grid, **magnitude)
    if "filaments_per_square" in noise:
        return initial.with_noise(state, grid, **noise)
    if noise:
        key = next(iter(noise))
        raise InputError(
            key, noise[key], f"given with filaments_per_square for kind = {kind}", "add it, for noise"
        )
    return state


def _refuse_idle(run: Mapping[str, Any]) -> None:
    """Refuse settings that would do nothing."""
    fixed = run.get("stepper", "adaptive") != "adaptive"
    for key, idle, rule in (
        ("rtol", fixed, "used with stepper = adaptive"),
        ("atol", fixed, "used with stepper = adaptive"),
        ("dt", not fixed, "used with stepper = etdrk4 or rk4"),
        ("save_every", run.get("save_at") is not None, "used without save_at"),
    ):
        if idle and run.get(key) is not None:
            raise InputError(key, run[key], rule, "remove one of the two")


def _checked(item: Definition, value: Any) -> Any:
    if item.field and isinstance(value, list):
        return value  # `Parameters` checks fields
    return item.check(value)


def _closest(name: str, known: Any) -> str:
    match = difflib.get_close_matches(str(name), list(known), 1)
    return f"did you mean {match[0]}?".rstrip("?") if match else "check the spelling"
