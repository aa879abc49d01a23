"""Connections that no client can make expensive: few bytes at a time, few at once, none kept open in vain.

Both protocols are uvicorn's. The limits added here are those that it lacks: it reads up to 256 kB at once,
which may hold tens of thousands of tiny frames; it answers pings of a client that reads nothing; and it waits
forever for the rest of a request, or for a client to read the last bytes of a response.
"""

from __future__ import annotations

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

MOST = 200
"""Connections at once, of either kind."""
AT_ONCE = 4096
"""Bytes read from one connection before the others have their turn."""
PATIENCE = 10.0
"""Seconds for which a connection may send no request, read nothing that it is sent, or take to close."""
MOST_EMPTY = 1000
"""Pings, pongs and parts of messages in a row without the end of a message."""


class _Careful(asyncio.BufferedProtocol):
    """A connection that is read in small pieces and checked at intervals."""

    transport: asyncio.Transport
    connections: set[Any]
    timer: asyncio.TimerHandle

    def connection_made(self, transport: Any) -> None:
        self.room = bytearray(AT_ONCE)
        super().connection_made(transport)
        if len(self.connections) > MOST:
            transport.abort()
        self._check_later()

    def get_buffer(self, sizehint: int) -> bytearray:
        """Return the buffer for the next bytes."""
        return self.room

    def buffer_updated(self, nbytes: int) -> None:
        """Process the bytes that have arrived."""
        self.data_received(bytes(self.room[:nbytes]))  # type: ignore[attr-defined]

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self.timer.cancel()

    def _check_later(self) -> None:
        before = self._idle(), self.transport.get_write_buffer_size()
        self.timer = asyncio.get_running_loop().call_later(PATIENCE, self._check, *before)

    def _check(self, idle: Any, left: int) -> None:
        """Close the connection if it should have closed, or was idle since the last check."""
        silent = idle is not None and idle is self._idle()
        stuck = left > 0 and left == self.transport.get_write_buffer_size()
        if self.transport.is_closing() or silent or stuck:
            self.transport.abort()
        else:
            self._check_later()

    def _idle(self) -> Any:
        """Return an object that identifies the last activity, or None while the connection is active."""
        return None


class Http(_Careful, H11Protocol):  # type: ignore[misc]
    """A connection for HTTP, until it becomes one for a cell."""

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Give the connection to a `Socket`."""
        self.timer.cancel()
        super().handle_websocket_upgrade(event)

    def on_response_complete(self) -> None:
        """Close a connection that is still sending after the response: no request needs a body."""
        super().on_response_complete()
        if self.conn.their_state is h11.SEND_BODY:
            self.transport.close()

    def _idle(self) -> Any:
        if self.cycle is None:
            return self
        return self.cycle if self.cycle.response_complete else None


class Socket(_Careful, WebSocketsSansIOProtocol):  # type: ignore[misc]
    """A connection for a cell."""

    empty = 0
    """Frames since the last that ended a message."""

    def handle_ping(self) -> None:
        """Answer a ping, unless earlier answers have not been read."""
        self._count()
        if self.writable.is_set():
            super().handle_ping()
        else:
            self.conn.data_to_send()

    def handle_pong(self, event: Any) -> None:
        """Note that the visitor is still there."""
        self._count()
        super().handle_pong(event)

    def handle_cont(self, event: Any) -> None:
        """Process a part of a message."""
        self._count()
        super().handle_cont(event)

    def send_receive_event_to_app(self) -> None:
        """Give a whole message to the visit; text that is not UTF-8 is given as bytes, which are refused."""
        self.empty = 0
        try:
            b"".join(self.frames).decode()
        except UnicodeDecodeError:
            self.curr_msg_data_type = "bytes"
        super().send_receive_event_to_app()

    def _count(self) -> None:
        self.empty += 1
        if self.empty > MOST_EMPTY:
            self.transport.abort()
