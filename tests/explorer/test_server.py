"""The server answers its own page, refuses others in a sentence, and survives hostile clients."""

import json
import struct

import pytest
from fastapi.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from cyclosis.explorer import setup
from cyclosis.explorer.server import ServerLimits, application

HOST = "http://localhost:8765"
SETUP = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.2}}


@pytest.fixture
def client():
    with TestClient(application(ServerLimits(sessions=2, idle_seconds=30.0)), base_url=HOST) as client:
        yield client


def connect(client, **headers):
    return client.websocket_connect("/cell", headers={"host": "localhost:8765"} | headers)


def ask(socket, **words):
    socket.send_text(json.dumps(words))


def said(socket, kind):
    """Return the next text of a kind; draws whatever pictures come before."""
    for _ in range(200):
        message = socket.receive()
        if message["type"] == "websocket.close":
            raise WebSocketDisconnect
        if message.get("text"):
            words = json.loads(message["text"])
            if words["type"] == kind:
                return words
            if words["type"] == "alive":
                ask(socket, do="alive")
        else:
            ask(socket, do="seen", frame=header(message["bytes"])["frame"])
    raise AssertionError(f"nothing of type {kind} was said")


def header(data):
    return json.loads(data[8 : 8 + struct.unpack("<I", data[:4])[0]])


def shown(socket, enough):
    """Return the header of the first picture that is enough."""
    for _ in range(200):
        message = socket.receive()
        if message.get("bytes"):
            found = header(message["bytes"])
            ask(socket, do="seen", frame=found["frame"])
            if enough(found):
                return found
    raise AssertionError("no such picture was sent")


def test_a_cell_goes_to_a_frame_and_stands_still_there(client):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        ask(socket, do="play")
        ask(socket, do="reach", frame=7)
        shown(socket, lambda found: found["frame"] == 7)
        ask(socket, do="reach", frame=7)  # the picture is sent again: it may have been lost
        assert shown(socket, lambda found: True)["frame"] == 7
        ask(socket, do="reach", frame=3)
        assert shown(socket, lambda found: True)["frame"] == 7
        ask(socket, do="tell")
        cell = said(socket, "cell")
        while not cell["t"]:
            cell = said(socket, "cell")
        assert (cell["t"], cell["playing"]) == (0.7, False)
        ask(socket, do="play")
        shown(socket, lambda found: found["frame"] > 9)
        ask(socket, do="pause")
        while (cell := said(socket, "cell"))["playing"]:
            pass
        assert shown(socket, lambda found: True)["t"] == cell["t"]  # that of the time that is told


def test_a_cell_plays_pauses_and_tells_the_same_hash_through_a_link(client):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        assert said(socket, "cell")["fresh"]
        ask(socket, do="speed", value=50)
        ask(socket, do="play")
        ask(socket, do="change", values={"alpha_p": 0.5})
        for _ in range(3):
            ask(socket, do="step")
        ask(socket, do="hash")
        found = said(socket, "hash")
        ask(socket, do="pause")
        cell = said(socket, "cell")
        while cell["t"] < found["t"]:
            cell = said(socket, "cell")
    with connect(client) as socket:
        ask(socket, do="begin", link=cell["link"])
        while (again := said(socket, "cell"))["catching_up"] is not None:
            pass
        assert again["t"] == cell["t"]
        assert again["link"] == cell["link"]
        ask(socket, do="hash")
        assert said(socket, "hash") == found


def test_nonsense_is_refused_in_a_sentence_and_the_cell_lives_on(client):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        said(socket, "cell")
        for text in (
            "",
            "{",
            "null",
            '{"do": "change", "values": {"alpha_p": -1}}',
            '{"do": "begin", "link": "x"}',
        ):
            socket.send_text(text)
            assert "must be" in said(socket, "refused")["sentence"]
        socket.send_bytes(b"\0" * 100)
        assert "must be" in said(socket, "refused")["sentence"]
        ask(socket, do="hash")
        assert said(socket, "hash")["t"] == 0.0


def test_who_talks_nonsense_only_is_let_go(client):
    with connect(client) as socket:
        for _ in range(30):
            socket.send_text("nonsense")
        with pytest.raises(WebSocketDisconnect):
            said(socket, "never")


def test_other_origins_and_names_are_refused(client):
    for headers in ({"origin": "http://evil.example"}, {"host": "evil.example"}):
        with pytest.raises(WebSocketDisconnect), connect(client, **headers):
            pass
    assert client.get("/api/about", headers={"host": "evil.example"}).status_code == 421
    with connect(client, origin=HOST) as socket:
        ask(socket, do="begin", setup=SETUP)
        assert said(socket, "cell")["t"] == 0


def test_sessions_are_bounded_and_free_again_after_an_abrupt_close(client):
    for _ in range(5):
        with connect(client) as one, connect(client) as two:
            ask(one, do="begin", setup=SETUP)
            ask(two, do="begin", setup=SETUP)
            said(one, "cell")
            said(two, "cell")
            with connect(client) as three:
                ask(three, do="begin", setup=SETUP)
                assert "2 sessions" in said(three, "ended")["sentence"]


def test_files_are_made_from_a_link(client, tmp_path):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        for _ in range(3):
            ask(socket, do="step")
        cell = said(socket, "cell")
        while cell["t"] < 0.3:
            cell = said(socket, "cell")
    got = client.get("/api/export/run.nc", params={"cell": cell["link"]})
    assert got.status_code == 200
    (tmp_path / "run.nc").write_bytes(got.content)
    import cyclosis as cy

    assert cy.load(tmp_path / "run.nc").t_final == pytest.approx(0.3)
    assert b"t_end" in client.get("/api/export/cell.toml", params={"cell": cell["link"]}).content
    for name, link in (("run.nc", "nonsense"), ("passwd", cell["link"])):
        refused = client.get(f"/api/export/{name}", params={"cell": link})
        assert refused.status_code == 400
        assert "must be" in refused.json()["sentence"]


@pytest.mark.slow
def test_curves_of_theory_come_while_the_cell_goes_on(client):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        ask(socket, do="curves")
        ask(socket, do="hash")
        assert said(socket, "hash")["t"] == 0.0
        assert said(socket, "curves")["applies"]


def test_an_address_keeps_its_time_while_the_cell_catches_up(client):
    cell = setup.from_tables(SETUP, t=500.0)
    with connect(client) as socket:
        ask(socket, do="begin", link=cell.link())
        told = said(socket, "cell")
    assert (told["t"], told["catching_up"]) == (0.0, 500.0)
    assert setup.from_link(told["link"]).t == 500.0


def test_malformed_origins_are_refused_and_no_frame_is_no_file(client):
    with pytest.raises(WebSocketDisconnect), connect(client, origin="http://["):
        pass
    answer = client.get("/api/export/run.nc", params={"cell": setup.from_tables(SETUP).link()})
    assert answer.status_code == 400
    assert "let the cell run" in answer.json()["sentence"]


def test_units_are_kept_in_the_set_up_and_given_to_the_next_cell():
    scales = {"radius_um": 500.0, "speed_um_s": 75.0}
    server = application(ServerLimits(sessions=2), scales)
    with TestClient(server, base_url=HOST) as client, connect(client) as socket:
        assert client.get("/api/about").json()["scales"] == scales
        ask(socket, do="begin", setup=SETUP)
        assert said(socket, "cell")["setup"]["scales"] == {}
        ask(socket, do="units", scales=scales)
        told = said(socket, "cell")
        assert told["setup"]["scales"] == scales
        assert "[scales]\nradius_um = 500.0\n" in setup.from_link(told["link"]).toml()
        ask(socket, do="begin", setup=SETUP, scales=scales | {"radius_um": 100.0})
        assert said(socket, "cell")["setup"]["scales"]["radius_um"] == 100.0
        ask(socket, do="begin", link=told["link"], scales=scales | {"radius_um": 100.0})
        assert said(socket, "cell")["setup"]["scales"] == scales
        ask(socket, do="units", scales=scales | {"speed_um_s": 0.0})
        assert "speed_um_s" in said(socket, "refused")["sentence"]
        ask(socket, do="units")
        assert said(socket, "cell")["setup"]["scales"] == {}


def test_a_visitor_undoes_and_begins_again(client):
    with connect(client) as socket:
        ask(socket, do="begin", setup=SETUP)
        said(socket, "cell")
        for words in ({"do": "step"}, {"do": "change", "values": {"alpha_p": 0.5}}, {"do": "step"}):
            ask(socket, **words)
            told = said(socket, "cell")
        assert (told["t"], told["undo"]) == (0.2, 1)
        ask(socket, do="undo")
        told = said(socket, "cell")
        assert (told["t"], told["undo"], told["protocol"], told["fresh"]) == (0.1, 0, [], False)
        ask(socket, do="undo")
        assert "intervention" in said(socket, "refused")["sentence"]
        ask(socket, do="change", values={"alpha_p": 0.25})
        said(socket, "cell")
        ask(socket, do="again")
        told = said(socket, "cell")
        assert (told["t"], told["fresh"], told["parameters"]["alpha_p"]) == (0.0, True, 0.25)
