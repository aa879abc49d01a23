"""A run in closed form, for instruments to look at."""

import numpy as np
import xarray

LENGTH = 5.0


def cell(frames=(0.0, 1.0, 2.0), n=(32, 24), flow=None):
    """A run in closed form: two streams, a wave on them that grows in time, and P along z or -z."""
    flow = velocity if flow is None else flow
    n_theta, n_z = n
    theta = 2 * np.pi * np.arange(n_theta) / n_theta
    z = LENGTH * np.arange(n_z) / n_z
    u, P = np.zeros((2, len(frames), 2, n_theta, n_z))
    for k, t in enumerate(frames):
        u[k] = flow(theta[:, None], z[None, :], t)
        P[k, 1] = 0.9 * np.sign(np.sin(theta))[:, None]
    dims = ("time", "component", "theta", "z")
    coords = {"time": list(frames), "component": ["theta", "z"], "theta": theta, "z": z}
    return xarray.Dataset({"P": (dims, P), "u": (dims, u)}, coords, {"length": LENGTH})


def velocity(theta, z, t):
    q = 2 * np.pi / LENGTH
    growing = 0.2 + 0.1 * t
    around = growing * q * np.sin(theta) * np.sin(q * z)
    along = 0.8 * np.sin(theta) + growing * np.cos(theta) * np.cos(q * z)
    return np.stack([around, along + 0 * around])


def helical(theta, z, t):
    """Two streams with a right-handed helix on them that grows: no mirror image of itself."""
    q = 2 * np.pi / LENGTH
    growing = 0.2 + 0.1 * t
    wave = np.cos(theta + q * z)
    return np.stack([-growing * q * wave, 0.8 * np.sin(theta) + growing * wave])


RUN = cell()
