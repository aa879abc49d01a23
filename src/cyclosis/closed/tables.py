"""Values of the surface harmonics on the points of a grid, built once for each surface and kept on disk."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .harmonics import Harmonics, Weighted, functions, harmonics, vector_powers
from .kept import kept
from .shapes import Shape

Array = npt.NDArray[np.float64]


class Tables(NamedTuple):
    """Harmonics on n_s points of the meridian, for m = 0..M, padded with zeros.

    `vector` (M + 1, n_s, J) holds p_mj(s), and `rate` (M + 1, J) λ; those of -m at s are those of m at S - s.
    `flow` (M + 1, n_s, K) holds the packed flow -(ψ' + (m/r) ψ) of the stream functions of the flow modes,
    and `viscous` (M + 1, K) β; the flow of -m at s is -parity (M + 1, K) times that of m at S - s. `modes`
    and `flows` say how many there are of each m, shape (M + 1,).
    """

    vector: Array
    rate: Array
    flow: Array
    viscous: Array
    parity: Array
    modes: npt.NDArray[np.int64]
    flows: npt.NDArray[np.int64]


@lru_cache(maxsize=8)
def tables(shape: Shape, k_max: float, n_s: int) -> Tables:
    """Return the `Tables` of a surface with harmonics up to k_max on n_s Gauss-Legendre points.

    They are kept on disk, so that the second process that needs them reads them.
    """
    key = {"surface": shape.table, "k_max": k_max, "n_s": n_s}
    return Tables(**kept(key, lambda: _computed(shape, k_max, n_s)._asdict()))


def _computed(shape: Shape, k_max: float, n_s: int) -> Tables:
    found, points = harmonics(shape, k_max), Weighted.of(shape, n_s)
    modes = np.array([len(one.rate) for one in found])
    flows = np.array([len(one.viscous) for one in found])
    M, J, K = len(found), int(modes.max()), int(flows.max())
    made = Tables(
        np.zeros((M, n_s, J)),
        np.zeros((M, J)),
        np.zeros((M, n_s, K)),
        np.zeros((M, K)),
        np.ones((M, K)),
        modes,
        flows,
    )
    for one in found:
        m, j, k = one.m, len(one.rate), len(one.viscous)
        value, flow, parity = _values(one, points)
        made.vector[m, :, :j], made.rate[m, :j] = value, one.rate
        made.flow[m, :, :k], made.viscous[m, :k], made.parity[m, :k] = flow, one.viscous, parity
    return made


def _values(one: Harmonics, points: Weighted) -> tuple[Array, Array, Array]:
    """Return the vectors, the flows, and the parity of the stream functions of one m."""
    value, _ = functions(points, vector_powers(one.m), len(one.vector))
    psi, slope = functions(points, (one.m, one.m), len(one.stream))
    stream, along = psi @ one.stream, slope @ one.stream
    flow = -(along + (one.m / points.meridian.r)[:, None] * stream)
    # Even stream functions give parity 1, odd ones -1; of m = 0, ψ itself may be any constant more.
    parity = -np.sign(np.sum(along * along[::-1], axis=0))
    return value @ one.vector, flow, parity
