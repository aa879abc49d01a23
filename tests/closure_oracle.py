"""Closures of the equation for filament angles in plain array code: an oracle for the polar model's closures.

Filaments at one place have a density f(φ) of angles with mean direction <p> = P. A closure is a family of
densities with one member for each P. The mean of dp/dt = (I - pp)·T(p) over f, with

    T(p) = ε (p·∇)u + α_p P + α_u u - κ (p·d) d,

needs <pp> and <ppp>, which are sums over angles here: there are no Fourier moments and no complex packing.
The flow, gradients and diffusion are those of the oracle of the polar model.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.special import ive

import oracle

ANGLES = 384


def von_mises(magnitude, offset):
    """Return exp(x cos) / ∫ with x such that the mean is the magnitude."""
    x = brentq(lambda x: ive(1, x) / ive(0, x) - magnitude, 0.0, 1e4, xtol=1e-14, rtol=1e-14)
    return np.exp(x * (np.cos(offset) - 1))


def wrapped_normal(magnitude, offset):
    """Return the sum of normal densities at all turns of the circle."""
    if magnitude < 0.05:  # too wide for a sum over turns
        return 1 + 2 * sum(magnitude ** (n * n) * np.cos(n * offset) for n in range(1, 5))
    variance = -2 * np.log(magnitude)
    turns = 2 * np.pi * np.arange(-12, 13)[:, None]
    return np.exp(-((offset + turns) ** 2) / (2 * variance)).sum(axis=0)


def weak(magnitude, offset):
    """Return the wrapped Cauchy density, all of whose moments are powers of the first."""
    return (1 - magnitude**2) / (1 + magnitude**2 - 2 * magnitude * np.cos(offset))


FAMILIES = {"von_mises": von_mises, "wrapped_normal": wrapped_normal, "weak": weak}


def tensors(closure, P):
    """Return <pp> and <ppp> of a state, with the indices of the tensors first."""
    phi = 2 * np.pi * np.arange(ANGLES) / ANGLES
    p = np.array([np.cos(phi), np.sin(phi)])
    two, three = np.zeros((2, 2, *P.shape[1:])), np.zeros((2, 2, 2, *P.shape[1:]))
    for at in np.ndindex(*P.shape[1:]):
        here = P[(slice(None), *at)]
        f = FAMILIES[closure](np.hypot(*here), phi - np.arctan2(here[1], here[0]))
        f = f / f.sum()
        two[(..., *at)] = np.einsum("f,if,jf->ij", f, p, p)
        three[(..., *at)] = np.einsum("f,if,jf,kf->ijk", f, p, p, p)
    return two, three


def terms(values, length, P, closure, names=oracle.TERMS):
    """Return the named terms of dP/dt, each of shape (2, n_theta, n_z); `values` as in `oracle`."""
    u = oracle.flow(values, length, P)
    P = oracle.both(P, P[0].shape)
    two, three = tensors(closure, P)
    slopes = np.stack([oracle.gradient(u[i], length) for i in (0, 1)])  # slopes[i, k] = d_k u_i
    d = np.array([np.cos(values.repulsion_angle), np.sin(values.repulsion_angle)])
    d = d.reshape(2, *(d.shape[1:] or (1, 1))) * np.ones((2, *P[0].shape))
    torques = {
        "shear": values.epsilon
        * (np.einsum("kxy,ikxy->ixy", P, slopes) - np.einsum("ijkxy,jkxy->ixy", three, slopes)),
        "bundling": values.alpha_p * (P - np.einsum("ijxy,jxy->ixy", two, P)),
        "flow_alignment": values.alpha_u * (u - np.einsum("ijxy,jxy->ixy", two, u)),
        "repulsion": -values.kappa
        * (np.einsum("kxy,kxy,ixy->ixy", P, d, d) - np.einsum("ijkxy,kxy,jxy->ixy", three, d, d)),
    }
    rest = oracle.terms(values, length, P, [name for name in names if name not in torques])
    return {name: rest[name] if name in rest else oracle.both(torques[name], P[0].shape) for name in names}


def rate(values, length, P, closure):
    """Return dP/dt, shape (2, n_theta, n_z)."""
    return sum(terms(values, length, P, closure).values())
