"""What the physics tests and `benchmarks/validation.py` measure: each number beside its bound."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Row(NamedTuple):
    """One measured number: what it is, its value, and the interval it must lie in (None: only reported)."""

    law: str
    quantity: str
    value: float
    high: float | None = None
    low: float | None = None

    @property
    def ok(self) -> bool:
        above = self.low is None or self.value >= self.low
        return bool(np.isfinite(self.value) and above and (self.high is None or self.value <= self.high))

    @property
    def bound(self) -> str:
        if self.low is None:
            return "reported" if self.high is None else f"<= {self.high:.3g}"
        if self.high is None:
            return f">= {self.low:.3g}"
        return f"{(self.high + self.low) / 2:.3g} +- {(self.high - self.low) / 2:.3g}"


def check(rows):
    """Assert that every row lies within its bound, and say which do not."""
    assert rows
    failed = [f"{row.law}: {row.quantity} = {row.value:.6e}, bound {row.bound}" for row in rows if not row.ok]
    assert not failed, "\n".join(failed)


def furthest(a, b):
    """Return the largest difference of two arrays relative to the largest value of the second."""
    return float(np.max(np.abs(np.asarray(a) - b)) / np.max(np.abs(b)))


def band_limited(seed, shape, modes, largest=0.95):
    """Return a random state whose modes reach `modes`, with max |P| = `largest`."""
    rng = np.random.default_rng(seed)
    spectrum = np.zeros((2, *shape), dtype=complex)
    rows, cols = (np.arange(-h, h + 1) for h in modes)
    size = (2, rows.size, cols.size)
    spectrum[:, rows[:, None], cols] = rng.normal(size=size) + 1j * rng.normal(size=size)
    P = np.fft.ifft2(spectrum).real
    return P * (largest / np.hypot(*P).max())


def broadband(seed, shape, largest=0.95):
    """Return a state of independent random numbers at every point, with max |P| = `largest`."""
    P = np.random.default_rng(seed).normal(size=(2, *shape))
    return P * (largest / np.hypot(*P).max())
