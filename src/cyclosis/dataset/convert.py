"""Trajectory <-> xarray <-> file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ..contract.model import Model, TermLike
from ..dynamics.advance import StepperState
from ..dynamics.course import Intervention
from ..dynamics.frames import Frames
from ..dynamics.multistep import Past
from ..dynamics.protocol import Protocol
from ..dynamics.restart import PAST, Restart
from ..dynamics.settings import Settings
from ..dynamics.trajectory import Effort, Status, Trajectory
from ..model.doors import door
from ..model.errors import InputError
from ..model.precision import dtypes
from .contents import GROWING, Contents, described, interventions, of_trajectory, out_of_pairs
from .netcdf import DAMAGED, check, damaged, read_joined, write_contents
from .parts import MARKS, parts
from .place import check_writable, in_the_way, vacate

if TYPE_CHECKING:
    import xarray


@door
def to_dataset(run: Trajectory) -> xarray.Dataset:
    """Return a trajectory as an `xarray.Dataset` in memory, equal to that of its file: all of unit 1.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import to_dataset
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = to_dataset(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0))
        >>> data["P"].dims, data["stripe_width"].isel(time=-1).values[:2].round(3)
        (('time', 'component', 'theta', 'z'), array([0.5, 0.5]))
    """
    return _dataset(of_trajectory(run))


@door
def write(run: Trajectory, path: str | os.PathLike[str], force: bool = False) -> Path:
    """Write a trajectory to a NetCDF file, block by block, and return its path.

    The file is written completely or not at all: under a temporary name in the same folder, then synced
    and renamed. With `force` it replaces whatever exists at `path`, including the parts of an unfinished run.
    Raises `InputError` if a file or an unfinished run exists there and `force` is not given, if a run is
    being written there, and if the file cannot be written.

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
    try:
        write_contents(of_trajectory(run), target, force, lambda: vacate(target) if force else None)
    except FileExistsError as error:
        raise in_the_way(target) from error
    return target


def open_dataset(path: str | os.PathLike[str], model: Model | None = None) -> xarray.Dataset:
    """Open the file of a run; fields are loaded lazily, and verified when they are loaded.

    An unfinished run is read into memory, as far as it was saved. `model` is needed only if it is not in
    `cyclosis.models`. Raises `InputError` if the file is not that of a run, has another schema, or was
    truncated or altered.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> path = cy.write(cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0), "opened.nc")
        >>> with cy.open_dataset(path) as data:
        ...     print(data["order"].dims, data["time"].values, data["order"].attrs["units"])
        ('time',) [0. 1. 2.] 1
    """
    import xarray  # slow to import, and not needed to write files

    place = Path(path)
    files = parts(place)
    if files != [place]:
        return _dataset(read_joined(files, model=model))
    try:
        with h5py.File(place, "r") as file:
            check(file, place, model)
        dataset = xarray.open_dataset(place, engine="h5netcdf", decode_times=False)
    except DAMAGED as error:
        raise damaged(place, error) from error
    public = dataset.drop_attrs(deep=False).assign_attrs(_public(dataset.attrs))
    public.set_close(dataset.close)
    return public


@door
def load(
    path: str | os.PathLike[str],
    terms: Iterable[TermLike] | None = None,
    fields: bool = True,
    model: Model | None = None,
) -> Trajectory:
    """Return the `Trajectory` stored in a file, ready for `resume`.

    `terms` must be given again if there are custom ones, and `model` if it is not in `cyclosis.models`.
    Without `fields` the frames stay in the file. Raises `InputError` for files that `open_dataset` refuses.

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
    contents = read_joined(parts(place), fields, model)
    try:
        return _trajectory(contents, place, terms, fields)
    except DAMAGED as error:
        raise damaged(place, error) from error


def _dataset(contents: Contents) -> xarray.Dataset:
    import xarray

    data: dict[str, Any] = {n: (v.dims, v.values, v.attributes) for n, v in contents.variables.items()}
    blocks = list(contents.frames)
    for item in contents.model.stored:
        shape = (0, *(contents.coordinates[dim].values.size for dim in item.dims))
        empty = np.empty(shape, contents.dtype(item))
        values = np.concatenate([empty, *(block[item.name] for block in blocks)])
        data[item.name] = (("time", *item.dims), values, described(item.meaning))
    coordinates = {n: ((n,), c.values, described(c.meaning)) for n, c in contents.coordinates.items()}
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
    model = contents.model
    grid = model.grid_from(asked["grid"])
    settings = Settings(**{k: v for k, v in asked["run"].items() if k != "terms"})
    restart_arrays = _stepper_state(contents)
    final_state = model.state(grid, restart_arrays["spectrum"])
    times = contents.coordinates["time"].values
    dtype = dtypes(contents.attributes["precision"])[np.iscomplexobj(final_state)]
    frames = Frames(final_state.shape, dtype, elsewhere=0 if fields else len(times))
    if fields:
        for block in contents.frames:
            for state in out_of_pairs(block[model.state_name], final_state):
                frames.append(state)
    wall = float(contents.attributes["wall_time_seconds"])
    done = outcome.get("protocol_events_done", 0)
    restart = Restart(restart_arrays, outcome["sign_time"], outcome["sign"], wall, done)
    grown = {n: v.values for n, v in contents.variables.items() if v.dims[0] in GROWING}
    records = {n: v for n, v in grown.items() if n not in interventions(model)}
    origin = {"initial_sha256": contents.attributes["initial_sha256"]}
    if "initial" in asked:
        origin["initial"] = asked["initial"]
    if "scales" in contents.attributes:
        origin["scales"] = json.loads(contents.attributes["scales"])
    done_to_it = _interventions(contents, final_state)
    if done_to_it and done_to_it[-1].time == restart.t:
        final_state = done_to_it[-1].after
    return Trajectory(
        model=model,
        params=model.parameters(**values),
        grid=grid,
        settings=settings,
        terms=_terms(model, asked["run"]["terms"], terms, place),
        times=times,
        frames=frames,
        record_times=contents.coordinates.get("record_time", contents.coordinates["time"]).values,
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
        interventions=done_to_it,
    )


def _interventions(contents: Contents, like: Any) -> tuple[Intervention, ...]:
    found = contents.coordinates.get("intervention_time")
    if found is None or not found.values.size:
        return ()
    times = found.values
    before, after = (
        out_of_pairs(contents.variables[name].values, like) for name in interventions(contents.model)
    )
    return tuple(Intervention(float(t), a, b) for t, a, b in zip(times, before, after, strict=True))


def _stepper_state(contents: Contents) -> dict[str, Any]:
    stored = contents.restart
    known = (*StepperState._fields, *(PAST + name for name in Past._fields))
    out = {name: stored[name] for name in known if name in stored}
    for name in {"spectrum", "nonlinear", "past_modes", "past_local"} & out.keys():
        packed = np.empty(out[name].shape[1:], dtypes(contents.attributes["precision"])[1])
        packed.real, packed.imag = out[name]  # a sum would lose the sign of zeros
        out[name] = packed
    out["failed"] = out["failed"].astype(bool)
    return out


def _terms(model: Model, names: list[str], given: Iterable[TermLike] | None, place: Path) -> Any:
    if given is None:
        known = {term.name for term in model.terms(None)}
        unknown = [name for name in names if name not in known]
        if unknown:
            remedy = f"resume it in Python with terms=[..., {unknown[0]}]"
            raise InputError("terms of " + str(place), unknown[0], "a term of the package", remedy)
        return model.terms(names)
    chosen = model.terms(given)
    if [term.name for term in chosen] != names:
        found = [term.name for term in chosen]
        raise InputError(
            "terms", found, "those of the run: " + ", ".join(names), "give the same, in this order"
        )
    return chosen
