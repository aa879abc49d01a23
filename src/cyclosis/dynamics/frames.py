"""Saved fields: in memory while they are few, in a temporary file once they are many."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from typing import IO, Any, overload

import numpy as np
import numpy.typing as npt

from ..display.shown import shown

MEMORY_LIMIT = 256 * 2**20
"""Bytes of frames that are kept in memory before all go to a temporary file."""


@shown
class Frames:
    """A growing sequence of arrays of one shape and type, read back one by one.

    The first `elsewhere` frames are counted but not held: they are in the file that the run streams to.
    """

    def __init__(
        self, shape: tuple[int, ...], dtype: npt.DTypeLike, limit: int = MEMORY_LIMIT, elsewhere: int = 0
    ) -> None:
        self.shape, self.dtype, self.elsewhere = shape, np.dtype(dtype), elsewhere
        self._bytes = int(np.prod(shape)) * self.dtype.itemsize
        self._limit = limit
        self._memory: list[npt.NDArray[Any]] = []
        self._file: IO[bytes] | None = None
        self._count = 0

    def __repr__(self) -> str:
        return f"Frames({len(self)} of shape {self.shape}, {self.dtype})"

    def append(self, frame: npt.NDArray[Any]) -> None:
        """Store a copy of `frame` at the end."""
        kept = np.array(frame, dtype=self.dtype, order="C")
        if self._file is None and (self._count + 1) * self._bytes > self._limit:
            self._file = tempfile.TemporaryFile(prefix="cyclosis-frames-")  # noqa: SIM115
            for earlier in self._memory:
                self._file.write(earlier.tobytes())
            self._memory.clear()
        if self._file is None:
            self._memory.append(kept)
        else:
            self._file.seek(self._count * self._bytes)
            self._file.write(kept.tobytes())
        self._count += 1

    def copy(self) -> Frames:
        """Return a sequence that starts with these frames and grows separately."""
        other = Frames(self.shape, self.dtype, self._limit, self.elsewhere)
        for index in range(self.elsewhere, len(self)):
            other.append(self[index])
        return other

    def release(self) -> None:
        """Forget the frames held so far: they have been written elsewhere."""
        self.elsewhere += self._count
        self._count = 0
        self._memory.clear()
        if self._file is not None:
            self._file.close()
            self._file = None

    def __len__(self) -> int:
        return self.elsewhere + self._count

    @overload
    def __getitem__(self, index: int) -> npt.NDArray[Any]: ...

    @overload
    def __getitem__(self, index: slice) -> list[npt.NDArray[Any]]: ...

    def __getitem__(self, index: int | slice) -> npt.NDArray[Any] | list[npt.NDArray[Any]]:
        if isinstance(index, slice):
            return [self[at] for at in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        index = index % len(self) - self.elsewhere
        if index < 0:
            raise IndexError(f"frame {index + self.elsewhere} is in the file that the run was written to")
        if self._file is None:
            return self._memory[index]
        self._file.seek(index * self._bytes)
        return np.frombuffer(self._file.read(self._bytes), self.dtype).reshape(self.shape)

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        return (self[index] for index in range(len(self)))
