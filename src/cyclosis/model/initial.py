"""Initial states: arrays P of shape (2, n_theta, n_z), dimensionless."""

from __future__ import annotations

import zipfile
from typing import Any

import numpy as np
import numpy.typing as npt

from .arrays import STATE_DIMS, numbers
from .bumps import bump as bump
from .bumps import with_concentration as with_concentration
from .definitions import definition
from .doors import door
from .errors import InputError
from .grid import Array, CylinderGrid, covered, interpolate, same_length

__all__ = [
    "bump",
    "circumferential",
    "disordered",
    "fitted",
    "from_file",
    "noise",
    "standard_noise",
    "stripes",
    "unidirectional",
    "with_concentration",
    "with_noise",
]


def __dir__() -> list[str]:
    return sorted(__all__)


@door
def noise(
    grid: CylinderGrid,
    filaments_per_square: float = 1000,
    seed: int = 0,
    noise_grid: tuple[int, int] | None = None,
) -> Array:
    """Return the order vector of N randomly oriented filaments in every grid square.

    P_theta and P_z are independent and normal with mean 0 and variance 1/(2N), drawn by
    `numpy.random.default_rng(seed).normal(size=(2, n_theta, n_z))` on `noise_grid` (default: the
    grid itself) and interpolated spectrally where the two differ, so that a seed gives the same state
    on every grid. Shape (2, n_theta, n_z). Raises `InputError` for settings out of range. Source: Woodhouse &
    Goldstein 2013, Materials and Methods.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(64, 64)
        >>> float(cy.initial.noise(grid, filaments_per_square=200).var().round(4))  # 1/(2N)
        0.0025
    """
    N = definition("initial", "filaments_per_square").check(filaments_per_square)
    seed = definition("initial", "seed").check(seed)
    shape = definition("initial", "noise_grid").check(noise_grid) or grid.shape
    drawn = np.random.default_rng(seed).normal(size=(2, *shape)) * np.sqrt(0.5 / N)
    return interpolate(drawn, grid.shape)


@door
def standard_noise(
    grid: CylinderGrid, rng: np.random.Generator, noise_grid: tuple[int, int] | None = None
) -> Array:
    """Return normal numbers (2, n_theta, n_z), independent and of variance 1 on `noise_grid`; see `noise`.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> drawn = cy.initial.standard_noise(cy.CylinderGrid(64, 64), np.random.default_rng(0))
        >>> drawn.shape, float(drawn.std().round(2))
        ((2, 64, 64), 1.0)
    """
    shape = definition("initial", "noise_grid").check(noise_grid) or grid.shape
    if not isinstance(rng, np.random.Generator):
        raise InputError("rng", rng, "a numpy.random.Generator", "write numpy.random.default_rng(seed)")
    return interpolate(rng.normal(size=(2, *shape)), grid.shape)


@door
def disordered(
    grid: CylinderGrid,
    filaments_per_square: float = 1000,
    seed: int = 0,
    noise_grid: tuple[int, int] | None = None,
) -> Array:
    """Return total filament disorder: `noise` alone. Raises `InputError` where |P| > 1.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(32, 32)
        >>> state = cy.initial.disordered(grid, filaments_per_square=1000, seed=0)
        >>> round(cy.diagnose(cy.Parameters(), grid, state)["order"], 2)  # N^(-1/2)
        0.03
    """
    return with_noise(np.zeros((2, *grid.shape)), grid, filaments_per_square, seed, noise_grid)


@door
def with_noise(
    state: npt.ArrayLike,
    grid: CylinderGrid,
    filaments_per_square: float = 1000,
    seed: int = 0,
    noise_grid: tuple[int, int] | None = None,
) -> Array:
    """Return a state with `noise` added. Raises `InputError` where |P| > 1 then.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.with_noise(cy.initial.stripes(grid, magnitude=0.5), grid, seed=1)
        >>> bool(np.allclose(state - cy.initial.noise(grid, seed=1), cy.initial.stripes(grid, magnitude=0.5)))
        True
    """
    noisy = grid.check_state(state) + noise(grid, filaments_per_square, seed, noise_grid)
    return grid.check_state(noisy, "the initial state", bounded=True)


@door
def unidirectional(grid: CylinderGrid, magnitude: float = 0.9) -> Array:
    """Return P = `magnitude` e_z everywhere (the steady state has P0² = 1 - d_r/alpha_p).

    Raises `InputError` for a magnitude outside [0, 1], as do the two functions below.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
        >>> state = cy.initial.unidirectional(grid, magnitude=np.sqrt(1 - 0.025 / 1.0))
        >>> bool(np.abs(cy.rate_of_change(params, grid, state)).max() < 1e-12)
        True
    """
    state = np.zeros((2, *grid.shape))
    state[1] = definition("initial", "magnitude").check(magnitude)
    return state


@door
def circumferential(grid: CylinderGrid, magnitude: float = 0.9) -> Array:
    """Return P = `magnitude` e_theta everywhere.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.circumferential(grid, magnitude=0.8)
        >>> cy.regime(cy.Parameters(), grid, state).name
        'circumferential'
        >>> cy.flow(cy.Parameters(), grid, state)[:, 0, 0].round(3)  # |P|²P: no pressure opposes it
        array([0.512, 0.   ])
    """
    return unidirectional(grid, magnitude)[::-1].copy()


@door
def stripes(grid: CylinderGrid, count: int = 2, magnitude: float = 0.9) -> Array:
    """Return `count` stripes of equal width along the cell: P_z = magnitude sin(count theta / 2).

    Raises `InputError` for a count that is odd or that the grid does not resolve.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.stripes(grid, count=4)
        >>> cy.regime(cy.Parameters(), grid, state).name
        'multistripe'
        >>> cy.initial.stripes(grid, count=3)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: stripes = 3 cannot be used: ...
    """
    number = definition("initial", "stripes").check(count)
    if number % 2:
        raise InputError("stripes", count, "an even number, because stripes alternate", "choose 2 or 4")
    if number // 2 > (grid.n_theta - 1) // 2:
        raise InputError("stripes", count, f"resolved by n_theta = {grid.n_theta}", "raise n_theta")
    state = np.zeros((2, *grid.shape))
    profile = definition("initial", "magnitude").check(magnitude) * np.sin(number / 2 * grid.theta)
    state[1] = profile[:, None]
    return state


@door
def fitted(grid: CylinderGrid, state: Any) -> Array:
    """Return a state given on any grid of the same cylinder, interpolated onto `grid`.

    Raises `InputError` for an array that is not a state, or with |P| > 1.

    Example:
        >>> import cyclosis as cy
        >>> coarse, fine = cy.CylinderGrid(16, 16), cy.CylinderGrid(32, 48)
        >>> cy.initial.fitted(fine, cy.initial.stripes(coarse)).shape
        (2, 32, 48)
    """
    name, remedy = "the initial state", "give both components on a grid"
    rule = "an array of real numbers of shape (2, n_theta, n_z), each at least 8, or n_z = 1"
    array = numbers(name, state, rule, remedy, STATE_DIMS)
    if array.ndim != 3 or array.shape[0] != 2 or min(array.shape) < 1 or 1 < min(array.shape[1:]) < 8:
        raise InputError(name, array, rule, remedy)
    own = CylinderGrid(array.shape[1], array.shape[2], grid.length)
    return grid.check_state(interpolate(own.check_state(state, name), grid.shape), name, bounded=True)


@door
def from_file(path: str, grid: CylinderGrid, frame: int = -1, stretch: bool = False) -> Array:
    """Return a state stored in a file, interpolated onto `grid`.

    Reads variable `P` of a NetCDF file (time, component, theta, z), taking `frame`, or a NumPy file
    `.npy` with one array (2, n_theta, n_z), dimensionless. A NetCDF file contains the length of its cell:
    a state is refused if that is not `grid.length`, unless `stretch` is true, which stretches the state along
    z. A `.npy` file contains no length: its state is taken to span the whole of `grid.length`. Raises
    `InputError` for a file that is neither, that has no such frame, or whose cell has another length.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> coarse, fine = cy.CylinderGrid(16, 16), cy.CylinderGrid(32, 32)
        >>> np.save("state.npy", cy.initial.stripes(coarse))
        >>> state = cy.initial.from_file("state.npy", fine)
        >>> bool(np.allclose(state, cy.initial.stripes(fine)))
        True
    """
    frame = definition("initial", "frame").check(frame)
    stretch = definition("initial", "stretch").check(stretch)
    try:
        if str(path).endswith(".npy"):
            stored, length = np.load(path, allow_pickle=False), None
        else:
            stored, length = _frame_of(path, frame)
    except (OSError, KeyError, EOFError, ValueError, TypeError, zipfile.BadZipFile) as error:
        if isinstance(error, InputError):
            raise
        if isinstance(error, FileNotFoundError):
            remedy = "check the path: there is no such file"
            raise InputError("path", str(path), "a .nc or .npy file with a state", remedy) from error
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            "path",
            str(path),
            "a readable .nc file with a variable P, or a .npy file",
            f"it gave: {reason[:90]}",
        ) from error
    if length is not None and not stretch and not same_length(length, grid.length):
        raise InputError(
            f"length of the cell in {path}",
            length,
            f"that of the grid, {grid.length:.12g}",
            f"give the grid length = {length:.12g}, or stretch the state with stretch = true",
        )
    return fitted(grid, stored)


def _frame_of(path: str, frame: int) -> tuple[Array, float | None]:
    """Return one frame of P in a NetCDF file, and the length of its cell if the file has it."""
    import h5py

    with h5py.File(path, "r") as file:
        frames = file["P"]
        if not -len(frames) <= frame < len(frames):
            raise InputError("frame", frame, f"one of the {len(frames)} frames stored", "choose another")
        dims = tuple(scale[0].name.rpartition("/")[2] for scale in frames.dims if len(scale))
        if dims and dims != _DIMS:
            rule = "over (time, component, theta, z), in this order"
            raise InputError(f"P in {path}", dims, rule, "store it in this order")
        length = float(np.ravel(file.attrs["length"])[0]) if "length" in file.attrs else None
        if _has_axis(file, "z"):
            length = covered("z", file["z"][()], length, str(path))
        if _has_axis(file, "theta"):
            covered("theta", file["theta"][()], 2 * np.pi, str(path))
        return np.asarray(frames[frame % len(frames)]), length


_DIMS = ("time", "component", "theta", "z")


def _has_axis(file: Any, name: str) -> bool:
    """Whether a NetCDF file stores the positions of an axis, not only its size."""
    return name in file and "This is a netCDF dimension but" not in str(file[name].attrs.get("NAME"))
