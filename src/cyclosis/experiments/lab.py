"""Where experiments are run: many seeds with the sweep engine, single cells with `simulate`."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..dynamics.simulate import simulate
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from ..sweep.cluster.local_cluster import local_client
from ..sweep.cluster.pickling import shipped
from ..sweep.execute import run_sweep
from ..sweep.plan.sweep import Sweep
from ..sweep.store.read import open_sweep

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from ..dynamics.protocol import Protocol
    from ..dynamics.trajectory import Trajectory
    from ..sweep.cluster.progress import SweepProgress

Told = Callable[[str, "SweepProgress"], None]


class Lab:
    """The resources of one experiment: how many `seeds`, whether it is `quick`, and where sweeps are stored.

    As a context manager it starts worker processes with the first sweep and stops them at the end. Stores
    remain in `folder`, so that an interrupted experiment continues where it stopped. `told` is called with
    progress.
    """

    def __init__(
        self,
        folder: Path,
        seeds: int,
        quick: bool = False,
        workers: int | None = None,
        told: Told | None = None,
    ) -> None:
        self.folder, self.seeds, self.quick = folder, seeds, quick
        self._workers, self._told = workers, told
        self._cluster: AbstractContextManager[Any] | None = None
        self._client: Any = None

    def __enter__(self) -> Lab:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._cluster is not None:
            self._cluster.__exit__(kind, error, trace)
            self._cluster = self._client = None

    def sweep(
        self, label: str, tables: Mapping[str, Any], variables: Sequence[str] | None = None
    ) -> xarray.Dataset:
        """Compute a sweep given as tables, or what is missing of it, and return its dataset in memory.

        [ensemble] seeds is the lab's number of seeds and the grid 48 x 48, unless the tables say otherwise.
        Raises `InputError` if members failed.
        """
        whole = {
            "grid": {"n_theta": 48, "n_z": 48},
            **tables,
            "ensemble": {"seeds": self.seeds, **tables.get("ensemble", {})},
        }
        sweep = Sweep.from_tables(whole)
        store = self.folder / label
        store.parent.mkdir(parents=True, exist_ok=True)

        def told(now: SweepProgress) -> None:
            if self._told is not None:
                self._told(label, now)

        summary = run_sweep(sweep, store, self._running(), progress=told)
        if summary.status != "complete":
            rule = f"complete, and it is {summary.status} ({summary.message.rstrip('.')})"
            raise InputError("the sweep", str(store), rule, "start the experiment again to continue it")
        with open_sweep(store, variables=variables) as data:
            return data.load()

    def each(self, label: str, function: Callable[..., Any], items: Iterable[tuple[Any, ...]]) -> list[Any]:
        """Return function(*item) for every item, in order, computed by the workers.

        For quantities that a sweep does not record, such as a course over time. `function` must be defined
        in a module.
        """
        listed = list(items)
        called = shipped(lambda item: function(*item))
        client = self._running()
        futures = client.map(called, listed, pure=False, key=f"{label}-{id(listed)}")
        return list(client.gather(futures))

    def kept(self, label: str, function: Callable[..., Any], items: Iterable[tuple[Any, ...]]) -> list[Any]:
        """Return the same as `each` of a function that returns arrays, and keep each array in `folder`.

        An interrupted experiment continues where it stopped. Items must be numbers, strings and tuples of
        them: they name the file.
        """
        folder = self.folder / label
        folder.mkdir(parents=True, exist_ok=True)
        named = [(str(folder / f"{_digest(item)}.npy"), item) for item in items]
        return self.each(label, partial(_kept, function), named)

    def story(
        self,
        params: Parameters,
        grid: CylinderGrid,
        state: Array,
        t_end: float,
        times: Sequence[float] = (),
        protocol: Protocol | None = None,
        **settings: Any,
    ) -> Trajectory:
        """Run one cell and return its trajectory; `times` are those of saved frames (default: the end)."""
        saved = tuple(times) or (t_end,)
        return simulate(params, grid, state, t_end, save_at=saved, protocol=protocol, **settings)

    def _running(self) -> Any:
        if self._client is None:
            self._cluster = local_client(self._workers)
            self._client = self._cluster.__enter__()
        return self._client


def _digest(item: tuple[Any, ...]) -> str:
    return hashlib.sha256(repr(item).encode()).hexdigest()[:32]


def _kept(function: Callable[..., Any], file: str, item: tuple[Any, ...]) -> Array:
    """Return the array in a file, or compute it and write it there, completely or not at all."""
    target = Path(file)
    if not target.exists():
        beside = target.with_suffix(f".{os.getpid()}.part")
        with beside.open("wb") as written:
            np.save(written, np.asarray(function(*item)))
        beside.replace(target)
    found: Array = np.load(target, allow_pickle=False)
    return found


def frames(run: Trajectory, times: Sequence[float]) -> xarray.Dataset:
    """Return P and u of a run's frames nearest to `times`, as variables over `frame`, in single precision."""
    saved = np.asarray(run.times)
    chosen = [int(np.argmin(np.abs(saved - time))) for time in times]
    P = np.stack([run.frames[index] for index in chosen])
    u = np.stack([flow(run.params, run.grid, state) for state in P])
    dims = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {"P": (dims, P.astype(np.float32)), "u": (dims, u.astype(np.float32))},
        coords={
            "frame_time": ("frame", saved[chosen]),
            "component": ["theta", "z"],
            "theta": run.grid.theta,
            "z": run.grid.z,
        },
        attrs={"length": run.grid.length},
    )
