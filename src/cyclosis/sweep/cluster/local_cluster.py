"""A cluster on this machine: one process with one thread on every core, or on every GPU."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import dask
from distributed import Client, LocalCluster

from .dask_logging import LIGHT, level, quiet
from .environment import accelerators, idlest_cores, wanted

SETTINGS = LIGHT | {"distributed.scheduler.worker-saturation": 1.0}
"""A worker gets its next block only when the last one is done: a block that kills its worker affects no other
block, and all workers finish at about the same time."""
SHORTEST, LONGEST = 0.5, 10.0
"""Shortest and longest pause in seconds before a worker is restarted: it doubles while it dies at once."""
AT_ONCE = 20.0
"""A worker that ran for at least so many seconds did not die at once."""


@contextmanager
def local_client(workers: int | None = None) -> Iterator[Client]:
    """Provide a client of a cluster of `workers` processes, by default one per core or one per GPU.

    Each has the environment of `cyclosis.sweep.cluster.environment` and stays on one core. A worker that
    dies is started again. Ctrl-C does not reach workers, and they end with this process even if it is killed.
    """
    with (
        quiet(),
        dask.config.set(SETTINGS),
        LocalCluster(
            n_workers=0,
            threads_per_worker=1,
            protocol="tcp://",
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=level(),
            scheduler_kwargs={"allowed_failures": 0},
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
        _staff(str(cluster.scheduler_address), workers),
    ):
        yield client


@contextmanager
def _staff(address: str, count: int | None) -> Iterator[None]:
    keepers = [_Keeper(address, number, *place) for number, place in enumerate(places(count))]
    try:
        for keeper in keepers:
            keeper.start()
        yield
    finally:
        for keeper in keepers:
            keeper.stop()


def places(count: int | None) -> list[tuple[int | None, dict[str, str]]]:
    """Return for every worker the core it stays on, if any, and the variables of its environment."""
    gpus, idle, shared = accelerators(os.environ), idlest_cores(), wanted(os.environ)
    if gpus:
        count = count or len(gpus)
        divided = {"XLA_PYTHON_CLIENT_PREALLOCATE": "false"} if count > len(gpus) else {}
        return [
            (None, shared | divided | {"CUDA_VISIBLE_DEVICES": gpus[n % len(gpus)]}) for n in range(count)
        ]
    return [(idle[n % len(idle)], shared) for n in range(count or len(idle))]


class _Keeper(threading.Thread):
    """Starts a worker, and restarts it whenever it has died."""

    def __init__(self, address: str, number: int, core: int | None, environment: dict[str, str]) -> None:
        super().__init__(daemon=True, name=f"keeper of worker {number}")
        place = [] if core is None else [str(core)]
        self.command = [sys.executable, "-m", "cyclosis.sweep.cluster.worker", address, str(number), *place]
        self.environment = os.environ | environment | {"PYTHONPATH": _search_path()}
        self.lock, self.stopped = threading.Lock(), threading.Event()
        self.process: subprocess.Popen[bytes] | None = None

    def run(self) -> None:
        """Keep a worker running until `stop` is called."""
        pause = SHORTEST
        while not self.stopped.is_set():
            began = time.monotonic()
            with suppress(OSError):  # no process can be started at this moment
                self._start()
            if self.process is not None:
                self.process.wait()
            self.stopped.wait(pause)
            pause = SHORTEST if time.monotonic() > began + AT_ONCE else min(2 * pause, LONGEST)

    def _start(self) -> None:
        with self.lock:
            if not self.stopped.is_set():
                self.process = subprocess.Popen(
                    self.command, env=self.environment, stdin=subprocess.PIPE, start_new_session=True
                )

    def stop(self) -> None:
        """Kill the worker: each of its blocks is in the store completely or not at all."""
        with self.lock:
            self.stopped.set()
            if self.process is not None:
                self.process.kill()
        self.join()
        if self.process is not None and self.process.stdin is not None:
            self.process.stdin.close()


def _search_path() -> str:
    """Return the search path of modules of this process, so that a worker loads the same ones."""
    return os.pathsep.join(str(Path(place).absolute()) for place in sys.path)
