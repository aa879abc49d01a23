"""Empty blocks through the real engine: what a block costs beside its members, and who remembers what.

    python benchmarks/scheduler_overhead.py                # 100 000 blocks of one made-up member

Scheduler, workers and client are processes of their own, as on a cluster. What a worker spends on a block is
making it up, packing it, writing and syncing its file, and talking; the processor time of scheduler and
client says how many blocks a second they can handle, however many workers there are.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cyclosis.sweep.cluster.environment import wanted
from cyclosis.sweep.cluster.progress import SweepProgress
from cyclosis.sweep.cluster.running_cluster import guest_client
from cyclosis.sweep.execute import run_sweep
from measure.faults import environment
from measure.sweeps import made_up, sweep


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--store", type=Path, help="folder for the store, by default a temporary one")
    arguments = parser.parse_args()
    plan = sweep(
        grid={"n_theta": 8, "n_z": 8},
        axes={
            "alpha_p": {"start": 0.0, "stop": 1.0, "count": 50},
            "alpha_u": {"start": 0.0, "stop": 1.0, "count": 50},
        },
        ensemble={"seeds": max(1, arguments.blocks // 2500), "block": 1},
    )
    print("| blocks | seconds | blocks/s | scheduler, MB | client, MB | a worker, MB |")
    print("|---:|---:|---:|---:|---:|---:|")
    with (
        tempfile.TemporaryDirectory(dir=arguments.store) as folder,
        cluster(Path(folder), arguments.workers) as (address, scheduler, worker),
    ):
        table = Table([scheduler, psutil.Process(), worker], plan.blocks)
        with guest_client(address) as client, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            client.wait_for_workers(arguments.workers)
            summary = run_sweep(plan, Path(folder) / "store", client, progress=table, compute=made_up)
        spent = [sum(process.cpu_times()[:2]) for process in table.processes]
    blocks = summary.computed
    each, inside = summary.seconds / blocks, summary.core_seconds / blocks
    used = [1e3 * (after - before) / blocks for after, before in zip(spent, table.spent, strict=True)]
    print(f"\n{summary.status}: {blocks} blocks in {summary.seconds:.1f} s, {1e3 * each:.2f} ms each")
    print(f"on the clock in a worker: {1e3 * inside:.2f} ms a block")
    print(f"processor time a block: scheduler {used[0]:.2f} ms, client {used[1]:.2f} ms, ", end="")
    print(f"workers {arguments.workers * used[2]:.2f} ms")


class Table:
    """Prints a line at every tenth of the way."""

    def __init__(self, processes: list[psutil.Process], total: int) -> None:
        self.processes, self.next, self.step = processes, 0, total // 10
        self.spent = [sum(process.cpu_times()[:2]) for process in processes]

    def __call__(self, now: SweepProgress) -> None:
        """Print where things stand, if it is time."""
        if now.done >= self.next:
            memory = " | ".join(f"{process.memory_info().rss / 1e6:.0f}" for process in self.processes)
            print(f"| {now.done} | {now.seconds:.1f} | {now.rate:.0f} | {memory} |", flush=True)
            self.next += self.step


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[tuple[str, psutil.Process, psutil.Process]]:
    """Provide a cluster of separate processes: its address, its scheduler, and one of its workers."""
    file = folder / "scheduler.json"
    own = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard", "--host", "127.0.0.1"]
    own += ["--port", "0", "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(file)]
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
    processes = [subprocess.Popen(own, **silent)]
    while not file.exists():
        time.sleep(0.05)
    address = json.loads(file.read_text())["address"]
    each = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--no-dashboard"]
    each += ["--nthreads", "1", "--memory-limit", "0"]
    around = environment(**wanted(os.environ))
    processes += [subprocess.Popen(each, env=around, **silent) for _ in range(workers)]
    try:
        yield address, psutil.Process(processes[0].pid), psutil.Process(processes[1].pid)
    finally:
        for process in processes:
            process.kill()
            process.wait()


if __name__ == "__main__":
    main()
