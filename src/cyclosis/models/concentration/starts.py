"""Initial states with a concentration as the [initial] table of a configuration describes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...contract.members import Starts
from ...model import bumps
from ...model.definitions import definition
from ...model.errors import InputError
from ...model.grid import Array, CylinderGrid, interpolate
from ...model.starts import BUMP


def starts_of(polar: Starts) -> Starts:
    """Return the starts of P of the polar model with the concentration of the same table."""

    def make(given: Mapping[str, Any], grid: CylinderGrid) -> Array:
        rest, bump = _apart(given)
        return bumps.with_concentration(polar.make(rest, grid), _concentration(given, bump, grid))

    def seeded(given: Mapping[str, Any], seed: int, grid: CylinderGrid) -> Array:
        rest, bump = _apart(given)
        return bumps.with_concentration(polar.seeded(rest, seed, grid), _concentration(given, bump, grid))

    def filled(given: Mapping[str, Any], ends: Any) -> dict[str, Any]:
        rest, bump = _apart(given)
        return polar.filled(rest, ends) | bump

    def refuse(given: dict[str, Any], ends: Any, seeds: int, grids: Sequence[Any], files: bool) -> None:
        rest, bump = _apart(given)
        polar.refuse_impossible(rest, ends, seeds, grids, files)
        given.update(rest)  # with the path and the checksum of a file
        for grid in grids:
            _concentration(given, bump, grid)

    return Starts(
        make=make,
        filled=filled,
        noisy=lambda given, ends: polar.noisy(_apart(given)[0], ends),
        refuse_impossible=refuse,
        seeded=seeded,
    )


def _apart(given: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the keys of an [initial] table that describe P, and those that describe the concentration."""
    bump = {key: value for key, value in given.items() if key in BUMP and value is not None}
    for key, value in bump.items():
        if "bump" not in bump:
            raise InputError(key, value, "used only with bump, the height of one", "add it, or remove this")
    return {key: value for key, value in given.items() if key not in BUMP}, bump


def _concentration(given: Mapping[str, Any], bump: dict[str, Any], grid: CylinderGrid) -> Array:
    """Return the concentration that a table describes: a bump, that of a file, or 1."""
    if bump:
        how = {key.removeprefix("bump_"): value for key, value in bump.items() if key != "bump"}
        return bumps.bump(grid, bump["bump"], **how)
    found = _stored(given) if given.get("kind") == "file" else None
    return np.ones(grid.shape) if found is None else interpolate(found, grid.shape)


def _stored(given: Mapping[str, Any]) -> Array | None:
    """Return the concentration in a file of a run, or None if it has none."""
    if str(given["path"]).endswith(".npy"):
        return None
    import h5py

    frame = given.get("frame", definition("initial", "frame").default)
    with h5py.File(given["path"], "r") as file:
        for name in ("concentration", "c"):  # of this model, and of the kinetic one
            if name in file and file[name].ndim == 3:
                return np.asarray(file[name][frame % len(file[name])], dtype=np.float64)
    return None
