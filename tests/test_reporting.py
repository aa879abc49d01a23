"""Progress of calls in Python: shown where somebody can see it, nowhere else, and without any effect."""

import io
import sys
import types

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.display import progress as display
from cyclosis.ensemble import EnsembleSettings, Member, follow
from cyclosis.model import reporting

GRID = cy.CylinderGrid(16, 16)
STATE = cy.initial.stripes(GRID)


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Handle:
    """What `IPython.display.display` returns: it keeps what it was given in turn."""

    def __init__(self):
        self.seen = []

    def update(self, html):
        self.seen.append(html)


@pytest.fixture
def stream(monkeypatch):
    """Return a function that replaces standard error, with progress shown from the first moment."""
    monkeypatch.setattr(reporting, "DELAY", -1.0)
    monkeypatch.setattr(display, "_silent", False)
    monkeypatch.setattr(display.multiprocessing, "parent_process", lambda: None)
    for surface in (display.Terminal, display.Notebook, display.Lines):
        monkeypatch.setattr(surface, "every", 0.0)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")

    def put(kind):
        made = kind()
        monkeypatch.setattr(sys, "stderr", made)
        return made

    return put


@pytest.fixture
def notebook(monkeypatch):
    handle = Handle()
    shell = types.SimpleNamespace(kernel=object())
    module = types.SimpleNamespace(get_ipython=lambda: shell)
    shown = types.SimpleNamespace(HTML=str, display=lambda html, display_id: handle)
    monkeypatch.setitem(sys.modules, "IPython", module)
    monkeypatch.setitem(sys.modules, "IPython.display", shown)
    return handle


def run(**given):
    return cy.simulate(cy.Parameters(), GRID, STATE, t_end=1.0, **given)


def test_a_terminal_shows_a_bar_that_changes_no_bit(stream):
    plain = run(progress=False)
    terminal = stream(Terminal)
    assert np.array_equal(run().final_state, plain.final_state)
    assert "simulate: t = " in terminal.getvalue()
    assert terminal.getvalue().endswith("\x1b[2K"), "the bar is removed"


@pytest.mark.parametrize("progress", [None, False])
def test_a_script_without_a_terminal_is_silent(stream, progress):
    script = stream(io.StringIO)
    run(progress=progress)
    assert script.getvalue() == ""


def test_it_is_off_by_one_argument_and_prints_lines_by_one(stream):
    terminal = stream(Terminal)
    run(progress=False)
    assert terminal.getvalue() == ""
    script = stream(io.StringIO)
    run(progress=True)
    assert script.getvalue().splitlines()[-1] == "100 %, simulate: t = 1.0 of 1"


def test_a_short_call_shows_nothing(stream, monkeypatch):
    monkeypatch.setattr(reporting, "DELAY", 1e3)
    terminal = stream(Terminal)
    run()
    assert terminal.getvalue() == ""


def test_a_worker_and_the_command_line_show_nothing_by_default(stream, monkeypatch):
    terminal = stream(Terminal)
    display.leave_to_the_command()
    run()
    monkeypatch.setattr(display, "_silent", False)
    monkeypatch.setattr(display.multiprocessing, "parent_process", object)
    run()
    assert terminal.getvalue() == ""


def test_a_notebook_has_one_line_that_is_updated_in_place(stream, notebook):
    script = stream(io.StringIO)
    run()
    *lines, last = notebook.seen
    assert lines
    assert all('<progress max="1" value="' in line for line in lines)
    assert "simulate: t = 1.0 of 1" in lines[-1]
    assert last == "", "it is removed at the end"
    assert script.getvalue() == ""


def test_an_interrupted_call_removes_its_bar(stream, notebook, monkeypatch):
    stream(io.StringIO)

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(display.Notebook, "show", stop)
    with pytest.raises(KeyboardInterrupt):
        run()
    assert notebook.seen == [""]


def test_members_are_counted(stream, notebook):
    seen = []
    members = [Member(cy.Parameters(), GRID, lambda: STATE)] * 3
    how = EnsembleSettings(t_end=1.0, finish="t_end")
    follow(members, how, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(1, 3), (2, 3), (3, 3)]
    stream(io.StringIO)
    follow(members, how)
    assert "follow: 3 of 3" in notebook.seen[-2]


@pytest.mark.parametrize("value", ["no", 3, [True]])
def test_anything_else_is_refused(value):
    with pytest.raises(cy.InputError, match="True, False, None or a function"):
        run(progress=value)
