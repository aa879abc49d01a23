"""Ctrl-C and SIGTERM end a script that loops over runs, once what was done is safe."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset import parts
from cyclosis.dynamics.interrupts import Interrupts, terminable
from measure.files import SETTINGS, started, wait_for_parts

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters(d_s=0.1)
STATE = cy.initial.stripes(GRID)

LOOP = """
import signal, sys
import cyclosis as cy
{before}
params, grid = cy.Parameters(d_s=0.1), cy.CylinderGrid(32, 24, 5.0)
def begun(now):
    if now.t > 1.0:
        print("begun", flush=True)
for number in range(100):
    {call}
print("survived")
"""
RUN = """cy.simulate(
        params, grid, cy.initial.stripes(grid), t_end=1e6, save_every=1e5, stepper="etdrk4", dt=0.01,
        progress=begun, checkpoint=cy.RunWriter(f"run-{number}.nc"),
    )"""
RESUME = """cy.resume_file("run-0.nc", t_end=1e6, progress=begun)"""


def struck(folder, number, before="", call=RUN):
    """Start a script that loops, send it a signal once it computes; return its exit code and complaints."""
    process = subprocess.Popen(
        [sys.executable, "-c", LOOP.format(before=before, call=call)],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    line = process.stdout.readline()
    assert line == "begun\n", process.communicate()
    process.send_signal(number)
    said, complaints = process.communicate()
    assert "survived" not in said
    return process.returncode, complaints


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.slow
def test_a_script_that_loops_over_runs_ends_with_the_first_and_keeps_it(tmp_path, number):
    code, complaints = struck(tmp_path, number)
    assert code == -number
    assert ("KeyboardInterrupt" in complaints) is (number == signal.SIGINT)
    assert not parts.is_unfinished(tmp_path / "run-1.nc")
    run = cy.load(tmp_path / "run-0.nc")
    assert run.status == "interrupted"
    assert run.t_final > 1.0, "the checkpoint was written when the signal came"


@pytest.mark.slow
def test_a_script_that_resumes_ends_too_and_its_file_holds_the_run(tmp_path):
    cy.write(cy.simulate(PARAMS, GRID, STATE, 1.0, 1.0, stepper="etdrk4", dt=0.01), tmp_path / "run-0.nc")
    assert struck(tmp_path, signal.SIGINT, call=RESUME)[0] == -signal.SIGINT
    assert not parts.is_unfinished(tmp_path / "run-0.nc")
    assert cy.load(tmp_path / "run-0.nc").t_final > 1.0


HANDLER = """
def own(number, frame):
    print("own handler", cy.load("run-0.nc").t_final > 1.0, file=sys.stderr, flush=True)
    sys.exit(7)
signal.signal(signal.{name}, own)
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_handler_of_the_users_own_acts_once_the_file_is_safe(tmp_path, number):
    code, complaints = struck(tmp_path, number, before=HANDLER.format(name=number.name))
    assert code == 7
    assert "own handler True" in complaints
    assert not parts.is_unfinished(tmp_path / "run-1.nc")


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM])
def test_the_command_line_ends_gracefully(tmp_path, number):
    arguments = ["run", *SETTINGS, "--out", "run.nc", "--checkpoint-seconds", "0"]
    process = started(tmp_path, *arguments)
    wait_for_parts(process, tmp_path / "run.nc")
    process.send_signal(number)
    said = process.communicate()[0]
    assert process.returncode == 130
    assert "cyclosis resume run.nc" in said
    assert not parts.is_unfinished(tmp_path / "run.nc")
    assert cy.load(tmp_path / "run.nc").status == "interrupted"


def striking(number, at):
    """Return a progress callback that sends this process a signal once, at a time of the run."""
    sent = []

    def strike(now):
        if now.t >= at and not sent:
            sent.append(now.t)
            os.kill(os.getpid(), number)

    return strike


def test_ctrl_c_hands_over_the_run_so_far_and_it_goes_on():
    saved = []
    with pytest.raises(KeyboardInterrupt) as stopped:
        cy.simulate(
            PARAMS, GRID, STATE, 50.0, 1.0, progress=striking(signal.SIGINT, 2.0), checkpoint=saved.append
        )
    part = stopped.value.run
    assert part.status == "interrupted"
    assert 2.0 <= part.t_final < 50.0
    assert saved[-1].t_final == part.t_final
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    whole = cy.simulate(PARAMS, GRID, STATE, 50.0, 1.0)
    assert np.array_equal(cy.resume(part).final_state, whole.final_state)


def test_a_handler_that_returns_lets_the_run_go_on():
    heard, saved = [], []
    previous = signal.signal(signal.SIGTERM, lambda number, frame: heard.append((number, len(saved))))
    try:
        run = cy.simulate(
            PARAMS, GRID, STATE, 50.0, 1.0, progress=striking(signal.SIGTERM, 2.0), checkpoint=saved.append
        )
    finally:
        signal.signal(signal.SIGTERM, previous)
    assert heard == [(signal.SIGTERM, 2)], "once, after a checkpoint beside the first"
    assert run.status == "completed"
    assert np.array_equal(run.final_state, cy.simulate(PARAMS, GRID, STATE, 50.0, 1.0).final_state)


def test_a_signal_at_the_very_end_is_not_lost():
    """The run is complete, and yet the script was told to end."""
    with pytest.raises(KeyboardInterrupt) as stopped:
        cy.simulate(PARAMS, GRID, STATE, 2.0, 2.0, progress=striking(signal.SIGINT, 2.0))
    assert stopped.value.run.status == "completed"


def test_what_is_ignored_stays_ignored():
    previous = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        run = cy.simulate(PARAMS, GRID, STATE, 5.0, 1.0, progress=striking(signal.SIGINT, 1.0))
    finally:
        signal.signal(signal.SIGINT, previous)
    assert run.status == "completed"


def test_an_exception_on_the_way_does_not_swallow_the_signal():
    def strike(now):
        os.kill(os.getpid(), signal.SIGINT)
        raise ZeroDivisionError

    with pytest.raises(KeyboardInterrupt) as stopped:
        cy.simulate(PARAMS, GRID, STATE, 50.0, 1.0, progress=strike)
    assert isinstance(stopped.value.__context__, ZeroDivisionError)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_second_signal_acts_at_once():
    def twice():
        with Interrupts() as interrupts:
            os.kill(os.getpid(), signal.SIGINT)
            assert interrupts.asked
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1.0)

    with pytest.raises(KeyboardInterrupt) as stopped:
        twice()
    assert not hasattr(stopped.value, "run")


def test_in_another_thread_nothing_changes():
    found = []
    thread = threading.Thread(target=lambda: found.append(cy.simulate(PARAMS, GRID, STATE, 1.0).status))
    thread.start()
    thread.join()
    assert found == ["completed"]


def test_sigterm_becomes_ctrl_c_only_where_nobody_has_decided():
    with terminable():
        assert signal.getsignal(signal.SIGTERM) is signal.default_int_handler
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    previous = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with terminable():
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, previous)
