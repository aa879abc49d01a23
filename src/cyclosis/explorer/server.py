"""The explorer's server: the page and its data, one session for each visitor, and files."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import urlsplit

from fastapi import FastAPI, Request, WebSocket, WebSocketDisconnect
from fastapi.responses import JSONResponse, Response
from fastapi.staticfiles import StaticFiles
from starlette.datastructures import Headers, MutableHeaders

from ..model.errors import InputError
from . import exports
from .about import about
from .ahead import prepare
from .catalogue import whole
from .files import Kept, Reported
from .messages import LONGEST
from .visits import Visits
from .work import Work

PAGE = Path(__file__).parent / "page"
"""The built page."""
LOOPBACK = ("127.0.0.1", "localhost", "::1")
MOST_FILES = 4
"""Files that are made or sent at once; they are made one after another."""
MISSING = "install Node.js 20.19 or newer, then run `make page` or reinstall cyclosis"
_SECURITY = {
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' blob: data:; connect-src 'self' ws: wss:; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


@dataclass(frozen=True)
class ServerLimits:
    """The limits of a server: sessions at once, and seconds for which one may be idle.

    `hosts` are the names under which it answers, "*" for any; `threads` compute at once. A session whose
    connection is lost is kept for `kept_seconds`. With `ahead` the kinds of cell of the presets are compiled
    before anyone needs them, while nothing is computed.
    """

    sessions: int = 8
    idle_seconds: float = 1800.0
    hosts: tuple[str, ...] = LOOPBACK
    threads: int = 2
    kept_seconds: float = 600.0
    ahead: bool = False


class _Wire:
    """A WebSocket with the methods that a visit needs."""

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket

    async def text(self) -> str:
        message = await self.socket.receive()
        if message["type"] != "websocket.receive":
            raise ConnectionError("the visitor has left")
        return message.get("text") or "not text"

    async def say(self, text: str) -> None:
        await self.socket.send_text(text)

    async def show(self, data: bytes) -> None:
        await self.socket.send_bytes(data)


class _Guarded:
    """Answers only under known names, and adds the security headers.

    It wraps nothing around the connection, so that a response notices when the visitor has left.
    """

    def __init__(self, app: Any, allowed: ServerLimits) -> None:
        self.app, self.allowed = app, allowed

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def guarded(message: Any) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_SECURITY)
            await send(message)

        if _known_host(Headers(scope=scope).get("host", ""), self.allowed):
            await self.app(scope, receive, guarded)
        else:
            sentence = "This server does not answer to that name."
            await JSONResponse({"sentence": sentence}, 421)(scope, receive, guarded)


def application(limits: ServerLimits | None = None, scales: Mapping[str, float] | None = None) -> FastAPI:
    """Return the server. Its only state is its sessions and the page.

    With `scales` (the [scales] table of a configuration) cells are shown in their units at first.
    """
    allowed = limits or ServerLimits()
    work = Work(allowed.threads)
    visits = Visits(work, allowed.sessions, allowed.idle_seconds, allowed.kept_seconds)

    @contextlib.asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        ahead = asyncio.create_task(prepare(visits)) if allowed.ahead else None
        yield
        if ahead is not None:
            ahead.cancel()
        visits.end()
        work.end()

    app = FastAPI(title="cyclosis explorer", docs_url=None, redoc_url=None, openapi_url=None, lifespan=life)
    desk = exports.Desk()
    folders: set[str] = set()

    app.add_middleware(_Guarded, allowed=allowed)

    @app.get("/api/about")
    def described() -> JSONResponse:
        return JSONResponse(about() | {"scales": scales})

    @app.get("/api/engine")
    def needed() -> JSONResponse:
        return JSONResponse(whole())

    @app.get("/api/export/{name}")
    async def export(name: str, cell: str, request: Request, told: bool = False) -> Response:
        if len(folders) >= MOST_FILES:
            return JSONResponse({"sentence": "Other files are being made: try again soon."}, 503)
        with contextlib.ExitStack() as kept:
            folder = kept.enter_context(TemporaryDirectory(prefix="cyclosis-", ignore_cleanup_errors=True))
            folders.add(folder)
            kept.callback(folders.discard, folder)
            try:
                exports.checked(name, cell)

                def make(tell: exports.Tell = exports.nobody) -> Awaitable[Path]:
                    return desk.make(name, cell, Path(folder), request.is_disconnected, tell)

                return Reported(make, kept.pop_all()) if told else Kept(await make(), kept.pop_all())
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
        code = 1000
        try:
            code = await visits.serve(_Wire(socket))
        except (ConnectionError, TimeoutError, RuntimeError, WebSocketDisconnect, asyncio.CancelledError):
            pass  # the visitor left, or the server ends
        finally:
            with contextlib.suppress(Exception):
                await socket.close(code)

    if (PAGE / "index.html").exists():
        app.mount("/", StaticFiles(directory=PAGE, html=True))
    return app


def serve(
    host: str,
    port: int,
    limits: ServerLimits,
    ready: Callable[[int], Any] | None = None,
    scales: Mapping[str, float] | None = None,
) -> None:
    """Serve until interrupted; at port 0, at any free one. `ready` is called with the port once it answers.

    `scales` are those of `application`.

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
        # Connections inherit it: otherwise a picture waits some 40 ms until the last one is acknowledged.
        listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    except (socket.gaierror, UnicodeError, TypeError) as error:
        rule = "a name or an address of this machine"
        raise InputError("host", host, rule, "choose another with --host") from error
    except OSError as error:
        rule = f"a free place to listen ({os.strerror(error.errno) if error.errno else error})"
        raise InputError("host and port", f"{host}:{port}", rule, "choose another with --port") from error

    sys.setswitchinterval(0.001)  # the thread that answers competes with those that compute

    class Server(uvicorn.Server):
        async def startup(self, sockets: Any = None) -> None:
            await super().startup(sockets)
            if ready is not None:
                ready(listening.getsockname()[1])

    how = uvicorn.Config(
        application(limits, scales),
        log_level="error",  # a line for every malformed request would let anyone fill the log
        http=connections.Http,
        ws=connections.Socket,
        ws_max_size=LONGEST,
        timeout_graceful_shutdown=3,
        ws_per_message_deflate=False,  # it hardly shortens pictures and blocks the thread that answers
    )
    Server(how).run([listening])


def _known_host(header: str, allowed: ServerLimits) -> bool:
    return "*" in allowed.hosts or _name(f"//{header}") in allowed.hosts


def _same_origin(socket: WebSocket) -> bool:
    origin, host = socket.headers.get("origin"), socket.headers.get("host", "")
    # A program that is not a browser sends no origin, and no page can mislead it.
    try:
        return origin is None or urlsplit(origin).netloc == host
    except ValueError:
        return False


def _name(address: str) -> str:
    try:
        return urlsplit(address).hostname or ""
    except ValueError:
        return ""
