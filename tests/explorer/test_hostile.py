"""A real server, real sockets and hostile clients: it answers, refuses in a sentence, and stays small."""

import asyncio
import importlib
import json
import math
import time

import jax
import pytest

from cyclosis.explorer import setup, work
from cyclosis.model.errors import InputError

attacks, clients, hostile = map(importlib.import_module, ("attacks", "clients", "hostile"))
SMALL = {"do": "begin", "setup": {"grid": {"n_theta": 16, "n_z": 16}}}


@pytest.fixture
def port(server):
    """Yield the port; see afterwards that a visitor is served as before, and that memory has not grown."""
    port, process = server
    before = process.memory_info().rss
    yield port
    assert process.is_running()
    assert clients.get(port, "/api/about")[0] == 200
    end = time.monotonic() + 60
    while True:
        try:
            with clients.visit(port) as wire:
                wire.send(json.dumps(SMALL))
                assert clients.said(wire, "cell")["t"] == 0.0
            break
        except clients.GONE:  # those who are gone may have asked for work that is still under way
            assert time.monotonic() < end
            time.sleep(0.2)
    assert process.memory_info().rss - before < 300 * 2**20


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("malformed", "closed, 1000"),
        ("huge", "closed, 1009"),
        ("bomb", "closed, 1002"),
        ("fragments", "cut off"),
        ("pings", "cut off"),
        ("tiny", "cut off"),
        ("strangers", "InvalidStatus"),
        # Its visitors keep their places for up to ten seconds after they have left.
        pytest.param(
            "crowd",
            "This server has 8 sessions and all are taken: try again later.",
            marks=pytest.mark.slow,
        ),
        ("unread", "read no further"),
        ("tokens", "forgotten"),
        ("returns", "resumed"),
        ("bodies", "ConnectionResetError"),
        ("abrupt", "served"),
    ],
)
def test_a_hostile_client_is_answered_briefly(port, name, answer, monkeypatch):
    monkeypatch.setattr(attacks, "BEGIN", SMALL)
    found = ""
    for seconds in (0.5, 2.0, 8.0):  # a busy machine sends too little in half a second to be cut off
        found = attacks.ATTACKS[name](port, seconds)
        if answer in found:
            return
    raise AssertionError(found)


def test_more_random_numbers_than_the_grid_takes_are_refused(port):
    steps = [{"at": 0, "action": "fragment", "noise_grid": [8192, 8192]}]
    with clients.visit(port) as wire:
        clients.ask(wire, do="begin", link=clients.link_of(steps))
        assert "at most 128 x 128 in the explorer" in clients.said(wire, "refused")["sentence"]


@pytest.mark.parametrize(
    ("grid", "part"),
    [
        ({"shape": "cube"}, "shape = 'cube'"),
        ({"shape": "capsule", "length": -1}, "length = -1"),
        ({"shape": "capsule", "smoothing": 1e-9}, "smoothing = 1e-09"),
        ({"shape": "spheroid", "aspect": 1e300}, "aspect = 1e+300"),
        ({"shape": "spheroid", "aspect": "wide"}, "aspect = 'wide'"),
        ({"shape": "sphere", "k_max": 96}, "at most 24"),
        ({"shape": "capsule", "length": 60, "k_max": 24}, "at most 16384"),
        ({"shape": "sphere", "n_s": 4000}, "at most 16384"),
    ],
)
def test_a_malformed_shape_is_refused_in_a_sentence(port, grid, part):
    with clients.visit(port) as wire:
        clients.ask(wire, do="begin", setup={"model": {"kind": "closed"}, "grid": grid})
        sentence = clients.said(wire, "refused")["sentence"]
    assert part in sentence
    assert "\n" not in sentence


@pytest.mark.slow
def test_a_closed_cell_has_no_vacuole_to_look_into(port):
    with clients.visit(port) as wire:
        clients.ask(
            wire, do="begin", setup={"model": {"kind": "closed"}, "grid": {"shape": "sphere", "k_max": 4}}
        )
        assert clients.said(wire, "cell")["outline"]["axial"] is False
        clients.ask(wire, do="vacuole", on=True)
        assert "that of the cylinder" in clients.said(wire, "refused")["sentence"]
        clients.ask(wire, do="curves")
        assert clients.said(wire, "curves")["applies"] is False


def test_a_file_of_too_many_points_is_refused(port):
    status, body = clients.get(
        port, f"/api/export/run.nc?cell={clients.link_of([], 200.0, n_theta=128, n_z=128)}"
    )
    assert status == 400
    assert "at most 1000 in a file made here of 128 x 128 points" in json.loads(body)["sentence"]


def test_a_protocol_that_would_take_much_memory_is_refused(port):
    steps = [{"at": 0.1 * k, "action": "change", "d_s": 0.1} for k in range(99)]
    steps[0] |= {"where": {"shape": "disc", "theta": 1, "z": 1, "radius": 1}, "alpha_p": 0.5}
    del steps[0]["d_s"]
    with clients.visit(port) as wire:
        clients.ask(wire, do="begin", link=clients.link_of(steps, n_theta=128, n_z=128))
        assert "at most 32 on 128 x 128 points" in clients.said(wire, "refused")["sentence"]


def test_more_kinds_of_cell_than_there_is_memory_for_wait_until_others_have_left(monkeypatch):
    cleared = []
    monkeypatch.setattr(jax, "clear_caches", lambda: cleared.append(True))
    monkeypatch.setattr(work, "_compiled", {((8, 8), frozenset(), frozenset(), True)})
    monkeypatch.setattr(work, "MOST_KINDS", 1)
    shared, begun = work.Work(1), setup.from_tables(SMALL["setup"])
    shared.visits = 2
    with pytest.raises(InputError, match="while others are here"):
        asyncio.run(shared.opened(begun))
    shared.visits = 1
    assert asyncio.run(shared.opened(begun)).kind in work._compiled
    assert cleared
    shared.end()


def test_many_shapes_are_kinds_of_cell_that_are_bounded_too(monkeypatch):
    class Cell:
        def __init__(self, begun, ready):
            self.kind = work.kind_at(ready.schedule, ready.grid)

        def rehearse(self):
            pass

    monkeypatch.setattr(work, "Session", Cell)
    monkeypatch.setattr(jax, "clear_caches", lambda: None)
    monkeypatch.setattr(work, "_compiled", set())
    monkeypatch.setattr(work, "MOST_KINDS", 8)
    shared = work.Work(1)
    shared.visits = 1

    def sphere(k_max):
        return setup.from_tables({"model": {"kind": "closed"}, "grid": {"shape": "sphere", "k_max": k_max}})

    for k_max in (3, 4, 5):
        asyncio.run(shared.opened(sphere(k_max)))
        assert work.taken(work._compiled) == 4 * len(work._compiled) <= 8
    shared.visits = 2
    asyncio.run(shared.opened(sphere(3)))
    with pytest.raises(InputError, match="while others are here"):
        asyncio.run(shared.opened(sphere(4)))
    shared.end()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["none", *attacks.ATTACKS])
def test_no_attack_cuts_off_a_visitor_or_fills_the_memory(server, name):
    """How long the visitor waits, `python benchmarks/hostile.py` measures."""
    port, process = server
    _, wait, growth = hostile.under(name, port, process, 3.0)
    assert math.isfinite(wait)
    assert growth < 500
