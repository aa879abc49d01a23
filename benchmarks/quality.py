"""Write the measured tables of docs/quality.md from docs/data/faults.json and docs/data/coverage.json.

python benchmarks/quality.py                    # from what is stored
python benchmarks/quality.py .coverage.json     # first store a new coverage report, part by part
"""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
PAGE, FAULTS, COVERAGE = DOCS / "quality.md", DOCS / "data" / "faults.json", DOCS / "data" / "coverage.json"
PARTS = ("statements", "statements_run", "branches", "branches_run")


def rooms(report: dict) -> dict[str, dict[str, int]]:
    """Return what was run of every part of the package, from a report of coverage.py."""
    out: dict[str, Counter[str]] = {}
    for path, told in sorted(report["files"].items()):
        inside = path.partition("cyclosis/")[2].split("/")
        room, found = inside[0] if len(inside) > 1 else "(top)", told["summary"]
        numbers = (
            found[key] for key in ("num_statements", "covered_lines", "num_branches", "covered_branches")
        )
        out.setdefault(room, Counter()).update(dict(zip(PARTS, numbers, strict=True)) | {"files": 1})
    return {room: dict(numbers) for room, numbers in out.items()}


def coverage(measured: dict[str, dict[str, int]]) -> str:
    """Return the table of coverage by part."""
    out = "| part | files | statements | run, % | branches | run, % |\n|---|---:|---:|---:|---:|---:|\n"
    whole = Counter()
    for room, numbers in measured.items():
        whole.update(numbers)
        out += _row(f"`{room}`", numbers)
    return out + _row("all", whole)


def _row(name: str, numbers: dict[str, int]) -> str:
    lines, branches = (
        f"{100 * numbers[f'{part}_run'] / numbers[part]:.1f}" if numbers[part] else "-"
        for part in ("statements", "branches")
    )
    return (
        f"| {name} | {numbers['files']} | {numbers['statements']} | {lines} "
        f"| {numbers['branches']} | {branches} |\n"
    )


def faults(results: list[dict]) -> str:
    """Return the table of deliberate faults."""
    caught = sum(result["outcome"] == "caught" for result in results)
    out = f"{caught} of {len(results)} faults are caught.\n\n"
    out += "| fault | in | original | changed to | first test that fails |\n|---|---|---|---|---|\n"
    for item in results:
        cells = [f"`{item[key].strip()}`".replace("|", "\\|") for key in ("file", "line", "faulty")]
        by = f"`{item['by']}`" if item["by"] else item["outcome"]
        out += f"| {item['name']} | " + " | ".join((*cells, by)) + " |\n"
    return out


def page() -> str:
    """Return the page with its tables as they are stored."""
    text = PAGE.read_text()
    tables = {
        "faults": faults(json.loads(FAULTS.read_text())),
        "coverage": coverage(json.loads(COVERAGE.read_text())),
    }
    for name, table in tables.items():
        part = re.compile(rf"(<!-- {name}: [^\n]*-->\n).*?(<!-- end -->)", re.DOTALL)
        text = part.sub(lambda found, table=table: f"{found[1]}\n{table}\n{found[2]}", text)
    return text


if __name__ == "__main__":
    for report in sys.argv[1:]:
        COVERAGE.write_text(json.dumps(rooms(json.loads(Path(report).read_text())), indent=1) + "\n")
    PAGE.write_text(page())
