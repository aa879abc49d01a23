"""How long it takes to plan a sweep, to count its blocks and to open it.

    python benchmarks/store.py

Blocks hold made-up results. Opened is a store of the size of the paper's Figure 5: every byte is read and
checked.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store.read import open_sweep
from cyclosis.sweep.store.store import Store
from sweep import fakes

TURNS = 5


def seconds(action: Callable[[], object]) -> float:
    """Return the best time of an action, which other work can only lengthen."""
    taken = []
    for _ in range(TURNS):
        began = time.perf_counter()
        action()
        taken.append(time.perf_counter() - began)
    return min(taken)


def planned(count: int, seeds: int, **others: dict) -> Sweep:
    """Return a sweep of `count` squared points."""
    axis = {"start": 0.1, "stop": 1.0, "count": count}
    axes = {"alpha_p": axis, "kappa": axis}
    return fakes.sweep(axes=axes, ensemble={"seeds": seeds, "block": None}, **others)


def main() -> None:
    print("| what | how much | seconds |\n|---|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        print(f"| planned | 10⁸ members | {seconds(lambda: planned(1000, 100).digest):.3f} |")
        many = Store.create(Path(folder) / "many", planned(100, 1000))
        for index in range(many.sweep.blocks):
            many.path_of(index).parent.mkdir(parents=True, exist_ok=True)
            many.path_of(index).touch()
        print(f"| counted | {many.sweep.blocks} blocks | {seconds(many.present):.3f} |")
        figure5 = Store.create(Path(folder) / "figure5", planned(20, 50, grid={"n_theta": 48, "n_z": 48}))
        for index in range(figure5.sweep.blocks):
            figure5.write(index, fakes.arrays(figure5.sweep, 0))
        opened = seconds(lambda: open_sweep(figure5.path))
        print(f"| opened | {figure5.sweep.blocks} blocks, {figure5.sweep.members} members | {opened:.2f} |")


if __name__ == "__main__":
    main()
