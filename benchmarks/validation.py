"""Every number by which the model is validated, beside its bound, as Markdown tables.

    python benchmarks/validation.py                     # all, some ten minutes
    python benchmarks/validation.py profile dispersion  # some

The same functions measure in the tests of `tests/physics`. The exit code is 0 only if all bounds are met.
"""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

SECTIONS = {
    "reference": "Reference fields",
    "right_hand_side": "One right-hand side",
    "manufactured": "Manufactured solution",
    "dispersion": "Growth of small disturbances",
    "profile": "Steady cyclosis",
    "laws": "Laws",
    "spectra": "Spectra of stripes",
    "thresholds": "Thresholds of existence and stability",
    "whole_cell": "Modes of the whole cell",
    "continuation": "Branches of states",
    "kinetic": "The kinetic model",
    "vacuole": "The flow in the vacuole",
    "closed": "Closed cells",
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sections", nargs="*", metavar="section", help="any of " + ", ".join(SECTIONS))
    chosen = parser.parse_args().sections or list(SECTIONS)
    unknown = set(chosen) - set(SECTIONS)
    if unknown:
        parser.error(f"no section {min(unknown)}: choose from " + ", ".join(SECTIONS))
    failed = 0
    for name in chosen:
        print(f"\n## {SECTIONS[name]}\n\n| case | quantity | measured | bound |\n|---|---|---:|---:|")
        for row in import_module(f"measure.{name}").rows():
            failed += not row.ok
            verdict = "" if row.ok else " **missed**"
            cells = (text.replace("|", "\\|").replace("<", "\\<") for text in (row.law, row.quantity))
            print("| " + " | ".join([*cells, f"{row.value:.3g}", row.bound + verdict]) + " |", flush=True)
    print(f"\n{'All bounds met.' if not failed else f'{failed} bounds missed.'}")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
