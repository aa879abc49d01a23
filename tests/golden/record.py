"""Record what must stay the same, on this kind of machine: `python tests/golden/record.py`.

Run it on a machine without records to add them, and whenever results are meant to change: the changelog then
says under "Results may differ" what has changed, and why. A change makes the records of other machines
outdated, so that they are deleted.
"""

import shutil
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from golden.cases import CASES
from golden.machine import RECORDS, file_of, kinds, machine


def main():
    own = RECORDS / machine()
    found = {name: case() for name, case in CASES.items()}
    if own.exists() and not all(same(file_of(own, name), found[name]) for name in CASES):
        for folder in kinds():
            shutil.rmtree(folder)
            print(f"deleted: {folder.name}")
    own.mkdir(parents=True, exist_ok=True)
    for name, values in found.items():
        np.savez_compressed(file_of(own, name), **values)


def same(path, values):
    """Return whether a file holds these numbers, bit for bit."""
    if not path.exists():
        return False
    with np.load(path) as stored:
        return set(stored.files) == values.keys() and all(
            stored[key].tobytes() == values[key].tobytes() for key in stored.files
        )


if __name__ == "__main__":
    main()
