"""Trajectory <-> xarray <-> file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ..dynamics.advance import Progress
from ..dynamics.course import Intervention
from ..dynamics.frames import Frames
from ..dynamics.protocol import Protocol
from ..dynamics.restart import Restart
from ..dynamics.settings import Settings
from ..dynamics.trajectory import Effort, Status, Trajectory
from ..model.definitions import TERM_NAMES
from ..model.errors import InputError
from ..model.filaments import TermLike, select_terms
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from ..model.spectral import dtypes
from .contents import (
    COORDINATES,
    FIELD_DIMS,
    FIELDS,
    GROWING,
    INTERVENTIONS,
    ZONE_VARIABLES,
    Contents,
    described,
    of_trajectory,
)
from .netcdf import DAMAGED, check, damaged, joined, write_contents
from .parts import MARKS, parts

if TYPE_CHECKING:
    import xarray


def to_dataset(run: Trajectory) -> xarray.Dataset:
    """Return a trajectory as an `xarray.Dataset` in memory, as a file of it would be read: all of unit 1.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import to_dataset
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = to_dataset(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0))
        >>> data["P"].dims, data["stripe_width"].isel(time=-1).values[:2].round(3)
        (('time', 'component', 'theta', 'z'), array([0.5, 0.5]))
    """
    return _dataset(of_trajectory(run), run.grid.shape)


def write(run: Trajectory, path: str | os.PathLike[str], force: bool = False) -> Path:
    """Write a trajectory to a NetCDF file, frame by frame, and return its path.

    The file appears whole or not at all: it is written under a temporary name beside its place, synced
    and renamed. Raises `InputError` if `path` exists and `force` is not given, or cannot be written.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=1.0)
        >>> cy.write(run, "run.nc").name
        'run.nc'
        >>> cy.write(run, "run.nc")
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: out = 'run.nc' cannot be used: ...
    """
    target = Path(path)
    check_writable(target, force)
    write_contents(of_trajectory(run), target)
    return target


def check_writable(target: Path, force: bool) -> None:
    """Raise `InputError` if a file is in the way or its folder is missing.

    Example:
        >>> from pathlib import Path
        >>> from cyclosis.dataset import check_writable
        >>> check_writable(Path("new.nc"), force=False)
        >>> check_writable(Path("nowhere/new.nc"), force=False)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: out = 'nowhere/new.nc' cannot be used: ...
    """
    try:
        folder, there, room = target.is_dir(), target.exists(), target.parent.is_dir()
    except OSError as error:
        remedy = f"choose another ({error.strerror})"
        raise InputError("out", str(target), "a place that can be written to", remedy) from error
    if folder:
        raise InputError("out", str(target), "a file name", "add a name to the folder")
    if there and not force:
        raise InputError("out", str(target), "a new file", "add --force (force=True) to overwrite it")
    if not room:
        raise InputError("out", str(target), "in a folder that exists", f"create {target.parent} first")


def open_dataset(path: str | os.PathLike[str]) -> xarray.Dataset:
    """Open a file of a run; fields load lazily, and are verified as they load.

    An unfinished run is read into memory, as far as it was saved. Raises `InputError` for a file that is
    none, of another schema, truncated or altered.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0), "opened.nc")
        >>> with cy.open_dataset(path) as data:
        ...     print(data["order"].dims, data["time"].values, data["order"].attrs["units"])
        ('time',) [0. 1. 2.] 1
    """
    import xarray  # heavy, and of no use to those who only write files

    place = Path(path)
    standing = parts(place)
    if standing != [place]:
        contents = joined(standing)
        sizes = contents.coordinates
        return _dataset(contents, (sizes["theta"].size, sizes["z"].size))
    try:
        with h5py.File(place, "r") as file:
            check(file, place)
        dataset = xarray.open_dataset(place, engine="h5netcdf", decode_times=False)
    except DAMAGED as error:
        raise damaged(place, error) from error
    public = dataset.drop_attrs(deep=False).assign_attrs(_public(dataset.attrs))
    public.set_close(dataset.close)
    return public


def load(
    path: str | os.PathLike[str], terms: Iterable[TermLike] | None = None, fields: bool = True
) -> Trajectory:
    """Return the `Trajectory` stored in a file, ready for `resume`.

    `terms` must be given again if the user wrote some. Without `fields` the frames stay in the file.
    Raises `InputError` for files that `open_dataset` refuses.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> again = cy.load(cy.write(run, "loaded.nc"))
        >>> again.params == params, bool(np.array_equal(again.final_state, run.final_state))
        (True, True)
    """
    place = Path(path)
    contents = joined(parts(place), fields)
    try:
        return _trajectory(contents, place, terms, fields)
    except DAMAGED as error:
        raise damaged(place, error) from error


def _dataset(contents: Contents, shape: tuple[int, int]) -> xarray.Dataset:
    import xarray

    data: dict[str, Any] = {n: (v.dims, v.values, v.attributes) for n, v in contents.variables.items()}
    frames = list(contents.frames)
    for name, meaning in FIELDS.items():
        stacked = np.array([frame[name] for frame in frames], dtype=contents.dtype).reshape(-1, 2, *shape)
        data[name] = (FIELD_DIMS, stacked, described(meaning))
    slots = len(contents.coordinates["zone"])
    for name, (dims, meaning) in ZONE_VARIABLES.items():
        kind = np.int64 if name == "zone_count" else np.float64
        values = np.array([frame[name] for frame in frames], dtype=kind)
        data[name] = (("time", *dims), values.reshape(-1, *([slots] if dims else [])), described(meaning))
    coordinates = {n: ((n,), v, described(COORDINATES[n])) for n, v in contents.coordinates.items()}
    return xarray.Dataset(data, coordinates, _public(contents.attributes))


def _public(attributes: dict[Any, Any]) -> dict[str, Any]:
    hidden = ("digest", *MARKS)
    return {key: value for key, value in attributes.items() if key not in hidden}


def _trajectory(
    contents: Contents, place: Path, terms: Iterable[TermLike] | None, fields: bool
) -> Trajectory:
    asked = json.loads(contents.attributes["configuration"])
    outcome = json.loads(contents.attributes["outcome"])
    values: dict[str, Any] = {
        n: contents.variables[n].values if v == "field" else v for n, v in asked["parameters"].items()
    }
    grid = CylinderGrid(**asked["grid"])
    settings = Settings(**{k: v for k, v in asked["run"].items() if k != "terms"})
    frames = Frames(
        (2, *grid.shape), contents.dtype, elsewhere=0 if fields else len(contents.coordinates["time"])
    )
    if fields:
        for frame in contents.frames:
            frames.append(frame["P"])
    wall = float(contents.attributes["wall_time_seconds"])
    done = outcome.get("protocol_events_done", 0)
    restart = Restart(_progress(contents), outcome["sign_time"], outcome["sign"], wall, done)
    grown = {n: v.values for n, v in contents.variables.items() if v.dims[0] in GROWING}
    records = {n: v for n, v in grown.items() if n not in INTERVENTIONS}
    times = contents.coordinates["time"]
    origin = {"initial_sha256": contents.attributes["initial_sha256"]}
    if "initial" in asked:
        origin["initial"] = asked["initial"]
    interventions = _interventions(contents)
    final = np.fft.ifft2(restart.progress["spectrum"].astype(np.complex128))
    final_state = np.stack([final.real, final.imag])
    if interventions and interventions[-1].time == restart.t:
        final_state = interventions[-1].after
    return Trajectory(
        params=Parameters(**values),
        grid=grid,
        settings=settings,
        terms=_terms(asked["run"]["terms"], terms, place),
        times=times,
        frames=frames,
        record_times=contents.coordinates.get("record_time", times),
        records=records,
        status=Status(outcome["status"]),
        status_time=outcome["status_time"],
        message=outcome["message"],
        t_final=outcome["t_final"],
        final_state=final_state,
        restart=restart,
        effort=Effort(outcome["evaluations"], outcome["accepted"], outcome["rejected"], wall),
        provenance=origin,
        protocol=Protocol.from_tables(asked.get("protocol", []), asked.get("protocol_seed", 0)),
        interventions=interventions,
    )


def _interventions(contents: Contents) -> tuple[Intervention, ...]:
    times = contents.coordinates.get("intervention_time", ())
    before, after = (contents.variables[n].values if len(times) else () for n in INTERVENTIONS)
    return tuple(Intervention(float(t), a, b) for t, a, b in zip(times, before, after, strict=True))


def _progress(contents: Contents) -> dict[str, Any]:
    stored = contents.restart
    out = {name: stored[name] for name in Progress._fields}
    for name in ("spectrum", "nonlinear"):
        packed = np.empty(out[name].shape[1:], dtypes(contents.attributes["precision"])[1])
        packed.real, packed.imag = out[name]  # a sum would lose the sign of zeros
        out[name] = packed
    out["failed"] = out["failed"].astype(bool)
    return out


def _terms(names: list[str], given: Iterable[TermLike] | None, place: Path) -> Any:
    if given is None:
        unknown = [name for name in names if name not in TERM_NAMES]
        if unknown:
            remedy = f"resume it in Python with terms=[..., {unknown[0]}]"
            raise InputError("terms of " + str(place), unknown[0], "one that the package knows", remedy)
        return select_terms(names)
    chosen = select_terms(given)
    if [term.name for term in chosen] != names:
        found = [term.name for term in chosen]
        raise InputError(
            "terms", found, "those of the run: " + ", ".join(names), "give the same, in this order"
        )
    return chosen
