"""Put deliberate faults into a copy of the program, one at a time, and see whether a test fails.

    python benchmarks/faults.py                     # all of faults.toml
    python benchmarks/faults.py pressure-sign ...   # only these

Each fault changes one line. It is caught if the few tests named for it, run on the copy, fail; a run that
breaks in another way does not count. All of these tests must first pass on a copy without fault. Results are
stored in docs/data/faults.json. Exits with 1 if a fault survives.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).parents[1]
RESULT = ROOT / "docs" / "data" / "faults.json"
AT_ONCE = 2
SECONDS = 300.0
"""Longest run of the tests of one fault."""


@dataclass(frozen=True)
class Fault:
    """A fragment `line` of a `file` of the package, what is put in its place, and tests that must fail."""

    name: str
    file: str
    line: str
    faulty: str
    tests: tuple[str, ...]

    def applied(self, text: str) -> str:
        """Return the text of the file with the fault. Raises `ValueError` unless `line` stands there once."""
        if text.count(self.line) != 1:
            raise ValueError(f"{self.name}: {text.count(self.line)} times in {self.file}: {self.line}")
        return text.replace(self.line, self.faulty)


def faults() -> list[Fault]:
    """Return the table of faults."""
    table = tomllib.loads((Path(__file__).with_suffix(".toml")).read_text())
    return [
        Fault(name, item["file"], item["line"], item["faulty"], tuple(item["tests"]))
        for name, item in table.items()
    ]


class Copy:
    """A copy of program and tests in a folder, and its tests' results."""

    def __init__(self, folder: Path, cache: Path) -> None:
        self.folder = folder
        ignored = shutil.ignore_patterns("__pycache__", "page")
        for name in ("src", "tests", "benchmarks"):  # whose scripts some tests use
            shutil.copytree(ROOT / name, folder / name, ignore=ignored)
        shutil.copy(ROOT / "pyproject.toml", folder)
        # Without bytecode, which would go by the time of a file and might outlive a fault.
        self.environment = os.environ | {
            "PYTHONPATH": str(folder / "src"),
            "PYTHONDONTWRITEBYTECODE": "1",
            "JAX_COMPILATION_CACHE_DIR": str(cache),
        }
        found = self._python("-c", "import cyclosis; print(cyclosis.__file__)").stdout.strip()
        if not Path(found).is_relative_to(folder):
            raise RuntimeError(f"the tests would run {found}, not the copy")

    def _python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=SECONDS,
        )

    def run(self, *tests: str) -> subprocess.CompletedProcess[str]:
        """Run tests of the copy up to the first that fails."""
        places = [f"tests/{test}" for test in tests]
        return self._python("-m", "pytest", "-x", "-q", "-rf", "-p", "no:cacheprovider", *places)

    def tried(self, fault: Fault) -> dict[str, object]:
        """Return what became of a fault."""
        path = self.folder / "src" / "cyclosis" / fault.file
        whole, began = path.read_text(), time.perf_counter()
        path.write_text(fault.applied(whole))
        try:
            code, told = (out := self.run(*fault.tests)).returncode, out.stdout
        except subprocess.TimeoutExpired:
            code, told = -1, ""
        finally:
            path.write_text(whole)
        failed = re.search(r"^FAILED tests/(.+?)(?: - |$)", told, re.MULTILINE)
        return {
            "name": fault.name,
            "file": fault.file,
            "line": fault.line,
            "faulty": fault.faulty,
            "outcome": {0: "survived", 1: "caught"}.get(code, f"broken ({code})"),
            "by": failed[1] if failed else "",
            "seconds": round(time.perf_counter() - began, 1),
        }


def store(results: list[dict[str, object]]) -> None:
    """Store results, and keep the earlier ones of faults that were not tried."""
    known = {item["name"]: item for item in json.loads(RESULT.read_text())} if RESULT.exists() else {}
    known |= {str(item["name"]): item for item in results}
    kept = [known[fault.name] for fault in faults() if fault.name in known]
    RESULT.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="name")
    wanted = parser.parse_args().names
    chosen = [fault for fault in faults() if not wanted or fault.name in wanted]
    if unknown := set(wanted) - {fault.name for fault in chosen}:
        parser.error(f"no such fault: {min(unknown)}")
    with tempfile.TemporaryDirectory() as name:
        copies: Queue[Copy] = Queue()
        for number in range(AT_ONCE):
            copies.put(Copy(Path(name) / str(number), Path(name) / "compiled"))
        tests = sorted({test for fault in chosen for test in fault.tests})

        def on_a_copy(call):
            copy = copies.get()
            try:
                return call(copy)
            finally:
                copies.put(copy)

        with ThreadPoolExecutor(AT_ONCE) as pool:
            shares = [share for k in range(AT_ONCE) if (share := tests[k::AT_ONCE])]
            for out in pool.map(lambda share: on_a_copy(lambda copy: copy.run(*share)), shares):
                if out.returncode != 0:
                    print(out.stdout)
                    print("Without a fault these tests must pass.")
                    return 1
            print(f"Without a fault the tests named for {len(chosen)} faults pass.")
            results = []
            for result in pool.map(lambda fault: on_a_copy(lambda copy: copy.tried(fault)), chosen):
                results.append(result)
                print(
                    f"{result['outcome']:10} {result['seconds']:6.1f} s  {result['name']:36} {result['by']}"
                )
    caught = sum(result["outcome"] == "caught" for result in results)
    print(f"{caught} of {len(results)} faults caught.")
    store(results)
    return 0 if caught == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
