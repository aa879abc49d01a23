"""The flow of a run at any point: its trigonometric interpolant, and its correlation with a measurement."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ModelFlow:
    """u (time, 2, n_theta, n_z) of a run at its saved `times`, on a periodic cylinder of a `length`."""

    times: Array
    u: Array
    length: float

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of points around and along the cell."""
        return self.u.shape[2], self.u.shape[3]

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last saved time."""
        return float(self.times[0]), float(self.times[-1])

    @property
    def peak(self) -> float:
        """The largest speed."""
        return float(np.hypot(self.u[:, 0], self.u[:, 1]).max())

    def at(self, times: Array, mirror: bool) -> Array:
        """Return u at some times, linear between the saved ones and constant beyond; its mirror image if asked."""
        at = np.clip(times, *self.span)
        k = np.clip(np.searchsorted(self.times, at, side="right") - 1, 0, max(self.times.size - 2, 0))
        nxt = np.minimum(k + 1, self.times.size - 1)
        gap = np.where(nxt > k, self.times[nxt] - self.times[k], 1.0)
        share = ((at - self.times[k]) / gap)[:, None, None, None]
        u = (1 - share) * self.u[k] + share * self.u[nxt]
        if mirror:
            u = np.roll(u[:, :, ::-1], 1, axis=2) * np.array([-1.0, 1.0])[None, :, None, None]
        return np.asarray(u)

    def coarse(
        self, frames: Array, u: Array, weights: Array, theta: Array, z: Array, speed: float | None
    ) -> tuple[float, float, float, float]:
        """Return the least cost over all shifts by grid points, and the rotation, shift and speed there."""
        seen, weight = self._gridded(u, weights, theta, z)
        model = np.fft.rfft2(frames)
        square = np.fft.rfft2(frames**2)
        overlap = np.fft.irfft2((np.fft.rfft2(seen) * model.conj()).sum(axis=(0, 1)), self.shape)
        power = np.fft.irfft2((np.fft.rfft2(weight) * square.conj()).sum(axis=(0, 1)), self.shape)
        power = np.maximum(power, 1e-12 * max(float(power.max()), 1e-300))
        total = float((weights * u**2).sum())
        if speed is None:
            gain = np.where(overlap > 0, overlap**2 / power, 0.0)
            U = overlap / power
        else:
            gain = 2 * speed * overlap - speed**2 * power
            U = np.full_like(overlap, speed)
        i, j = np.unravel_index(int(gain.argmax()), gain.shape)
        turn, shift = 2 * np.pi * i / self.shape[0], self.length * j / self.shape[1]
        return total - float(gain[i, j]), float(turn), float(shift), max(float(U[i, j]), 1e-12)

    def _gridded(self, u: Array, weights: Array, theta: Array, z: Array) -> tuple[Array, Array]:
        """Return weight times u, and weight, summed over the cells of the run's grid."""
        n, m = self.shape
        i = np.round(theta * n / (2 * np.pi)).astype(int) % n
        j = np.round(z * m / self.length).astype(int) % m
        place = (i[:, None] * m + j[None, :]).ravel()
        out = []
        for values in (weights * u, weights):
            flat = values.reshape(-1, place.size)
            cells = np.stack([np.bincount(place, each, minlength=n * m) for each in flat])
            out.append(cells.reshape(*values.shape[:2], n, m))
        return out[0], out[1]

    def fitted(
        self,
        frames: Array,
        place: Array,
        u: Array,
        weights: Array,
        theta: Array,
        z: Array,
        speed: float | None,
    ) -> tuple[float, float, Array]:
        """Return the cost at a rotation and shift, the best speed, and the model's values there."""
        f = self._interpolant(frames, theta - place[0], z - place[1])
        if speed is None:
            power = float((weights * f**2).sum())
            speed = max(float((weights * u * f).sum()) / power, 1e-12) if power > 0 else 1e-12
        model = speed * f
        return float((weights * (u - model) ** 2).sum()), speed, model

    def _interpolant(self, frames: Array, theta: Array, z: Array) -> Array:
        n, m = self.shape
        around = _weights(n, theta)
        along = _weights(m, 2 * np.pi * z / self.length)
        return np.asarray(np.einsum("ai,tcij,bj->tcab", around, frames, along, optimize=True))


def _weights(n: int, angle: Array) -> Array:
    """Return what each of n periodic samples counts for the trigonometric interpolant at some angles."""
    k = np.fft.fftfreq(n) * n
    phase = np.exp(1j * np.outer(angle, k))
    if n % 2 == 0:
        phase[:, n // 2] = np.cos(angle * n / 2)
    return np.asarray(np.fft.fft(phase, axis=1).real / n)


def model_flow(run: Any) -> ModelFlow:
    """Return the flow of a run, a dataset or a file of one. Raises `InputError` for anything else."""
    import xarray

    if isinstance(run, str | os.PathLike):
        from ..dataset import open_dataset

        with open_dataset(run) as data:
            return model_flow(data[["u"]].load())
    data = run.to_dataset() if hasattr(run, "to_dataset") and not isinstance(run, xarray.Dataset) else run
    if not isinstance(data, xarray.Dataset) or "u" not in data:
        rule = "a run, its dataset or its file, with the flow u"
        raise InputError("run", type(run).__name__, rule, "simulate one")
    if data["u"].dims != ("time", "component", "theta", "z"):
        rule = "a run of the cylinder, with u over (time, component, theta, z)"
        raise InputError("run", list(data["u"].dims), rule, "use a run of another model")
    u = np.asarray(data["u"].values, dtype=np.float64)
    z = np.asarray(data["z"].values, dtype=np.float64)
    length = float(data.attrs.get("length", z.size * (z[1] - z[0])))
    if not np.isfinite(u).all() or not u.any():
        raise InputError("run", type(run).__name__, "a run with a finite flow that moves", "use another")
    return ModelFlow(np.asarray(data["time"].values, dtype=np.float64), u, length)
