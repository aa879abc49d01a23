"""Record what must stay the same: `python tests/golden/record.py`, whenever results are meant to change.

The changelog then says under "Results may differ" what has changed, and why.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from golden.cases import CASES
from golden.machine import machine

FOLDER = Path(__file__).parent


def main():
    for name, case in CASES.items():
        np.savez_compressed(FOLDER / f"{name.replace(' ', '-')}.npz", machine=machine(), **case())


if __name__ == "__main__":
    main()
