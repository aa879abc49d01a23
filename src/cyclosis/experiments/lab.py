"""Where experiments are run: many seeds with the sweep engine, single cells with `simulate`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import distributed
import numpy as np
import xarray

from ..dataset import load, write
from ..dynamics.simulate import simulate
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..model.system import flow
from ..sweep.cluster.local_cluster import local_client
from ..sweep.cluster.pickling import shipped
from ..sweep.cluster.progress import counted
from ..sweep.execute import run_sweep
from ..sweep.plan.sweep import Sweep
from ..sweep.store.read import open_sweep
from ..sweep.store.store import SWEEP, Store
from .stored import Unstorable, described, member, of_content

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from ..dynamics.protocol import Protocol
    from ..dynamics.trajectory import Trajectory
    from ..sweep.cluster.progress import SweepProgress

Told = Callable[[str, "SweepProgress"], None]
STORIES = "stories"
"""Folder, within that of an experiment's stores, for its single runs."""


class Lab:
    """The resources of one experiment: how many `seeds`, whether it is `quick`, and where sweeps are stored.

    As a context manager it starts worker processes with the first sweep and stops them at the end. Every
    member that is done is stored in `folder`, so that an interrupted experiment continues where it stopped.
    `told` is called with progress.
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
        if (store / SWEEP).exists() and Store(store).sweep != sweep:
            store = store.with_name(f"{label}-{sweep.digest[:12]}")  # the experiment has another definition

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
        in a module. Each result is stored in `folder` as soon as it is there, see `stored`.
        """
        listed = list(items)
        folder = str(self.folder / label)
        called = shipped(lambda item: member(folder, function, *item))
        client = self._running()
        began = time.monotonic()
        futures = client.map(called, listed, pure=False, key=f"{label}-{id(listed)}")
        if self._told is not None:
            for done, _ in enumerate(distributed.as_completed(futures, loop=client.loop), 1):
                self._told(label, counted(done, len(listed), time.monotonic() - began))
        return list(client.gather(futures))

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
        """Run one cell and return its trajectory; `times` are those of saved frames (default: the end).

        The run is stored in `folder` and read from there when it is needed again.
        """
        saved = tuple(times) or (t_end,)

        def run() -> Trajectory:
            return simulate(
                params, grid, state, t_end, save_at=saved, protocol=protocol, progress=False, **settings
            )

        steps = None if protocol is None else (protocol.as_tables(), protocol.seed)
        cell = (params, grid.shape, grid.length, np.asarray(state))
        try:
            told = described((*cell, t_end, saved, steps, settings))
        except Unstorable:  # a term of the user's own
            return run()
        file = self.folder / STORIES / f"{of_content(told)}.nc"
        with suppress(InputError):  # missing or damaged
            return load(file)
        file.parent.mkdir(parents=True, exist_ok=True)
        found = run()
        write(found, file, force=True)
        return found

    def _running(self) -> Any:
        if self._client is None:
            self._cluster = local_client(self._workers)
            self._client = self._cluster.__enter__()
        return self._client


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
