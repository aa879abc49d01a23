"""Many small arrays as one: what lanes report is brought to the host in one transfer instead of a dozen."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt


def packed(tree: Any) -> jax.Array:
    """Return the numbers of all leaves of a tree, one after another, in double precision (traceable).

    Nothing is rounded: complex leaves become pairs, whole numbers and flags are exact below 2^53.
    """
    return jnp.concatenate([part for leaf in jax.tree.leaves(tree) for part in _parts(jnp.asarray(leaf))])


def _parts(leaf: jax.Array) -> list[jax.Array]:
    parts = [leaf.real, leaf.imag] if jnp.iscomplexobj(leaf) else [leaf]
    return [jnp.ravel(part).astype(jnp.float64) for part in parts]


class Packing:
    """How the leaves of a tree lie among its `packed` numbers; `like` has their shapes and types.

    It is found once, because a member in a lane is looked at every few steps.
    """

    def __init__(self, like: Any) -> None:
        leaves, self._structure = jax.tree.flatten(like)
        self._places: list[_Place] = []
        at = 0
        for leaf in leaves:
            size = int(np.prod(leaf.shape))
            parts = 2 if np.issubdtype(leaf.dtype, np.complexfloating) else 1
            self._places.append(_Place(at, size, parts == 2, np.dtype(leaf.dtype), leaf.shape))
            at += parts * size

    def unpacked(self, numbers: npt.NDArray[np.float64]) -> Any:
        """Return the tree of these numbers."""
        return jax.tree.unflatten(self._structure, [place.of(numbers) for place in self._places])


class _Place(NamedTuple):
    """Where a leaf begins among the numbers, how many values it has, and what they are."""

    start: int
    size: int
    complex: bool
    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    def of(self, numbers: npt.NDArray[np.float64]) -> Any:
        """Return the leaf."""
        if not self.shape and not self.complex:
            return self.dtype.type(numbers[self.start])
        middle = self.start + self.size
        values: Any = numbers[self.start : middle]
        if self.complex:
            values = values + 1j * numbers[middle : middle + self.size]
        return values.astype(self.dtype).reshape(self.shape)
