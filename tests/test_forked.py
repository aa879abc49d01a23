"""A process that is forked after JAX has run is told so at once; one forked before it computes."""

import json
import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

BEGIN = """
import multiprocessing, sys, warnings
warnings.simplefilter("ignore")
import cyclosis as cy
params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
state = cy.initial.stripes(grid)
"""
TASKS = """
def simulated(_): return len(cy.simulate(params, grid, state, t_end=0.1).times)
def flowing(_): return cy.flow(params, grid, state).shape
def steady(_): return cy.stability.stripes(params, 2, 64).spectrum(2).eigenvalues.shape
def followed(_): return cy.ensemble.follow([cy.ensemble.Member(params, grid, lambda: state)])
def traced(_): return cy.traced.flow(params, grid, state, precision="float32").shape
def asked(task):
    with multiprocessing.get_context("fork").Pool(1) as pool:
        try:
            return pool.apply_async(task, (0,)).get(60)
        except multiprocessing.TimeoutError:
            return "hangs"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
"""
COMMAND = """
from cyclosis import cli
def command(_):
    sys.argv = ["cyclosis", "run", "--t-end", "0.1", "--n-theta", "16", "--n-z", "16", "--out", "forked.nc"]
    try:
        cli.main()
    except SystemExit as error:
        return error.code
"""


TOLD = {
    "fresh": "(asked(flowing), asked(simulated))",  # and the child of the fork, until it has computed itself
    "jax alone": "jnp.zeros(2) + 1 is not None and asked(flowing)",
    **{
        task: f"cy.flow(params, grid, state) is not None and asked({task})"
        for task in ("simulated", "flowing", "steady", "followed", "traced", "noisy", "command")
    },
}
"""What one process does in this order, each in a fork of its own, and prints."""


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What a fresh process prints, by name, and its errors; what hangs is told as such."""
    code = f"{BEGIN}{TASKS}{COMMAND}\nimport json\nimport jax.numpy as jnp\n"
    code += "def noisy(_): return cy.initial.noise(grid).shape\n"
    code += "".join(f"print(json.dumps([{name!r}, {does}]), flush=True)\n" for name, does in TOLD.items())
    out = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=900,
        cwd=tmp_path_factory.mktemp("forked"),
    )
    return dict(map(json.loads, out.stdout.splitlines())), out.stderr


@pytest.mark.parametrize("task", ["simulated", "flowing", "steady", "followed", "traced"])
def test_a_fork_of_a_process_that_has_computed_is_refused_with_the_remedy(task, told):
    out, errors = told
    assert out[task].startswith("ForkedError: this process was forked"), errors
    assert 'get_context("spawn")' in out[task], errors


def test_a_fork_after_jax_alone_was_used_is_refused_too(told):
    out, errors = told
    assert out["jax alone"].startswith("ForkedError: "), errors


def test_a_fork_before_anything_was_computed_works(told):
    """And so does its own child, until it has computed itself."""
    out, errors = told
    assert out["fresh"] == [[2, 16, 16], 2], errors


def test_what_a_fork_may_do_without_computing(told):
    out, errors = told
    assert out["noisy"] == [2, 16, 16], errors


def test_the_command_line_says_it_in_a_sentence(told):
    out, errors = told
    assert out["command"] == 1, errors
    assert "cyclosis: this process was forked" in errors, errors
    assert "Traceback" not in errors
    assert "report it" not in errors


def test_a_spawned_process_computes(tmp_path):
    (tmp_path / "work.py").write_text(
        f"{BEGIN}{TASKS}\nif __name__ == '__main__':\n"
        "    cy.flow(params, grid, state)\n"
        "    with multiprocessing.get_context('spawn').Pool(1) as pool:\n"
        "        print(pool.map(flowing, [0]))\n"
    )
    out = subprocess.run(
        [sys.executable, "work.py"], capture_output=True, text=True, timeout=300, cwd=tmp_path
    )
    assert out.stdout == "[(2, 16, 16)]\n", out.stdout + out.stderr
