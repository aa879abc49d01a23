"""Clients of the explorer's server over real sockets, well-behaved and not: see `attacks` and `hostile`."""

from __future__ import annotations

import base64
import contextlib
import json
import socket
import struct
import threading
import time
import urllib.error
import urllib.request
import zlib
from collections import Counter
from collections.abc import Callable

from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.sync.client import ClientConnection, connect

SESSIONS = 8
TEXT, PART, PING, PONG = 1, 0, 9, 10
GONE = (OSError, ConnectionClosed, InvalidHandshake, TimeoutError)
BEGIN, PLAY = {"do": "begin", "setup": {}}, {"do": "play"}


def get(port: int, path: str) -> tuple[int, bytes]:
    """Return the status and the body of what the server answers, or (0, b"") if it does not."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=60) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.read()
    except OSError:
        return 0, b""


def visit(port: int, **options: object) -> ClientConnection:
    """Connect as a page of the server does."""
    given = {"origin": f"http://127.0.0.1:{port}", "max_size": None, "close_timeout": 1} | options
    return connect(f"ws://127.0.0.1:{port}/cell", **given)


def ask(wire: ClientConnection, **words: object) -> None:
    """Send one ask."""
    wire.send(json.dumps(words))


def said(wire: ClientConnection, kind: str, timeout: float = 60.0) -> dict[str, object]:
    """Return the next words of a kind; look at pictures that come before."""
    end = time.monotonic() + timeout
    while True:
        message = wire.recv(max(0.01, end - time.monotonic()))
        if isinstance(message, bytes):
            ask(wire, do="seen", frame=0)
        elif (words := json.loads(message))["type"] == kind:
            return words
        elif words["type"] == "alive":
            ask(wire, do="alive")


def frame(opcode: int, data: bytes = b"", *, last: bool = True, packed: bool = False) -> bytes:
    """Return a WebSocket frame of a client, whose mask changes nothing."""
    first = opcode | (0x80 if last else 0) | (0x40 if packed else 0)
    size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
    return bytes([first]) + size + b"\0\0\0\0" + data


def raw(port: int, data: bytes = b"", *, cell: bool = True) -> socket.socket:
    """Return a connection on which bytes were sent, after the handshake of a cell if so."""
    link = socket.create_connection(("127.0.0.1", port), 10)
    if cell:
        here = f"127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nConnection: Upgrade"
        more = (
            "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Extensions: permessage-deflate"
        )
        key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="
        link.sendall(f"GET /cell HTTP/1.1\r\nHost: {here}\r\n{more}\r\n{key}\r\n\r\n".encode())
        got = b""
        while not got.endswith(b"\r\n\r\n"):
            if not (piece := link.recv(1)):
                raise ConnectionError("no handshake")
            got += piece
    link.sendall(data)
    return link


def words_of(link: socket.socket) -> str:
    """Return how the server ends a connection."""
    got = b""
    link.settimeout(1.0)  # the server waits for a farewell to its own
    with contextlib.suppress(OSError):
        while piece := link.recv(65536):
            got = (got + piece)[-200:]
    at = got.rfind(b"\x88")
    return f"closed, {struct.unpack('>H', got[at + 2 : at + 4])[0]}" if 0 <= at < len(got) - 3 else "cut off"


def together(act: Callable[[int, float], str], port: int, seconds: float, times: int = SESSIONS - 1) -> str:
    """Let an attack come from many connections at once; return what most were answered."""
    answers: Counter[str] = Counter()

    def one() -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                answers[act(port, end)] += 1
            except ConnectionClosed as closed:
                answers[f"closed, {closed.rcvd.code if closed.rcvd else 1006}"] += 1
            except GONE as error:
                answers[type(error).__name__] += 1

    threads = [threading.Thread(target=one) for _ in range(times)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return ", ".join(f"{n} x {words}" for words, n in answers.most_common(2))


def repeated(port: int, end: float, *asks: dict[str, object], wait: str = "") -> str:
    """Send asks again and again on one connection; return the last sentence heard."""
    heard = ""
    with visit(port) as wire:
        while time.monotonic() < end:
            for words in asks:
                ask(wire, **words)
            with contextlib.suppress(TimeoutError):
                for _ in range(len(asks)):
                    message = wire.recv(max(0.01, end - time.monotonic()) if wait else 0)
                    if isinstance(message, str) and "sentence" in message:
                        heard = json.loads(message)["sentence"]
    return heard or "served"


def poured(port: int, end: float, data: bytes, before: bytes = b"") -> str:
    """Send the same bytes without end on a connection and read nothing; return how it ends."""
    with raw(port, before) as link:
        sent = 0
        try:
            while time.monotonic() < end:
                link.settimeout(max(0.01, end - time.monotonic()))
                sent += link.send(data)
        except TimeoutError:
            return "read no further"
        except OSError:
            return words_of(link)
    return "read"


def link_of(steps: list[dict[str, object]], t: float = 0.0, **grid: int) -> str:
    """Return the link of a cell to which steps are done."""
    text = json.dumps({"grid": grid, "run": {"save_every": 0.1}, "protocol": steps, "t": t})
    return base64.urlsafe_b64encode(zlib.compress(text.encode())).decode().rstrip("=")
