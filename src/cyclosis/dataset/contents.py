"""The contents of a run: coordinates, small variables, frames block by block, restart and attributes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..contract.model import FIELD, Coordinate, Model, Stored
from ..dynamics.trajectory import Trajectory
from ..model.precision import dtypes
from . import provenance

COORDINATES = {
    "time": "time in units of R/U",
    "record_time": "time of recorded quantities in units of R/U",
    "intervention_time": "time at which the protocol acted on the state, in units of R/U",
    "term": "terms of the filament equation",
}
"""Coordinates of runs of every model; the others are those of `Model.coordinates`."""
GROWING = ("time", "record_time", "intervention_time")
"""Dimensions along which the parts of a run are joined."""

BLOCK_BYTES = 2**23
"""Approximate size of the blocks in which fields are written to and read from a file."""

Block = dict[str, npt.NDArray[Any]]
"""Values at several successive times, by name."""


@dataclass
class FileVariable:
    """One array with its dimensions and attributes."""

    dims: tuple[str, ...]
    values: npt.NDArray[Any]
    attributes: dict[str, str]


@dataclass
class Contents:
    """A run of a model, or a part of one, as it is stored in a file.

    `frames` yields one block of times after another: what `model` stores of every frame, by name, with time
    as the first dimension; it can be consumed once. `restart` holds arrays by name.
    """

    model: Model
    coordinates: dict[str, Coordinate]
    variables: dict[str, FileVariable]
    frames: Iterator[Block]
    restart: dict[str, npt.NDArray[Any]]
    attributes: dict[str, Any]

    def dtype(self, item: Stored) -> npt.DTypeLike:
        """Return the type of an item that is stored of every frame."""
        return stored_type(item, self.attributes["precision"])


def stored_type(item: Stored, precision: str) -> npt.DTypeLike:
    """Return the type of what is stored of every frame of a run of some precision."""
    return dtypes(precision)[0] if item.dtype == FIELD else np.dtype(item.dtype)


def of_trajectory(
    run: Trajectory, first_frame: int = 0, first_record: int = 0, first_intervention: int = 0
) -> Contents:
    """Return the contents of a trajectory, beginning at a given frame, record and intervention."""
    names = [term.name for term in run.terms]
    coordinates = {"time": _along("time", run.times[first_frame:])}
    coordinates |= run.model.coordinates(run.grid, run.final_state.shape)
    coordinates["term"] = _along("term", np.array(names, dtype=object))
    apart = run.settings.record_every is not None
    if apart:
        coordinates["record_time"] = _along("record_time", run.record_times[first_record:])
    variables = {
        name: FileVariable(item.dims, item.values, described(item.meaning))
        for name, item in run.model.geometry(run.grid).items()
    }
    for item in run.model.quantities:
        if item.name in run.records:
            values = run.records[item.name][first_record:]
            dims = ("record_time" if apart else "time", *item.dims)
            variables[item.name] = FileVariable(
                dims, values, described(item.meaning) | {"symbol": item.symbol}
            )
    if run.protocol:
        done = run.interventions[first_intervention:]
        times = np.array([item.time for item in done])
        coordinates["intervention_time"] = _along("intervention_time", times)
        for (name, (dims, meaning)), states in zip(
            interventions(run.model).items(),
            ([item.before for item in done], [item.after for item in done]),
            strict=True,
        ):
            stacked = np.array(states, run.final_state.dtype).reshape(-1, *run.final_state.shape)
            variables[name] = FileVariable(dims, in_pairs(stacked), described(meaning))
    for name, value in run.params.items():
        if isinstance(value, np.ndarray):
            dims = run.model.stored[0].dims[-value.ndim :]
            variables[name] = FileVariable(dims, value, described(f"parameter {name}"))
    restart = {name: _real(value) for name, value in run.restart.progress.items()}
    frames, about = _blocks(run, first_frame), provenance.attributes(run)
    return Contents(run.model, coordinates, variables, frames, restart, about)


def interventions(model: Model) -> dict[str, tuple[tuple[str, ...], str]]:
    """Return the names of states before and after interventions, with their dimensions and meanings."""
    state = model.stored[0]
    dims = ("intervention_time", *state.dims)
    what = state.meaning.partition(" of ")[0]
    return {
        f"{state.name}_before": (dims, f"{what} just before the protocol acted on it"),
        f"{state.name}_after": (dims, f"{what} just after the protocol acted on it"),
    }


def _along(name: str, values: npt.NDArray[Any]) -> Coordinate:
    return Coordinate(values, COORDINATES[name])


def described(meaning: str) -> dict[str, str]:
    """Return the attributes of a dimensionless variable."""
    return {"long_name": meaning, "units": "1"}


def _real(value: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return complex numbers as pairs: NetCDF has no complex type."""
    return np.stack([value.real, value.imag]) if np.iscomplexobj(value) else value


def in_pairs(states: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return states over time with complex numbers as pairs, along the dimension after time."""
    return np.stack([states.real, states.imag], 1) if np.iscomplexobj(states) else states


def out_of_pairs(values: npt.NDArray[Any], like: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return states over time as numbers of the kind of a state, complex ones from pairs."""
    if not np.iscomplexobj(like):
        return values
    out = np.empty((len(values), *values.shape[2:]), np.result_type(values, np.complex64))
    out.real, out.imag = values[:, 0], values[:, 1]  # a sum would lose the sign of zeros
    return out


def spans(frames: int, values: int, dtype: npt.DTypeLike) -> list[slice]:
    """Return the blocks of a number of frames, each with two fields of `values` numbers."""
    step = max(1, BLOCK_BYTES // (2 * values * np.dtype(dtype).itemsize))
    return [slice(start, min(start + step, frames)) for start in range(0, frames, step)]


def _blocks(run: Trajectory, first: int) -> Iterator[Block]:
    shape = run.final_state.shape
    problem = run.model.problem(run.params, run.grid, run.terms, run.settings.dealias, shape=shape)
    derive = run.model.derive(problem)
    for span in spans(len(run.frames) - first, int(np.prod(run.frames.shape)), run.frames.dtype):
        states, found = [], []
        for index in range(first + span.start, first + span.stop):
            states.append(run.frames[index].astype(np.result_type(run.frames.dtype, np.float64)))
            found.append(derive(run.params_at(float(run.times[index])), states[-1]))
        block = {run.model.state_name: in_pairs(np.array(states, run.frames.dtype))}
        for item in run.model.stored[1:]:
            dtype = stored_type(item, run.settings.precision)
            block[item.name] = np.array([values[item.name] for values in found], dtype)
        yield block
