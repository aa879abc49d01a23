"""Kill runs at random moments, resume them, and compare every bit with an undisturbed run.

    python benchmarks/crashes.py --rounds 50

Each round kills a run and its resumption with SIGKILL, checks that what is left opens, resumes to the
end, and compares all variables. Exits with 1 if any round went wrong.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from measure.files import killing


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        wrong = killing(Path(folder), arguments.rounds, arguments.seed)
    for text in wrong:
        print(text)
    print(f"{arguments.rounds} rounds, {len(wrong)} wrong")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
