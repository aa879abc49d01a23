"""The results of an experiment's single members, each in a file that appears whole and contains its checksum.

The name of a file is a digest of everything that determines the result: the function, its arguments, and the
sources and versions of what computes. After any change of these the member is computed again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any

import jax
import numpy as np
import scipy
import xarray

from ..model.errors import InputError
from ..sweep.store.safe_files import write
from ..version import __version__

NEVER_COMPUTE = ("cli", "explorer", "report", "figures", "display")
"""Parts of the package whose sources do not affect results."""
_SUFFIX = ".member"


class Unstorable(TypeError):
    """A value that has no exact description, or that a file of arrays cannot hold."""


def member(folder: str, function: Callable[..., Any], *item: Any) -> Any:
    """Return function(*item): from its file in a folder, or computed, and then stored there.

    What cannot be described or stored exactly is computed each time. A damaged file counts as missing.
    """
    try:
        target = Path(folder) / f"{digest(function, item)}{_SUFFIX}"
    except Unstorable:
        return function(*item)
    found = _read(target)
    if found is None:
        value = function(*item)
        with suppress(Unstorable):
            write(target, _sealed(value))
        return value
    return found[0]


def digest(function: Callable[..., Any], item: Any) -> str:
    """Return the SHA-256 of everything that determines function(*item). Raises `Unstorable` if unknown."""
    return of_content([f"{function.__module__}.{function.__qualname__}", described(item)])


def of_content(content: Any) -> str:
    """Return the SHA-256 of plain content together with the definition of what computes."""
    text = json.dumps([definition(), content], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def definition() -> str:
    """Return the SHA-256 of the sources and the versions that results depend on."""
    root = Path(__file__).parents[1]
    found = hashlib.sha256()
    for version in (__version__, jax.__version__, np.__version__, scipy.__version__):
        found.update(version.encode() + b"\n")
    for path in sorted(root.rglob("*.py")):
        own = path.relative_to(root)
        if own.parts[0] not in NEVER_COMPUTE:
            found.update(own.as_posix().encode() + b"\n" + path.read_bytes())
    return found.hexdigest()


def described(value: Any) -> Any:
    """Return an exact description of a value as plain content. Raises `Unstorable` for an unknown kind."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float | np.generic):
        return repr(value)
    if isinstance(value, np.ndarray) and value.dtype != object:
        data = np.ascontiguousarray(value)
        return ["array", value.dtype.str, list(value.shape), hashlib.sha256(data.tobytes()).hexdigest()]
    if isinstance(value, Mapping):
        return ["mapping", [[described(key), described(one)] for key, one in value.items()]]
    if isinstance(value, tuple | list):
        return [type(value).__name__, *map(described, value)]
    if hasattr(value, "items") and callable(value.items):  # Parameters
        return [type(value).__qualname__, described(dict(value.items()))]
    raise Unstorable(f"a {type(value).__name__}")


def _sealed(value: Any) -> bytes:
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    layout = json.dumps(_plain(value, arrays))
    buffer = BytesIO()
    np.savez(buffer, layout=np.array(layout), **arrays)  # type: ignore[arg-type]
    data = buffer.getvalue()
    return hashlib.sha256(data).hexdigest().encode() + b"\n" + data


def _read(path: Path) -> tuple[Any] | None:
    """Return the value in a file; None if it is missing or damaged."""
    try:
        seal, _, data = path.read_bytes().partition(b"\n")
    except OSError:
        return None
    if hashlib.sha256(data).hexdigest().encode() != seal:
        return None
    with np.load(BytesIO(data), allow_pickle=False) as arrays:
        return (_value(json.loads(str(arrays["layout"])), arrays),)


def _plain(value: Any, arrays: dict[str, Any]) -> Any:
    """Return a value as plain content, with its arrays and numbers put into `arrays`."""
    if value is None or isinstance(value, bool | str):
        return {"plain": value}
    if isinstance(value, xarray.Dataset):
        parts = [
            {name: (tuple(one.dims), np.asarray(one.values), dict(one.attrs)) for name, one in group.items()}
            for group in (value.data_vars, value.coords)
        ]
        return {"dataset": [_plain(part, arrays) for part in (*parts, dict(value.attrs))]}
    if isinstance(value, Mapping):
        return {"mapping": [[str(key), _plain(one, arrays)] for key, one in value.items()]}
    if isinstance(value, tuple | list):
        kind = type(value)
        named = None if kind in (tuple, list) else f"{kind.__module__}:{kind.__qualname__}"
        items = [_plain(one, arrays) for one in value]
        return {"list" if kind is list else "tuple": items, "kind": named}
    array = np.asarray(value)
    if array.dtype == object:
        if not all(isinstance(one, str) for one in array.ravel()):
            raise Unstorable(f"a {type(value).__name__}")
        array = array.astype(str)
    name = f"a{len(arrays)}"
    arrays[name] = array
    scalar = {int: "int", float: "float"}.get(type(value))
    return {"array": name, "scalar": scalar or ("numpy" if isinstance(value, np.generic) else None)}


def _value(content: Any, arrays: Any) -> Any:
    if "plain" in content:
        return content["plain"]
    if "dataset" in content:
        variables, coordinates, attributes = (_value(part, arrays) for part in content["dataset"])
        return xarray.Dataset(variables, coordinates, attributes)
    if "mapping" in content:
        return {key: _value(one, arrays) for key, one in content["mapping"]}
    if "list" in content:
        return [_value(one, arrays) for one in content["list"]]
    if "tuple" in content:
        items = [_value(one, arrays) for one in content["tuple"]]
        return tuple(items) if content["kind"] is None else _named(content["kind"], items)
    array = arrays[content["array"]]
    scalar = content["scalar"]
    return array if scalar is None else array.item() if scalar in ("int", "float") else array[()]


def _named(kind: str, items: list[Any]) -> Any:
    """Return a named tuple of this package with these items."""
    module, _, name = kind.partition(":")
    if module.partition(".")[0] != __name__.partition(".")[0]:
        raise InputError("stored member", kind, "a tuple of this package", "use --fresh")
    return getattr(import_module(module), name)(*items)
