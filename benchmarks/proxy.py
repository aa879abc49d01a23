"""A proxy between a client and the explorer that can swallow all that passes, as a dead network does."""

from __future__ import annotations

import contextlib
import socket
import threading


class Proxy:
    """Forwards connections to a port. While `swallowing`, sockets stay open and nothing is forwarded.

    A connection of which bytes were swallowed stays dead; `ended` counts those that the server has ended.
    """

    def __init__(self, port: int) -> None:
        self.target, self.ended = port, 0
        self.swallowing = threading.Event()
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.port = self.listening.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self.listening.accept()
                try:
                    far = socket.create_connection(("127.0.0.1", self.target), 10)
                except OSError:  # there is no server
                    near.close()
                    continue
                far.settimeout(None)
                for one in (near, far):
                    one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                dead = threading.Event()
                for source, sink, server in ((near, far, False), (far, near, True)):
                    ends = source, sink, dead, server
                    threading.Thread(target=self._pump, args=ends, daemon=True).start()

    def _pump(self, source: socket.socket, sink: socket.socket, dead: threading.Event, server: bool) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                if self.swallowing.is_set():
                    dead.set()
                if not dead.is_set():
                    sink.sendall(data)
        if server:
            self.ended += 1
        if not dead.is_set():
            for each in (source, sink):
                with contextlib.suppress(OSError):
                    each.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Take no more connections."""
        self.listening.close()
