"""Initial states of the kinetic model as the [initial] table of a configuration describes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...model import initial
from ...model.grid import CylinderGrid, interpolate
from ...model.starts import NOISE, check_initial, initial_state
from ...model.swept_starts import require_file
from .angular import Moments, disordered, dressed, with_noise


def kinetic_state(modes: int, given: Mapping[str, Any], grid: CylinderGrid) -> Moments:
    """Return the moments up to `modes` that an [initial] table describes.

    Order vectors of the polar model's kinds, and of its files, are dressed with von Mises distributions; a
    file of a kinetic run gives its moments. Noise is that of `disordered`.
    """
    check_initial(given)
    noise = {key: given[key] for key in NOISE if key in given}
    kind = given.get("kind", "disordered")
    if kind == "disordered":
        return disordered(grid, **noise, modes=modes)
    plain = {key: value for key, value in given.items() if key not in NOISE}
    state = _stored(given, grid, modes) if kind == "file" else None
    if state is None:
        state = dressed(initial_state(plain, grid), modes)
    return with_noise(state, grid, **noise) if "filaments_per_square" in noise else state


def seeded(modes: int, given: Mapping[str, Any], seed: int, grid: CylinderGrid) -> Moments:
    """Return the moments that an [initial] table of a sweep describes, with the noise of a seed."""
    own = dict(given)
    if "sha256" in own:
        require_file(own["path"], own.pop("sha256"))
    noisy = own.get("kind") == "disordered" or "filaments_per_square" in own
    return kinetic_state(modes, own | ({"seed": seed} if noisy else {}), grid)


def _stored(given: Mapping[str, Any], grid: CylinderGrid, modes: int) -> Moments | None:
    """Return the moments in a file on a grid, or None if it has none; modes that it lacks are 0."""
    how = {key: given[key] for key in ("frame", "stretch") if key in given}
    initial.from_file(given["path"], grid, **how)  # refuses what is not a state of this cell
    if str(given["path"]).endswith(".npy"):
        return None
    import h5py

    with h5py.File(given["path"], "r") as file:
        if "moments" not in file:
            return None
        real, imaginary = file["moments"][given.get("frame", -1) % len(file["moments"])]
    out = np.zeros((modes + 1, *grid.shape), dtype=np.complex128)
    for n, parts in enumerate(zip(real, imaginary, strict=True)):
        if n <= modes:
            fitted = interpolate(np.stack(parts), grid.shape)
            out[n] = fitted[0] + 1j * fitted[1]
    out[0] = out[0].real
    return out
