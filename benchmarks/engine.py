"""Cost of the engine in the browser, in Node.js, against the library's: one core, interleaved in one run.

    npm ci --prefix web && taskset -c 0 python benchmarks/engine.py

Times are those of the processor, so that other work on the machine matters little. A right-hand side of the
library is timed where it is used, in a compiled loop. The pace is that of a cell with frames every 0.1.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")

import jax
from right_hand_side import looped

import cyclosis as cy
from cyclosis.model.precision import double

WEB = Path(__file__).parents[1] / "web"


def built(folder: str) -> str:
    """Return the path of the engine's part, as one file for Node.js."""
    out = str(Path(folder, "engine.mjs"))
    entry = str(Path(__file__).with_suffix(".ts"))
    command = ["npx", "esbuild", entry, "--bundle", "--format=esm", "--platform=node", f"--outfile={out}"]
    subprocess.run([*command, "--log-level=warning"], cwd=WEB, check=True)
    return out


def engine(script: str, *arguments: object) -> float:
    """Return what the engine measures."""
    command = ["node", script, *map(str, arguments)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def library(n_theta: int, n_z: int, repeats: int) -> float:
    """Return the library's microseconds for one right-hand side."""
    loop, cell, spectrum = looped(cy.CylinderGrid(n_theta, n_z, 5.0), repeats)
    times = []
    with double():
        for _ in range(6):
            began = time.process_time()
            jax.block_until_ready(loop(cell, spectrum))
            times.append((time.process_time() - began) / repeats * 1e6)
    return statistics.median(times[1:])


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grids", nargs="+", default=["32x32", "64x64", "48x128", "60x60", "128x128"])
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    print("| grid | engine, us | library, us | ratio | time units a second |")
    print("|---|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        script = built(folder)
        for grid in arguments.grids:
            n_theta, n_z = map(int, grid.split("x"))
            repeats = max(20, int(300 * 4096 / (n_theta * n_z)))
            pairs = [
                (engine(script, "rates", n_theta, n_z, repeats), library(n_theta, n_z, repeats))
                for _ in range(arguments.rounds)
            ]
            ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
            ratio = statistics.median(a / b for a, b in pairs)
            pace = engine(script, "pace", n_theta, n_z, 20)
            print(f"| {grid} | {ours:.0f} | {theirs:.0f} | {ratio:.2f} | {pace:.1f} |", flush=True)


if __name__ == "__main__":
    main()
