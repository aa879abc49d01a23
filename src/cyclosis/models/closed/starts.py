"""Initial states on a closed surface as the [initial] table of a configuration describes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...closed import initial
from ...closed.grid import Array, ClosedGrid
from ...model.definitions import INITIAL
from ...model.errors import InputError
from ...model.starts import check_initial
from .stored_states import from_file

NOISE = ("seed", "filaments_per_square")


def closed_state(given: Mapping[str, Any], grid: ClosedGrid) -> Array:
    """Return the state that an [initial] table describes.

    `stripes` is a rotation about an axis perpendicular to the cell, `unidirectional` runs from the south pole
    to the north, `circumferential` around the axis, and `file` is a run on the same surface, or a .npy
    file of a state on this grid.
    """
    check_initial(given)
    kind = given.get("kind", INITIAL[0].default)
    if given.get("noise_grid") is not None:
        rule = "left out on a closed surface, where noise is drawn in surface harmonics"
        raise InputError("noise_grid", given["noise_grid"], rule, "remove it")
    noise = {key: given[key] for key in NOISE if given.get(key) is not None}
    if kind == "disordered":
        return initial.disordered(grid, **noise)
    if kind == "file":
        if given.get("stretch"):
            rule = "false on a closed surface, whose shape is that of the file"
            raise InputError("stretch", True, rule, "leave it out")
        state = from_file(str(given["path"]), grid, given.get("frame", -1))
    else:
        magnitude = {key: given[key] for key in ("magnitude",) if key in given}
        if kind == "stripes" and given.get("stripes", 2) != 2:
            raise InputError("stripes", given["stripes"], "2 on a closed surface", "leave it out")
        make = {
            "stripes": initial.rotation,
            "unidirectional": initial.source_to_sink,
            "circumferential": initial.swirl,
        }
        state = make[kind](grid, **magnitude)
    if "filaments_per_square" in noise:
        return initial.with_noise(state, grid, **noise)
    return state


def filled(given: Mapping[str, Any], ends: Any) -> dict[str, Any]:
    """Return the [initial] table of a sweep with defaults filled in, without what is swept."""
    from ...model import swept_starts

    out = swept_starts.filled(given, ends)
    out.pop("noise_grid", None)
    return out


def seeded(given: Mapping[str, Any], seed: int, grid: ClosedGrid) -> Array:
    """Return the initial state of a seed of a sweep."""
    named = {key: value for key, value in given.items() if key != "sha256"}
    if named.get("kind") == "disordered" or "filaments_per_square" in named:
        named["seed"] = seed
    return closed_state(named, grid)


def refuse_impossible(given: Any, ends: Any, seeds: int, grids: Any, files: bool) -> None:
    """Leave it to each member to refuse its own state: |P| > 1 depends on the surface."""
