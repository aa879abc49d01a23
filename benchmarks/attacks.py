"""Attacks on the explorer's server over real sockets; each returns what it was answered."""

from __future__ import annotations

import contextlib
import json
import secrets
import socket
import struct
import threading
import time
import zlib
from collections.abc import Callable

from clients import (
    BEGIN,
    GONE,
    PART,
    PING,
    PLAY,
    PONG,
    SESSIONS,
    TEXT,
    ask,
    frame,
    get,
    link_of,
    poured,
    raw,
    repeated,
    said,
    together,
    visit,
    words_of,
)
from websockets.sync.client import ClientConnection


def malformed(port: int, seconds: float) -> str:
    """Send what is no ask, in text, bytes, and text that is none."""
    texts = ["", "{", "[" * 60000, '{"do":"change","values":{"alpha_p":1e999}}', "9" * 60000, b"\0" * 999]

    def act(port: int, end: float) -> str:
        with visit(port) as wire:
            for text in texts * 4:
                wire.send(text)
                wire.recv(10)
        return "served"

    def no_text(port: int, end: float) -> str:
        with raw(port, frame(TEXT, b"\xff\xfe") * 25) as link:
            return words_of(link)

    return f"{together(act, port, seconds / 2)}; {together(no_text, port, seconds / 2)}"


def huge(port: int, seconds: float) -> str:
    """Announce a frame of 1 TiB, and send 64 MiB of it."""
    head = b"\x82\xff" + struct.pack(">Q", 2**40) + b"mask"
    return together(lambda port, end: poured(port, end, b"x" * 2**20, head), port, seconds, 3)


def bomb(port: int, seconds: float) -> str:
    """Send a compressed message that is 64 MiB long once unpacked."""
    packing = zlib.compressobj(9, wbits=-15)
    data = packing.compress(b"0" * 2**26) + packing.flush(zlib.Z_SYNC_FLUSH)

    def act(port: int, end: float) -> str:
        with raw(port, frame(TEXT, data[:65000], packed=True)) as link:
            return words_of(link)

    return together(act, port, seconds, 3)


def fragments(port: int, seconds: float) -> str:
    """Begin one message and send empty parts of it without end."""
    first, parts = frame(TEXT, b"{", last=False), frame(PART, last=False) * 20000
    return together(lambda port, end: poured(port, end, parts, first), port, seconds, 3)


def pings(port: int, seconds: float) -> str:
    """Send pings without end and read no answer."""
    data = frame(PING, b"x" * 125) * 2000
    return together(lambda port, end: poured(port, end, data), port, seconds, 3)


def tiny(port: int, seconds: float) -> str:
    """Send the smallest frames there are, unasked pongs, as fast as can be."""
    return together(lambda port, end: poured(port, end, frame(PONG) * 20000), port, seconds)


def unread(port: int, seconds: float) -> str:
    """Play at full speed, ask for true things without end, and read nothing."""
    asks = [BEGIN, PLAY, {"do": "speed", "value": 100}]
    before = b"".join(frame(TEXT, json.dumps(words).encode()) for words in asks)
    data = (frame(TEXT, b'{"do":"tell"}') + frame(TEXT, b'{"do":"seen","frame":0}')) * 1000
    return together(lambda port, end: poured(port, end, data, before), port, seconds)


def valid(port: int, seconds: float) -> str:
    """Send 100 000 true messages as fast as can be, and read all answers."""

    def hear(wire: ClientConnection) -> None:
        with contextlib.suppress(*GONE):
            for _ in wire:
                pass

    def act(port: int, end: float) -> str:
        with visit(port) as wire:
            threading.Thread(target=hear, args=(wire,), daemon=True).start()
            ask(wire, **BEGIN)
            for k in range(100_000 // (SESSIONS - 1)):
                ask(wire, do=("tell", "seen", "hash", "play")[k % 4], **({"frame": 0} if k % 4 == 1 else {}))
                if time.monotonic() > end:
                    return "served"
        return "served"

    return together(act, port, seconds)


def grids(port: int, seconds: float) -> str:
    """Begin cells on grids that nobody has used yet, each of which must be compiled for."""
    number = iter(range(10**6))

    def act(port: int, end: float) -> str:
        k = next(number)
        grid = {"n_theta": 8 + 2 * (k % 50), "n_z": 10 + 2 * (k // 50 % 50)}
        with visit(port) as wire:
            ask(wire, do="begin", setup={"grid": grid})
            while (message := json.loads(wire.recv(30)))["type"] not in ("cell", "refused", "ended"):
                pass
            return str(message.get("sentence", "served"))

    return together(act, port, seconds)


def largest(port: int, seconds: float) -> str:
    """Play the largest cells at full speed and begin them anew."""
    begin = {"do": "begin", "setup": {"grid": {"n_theta": 128, "n_z": 128}}}
    asks = [begin, PLAY, {"do": "speed", "value": 100}, *([{"do": "seen", "frame": 0}] * 20)]
    return together(lambda port, end: repeated(port, end, *asks, wait="all"), port, seconds)


def protocols(port: int, seconds: float) -> str:
    """Begin cells to which as much as is allowed is done, and do more."""
    steps = [{"at": 100 + 0.1 * k, "action": "change", "alpha_p": 0.5 + 1e-4 * k} for k in range(900)]
    begin = {"do": "begin", "link": link_of(steps, n_theta=128, n_z=128)}
    asks = [begin, *({"do": "change", "values": {"alpha_u": 0.1 * k}} for k in range(1, 5))]
    return together(lambda port, end: repeated(port, end, *asks, wait="all"), port, seconds)


def regions(port: int, seconds: float) -> str:
    """Begin cells whose parameters change from place to place, and do more."""
    where = {"shape": "disc", "theta": 1, "z": 1, "radius": 1}
    values = {"alpha_p": 0.5, "alpha_u": 0.1, "kappa": 0.2, "repulsion_angle": 1, "where": where}
    steps = [{"at": 100 + 0.1 * k, "action": "change"} | values for k in range(28)]
    begin = {"do": "begin", "link": link_of(steps, n_theta=128, n_z=128)}
    asks = [begin, *({"do": "change", "values": {"alpha_u": 0.1 * k}} for k in range(1, 5))]
    return together(lambda port, end: repeated(port, end, *asks, wait="all"), port, seconds)


def noise(port: int, seconds: float) -> str:
    """Ask for more random numbers than there is memory."""
    steps: list[dict[str, object]] = [{"at": 0, "action": "fragment", "noise_grid": [8192, 8192]}] * 20
    asks = {"do": "begin", "link": link_of(steps)}
    return together(lambda port, end: repeated(port, end, asks, {"do": "tell"}, wait="all"), port, seconds)


def curves(port: int, seconds: float) -> str:
    """Ask for the curves of theory, which take seconds, again and again."""
    asks = BEGIN, {"do": "curves"}, {"do": "tell"}
    return together(lambda port, end: repeated(port, end, *asks, wait="all"), port, seconds)


def crowd(port: int, seconds: float) -> str:
    """Come a hundred at once, again and again."""

    def act(port: int, end: float) -> str:
        with visit(port) as wire:
            ask(wire, **BEGIN)
            ask(wire, **PLAY)
            while time.monotonic() < end:
                message = wire.recv(max(0.01, end - time.monotonic()))
                if isinstance(message, str) and (words := json.loads(message))["type"] == "ended":
                    return str(words["sentence"])
        return "served"

    return together(act, port, seconds, 100)


def signs(port: int, seconds: float) -> str:
    """Say without end that one is there, ask whether the server is, and read nothing."""
    before = frame(TEXT, json.dumps(BEGIN).encode())
    data = (frame(TEXT, b'{"do":"ping"}') + frame(TEXT, b'{"do":"alive"}')) * 1000
    return together(lambda port, end: poured(port, end, data, before), port, seconds)


def tokens(port: int, seconds: float) -> str:
    """Guess the tokens of others' sessions."""

    def act(port: int, end: float) -> str:
        with visit(port) as wire:
            ask(wire, do="resume", token=secrets.token_urlsafe(32))
            return str(json.loads(wire.recv(30))["type"])

    return together(act, port, seconds)


def returns(port: int, seconds: float) -> str:
    """Begin a cell, and take it up over one connection after another without leaving those before."""

    def act(port: int, end: float) -> str:
        with contextlib.ExitStack() as held:
            wire = held.enter_context(visit(port))
            ask(wire, **BEGIN)
            token = said(wire, "welcome")["token"]
            while time.monotonic() < end:
                wire = held.enter_context(visit(port))
                ask(wire, do="resume", token=token)
                if said(wire, "resumed")["token"] != token:
                    return "another session"
        return "resumed"

    return together(act, port, seconds, 3)


def strangers(port: int, seconds: float) -> str:
    """Come from a page of elsewhere."""

    def act(port: int, end: float) -> str:
        with visit(port, origin="http://elsewhere.example"):
            return "let in"

    return together(act, port, seconds)


def abrupt(port: int, seconds: float) -> str:
    """Begin a cell and cut the connection off without a word."""
    asks = b"".join(frame(TEXT, json.dumps(words).encode()) for words in (BEGIN, PLAY))

    def act(port: int, end: float) -> str:
        link = raw(port, asks)
        time.sleep(0.05)
        link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        link.close()
        return "served"

    return together(act, port, seconds)


def half_open(port: int, seconds: float) -> str:
    """Hold a hundred connections on which headers come a byte at a time, or nothing comes."""

    def act(port: int, end: float) -> str:
        with raw(port, b"GET / HTTP/1.1\r\nX: ", cell=False) as link:
            link.settimeout(0.5)
            while time.monotonic() < end:
                with contextlib.suppress(TimeoutError):
                    link.sendall(b"x")
                    if not link.recv(100):
                        return "closed"
        return "held"

    return together(act, port, seconds, 100)


def bodies(port: int, seconds: float) -> str:
    """Send bodies without end, in pieces of one byte."""
    head = b"POST /api/about HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"

    def act(port: int, end: float) -> str:
        with raw(port, head, cell=False) as link:
            while time.monotonic() < end:
                link.sendall(b"1\r\nx\r\n" * 20000)
        return "read"

    return together(act, port, seconds)


def files(port: int, seconds: float) -> str:
    """Ask for large files, twenty at a time, and read nothing of half of them."""
    path = f"/api/export/run.nc?cell={link_of([], 90.0, n_theta=128, n_z=128)}"

    def act(port: int, end: float) -> str:
        if next(number) % 2:
            with raw(port, f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode(), cell=False):
                time.sleep(max(0.0, min(2.0, end - time.monotonic())))
            return "not read"
        time.sleep(0.1)
        status, body = get(port, path)
        return "a file" if status == 200 else f"{status} {body.decode()[:90]}"

    number = iter(range(10**6))
    return together(act, port, seconds, 20)


def insides(port: int, seconds: float) -> str:
    """Play the largest cells at full speed, with as many tracers as are allowed on and off again."""
    begin = {"do": "begin", "setup": {"grid": {"n_theta": 128, "n_z": 128}}}

    def act(port: int, end: float) -> str:
        heard = 0
        with visit(port) as wire:
            for words in (begin, PLAY, {"do": "speed", "value": 100}):
                ask(wire, **words)
            while time.monotonic() < end:
                if isinstance(wire.recv(30), bytes):
                    heard += 1
                    ask(wire, do="seen", frame=0)
                    on, pace = heard % 8 != 0, 2.0 - heard // 4 % 2
                    ask(wire, do="vacuole", on=on, tracers=1000, pace=pace)
        return "served"

    return together(act, port, seconds)


ATTACKS: dict[str, Callable[[int, float], str]] = {
    attack.__name__: attack
    for attack in (
        *(malformed, huge, bomb, fragments, pings, tiny, unread, valid, grids, largest, protocols),
        *(regions, noise, curves, crowd, signs, tokens, returns, strangers, abrupt, half_open, bodies, files),
        insides,
    )
}
