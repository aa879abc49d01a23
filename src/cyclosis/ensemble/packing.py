"""Many small arrays as one: what lanes report is brought to the host in one transfer instead of a dozen."""

from __future__ import annotations

from typing import Any

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


def unpacked(numbers: npt.NDArray[np.float64], like: Any) -> Any:
    """Return the tree whose numbers were `packed`; `like` has the shapes and types of its leaves."""
    leaves, structure = jax.tree.flatten(like)
    out: list[Any] = []
    at = 0
    for leaf in leaves:
        size = int(np.prod(leaf.shape))
        values: Any = numbers[at : at + size]
        at += size
        if np.issubdtype(leaf.dtype, np.complexfloating):
            values = values + 1j * numbers[at : at + size]
            at += size
        out.append(values.astype(leaf.dtype).reshape(leaf.shape))
    return jax.tree.unflatten(structure, out)
