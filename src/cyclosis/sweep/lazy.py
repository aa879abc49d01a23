"""Final fields over the axes of a sweep, read from the blocks that hold them when they are used."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from xarray.backends import BackendArray
from xarray.core import indexing

from .store import Store
from .variables import Variable


class StoredArray(BackendArray):
    """A variable over (axes..., seed) and its own dimensions, of which nothing is in memory.

    `standing` are the blocks that there are; what the others would hold is missing. Each block that a
    selection touches is read once and checked.
    """

    def __init__(self, store: Store, item: Variable, standing: set[int]) -> None:
        self.store, self.item, self.standing = store, item, standing
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
        """Return what slices, indices and arrays of indices, each along its own dimension, select."""
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
        for index in sorted(set(blocks.tolist()) & self.standing):
            values = self.store.read(index, (self.item.name,))[self.item.name]
            for at in np.flatnonzero(blocks == index):
                out[at] = values[flat[at] - index * sweep.block_size][inner]
        return out.reshape([size for place in places for size in place.shape])
