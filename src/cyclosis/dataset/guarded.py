"""A file object for writing HDF5, so that a full disk is an error and not a crash.

When a write fails, HDF5 tries again while closing the file, and may crash the process. This object therefore
hides the failure from HDF5: it stores the error, and keeps in memory what HDF5 continues to write. The caller
calls `check`, which raises the error, and removes the file.
"""

from __future__ import annotations

import io
import os
from pathlib import Path


class GuardedFile(io.RawIOBase):
    """A new file at `path`, readable, writable and seekable; a failed write is stored and not raised."""

    def __init__(self, path: Path) -> None:
        self._file = open(path, "w+b", buffering=0)  # noqa: SIM115
        self._position = self._size = 0
        self._kept: list[tuple[int, bytes]] = []
        self.error: OSError | None = None

    def check(self) -> None:
        """Raise the first error, if any."""
        if self.error is not None:
            raise self.error

    def sync(self) -> None:
        """Make the file durable. Raises `OSError` if this or an earlier write failed."""
        self.check()
        os.fsync(self._file.fileno())

    def readable(self) -> bool:
        """Return True."""
        return True

    def writable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True

    def seek(self, offset: int, whence: int = 0) -> int:
        """Move to a position."""
        self._position = offset + (0, self._position, self._size)[whence]
        return self._position

    def tell(self) -> int:
        """Return the position."""
        return self._position

    def write(self, data: object) -> int:
        """Write at the position, or keep the data once the disk has failed."""
        view = memoryview(data).cast("B")  # type: ignore[arg-type]
        if self.error is None:
            try:
                self._file.seek(self._position)
                done = 0
                while done < len(view):
                    done += self._file.write(view[done:])
            except OSError as error:
                self.error = error
        if self.error is not None:
            self._kept.append((self._position, bytes(view)))
        self._position += len(view)
        self._size = max(self._size, self._position)
        return len(view)

    def readinto(self, buffer: object) -> int:
        """Read from the position into a buffer."""
        view = memoryview(buffer).cast("B")  # type: ignore[arg-type]
        count = max(0, min(len(view), self._size - self._position))
        self._file.seek(self._position)
        stored = self._file.read(count)
        view[: len(stored)] = stored
        view[len(stored) : count] = bytes(count - len(stored))
        for offset, data in self._kept:
            low, high = max(offset, self._position), min(offset + len(data), self._position + count)
            if low < high:
                view[low - self._position : high - self._position] = data[low - offset : high - offset]
        self._position += count
        return count

    def truncate(self, size: int | None = None) -> int:
        """Set the size."""
        self._size = self._position if size is None else size
        if self.error is None:
            try:
                self._file.truncate(self._size)
            except OSError as error:
                self.error = error
        return self._size

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()
