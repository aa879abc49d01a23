"""What is said while things are computed, on a terminal and where there is none."""

import io
import sys
import time

import pytest

import cyclosis as cy
from cyclosis import progress
from cyclosis.dynamics.run import Snapshot
from measure.commandline import said

GRID = cy.CylinderGrid(16, 16, 5.0)
STATE = cy.initial.stripes(GRID)


class Terminal(io.StringIO):
    def isatty(self):
        return True


def shown(stream, words):
    """Wait until some words are on a stream; fail if they never come."""
    for _ in range(600):
        if words in stream.getvalue():
            return True
        time.sleep(0.05)
    return False


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(progress, "LINE_SECONDS", 0.02)


@pytest.fixture
def onto(monkeypatch):
    """Put a stream in the place of standard error, from within a test: pytest puts its own there before."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")

    def put(stream):
        monkeypatch.setattr(sys, "stderr", stream)
        return stream

    return put


@pytest.mark.parametrize("kind", [Terminal, io.StringIO])
def test_a_run_says_what_it_is_doing_from_the_very_start(kind, onto, quick):
    stream = onto(kind())
    with progress.RunProgress() as bar:
        assert shown(stream, "preparing")
        assert "compiling" not in stream.getvalue()
        bar.follow(cy.models.polar.problem(cy.Parameters(), GRID), lambda t: cy.Parameters())
        assert shown(stream, "compiling")
        bar(Snapshot(1.0, 8.0, STATE, 0.1))
        bar(Snapshot(2.0, 8.0, STATE, 0.2))
        for words in ("t = 2", "left", "cyclosis" if stream.isatty() else "t = 2 of 8"):
            assert shown(stream, words)
        bar.label("saving")
        assert shown(stream, "saving")


def test_other_work_without_a_terminal_gets_its_lines_too(onto, quick):
    stream = onto(io.StringIO())
    with progress.Bar("frames") as bar:
        assert shown(stream, "preparing frames")
        bar(3, 12)
        assert shown(stream, " s: 3 of 12 frames\n")
    told = stream.getvalue()
    time.sleep(0.1)
    assert stream.getvalue() == told, "nothing is said once it is over"


@pytest.mark.parametrize("kind", [Terminal, io.StringIO])
def test_nothing_is_said_where_nothing_is_to_be_seen(kind, onto, quick):
    stream = onto(kind())
    with progress.RunProgress(hidden=True) as bar:
        bar.follow(cy.models.polar.problem(cy.Parameters(), GRID), lambda t: cy.Parameters())
        bar(Snapshot(1.0, 8.0, STATE, 0.1))
        time.sleep(0.2)
    with progress.Bar("frames", hidden=True) as bar:
        bar(3, 12)
        time.sleep(0.2)
    assert stream.getvalue() == ""


def test_without_any_stream_for_errors(onto, quick):
    onto(None)
    with progress.RunProgress() as bar:
        bar(Snapshot(1.0, 8.0, STATE, 0.1))
        time.sleep(0.1)


def test_a_command_compiles_under_its_own_name(tmp_path, monkeypatch, quick):
    """The line that says "compiling" comes before the first step, however long that takes."""
    from cyclosis.dynamics import simulate

    def slow(*arguments, **rest):
        time.sleep(0.3)
        return whole(*arguments, **rest)

    whole = simulate.simulate
    monkeypatch.setattr(simulate, "simulate", slow)
    own = ("run", "--n-theta", "16", "--n-z", "16", "--t-end", "1", "--out")
    code, _, err = said(*own, tmp_path / "a.nc")
    assert code == 0
    assert ": compiling\n" in err
    assert said(*own, tmp_path / "b.nc", "--quiet") == (0, "", "")
