"""Reading the blocks of a store as one dataset over the axes of the sweep."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import xarray
from xarray.core.indexing import LazilyIndexedArray

from ...model.errors import InputError
from ..plan.variables import Variable, along_axes, attributes, of_states
from .block_file import CONVENTIONS, of_sweep
from .lazy_array import StoredArray
from .store import Store


def open_sweep(path: str | os.PathLike[str], variables: Iterable[str] | None = None) -> xarray.Dataset:
    """Return the results in a store as a dataset with one dimension per axis, and `seed`.

    It has all variables, or only those named, over (axes..., seed) and their own dimensions, all
    dimensionless. `regime` and `status` are integer codes, explained by their attributes `flag_values` and
    `flag_meanings`. Values that have not been computed are missing: -1 in integers, NaN in other numbers; the
    attributes `members_missing` and `blocks_missing` say how many and which. Every byte of every block is
    checked. Final fields `P` are read, and checked again, only when they are used. `path` may also be a file
    written by `export`, `.nc` or `.zarr`. Raises `InputError` if there is no store, a name is not one of its
    variables, or a block is damaged.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.sweep.store.block import compute
        >>> from cyclosis.sweep.store.store import Store
        >>> tables = {"axes": {"alpha_p": {"values": [0.01]}}, "ensemble": {"seeds": 2}}
        >>> sweep = cy.Sweep.from_tables(tables | {"grid": {"n_theta": 16, "n_z": 16}})
        >>> path = Store.create("opened", sweep).write(0, compute(sweep, 0))
        >>> data = cy.open_sweep("opened", ["regime"])
        >>> dict(data.sizes), data.attrs["members_missing"]
        ({'alpha_p': 1, 'seed': 2}, 0)
        >>> [cy.REGIMES[code] for code in data["regime"].values.flat]  # α_p < d_r
        ['disordered', 'disordered']
    """
    if os.fspath(path).endswith((".nc", ".zarr")):
        return _exported(Path(path), variables)
    store = Store(path)
    sweep = store.sweep
    chosen = choose(sweep.variables, variables)
    small = [item for item in chosen if item.name != sweep.model.state_name]
    arrays = {item.name: item.empty((sweep.members, *(sweep.sizes[d] for d in item.dims))) for item in small}
    present = sorted(store.present())
    for index in present:
        members = sweep.block(index).members
        for name, values in store.read(index, arrays.keys()).items():
            arrays[name][members.start : members.stop] = values
    data: dict[str, Any] = {}
    for item in chosen:
        dims = (*sweep.axes, "seed", *item.dims)
        if item.name in arrays:
            held: Any = arrays.pop(item.name).reshape([*sweep.shape, *(sweep.sizes[d] for d in item.dims)])
        else:
            held = LazilyIndexedArray(StoredArray(store, item, set(present)))
        data[item.name] = xarray.Variable(dims, held, attributes(item))
    used = {dim for item in chosen for dim in item.dims}
    placed = {n: c for n, c in of_states(sweep).items() if n in used} | along_axes(sweep)
    coordinates = {name: (item.dims, item.values, item.attributes) for name, item in placed.items()}
    return xarray.Dataset(data, coordinates, _attributes(store, present))


def _exported(path: Path, variables: Iterable[str] | None) -> xarray.Dataset:
    engine = "zarr" if path.suffix == ".zarr" else "h5netcdf"
    try:
        data = xarray.open_dataset(path, engine=engine, mask_and_scale=False)
    except (OSError, ValueError, KeyError) as error:
        rule = "the store of a sweep, or a file exported from one"
        raise InputError("store", str(path), rule, "check the path") from error
    if "configuration" not in data.attrs or "digest" not in data.attrs:
        data.close()
        raise InputError("store", str(path), "exported from the store of a sweep", "choose another file")
    names = [str(name) for name in data.data_vars] if variables is None else list(variables)
    for name in names:
        if name not in data.data_vars:
            rule = "variables of the file: " + ", ".join(map(str, data.data_vars))
            raise InputError("variables", name, rule, "export it as well")
    return data[names]


def choose(known: tuple[Variable, ...], names: Iterable[str] | None) -> list[Variable]:
    """Return the variables with these names, or all. Raises `InputError` for an unknown name."""
    asked = [item.name for item in known] if names is None else list(names)
    for name in asked:
        if name not in {item.name for item in known}:
            rule = "variables of the store: " + ", ".join(item.name for item in known)
            raise InputError("variables", name, rule, "check the spelling, or record it in the sweep")
    return [item for item in known if item.name in asked]


def _attributes(store: Store, present: list[int]) -> dict[str, Any]:
    sweep = store.sweep
    computed = sum(len(sweep.block(index).members) for index in present)
    found = set(present)
    absent = [index for index in range(sweep.blocks) if index not in found]
    return {
        "Conventions": CONVENTIONS,
        "title": of_sweep("Sweep", sweep),
        "source": sweep.model.source,
        "configuration": json.dumps(store.about["configuration"]),
        "digest": store.digest,
        **({"scales": json.dumps(scales, sort_keys=True)} if (scales := sweep.tables.get("scales")) else {}),
        "versions": json.dumps(store.about["versions"]),
        "created": store.about["created"],
        "members_computed": computed,
        "members_missing": sweep.members - computed,
        "blocks_missing": ranges(absent),
    }


def ranges(indices: Iterable[int]) -> str:
    """Return sorted integers as a short text, such as "0-3, 7, 9-12"."""
    listed = list(indices)
    starts = [b for a, b in pairwise([-2, *listed]) if b != a + 1]
    ends = [a for a, b in pairwise([*listed, listed[-1] + 2]) if b != a + 1] if listed else []
    return ", ".join(f"{a}" if a == b else f"{a}-{b}" for a, b in zip(starts, ends, strict=True))
