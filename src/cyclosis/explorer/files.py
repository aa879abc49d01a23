"""Responses that are files: sent and then deleted, with or without progress reports."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from fastapi.responses import FileResponse, Response

from ..model.errors import InputError
from . import exports

SENDING = 600.0
"""Seconds within which a client must read a file."""
PIECE = 65_536
"""Bytes of a file that are sent at a time."""


class Kept(FileResponse):
    """A file as it is; `kept` is closed once it is sent."""

    def __init__(self, path: Path, kept: contextlib.ExitStack) -> None:
        super().__init__(path, media_type=exports.FILES[path.name], filename=path.name)
        self.kept = kept

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Send the file."""
        with self.kept, contextlib.suppress(TimeoutError):
            await asyncio.wait_for(super().__call__(scope, receive, send), SENDING)


class Reported(Response):
    """Lines of JSON while a file is made, and then the file.

    A line has the `share` that is done (0 to 1, or null) and what is being done; the last one has the number
    of `bytes` of the file, which follow, or the `sentence` that says why there is none. The work is cancelled
    once the visitor has closed the connection.
    """

    def __init__(self, make: Callable[[exports.Tell], Awaitable[Path]], kept: contextlib.ExitStack) -> None:
        # Proxies that buffer a response would hide its progress.
        super().__init__(headers={"X-Accel-Buffering": "no", "Cache-Control": "no-store"})
        self.make, self.kept = make, kept
        del self.headers["content-length"]
        self.headers["content-type"] = "application/octet-stream"

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Make the file, report progress meanwhile, and send it."""

        async def body(data: bytes, more: bool = True) -> None:
            await send({"type": "http.response.body", "body": data, "more_body": more})

        async def tell(words: dict[str, Any]) -> None:
            await body(json.dumps(words).encode() + b"\n")

        with self.kept, contextlib.suppress(TimeoutError, ConnectionAbortedError):
            head = {"type": "http.response.start", "status": 200, "headers": self.raw_headers}
            await send(head)
            try:
                path = await self.make(tell)
            except (InputError, exports.Refused) as error:
                await tell({"sentence": str(error)})
            else:
                await tell({"bytes": path.stat().st_size})
                await asyncio.wait_for(_given(path, body), SENDING)
            await body(b"", more=False)


async def _given(path: Path, body: Callable[[bytes], Awaitable[None]]) -> None:
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            await body(piece)
