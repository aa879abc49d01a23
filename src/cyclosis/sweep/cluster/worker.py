"""A worker process of a cluster on this machine; started by `cyclosis.sweep.cluster.local_cluster`.

    python -m cyclosis.sweep.cluster.worker ADDRESS NAME [CORE]

It runs as long as its standard input is open, that is as long as the process that started it.
"""

from __future__ import annotations

import asyncio
import os
import sys
import threading

import dask
from distributed import Worker

from .dask_logging import LIGHT, quiet
from .environment import settle


def main(address: str, name: str, core: str = "") -> None:
    """Work for the scheduler at an address until that or the parent process ends."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if core:
        settle(int(core))
    with quiet(), dask.config.set(LIGHT):
        asyncio.run(_serve(address, name))


async def _serve(address: str, name: str) -> None:
    async with Worker(
        address, name=name, nthreads=1, memory_limit=0, dashboard=False, dashboard_address="127.0.0.1:0"
    ) as worker:
        await worker.finished()


def _end_with_parent() -> None:
    os.read(sys.stdin.fileno(), 1)  # nothing is ever written: this returns when the other end is closed
    os._exit(1)


if __name__ == "__main__":
    main(*sys.argv[1:])
