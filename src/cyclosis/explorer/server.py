"""The explorer's server: the page, what it is built from, one session for each visitor, and files."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import urlsplit

from fastapi import FastAPI, Request, WebSocket, WebSocketDisconnect
from fastapi.responses import FileResponse, JSONResponse, Response
from fastapi.staticfiles import StaticFiles

from ..model.errors import InputError, choice
from . import exports
from .about import about
from .messages import LONGEST
from .visit import Visit
from .work import Work

PAGE = Path(__file__).parent / "page"
"""The built page."""
LOOPBACK = ("127.0.0.1", "localhost", "::1")
MOST_FILES = 4
"""Files that are made or given away at once; they are made one after another."""
SENDING = 600.0
"""Seconds within which a file is taken."""
MISSING = "install Node.js 20.19 or newer, then run `make page` or reinstall cyclosis"
_SECURITY = {
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' blob: data:; connect-src 'self' ws: wss:; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


@dataclass(frozen=True)
class Limits:
    """What a server allows: sessions at once, and seconds for which one may be left alone.

    `hosts` are the names under which it answers, "*" for any; `threads` compute at once.
    """

    sessions: int = 8
    idle_seconds: float = 1800.0
    hosts: tuple[str, ...] = LOOPBACK
    threads: int = 2


class _Wire:
    """A WebSocket as a visit needs it."""

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket

    async def text(self) -> str:
        message = await self.socket.receive()
        if message["type"] != "websocket.receive":
            raise ConnectionError("the visitor has left")
        return message.get("text") or "not text"

    async def say(self, text: str) -> None:
        await asyncio.wait_for(self.socket.send_text(text), 30.0)

    async def show(self, data: bytes) -> None:
        await asyncio.wait_for(self.socket.send_bytes(data), 30.0)


class _File(FileResponse):
    """A file that is given away and then deleted."""

    def __init__(self, path: Path, kept: contextlib.ExitStack) -> None:
        super().__init__(path, media_type=exports.FILES[path.name], filename=path.name)
        self.kept = kept

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        with self.kept, contextlib.suppress(TimeoutError):
            await asyncio.wait_for(super().__call__(scope, receive, send), SENDING)


def application(limits: Limits | None = None) -> FastAPI:
    """Return the server. It holds no state but its sessions and the page."""
    allowed = limits or Limits()
    work = Work(allowed.threads)

    @contextlib.asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        yield
        work.end()

    app = FastAPI(title="cyclosis explorer", docs_url=None, redoc_url=None, openapi_url=None, lifespan=life)
    making = asyncio.Lock()
    folders: set[str] = set()

    @app.middleware("http")
    async def guarded(request: Request, call: Callable[[Request], Awaitable[Response]]) -> Response:
        if not _known_host(request.headers.get("host", ""), allowed):
            return JSONResponse({"sentence": "This server does not answer under that name."}, 421)
        response = await call(request)
        for name, value in _SECURITY.items():
            response.headers[name] = value
        return response

    @app.get("/api/about")
    def told() -> JSONResponse:
        return JSONResponse(about())

    @app.get("/api/export/{name}")
    async def export(name: str, cell: str, request: Request) -> Response:
        if len(folders) >= MOST_FILES:
            return JSONResponse({"sentence": "Other files are being made: try again soon."}, 503)
        with contextlib.ExitStack() as kept:
            folder = kept.enter_context(TemporaryDirectory(prefix="cyclosis-", ignore_cleanup_errors=True))
            folders.add(folder)
            kept.callback(folders.discard, folder)
            try:
                choice("file", name, tuple(exports.FILES))
                async with making:
                    path = await exports.make(name, cell, Path(folder), request.is_disconnected)
                return _File(path, kept.pop_all())
            except (InputError, exports.Refused) as error:
                return JSONResponse({"sentence": str(error)}, 400)
            except ConnectionAbortedError:
                return Response(status_code=499)

    @app.websocket("/cell")
    async def cell(socket: WebSocket) -> None:
        if not _known_host(socket.headers.get("host", ""), allowed) or not _same_origin(socket):
            await socket.close(1008, "Only pages of this server may connect.")
            return
        await socket.accept()
        if work.visits >= allowed.sessions:
            words = f"This server holds {allowed.sessions} sessions and all are taken: try again later."
            with contextlib.suppress(Exception):
                await socket.send_json({"type": "ended", "sentence": words})
                await socket.close(1013)
            return
        work.visits += 1
        try:
            await Visit(_Wire(socket), work, allowed.idle_seconds).go()
        except (ConnectionError, TimeoutError, RuntimeError, WebSocketDisconnect, asyncio.CancelledError):
            pass  # the visitor left, cannot be served, or the server ends
        finally:
            work.visits -= 1
            with contextlib.suppress(Exception):
                await socket.close()

    if (PAGE / "index.html").exists():
        app.mount("/", StaticFiles(directory=PAGE, html=True))
    return app


def serve(host: str, port: int, limits: Limits, ready: Callable[[int], Any] | None = None) -> None:
    """Serve until interrupted; at port 0, at any free one. `ready` is called with the port once it answers.

    Raises `InputError` where the page is not built or the port is taken.
    """
    import socket

    import uvicorn

    from . import connections

    if not (PAGE / "index.html").exists():
        raise InputError("explorer", "no page", "built with its page", MISSING)
    try:
        listening = socket.create_server(
            (host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET
        )
        # Connections inherit it: else a picture waits some 40 ms for word that the last one came.
        listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    except (socket.gaierror, UnicodeError, TypeError) as error:
        rule = "a name or an address of this machine"
        raise InputError("host", host, rule, "choose another with --host") from error
    except OSError as error:
        rule = f"a free place to listen ({os.strerror(error.errno) if error.errno else error})"
        raise InputError("host and port", f"{host}:{port}", rule, "choose another with --port") from error

    sys.setswitchinterval(0.001)  # the thread that answers waits for those that compute

    class Server(uvicorn.Server):
        async def startup(self, sockets: Any = None) -> None:
            await super().startup(sockets)
            if ready is not None:
                ready(listening.getsockname()[1])

    how = uvicorn.Config(
        application(limits),
        log_level="error",  # a line for every malformed request would let anyone fill the log
        http=connections.Http,
        ws=connections.Socket,
        ws_max_size=LONGEST,
        timeout_graceful_shutdown=3,
        ws_per_message_deflate=False,  # it shortens pictures little and takes its time where all wait for it
    )
    Server(how).run([listening])


def _known_host(header: str, allowed: Limits) -> bool:
    return "*" in allowed.hosts or _name(f"//{header}") in allowed.hosts


def _same_origin(socket: WebSocket) -> bool:
    origin, host = socket.headers.get("origin"), socket.headers.get("host", "")
    # A program that is no browser names no origin, and can be misled by no page.
    try:
        return origin is None or urlsplit(origin).netloc == host
    except ValueError:
        return False


def _name(address: str) -> str:
    try:
        return urlsplit(address).hostname or ""
    except ValueError:
        return ""
