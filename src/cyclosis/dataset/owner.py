"""The owner of a run's file: one writer at a time.

A writer owns the folder of a run's parts while it holds an operating system lock on the file `owner.json` in
it. The lock is released when the process ends, in whatever way, so that a killed process blocks nobody. The
file records the process, when it started, and its machine. It is used in messages, and in two cases in which
the lock is not sufficient: a writer on another machine is always assumed to be running, and on a file system
without locks the process and its start time decide. Within a process, a writer is replaced by a new one of
the same thread, because it cannot be writing at that time, and by one of any thread once its own has ended.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import secrets
import socket
import sys
import threading
import time
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import Any

from ..model.errors import InputError

NAME = "owner.json"
_PATIENCE = 0.3
"""Seconds for which a held lock is tried again: another process may only be checking it."""
_SAME_START = 2.0
"""Seconds by which two readings of a process's start time may differ, since clocks are adjusted."""


@dataclass(frozen=True)
class Who:
    """A writer: its process, when that started, its machine and boot, and since when it has been writing.

    Times are in seconds since 1970.
    """

    pid: int
    started: float
    host: str
    boot: str
    since: float
    token: str

    def is_far(self) -> bool:
        """Return whether this writer is on another machine (containers of one machine share its boot)."""
        return self.host != socket.gethostname() and self.boot != (_boot() or "-")

    def is_alive(self) -> bool:
        """Return whether its process, on this machine, still runs: the number may have been reused."""
        import psutil  # needed only if there are no locks

        try:
            return bool(abs(psutil.Process(self.pid).create_time() - self.started) < _SAME_START)
        except psutil.NoSuchProcess:
            return False
        except psutil.AccessDenied:
            return True

    def __str__(self) -> str:
        since = datetime.fromtimestamp(self.since).isoformat(" ", "minutes")
        name = "another thread" if self.token in _HELD else f"process {self.pid} on {self.host}"
        return f"{name} has been writing it since {since}"


class Owner:
    """The right to write a file, held until it is released or its process ends; also a context manager."""

    def __init__(self, folder: Path, handle: int, who: Who) -> None:
        self.folder, self.handle, self.who = folder, handle, who
        self.thread, self.pid = threading.current_thread(), os.getpid()

    def check(self, target: Path) -> None:
        """Raise `InputError` unless the folder is still owned; records the calling thread."""
        self.thread = threading.current_thread()
        if not self._holds():
            rule = "written to by one writer, and this one was closed or replaced, or its folder was removed"
            raise InputError("out", str(target), rule, "make a new RunWriter")

    def _holds(self) -> bool:
        if self.handle < 0 or self.pid != os.getpid():
            return False
        found = _read(self.folder / NAME)
        return found is not None and found.token == self.who.token

    def release(self) -> None:
        """Release the folder, and remove it if it is empty. Does nothing if it is no longer owned."""
        with _LOCK:
            if self.handle < 0 or self.pid != os.getpid():
                return
            path, held = self.folder / NAME, self._holds()
            try:
                if held:
                    path.unlink()
            except OSError:  # Windows cannot remove an open file
                self._close()
                with contextlib.suppress(OSError):
                    path.unlink()
            self._close()
        with contextlib.suppress(OSError):
            self.folder.rmdir()

    def _close(self) -> None:
        if self.handle >= 0:
            _HELD.pop(self.who.token, None)
            os.close(self.handle)
            self.handle = -1

    def _is_idle(self) -> bool:
        return self.thread is threading.current_thread() or not self.thread.is_alive()

    def __enter__(self) -> Owner:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()


_HELD: dict[str, Owner] = {}
_LOCK = threading.RLock()


def claim(folder: Path, target: Path, field: str = "out") -> Owner:
    """Return the ownership of the folder of the parts of `target`, which is created if it does not exist.

    Raises `InputError` if a running writer, or one on another machine, owns it, and `OSError` if the folder
    cannot be created or written to.
    """
    folder = Path(os.path.abspath(folder))
    until = time.monotonic() + _PATIENCE
    while True:
        with _LOCK:
            got = _try(folder)
        if isinstance(got, Owner):
            return got
        if time.monotonic() > until:
            raise _owned(target, field, got, folder)
        time.sleep(0.01)


def refuse_living(folder: Path, target: Path, field: str = "out") -> None:
    """Raise `InputError` if `claim` would, and change nothing."""
    with _LOCK:
        found = _read(folder / NAME)
        ours = _HELD.get(found.token) if found is not None else None
        if ours is not None and ours._is_idle():
            return
    claim(folder, target, field).release()


def _try(folder: Path) -> Owner | Who | None:
    """Return the ownership of a folder, or its present owner, or None if that is not known now."""
    folder.mkdir(exist_ok=True)
    path = folder / NAME
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
    except FileNotFoundError:  # the folder has just been removed
        return None
    kept = False
    try:
        found = _read(path)
        ours = _HELD.get(found.token) if found is not None else None
        if ours is not None and ours._is_idle():
            ours._close()
            found = None
        free = _locked(handle)
        if free is False or (found is not None and (found.is_far() or (free is None and found.is_alive()))):
            return found
        if not _same(handle, path):  # it has just been released
            return None
        owner = Owner(folder, handle, _myself())
        try:
            os.ftruncate(handle, 0)
            os.write(handle, json.dumps(asdict(owner.who)).encode())
            os.fsync(handle)
        except OSError:  # a full disk: remove what could not be written
            with contextlib.suppress(OSError):
                path.unlink()
                folder.rmdir()
            raise
        _HELD[owner.who.token] = owner
        kept = True
        return owner
    finally:
        if not kept:
            os.close(handle)


def _owned(target: Path, field: str, who: Who | None, folder: Path) -> InputError:
    rule = f"a file that nothing else is writing, but {who or 'another process is writing it'}"
    remedy = "wait until it ends, or stop it (Ctrl-C saves), or choose another name"
    if who is not None and who.is_far():
        remedy = f"wait until it ends; if you know that it no longer runs, remove {folder / NAME}"
    return InputError(field, str(target), rule, remedy)


def _myself() -> Who:
    import psutil

    started = float(psutil.Process().create_time())
    return Who(os.getpid(), started, socket.gethostname(), _boot(), time.time(), secrets.token_hex(8))


def _boot() -> str:
    """Return an identifier of this boot of this machine, or "" if the system has none."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text().strip()
    except OSError:
        return ""


def _read(path: Path) -> Who | None:
    try:
        found: dict[str, Any] = json.loads(path.read_bytes())
        return Who(**found)
    except (OSError, ValueError, TypeError):
        return None


def _same(handle: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), os.stat(path))
    except OSError:
        return False


if sys.platform == "win32":
    import msvcrt

    def _locked(handle: int) -> bool | None:
        """Lock an open file until it is closed; return whether that went well, None where it cannot be."""
        try:
            os.lseek(handle, 2**30, os.SEEK_SET)  # beyond all content, which others are to read
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            return True
        except OSError as error:
            return False if error.errno in (errno.EACCES, errno.EDEADLK) else None
        finally:
            os.lseek(handle, 0, os.SEEK_SET)

else:
    import fcntl

    def _locked(handle: int) -> bool | None:
        """Lock an open file until it is closed; return whether that went well, None where it cannot be."""
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except OSError as error:
            return False if error.errno in (errno.EWOULDBLOCK, errno.EACCES) else None


def _forget() -> None:
    """Forget all owners after a fork: the copy of a process must neither write nor keep its locks."""
    global _LOCK
    _LOCK = threading.RLock()
    for owner in list(_HELD.values()):
        owner._close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
