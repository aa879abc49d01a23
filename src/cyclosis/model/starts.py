"""Initial states as the [initial] table of a configuration describes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .definitions import INITIAL
from .errors import InputError

if TYPE_CHECKING:
    from .grid import Array, CylinderGrid

NOISE = ("seed", "filaments_per_square", "noise_grid")
"""The keys of [initial] that describe noise."""
BUMP = ("bump", "bump_theta", "bump_z", "bump_width")
"""The keys of [initial] that describe the concentration."""
USED_BY = {
    "disordered": NOISE,
    "unidirectional": ("magnitude", *NOISE),
    "circumferential": ("magnitude", *NOISE),
    "stripes": ("magnitude", "stripes", *NOISE),
    "file": ("path", "frame", "stretch", *NOISE),
}
"""The keys of [initial] that each kind of initial state uses."""


def check_initial(given: Mapping[str, Any]) -> None:
    """Raise `InputError` for an [initial] table whose keys are not those that its kind uses and needs."""
    kind = given.get("kind", INITIAL[0].default)
    for key, value in given.items():
        if key in BUMP:
            rule = "used only where [model] concentration is true"
            raise InputError(key, value, rule, "remove it, or set that")
        if key != "kind" and key not in USED_BY[kind]:
            users = ", ".join(k for k, keys in USED_BY.items() if key in keys)
            raise InputError(
                key, value, f"used only where initial kind is {users}", f"remove it, or change kind = {kind}"
            )
    if kind == "file" and given.get("path") is None:
        raise InputError("path", None, "given where initial kind is file", "name the file")
    noise = [key for key in NOISE if given.get(key) is not None]
    if kind != "disordered" and noise and given.get("filaments_per_square") is None:
        rule = f"given with filaments_per_square for kind = {kind}"
        raise InputError(noise[0], given[noise[0]], rule, "add it, for noise")


def initial_state(given: Mapping[str, Any], grid: CylinderGrid) -> Array:
    """Return the state that an [initial] table describes."""
    from . import initial

    check_initial(given)
    kind = given.get("kind", INITIAL[0].default)
    noise = {key: given[key] for key in NOISE if key in given}
    if kind == "disordered":
        return initial.disordered(grid, **noise)
    if kind == "file":
        how = {key: given[key] for key in ("frame", "stretch") if key in given}
        state = initial.from_file(given["path"], grid, **how)
    else:
        magnitude = {key: given[key] for key in ("magnitude",) if key in given}
        if kind == "stripes":
            state = initial.stripes(grid, given.get("stripes", 2), **magnitude)
        else:
            state = getattr(initial, kind)(grid, **magnitude)
    if "filaments_per_square" in noise:
        return initial.with_noise(state, grid, **noise)
    return state
