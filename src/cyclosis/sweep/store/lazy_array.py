"""Final fields over the axes of a sweep, read from their blocks only when they are used."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from xarray.backends import BackendArray
from xarray.core import indexing

from ..plan.variables import Variable
from .store import Store


class StoredArray(BackendArray):
    """A variable over (axes..., seed) and its own dimensions that is not held in memory.

    `present` are the indices of the blocks in the store; values of all others are missing. Each block that a
    selection needs is read and checked once.
    """

    def __init__(self, store: Store, item: Variable, present: set[int]) -> None:
        self.store, self.item, self.present = store, item, present
        sweep = store.sweep
        self.shape = (*sweep.shape, *(sweep.sizes[dim] for dim in item.dims))
        self.dtype = np.dtype(item.dtype)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> npt.NDArray[Any]:
        """Return a selection."""
        found: npt.NDArray[Any] = indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER, self._outer
        )
        return found

    def _outer(self, key: tuple[Any, ...]) -> npt.NDArray[Any]:
        """Return the selection by slices, indices and arrays of indices, one for each dimension."""
        sweep = self.store.sweep
        lead = len(sweep.shape)
        places = [np.arange(size)[chosen] for size, chosen in zip(self.shape, key, strict=True)]
        grid = np.ix_(*(np.atleast_1d(place) for place in places[:lead]))
        numbers = np.ravel_multi_index(tuple(np.broadcast_arrays(*grid)), sweep.shape)
        inner = np.ix_(*(np.atleast_1d(place) for place in places[lead:]))
        flat = numbers.ravel()
        sizes = [np.atleast_1d(place).size for place in places[lead:]]
        out = self.item.empty((flat.size, *sizes))
        blocks = flat // sweep.block_size
        for index in sorted(set(blocks.tolist()) & self.present):
            values = self.store.read(index, (self.item.name,))[self.item.name]
            for at in np.flatnonzero(blocks == index):
                out[at] = values[flat[at] - index * sweep.block_size][inner]
        return out.reshape([size for place in places for size in place.shape])
