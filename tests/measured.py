"""The sample files of measured cells, and the truth behind them."""

import contextlib
import importlib.util
import json
from functools import cache
from pathlib import Path

import numpy as np

import cyclosis as cy

SAMPLES = Path(__file__).parent / "observations" / "samples"
LENGTH = 5.0
VIEW = {"radius_px": 100.0, "axis_deg": 17.0, "centre_px": (30.0, 225.0), "facing": np.pi, "mirrored": False}
SCALES = cy.Scales(radius_um=500.0, speed_um_per_s=100.0)
HAS_TIFFFILE = importlib.util.find_spec("tifffile") is not None
PIXELS = {"y": "down", "speed": "px/s", "frame_s": 0.3}
"""What the raw files of OpenPIV do not say."""


@cache
def truth(name):
    """u or P (2, 64, 64) of the run, by the names in truth.npz."""
    with np.load(SAMPLES / "truth.npz") as stored:
        return stored[name].astype(float)


def at(field, theta, z):
    """A periodic field (2, n_theta, n_z) at points (theta, z) of one shape, by its Fourier series."""
    n, m = field.shape[1:]
    modes = np.fft.fft2(field) / (n * m)
    theta, z = np.broadcast_arrays(theta, z)
    around = np.exp(1j * np.outer(theta.ravel(), np.fft.fftfreq(n) * n))
    along = np.exp(2j * np.pi * np.outer(z.ravel(), np.fft.fftfreq(m) * m) / LENGTH)
    return np.einsum("cmq,am,aq->ca", modes, around, along).real.reshape(2, *theta.shape)


def errors(data, name, inside_deg=60.0):
    """|measured - truth| / peak, (2, n), within an angle from the facing line, where there are values."""
    theta, z = np.meshgrid(data["theta"].values, data["z"].values, indexing="ij")
    found, peak = data["u"].values, np.hypot(*truth(name)).max()
    near = np.abs(theta - np.pi) < np.radians(inside_deg)
    off = np.abs(found - at(truth(name), theta, z))[..., near] / peak
    return [off[:, k][np.isfinite(off[:, k])] for k in (0, 1)]


def run_of(*names):
    """A dataset like that of a run, with the flows of truth.npz at times 0, 1, ..."""
    import xarray

    u = np.stack([truth(name) for name in names])
    n, m = u.shape[2:]
    coords = {
        "time": np.arange(len(names), dtype=float),
        "component": ["theta", "z"],
        "theta": 2 * np.pi * np.arange(n) / n,
        "z": LENGTH * np.arange(m) / m,
    }
    dims = ("time", "component", "theta", "z")
    return xarray.Dataset({"u": (dims, u, {"units": "1"})}, coords, {"length": LENGTH})


def kymograph_truth():
    return json.loads((SAMPLES / "kymograph_truth.json").read_text())


@contextlib.contextmanager
def refused(*words):
    """What is inside raises `InputError` with these words, in one line."""
    try:
        yield
    except cy.InputError as error:
        said = str(error)
        assert all(word in said for word in words), said
        assert len(said.splitlines()) == 1, said
    else:
        raise AssertionError("no InputError")
