"""Initial states of a sweep: complete their table, refuse it where |P| > 1 is likely, make one for a seed."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from . import initial
from .definitions import definition
from .errors import InputError
from .grid import Array, CylinderGrid
from .starts import USED_BY, check_initial, initial_state

Ends = Mapping[str, tuple[float, float]]
"""The least and the greatest value of each setting of the initial state that is swept, by name."""

ALMOST_NEVER = 0.01
"""Expected number of points with |P| > 1 among the initial states of a sweep that is accepted."""


def filled(given: Mapping[str, Any], ends: Ends) -> dict[str, Any]:
    """Return the [initial] table of a sweep with defaults filled in, without what is swept.

    Raises `InputError` for a value that its kind does not use, or if one that it needs is missing.
    """
    given = {key: value for key, value in given.items() if value is not None}
    here = {key: first for key, (first, _) in ends.items()}
    kind = given.get("kind", definition("initial", "kind").default)
    if "sha256" in given and kind != "file":
        rule = "given only where initial kind is file"
        raise InputError("sha256", given["sha256"], rule, f"remove it, or change kind = {kind}")
    check_initial({key: value for key, value in (given | here).items() if key != "sha256"})
    out = {"kind": kind}
    for key in USED_BY[kind]:
        usual = None if key == "seed" else definition("initial", key).default
        if key == "filaments_per_square" and kind != "disordered":
            usual = None  # without it an ordered state has no noise
        if key not in ends and given.get(key, usual) is not None:
            out[key] = given.get(key, usual)
    if not out.get("stretch"):
        out.pop("stretch", None)
    if "noise_grid" in out:
        out["noise_grid"] = list(out["noise_grid"])
    return out | ({"sha256": given["sha256"]} if "sha256" in given else {})


def noisy(given: Mapping[str, Any], ends: Ends) -> bool:
    """Return whether the initial states of an [initial] table differ from seed to seed."""
    return "filaments_per_square" in {**given, **ends}


def refuse_impossible(
    given: dict[str, Any], ends: Ends, seeds: int, grids: Sequence[CylinderGrid], files: bool
) -> None:
    """Refuse noise that would make |P| > 1 somewhere: P is a mean of unit vectors.

    With |P| = M before noise of variance 1/(2N) a component, a point exceeds 1 with a probability of at most
    exp(-N (1 - M)²), which is exact for M = 0. `grids` are those at the ends of what is swept. The path and
    the checksum of a file are filled in if `files` may be read.
    """
    if given["kind"] != "file":
        magnitude = _magnitude(given, ends, grids[0])
    elif files:
        magnitude = _read_file(given, grids)
    else:
        return
    if not noisy(given, ends):
        return
    N, grid = _range(given, ends, "filaments_per_square")[0], grids[0]
    points = seeds * grid.n_theta * grid.n_z
    room = max(1.0 - magnitude, 0.0) ** 2 * _share_kept(given, grid)
    if points * math.exp(-N * room) > ALMOST_NEVER:
        needed = math.log(points / ALMOST_NEVER) / room if room > 0 else math.inf
        remedy = f"raise it to {_up(needed):g}" if needed < 1e15 else "lower the magnitude of the state"
        rule = f"large enough for |P| <= 1 at all points of all {seeds} initial states"
        raise InputError("filaments_per_square", N, rule, remedy)


def seeded(given: Mapping[str, Any], seed: int, grid: CylinderGrid) -> Array:
    """Return the initial state that an [initial] table describes, with the noise of a seed."""
    noise = {key: given[key] for key in ("filaments_per_square", "noise_grid") if key in given}
    if given["kind"] == "file":
        state = _stored(given["path"], given["sha256"], given["frame"], given.get("stretch", False), grid)
        return initial.with_noise(state, grid, seed=seed, **noise) if noise else state.copy()
    return initial_state({**given, "seed": seed} if noise else given, grid)


@lru_cache(maxsize=2)
def _stored(path: str, digest: str, frame: int, stretch: bool, grid: CylinderGrid) -> Array:
    """Return the state in a file that must have a checksum."""
    require_file(path, digest)
    return initial.from_file(path, grid, frame, stretch)


def require_file(path: str, digest: str) -> None:
    """Raise `InputError` unless a file is still the one with which a sweep was planned."""
    if file_digest(path) != digest:
        rule = f"the file with which the sweep was planned, of SHA-256 {digest}"
        raise InputError("path", path, rule, "restore it")


def file_digest(path: str) -> str:
    """Return the SHA-256 of a file. Raises `InputError` if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError("path", path, "a file that can be read", f"check the path ({reason})") from error


def _read_file(given: dict[str, Any], grids: Sequence[CylinderGrid]) -> float:
    """Fill in the path and the checksum of the file of the initial state; return the largest |P| in it."""
    given["path"] = os.path.abspath(given["path"])
    found = file_digest(given["path"])
    if given.setdefault("sha256", found) != found:
        rule = f"that of {given['path']}, {found}"
        raise InputError("sha256", given["sha256"], rule, "restore that file, or leave sha256 out")
    largest = 0.0
    for there in grids:
        state = initial.from_file(given["path"], there, given["frame"], given.get("stretch", False))
        largest = float(np.sqrt(np.max(np.sum(state**2, axis=0))))  # the same at every length
    return largest


def _magnitude(given: Mapping[str, Any], ends: Ends, grid: CylinderGrid) -> float:
    """Check that the initial states can be made, and return their largest |P| without noise."""
    if given["kind"] == "disordered":
        return 0.0
    magnitude = _range(given, ends, "magnitude")[1]
    if given["kind"] == "stripes":
        initial.stripes(grid.resized(grid.n_theta, 8), given["stripes"], magnitude)
    return magnitude


def _share_kept(given: Mapping[str, Any], grid: CylinderGrid) -> float:
    """Return the factor by which N grows in effect if the grid resolves less than the grid of the noise."""
    drawn = given.get("noise_grid")
    if drawn is None or tuple(drawn) == grid.shape:
        return 1.0
    kept = math.prod(2 * ((min(a, b) - 1) // 2) + 1 for a, b in zip(drawn, grid.shape, strict=True))
    return math.prod(drawn) / kept


def _range(given: Mapping[str, Any], ends: Ends, name: str) -> tuple[float, float]:
    """Return the least and the greatest value that a setting of the initial state takes."""
    return ends[name] if name in ends else (given[name], given[name])


def _up(value: float) -> float:
    """Return a number rounded up to two digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / digit) * digit
