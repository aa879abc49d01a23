"""The model written in other codes agrees with ours, and the page about them follows from its data."""

import importlib.util
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import cyclosis as cy

ROOT = Path(__file__).parents[1]
PEERS = ROOT / "benchmarks" / "peers"
COMPUTE = """
import importlib, sys
import numpy as np
import cyclosis as cy
module, n, dt, t, state, out = sys.argv[1:]
params = cy.Parameters(alpha_p=1.0, alpha_u=0.5)
advance = importlib.import_module(module).prepare(params, int(n), 2 * np.pi, float(dt), **HOW)
np.save(out, advance(np.load(state), float(t)))
"""


def page():
    spec = importlib.util.spec_from_file_location("peers_page", PEERS / "page.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def data():
    return json.loads((ROOT / "docs" / "data" / "peers.json").read_text())


@pytest.mark.parametrize(
    ("package", "module", "how", "dt", "within"),
    [
        ("cyclosis", "cyclosis_model", {"stepper": "etdrk4"}, 0.02, 1e-6),
        ("dedalus", "dedalus_model", {"scheme": "SBDF4"}, 0.01, 1e-5),
        ("dedalus", "dedalus_model", {"scheme": "RK443"}, 0.01, 1e-5),
        ("exponax", "exponax_model", {}, 0.02, 1e-6),
        ("pde", "pypde_model", {"derivatives": "fourier"}, 0.02, 1e-6),
        ("pde", "pypde_model", {"derivatives": "differences"}, 0.02, 0.05),
    ],
)
def test_the_model_in_another_code_agrees(package, module, how, dt, within, tmp_path):
    if find_spec(package) is None:
        pytest.skip(f"{package} is not installed: docs/peers.md says how to install it")
    n, t = 48, 1.0
    grid, params = cy.CylinderGrid(n, n, 2 * np.pi), cy.Parameters(alpha_p=1.0, alpha_u=0.5)
    state = cy.initial.disordered(grid, filaments_per_square=10, seed=1, noise_grid=(8, 8))
    np.save(tmp_path / "start.npy", state)
    # In a process of its own: these codes change settings of the process that loads them.
    given = [module, str(n), str(dt), str(t), tmp_path / "start.npy", tmp_path / "end.npy"]
    command = [sys.executable, "-c", COMPUTE.replace("HOW", repr(how)), *map(str, given)]
    done = subprocess.run(command, cwd=PEERS, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    ours = cy.simulate(params, grid, state, t, save_at=[t], rtol=1e-9).final_state
    found = np.load(tmp_path / "end.npy")
    assert np.linalg.norm(found - ours) < within * np.linalg.norm(ours)


def test_the_data_say_what_was_compared(data):
    assert set(data["about"]["versions"]) <= {"cyclosis", "dedalus", "exponax", "py-pde"}
    assert all(data["about"]["versions"].values())
    assert data["about"]["parameters"]["alpha_u"] == 0.5


def test_every_code_compared_was_accurate_enough(data):
    for case in data["cost"].values():
        assert case["error of the reference"] < 0.1 * data["about"]["tolerance"]
        for name, best in case["best"].items():
            assert best["error"] <= data["about"]["tolerance"]
            accurate = [one for one in case["tried"][name] if one["error"] and one["error"] <= 1e-4]
            assert best["seconds"] in sorted(one["seconds"] for one in accurate)[:3]
            assert len(best["timings"]) >= 3


def test_codes_agree_with_ours_as_their_order_says(data):
    for items in data["agreement"]["codes"].values():
        for item in items:
            assert item["errors"][-1] < 1e-5
            assert item["errors"][-1] <= item["errors"][0]


def test_ratios_follow_from_the_timings(data):
    found = page().ratios(data)
    for case, item in data["cost"].items():
        ours = min(item["best"]["cyclosis"]["timings"])
        for name, best in item["best"].items():
            assert found[name][case] == min(best["timings"]) / ours


def test_lines_of_code_are_counted_without_comments_and_docstrings():
    source = '"""Title."""\n\n# a comment\nx = 1  # counts\n\n\ndef f():\n    """Say."""\n    return 2\n'
    assert page().lines_of_code(source) == 3


def test_the_page_hides_no_case_in_which_another_code_is_faster(data):
    slow = [name for name, cases in page().ratios(data).items() if min(cases.values()) < 1]
    slow += [name for name, ratio in page().throughput(data).items() if ratio < 1]
    assert ("Ours is behind" in page().page()) == bool(slow)
