"""The table of deliberate faults fits the code: each is one change that can be made, and still is Python."""

import ast
import importlib.util
import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def loaded(name):
    spec = importlib.util.spec_from_file_location(f"benchmark_{name}", ROOT / "benchmarks" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look there
    spec.loader.exec_module(module)
    return module


FAULTS = loaded("faults").faults()


def test_there_are_enough():
    assert len(FAULTS) >= 26
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_can_be_made(fault):
    text = (ROOT / "src" / "cyclosis" / fault.file).read_text()
    assert "\n" not in fault.line + fault.faulty
    assert ast.dump(ast.parse(fault.applied(text))) != ast.dump(ast.parse(text))
    for test in fault.tests:
        file, _, name = test.partition("::")
        assert f"def {name.partition('[')[0]}" in (ROOT / "tests" / file).read_text(), test


def test_the_measured_tables_are_those_stored():
    quality = loaded("quality")
    assert quality.PAGE.read_text() == quality.page(), "run python benchmarks/quality.py"
    names = {result["name"] for result in json.loads(quality.FAULTS.read_text())}
    assert names == {fault.name for fault in FAULTS}, "run python benchmarks/faults.py"
