"""Silencing Dask's log on the terminal, since a sweep reports its own problems."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager

LIGHT = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.interval": "10s",
}
"""Settings of Dask that save processor time: its profiles and charts are not used."""


def level() -> int:
    """Return the lowest level at which messages of Dask are shown: all if CYCLOSIS_TRACEBACK is set."""
    return logging.NOTSET if os.environ.get("CYCLOSIS_TRACEBACK") else logging.CRITICAL


@contextmanager
def quiet() -> Iterator[None]:
    """Silence Dask in this process."""
    handlers = logging.getLogger("distributed").handlers
    before = [handler.level for handler in handlers]
    for handler in handlers:
        handler.setLevel(max(level(), handler.level))
    try:
        yield
    finally:
        for handler, old in zip(handlers, before, strict=True):
            handler.setLevel(old)
