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
        ("numba pyfftw", "numba_model", {}, 0.02, 1e-6),
        ("pde", "pypde_model", {"derivatives": "fourier"}, 0.02, 1e-6),
        ("pde", "pypde_model", {"derivatives": "differences"}, 0.02, 0.05),
    ],
)
def test_the_model_in_another_code_agrees(package, module, how, dt, within, tmp_path):
    if not all(find_spec(part) for part in package.split()):
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
    for about in (data["about"], data["grids"]["about"], data["members"]["about"]):
        assert set(about["versions"]) <= {"cyclosis", "numba", "dedalus", "exponax", "py-pde"}
        assert all(about["versions"].values())
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


def test_runs_on_every_grid_were_accurate_enough_and_ratios_follow_from_the_timings(data):
    module = page()
    for size in data["grids"]["sizes"].values():
        assert {"cyclosis", "exponax", "numba"} <= set(size["codes"])
        for code in size["codes"].values():
            assert all(one["error"] <= data["about"]["tolerance"] for one in code["runs"])
            assert min(code["seconds a right-hand side"]) > 0
    found = module.grid_ratios(data, module.right_hand_sides)
    size = data["grids"]["sizes"]["64"]["codes"]
    theirs, ours = (size[name]["seconds a right-hand side"] for name in ("numba", "cyclosis"))
    assert found["numba"][64] == np.median(np.divide(theirs, ours))
    assert set(found["cyclosis"].values()) == {1.0}


def test_a_run_that_was_made_once_is_compared_with_ours_of_the_same_turn():
    module = page()

    def code(*timings):
        return {"runs": [{"timings": list(timings)}]}

    size = {"n": 64, "t": 2.0, "codes": {"cyclosis": code(1.0, 2.0, 4.0), "numba": code(3.0)}}
    assert module.grid_ratios({"grids": {"sizes": {"64": size}}}, module.runs)["numba"] == {64: 3.0}


def test_members_were_timed_in_turns_and_are_about_as_accurate_as_one_cell(data):
    found = data["members"]
    assert found["members"] == 1000
    assert {way["code"] for way in found["ways"].values()} == {"cyclosis", "exponax", "numba"}
    for way in found["ways"].values():
        assert len(way["timings"]) >= 2
        assert max(way["errors"]) < 5 * data["about"]["tolerance"]


def test_lines_of_code_are_counted_without_comments_and_docstrings():
    source = '"""Title."""\n\n# a comment\nx = 1  # counts\n\n\ndef f():\n    """Say."""\n    return 2\n'
    assert page().lines_of_code(source) == 3


def test_the_page_hides_no_case_in_which_another_code_is_faster(data):
    slow = [name for name, cases in page().ratios(data).items() if min(cases.values()) < 1]
    slow += [name for name, ratio in page().throughput(data).items() if ratio < 1]
    on_grids = page().grid_ratios(data, page().runs)
    slow += [name for name, ratios in on_grids.items() if min(ratios.values()) < 1]
    assert ("Ours is behind" in page().page()) == bool(slow)


def test_the_page_names_every_grid_on_which_another_code_is_faster(data):
    module, text = page(), page().page()
    for measure in (module.right_hand_sides, module.runs):
        for name, ratios in module.grid_ratios(data, measure).items():
            slow = ", ".join(str(n) for n in sorted(ratios) if ratios[n] < 1)
            assert not slow or f"{module.TITLES[name]} on {slow} points" in text
