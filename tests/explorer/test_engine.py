"""The numbers that the engine in the browser is held to are those of the library."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "web" / "tests" / "golden"
if not (FOLDER / "make.py").is_file():
    pytest.skip("not in a checkout", allow_module_level=True)
SPEC = importlib.util.spec_from_file_location("golden_of_the_engine", FOLDER / "make.py")
make = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(make)
# Those that share one compiled program, on one grid with numbers as parameters and a cubic force, are fast.
FAST = make.cases()[:8]
SLOW = make.cases()[8:]


def stored(name):
    return json.loads((FOLDER / name).read_text())


def check_rate(case):
    found = make.right_hand_side(case)
    (old,) = (item for item in stored("rates.json")["cases"] if item["name"] == case["name"])
    rate, expected = make.unpacked(found.pop("rate")), make.unpacked(old.pop("rate"))
    assert np.abs(rate - expected).max() < 1e-13 * np.abs(expected).max()
    assert json.loads(json.dumps(found)) == old


def test_right_hand_sides():
    for case in FAST:
        check_rate(case)


@pytest.mark.slow
def test_right_hand_sides_of_other_kinds():
    for case in SLOW:
        check_rate(case)


def test_states_of_right_hand_sides():
    for name, text in stored("rates.json")["states"].items():
        state = make.given_state(*map(int, name.split(" x ")))
        assert make.unpacked(text).tolist() == state.ravel().tolist()


def test_random_numbers():
    assert make.noise() == stored("noise.json")


def test_initial_states():
    for new, old in zip(make.initial_states(), stored("initial.json"), strict=True):
        assert new["table"] == old["table"]
        np.testing.assert_allclose(make.unpacked(new["state"]), make.unpacked(old["state"]), atol=1e-15)


def test_links():
    assert json.loads(json.dumps(make.links())) == stored("links.json")


def test_colours():
    assert json.loads(json.dumps(make.colours())) == stored("colours.json")


def test_settings_and_presets():
    assert json.loads(json.dumps(make.catalogue())) == stored("catalogue.json")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["steps.json", "run.json", "protocols.json", "regimes.json", "ends.json"])
def test_runs(name):
    alike(json.loads(json.dumps(make.FILES[name]())), stored(name))


def alike(new, old):
    """Compare tables; fields and other numbers that are computed may differ by rounding."""
    if isinstance(old, dict):
        assert new.keys() == old.keys()
        for key, value in old.items():
            if key in ("state", "flow"):
                np.testing.assert_allclose(make.unpacked(new[key]), make.unpacked(value), atol=1e-9)
            else:
                alike(new[key], value)
    elif isinstance(old, list):
        assert len(new) == len(old)
        for pair in zip(new, old, strict=True):
            alike(*pair)
    elif isinstance(old, float):
        assert new == pytest.approx(old, rel=1e-6, abs=1e-8)
    else:
        assert new == old
