"""Peak memory and wall time of whole runs, each in a process of its own.

    python benchmarks/memory.py                # 64 x 64, and 1024 x 1024 with 200 saved frames
    python benchmarks/memory.py --sizes 64 256 # other sizes

Uses the accounting of the operating system (the largest resident set); not available on Windows.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = """
import json, resource, sys
import cyclosis as cy
n, frames, t_end, out = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
grid = cy.CylinderGrid(n, n, 5.0)
state = cy.initial.disordered(grid, seed=0, noise_grid=(64, 64))
run = cy.simulate(cy.Parameters(), grid, state, t_end=t_end, save_every=t_end / (frames - 1))
computed = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
cy.write(run, out)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps([len(run.frames), computed, peak, run.effort.evaluations, run.effort.wall_time, run.status]))
"""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[64, 1024])
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--t-end", type=float, default=20.0)
    arguments = parser.parse_args()
    unit = 2**20 if sys.platform == "darwin" else 2**10
    print(
        "| n | frames | peak of the run, MiB | with writing the file, MiB | right-hand sides | wall time, s |"
    )
    print("|---:|---:|---:|---:|---:|---:|")
    for n in arguments.sizes:
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", PROGRAM, str(n), str(arguments.frames), str(arguments.t_end)]
            out = subprocess.run(
                [*command, str(Path(folder) / "run.nc")], capture_output=True, text=True, check=True
            ).stdout
        frames, computed, peak, evaluations, seconds, status = json.loads(out)
        print(
            f"| {n} | {frames} | {computed / unit:.0f} | {peak / unit:.0f} | {evaluations} | {seconds:.1f} |"
            + ("" if status == "completed" else f" {status}"),
            flush=True,
        )


if __name__ == "__main__":
    main()
