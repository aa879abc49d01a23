"""A lost connection costs no cell: both sides notice, and the visitor goes on from the same state."""

import asyncio
import contextlib
import importlib
import json
import struct
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from fastapi.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from cyclosis.explorer import ahead, line, presets, setup, work
from cyclosis.explorer.on_cylinder import OnCylinder
from cyclosis.explorer.server import ServerLimits, application
from cyclosis.explorer.session import Session
from cyclosis.explorer.visits import Visits

clients, proxies = map(importlib.import_module, ("clients", "proxy"))
HOST = "http://localhost:8765"
reading = ThreadPoolExecutor(1)
"""Reads, so that a test that waits in vain fails."""
SETUP = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.2}}


@contextlib.contextmanager
def served(**limits):
    with TestClient(application(ServerLimits(**limits)), base_url=HOST) as client:
        yield client


def connect(client, **headers):
    return client.websocket_connect("/cell", headers={"host": "localhost:8765"} | headers)


def ask(socket, **words):
    socket.send_text(json.dumps(words))


def said(socket, *kinds, answers=True):
    """Return the next text of some kinds; draws whatever pictures come before."""
    end = time.monotonic() + 60
    while True:
        assert time.monotonic() < end, f"nothing of {kinds} was said"
        message = reading.submit(socket.receive).result(120)
        if message["type"] == "websocket.close":
            raise WebSocketDisconnect
        if message.get("text"):
            words = json.loads(message["text"])
            if words["type"] in kinds:
                return words
            if words["type"] == "alive" and answers:
                ask(socket, do="alive")
        elif answers:
            ask(socket, do="seen", frame=0)


def began(client):
    """Begin a cell and leave without a word; return the token."""
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        token = said(socket, "welcome")["token"]
        said(socket, "cell")
    return token


def answer_to(client, token, **headers):
    with connect(client, **headers) as socket:
        ask(socket, do="resume", token=token)
        return said(socket, "resumed", "forgotten")["type"]


@pytest.fixture
def proxy(server):
    with contextlib.closing(proxies.Proxy(server[0])) as proxy:
        yield proxy


@pytest.fixture
def page(proxy):
    page = Client(proxy.port)
    with page.visits:
        yield page


class Client:
    """A page over real sockets that keeps all it is told."""

    def __init__(self, port):
        self.port, self.token, self.times = port, "", []
        self.visits = contextlib.ExitStack()
        self.wire = self.connected()

    def connected(self):
        # Pings of the library's own would find out that the connection is dead.
        return self.visits.enter_context(clients.visit(self.port, ping_interval=None))

    def ask(self, **words):
        clients.ask(self.wire, **words)

    def until(self, kind, when=lambda words: True, seconds=60):
        """Return the next words of a kind, or the header of the next picture, for which a condition holds."""
        end = time.monotonic() + seconds
        while True:
            message = self.wire.recv(max(0.01, end - time.monotonic()))
            if isinstance(message, bytes):
                self.ask(do="seen", frame=0)
                size = struct.unpack("<I", message[:4])[0]
                words = {"type": "picture", **json.loads(message[8 : 8 + size])}
                start, rows = 8 + -(-size // 8) * 8, words["records"]
                self.times += np.frombuffer(message, "<f8", rows, start)[
                    :: 1 + len(OnCylinder.traces)
                ].tolist()
            else:
                words = json.loads(message)
                self.token = words.get("token", self.token)
                if words["type"] == "alive":
                    self.ask(do="alive")
            if words["type"] == kind and when(words):
                return words

    def resume(self):
        """Go on over another connection."""
        self.wire = self.connected()
        self.ask(do="resume", token=self.token)
        return self.until("resumed")


@pytest.mark.slow
def test_a_paused_cell_goes_on_bit_for_bit_after_its_connection_was_swallowed(proxy, page):
    page.ask(do="begin", setup=SETUP, n=1)
    page.ask(do="change", values={"alpha_p": 0.5}, n=2)
    page.ask(do="step", n=3)
    page.ask(do="hash")
    before = page.until("hash")
    page.ask(do="tell")
    cell = page.until("cell", lambda words: words["t"] == before["t"])
    proxy.swallowing.set()
    page.ask(do="change", values={"alpha_p": 0.9}, n=4)
    ended = proxy.ended
    wait(lambda: proxy.ended > ended, line.SILENCE + 60)  # the server has given the connection up
    proxy.swallowing.clear()
    resumed = page.resume()
    assert resumed["received"] == 3
    again = page.until("cell")
    assert not again["fresh"]
    for name in ("t", "link", "parameters", "begun", "playing", "done"):
        assert again[name] == cell[name]
    page.ask(do="hash")
    assert page.until("hash") == before
    page.ask(do="change", values={"alpha_p": 0.9}, n=4)
    assert page.until("cell")["parameters"]["alpha_p"] == 0.9


@pytest.mark.slow
def test_a_playing_cell_stands_still_and_loses_no_record(proxy, page):
    for words in ({"do": "begin", "setup": SETUP}, {"do": "speed", "value": 20}, {"do": "play"}):
        page.ask(**words)
    page.until("picture", lambda words: words["t"] > 3)
    proxy.swallowing.set()
    time.sleep(2 * line.QUIET)
    proxy.swallowing.clear()
    stood = page.times[-1] + 20 * (line.QUIET + 2.0)
    page.resume()
    cell = page.until("cell")
    assert cell["playing"]
    assert 3 < cell["t"] < stood
    page.until("picture", lambda words: words["t"] > cell["t"] + 1)
    page.ask(do="pause")
    page.ask(do="hash")
    found = page.until("hash")
    page.ask(do="tell")
    link = page.until("cell", lambda words: words["t"] == found["t"])["link"]
    other = Session(setup.from_link(link))
    while other.live.t < found["t"]:
        other.forward()
    assert other.digest() == found["sha256"]
    times = np.unique(np.round(page.times, 9))
    assert np.allclose(np.diff(times), 0.1)


def test_a_session_that_is_taken_up_elsewhere_ends_the_connection_before(page):
    page.ask(do="begin", setup=SETUP)
    page.until("cell")
    before = page.wire
    page.resume()
    with contextlib.suppress(clients.GONE):
        for _ in range(9):
            before.recv(30)
    with pytest.raises(clients.GONE):
        before.send("{}")
    page.ask(do="hash")
    assert page.until("hash")["t"] == 0.0
    page.ask(do="leave")


def wait(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def test_words_come_without_being_asked_for_and_at_once_when_asked(monkeypatch):
    monkeypatch.setattr(line, "BEAT", 0.4)
    with served() as client, connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        said(socket, "cell")
        for _ in range(4):
            said(socket, "alive")
            ask(socket, do="alive")
        monkeypatch.setattr(line, "BEAT", 1000.0)
        for _ in range(3):  # at most one of the answers comes by itself
            ask(socket, do="ping")
            said(socket, "alive")


def test_who_answers_nothing_any_more_is_let_go_and_may_come_back(monkeypatch):
    monkeypatch.setattr(line, "BEAT", 0.3)
    monkeypatch.setattr(line, "SILENCE", 1.0)
    with served() as client:
        with connect(client) as socket:
            ask(socket, do="begin", setup=SETUP)
            token = said(socket, "welcome")["token"]
            with pytest.raises(WebSocketDisconnect):
                said(socket, "never", answers=False)
        assert answer_to(client, token) == "resumed"


@pytest.mark.slow
def test_the_cell_of_a_page_that_says_nothing_stands_still(monkeypatch):
    monkeypatch.setattr(line, "QUIET", 0.3)
    with served() as client, connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        ask(socket, do="speed", value=4)
        ask(socket, do="play")
        ask(socket, do="hash")
        while (before := said(socket, "hash"))["t"] < 1:
            ask(socket, do="hash")
        time.sleep(4.0)
        ask(socket, do="hash")
        assert said(socket, "hash")["t"] - before["t"] < 6  # it would have come 16 further


def test_a_session_is_kept_for_a_while_and_then_forgotten():
    with served(kept_seconds=1.0) as client:
        token = began(client)
        assert answer_to(client, token) == "resumed"
        time.sleep(2.0)
        with connect(client) as socket:
            ask(socket, do="resume", token=token)
            said(socket, "forgotten")
            ask(socket, do="begin", setup=SETUP)
            assert said(socket, "welcome")["token"] != token
            assert said(socket, "cell")["fresh"]


def test_kept_sessions_count_and_the_oldest_gives_its_place_to_a_newcomer():
    with served(sessions=2) as client:
        first, second = began(client), began(client)
        with connect(client) as one:
            ask(one, do="begin", setup=SETUP)
            said(one, "cell")
            assert answer_to(client, first) == "forgotten"  # and does not take a place before it begins
            with connect(client) as two:
                ask(two, do="resume", token=second)
                said(two, "resumed")
                with connect(client) as three:
                    ask(three, do="begin", setup=SETUP)
                    assert "2 sessions" in said(three, "ended")["sentence"]


def test_who_says_farewell_is_not_kept():
    with served() as client:
        with connect(client) as socket:
            ask(socket, do="begin", setup=SETUP)
            token = said(socket, "welcome")["token"]
            said(socket, "cell")
            ask(socket, do="leave")
            with pytest.raises(WebSocketDisconnect):
                said(socket, "never")
        assert answer_to(client, token) == "forgotten"


def test_who_says_farewell_while_something_is_computed_is_not_kept(monkeypatch):
    """The page is told that the visit is over before what was still asked of it is done."""

    async def late(self, compute):
        await asyncio.sleep(0.5)
        return compute()

    with served() as client:
        with connect(client) as socket:
            ask(socket, do="begin", setup=SETUP)
            token = said(socket, "welcome")["token"]
            said(socket, "cell")
            monkeypatch.setattr(work.Work, "quickly", late)
            ask(socket, do="hash")
            ask(socket, do="leave")
            with pytest.raises(WebSocketDisconnect):
                said(socket, "never")
        assert answer_to(client, token) == "forgotten"


def test_a_token_opens_nothing_to_strangers():
    with served() as client:
        token = began(client)
        for headers in ({"origin": "http://evil.example"}, {"host": "evil.example"}):
            with pytest.raises(WebSocketDisconnect):
                answer_to(client, token, **headers)
        for wrong in ("", token[:-1], token + "x", token.swapcase()):
            assert answer_to(client, wrong) == "forgotten"
        with connect(client) as socket:
            for _ in range(2):  # one guess for a connection; the next is no ask
                ask(socket, do="resume", token="x" * 43)
            said(socket, "forgotten")
            assert "must be" in said(socket, "refused")["sentence"]
        with connect(client) as socket:
            ask(socket, do="resume", token=["x"])
            assert "must be" in said(socket, "refused")["sentence"]
        assert answer_to(client, token, origin=HOST) == "resumed"
        assert len(token) >= 43


def test_a_page_whose_session_is_gone_begins_where_it_was():
    with served() as client:
        with connect(client) as socket:
            ask(socket, do="begin", setup=SETUP)
            link = said(socket, "cell")["link"]
            for _ in range(4):
                ask(socket, do="step")
            ask(socket, do="hash")
            found = said(socket, "hash")
        with connect(client) as socket:
            ask(socket, do="begin", link=link, t=found["t"], playing=False)
            while (again := said(socket, "cell"))["catching_up"] is not None:
                pass
            assert again["t"] == found["t"] > 0
            ask(socket, do="hash")
            assert said(socket, "hash") == found
            ask(socket, do="begin", link=link, t=1e6)
            assert "must be" in said(socket, "refused")["sentence"]


def test_what_is_compiled_is_said_before_it_is_and_what_is_known_is_not(monkeypatch):
    monkeypatch.setattr(work, "_compiled", set())
    with served() as client, connect(client) as socket:
        for again in (False, True):
            ask(socket, do="begin", setup={"grid": {"n_theta": 18, "n_z": 14}})
            heard = [said(socket, "preparing", "prepared", "cell") for _ in range(1 if again else 3)]
            kinds = [words["type"] for words in heard]
            assert kinds == (["cell"] if again else ["preparing", "prepared", "cell"])
            if not again:
                assert "a cell of 18 x 14 points" in heard[0]["sentence"]
                assert heard[0]["another"]
        steps = [{"at": 0.1, "action": "change", "alpha_u": 0.1, "over": 5.0}]
        ask(socket, do="begin", setup={"grid": {"n_theta": 18, "n_z": 14}})
        link = setup.from_tables({"grid": {"n_theta": 18, "n_z": 14}}, steps, t=0.3).link()
        ask(socket, do="begin", link=link)
        words = said(socket, "preparing")
        assert not words["another"]
        assert "from now on" in words["sentence"]


def test_every_kind_of_cell_among_the_presets_is_prepared_ahead():
    met = {ahead.kind_at(begun.ready().schedule, begun.ready().grid) for begun in ahead.cells()}
    for preset in presets.PRESETS:
        ready = setup.from_tables(preset.tables, preset.protocol).ready()
        for t in (0.0, *ready.schedule.times):
            assert ahead.kind_at(ready.schedule, ready.grid, t) in met
    assert len(met) == len(list(ahead.cells()))
    cylinders = {kind for kind in met if work.taken({kind}) == 1}
    assert 0 < work.taken(cylinders) <= work.AHEAD < work.taken(met)


def test_preparing_ahead_waits_until_nobody_computes(monkeypatch):
    monkeypatch.setattr(work, "_compiled", set())
    monkeypatch.setattr(importlib.import_module("cyclosis.explorer.visits"), "REST", 0.2)
    monkeypatch.setattr(ahead, "cells", lambda: [setup.from_tables(SETUP)])

    class Busy:
        at_work = True

    async def scene():
        visits = Visits(work.Work(1), 8, 1.0, 1.0)
        visits.all["x"] = busy = Busy()
        preparing = asyncio.create_task(ahead.prepare(visits))
        await asyncio.sleep(1.0)
        assert not work._compiled
        busy.at_work = False
        await preparing
        visits.work.end()

    asyncio.run(scene())
    assert {kind[0] for kind in work._compiled} == {(16, 16)}
