"""Files of a cell: it is said how far they are, giving up ends the work on the server, a failure says why."""

import http.client
import importlib
import json
import time
from urllib.parse import quote

import pytest

from cyclosis.explorer import maker, setup
from cyclosis.model.errors import InputError
from measure.pages import makers

importlib.import_module("hostile")  # where the clients lie
CELL = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.2}}


def asked(port, name, t, tables=CELL):
    """Ask for a file and for words about it; return the connection and the answer."""
    link = setup.from_tables(tables, t=t).link()
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=120)
    connection.request("GET", f"/api/export/{name}?told=true&cell={quote(link)}")
    return connection, connection.getresponse()


def wait(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)


@pytest.mark.parametrize(
    ("name", "begins"),
    [("run.nc", b"\x89HDF"), pytest.param("movie.mp4", b"\0\0\0", marks=pytest.mark.slow)],
    ids=["data", "movie"],
)
def test_how_far_a_file_is_is_told_and_then_the_file(server, name, begins):
    port, _ = server
    connection, answer = asked(port, name, 40.0)
    lines = []
    while "bytes" not in (line := json.loads(answer.readline())):
        lines.append(line)
    data = answer.read()
    connection.close()
    assert len(data) == line["bytes"] > 1000
    assert data.startswith(begins)
    shares = [line["share"] for line in lines if line["share"] is not None]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] <= shares[-1] <= 1.0
    told = " ".join(line["doing"] for line in lines)
    assert "preparing the computation" in told
    if name == "movie.mp4":
        assert "of 144" in told


def test_giving_up_ends_the_work_and_lets_the_next_file_be_made(server):
    port, process = server
    large = {"grid": {"n_theta": 64, "n_z": 64}}
    connection, answer = asked(port, "run.nc", 390.0, large)
    answer.readline()
    wait(lambda: makers(process))
    waiting, second = asked(port, "run.nc", 390.0, large)
    assert "waiting" in json.loads(second.readline())["doing"]
    waiting.sock.close()
    second.close()
    connection.sock.close()
    answer.close()
    wait(lambda: not makers(process), 20)
    connection, answer = asked(port, "run.nc", 1.0)
    while "bytes" not in (line := json.loads(answer.readline())):
        pass
    assert len(answer.read()) == line["bytes"]


def test_a_maker_that_is_killed_is_said_to_be(server):
    port, process = server
    connection, answer = asked(port, "run.nc", 390.0, {"grid": {"n_theta": 64, "n_z": 64}})
    answer.readline()
    wait(lambda: makers(process))
    for child in makers(process):
        child.kill()
    while "sentence" not in (line := json.loads(answer.readline())):
        pass
    assert "memory ran out" in line["sentence"]
    assert answer.read() == b""
    connection.close()


def test_what_cannot_be_made_is_refused_before_anything_is_begun(server):
    port, _ = server
    connection, answer = asked(port, "run.nc", 0.0)
    assert answer.status == 400
    assert "let the cell run" in json.loads(answer.read())["sentence"]
    connection.close()


@pytest.mark.parametrize(
    ("error", "part"),
    [
        (InputError("frames", 1, "at least 2", "go on"), "frames = 1 cannot be used: it must be at least 2"),
        (MemoryError(), "not have enough memory"),
        (OSError(28, "No space left on device"), "No space left on device"),
        (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero"),
    ],
)
def test_a_failure_says_why(monkeypatch, capsys, tmp_path, error, part):
    def fails(*_):
        raise error

    monkeypatch.setattr(maker, "make", fails)
    assert maker.main(tmp_path / "run.nc", "") == 1
    sentence = json.loads(capsys.readouterr().out)["sentence"]
    assert part in sentence
    assert "\n" not in sentence


def test_a_run_that_ends_early_is_no_file(monkeypatch, tmp_path):
    cell = setup.from_tables(CELL, t=2.0)

    class Early:
        t_final = 1.0
        status = type("Status", (), {"value": "diverged"})

    monkeypatch.setattr(maker, "_run", lambda *_: Early())
    with pytest.raises(InputError, match="diverged at t = 1"):
        maker.make(tmp_path / "run.nc", cell.link(), maker.Words())
