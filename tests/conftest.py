"""What all tests share: they can import the benchmarks, and forget compiled programs in time.

A process of the tests forgets them before it has more of them than the system allows.
"""

import gc
import itertools
import sys
from pathlib import Path

# Attacks of the explorer run in processes of their own, which find them here as well.
sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))

MAPS, LIMIT = Path("/proc/self/maps"), Path("/proc/sys/vm/max_map_count")
SHARE = 0.5
"""Share of the memory maps that Linux allows at which programs are forgotten: each takes several."""
EVERY = 20
"""Tests between two looks at them."""
tests = itertools.count(1)


def pytest_runtest_teardown():
    """Forget all compiled programs when they hold many maps: one map too many ends the process."""
    if next(tests) % EVERY or not (MAPS.exists() and LIMIT.exists()):
        return
    with MAPS.open() as listed:
        held = sum(1 for _ in listed)
    if held > SHARE * int(LIMIT.read_text()):
        import jax

        jax.clear_caches()
        gc.collect()
