"""Transforms in batches: the same right-hand side, with fewer and larger transforms."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.model import filaments
from cyclosis.model.operations import TRANSFORM, Operations
from cyclosis.model.precision import double
from cyclosis.model.system import system
from cyclosis.model.transforms_together import transforms_together

ROUNDING = {"float64": 1e-14, "float32": 1e-5}


def transforms(function, *arguments):
    """Return the shapes of the fields that a function transforms, in order."""
    found = Operations(jax.make_jaxpr(function)(*arguments)).needed()
    return [each.kinds[0].shape for each in found if each.name == TRANSFORM]


@pytest.mark.parametrize("precision", ROUNDING)
@pytest.mark.parametrize(
    ("shape", "changes", "kwargs"),
    [
        ((48, 12), {}, {}),
        ((24, 32), {"repulsion_angle": 0.4, "force_exponent": 1.0}, {}),
        ((16, 16), {}, {"dealias": "full"}),
        ((16, 15), {"mu": 0.3}, {"terms": ["advection", "bundling"]}),
        ((16, 16), {"zero_theta_flux": True}, {"closure": "von_mises"}),
    ],
    ids=["few points", "another force", "padded", "two terms", "closure"],
)
def test_the_rate_is_the_same_to_rounding(shape, changes, kwargs, precision):
    grid = cy.CylinderGrid(*shape)
    P = cy.initial.disordered(grid, 40, seed=2)
    with double():
        alone = system(cy.Parameters(**changes), grid, precision=precision, **kwargs)
        spectrum = alone.spectrum(P)
        expected, found = (
            np.asarray(each.rate(each.at(spectrum, 0.0))) for each in (alone, alone.in_batches())
        )
    assert found.dtype == expected.dtype
    assert np.abs(found - expected).max() < ROUNDING[precision] * np.abs(expected).max()


def test_independent_transforms_share_a_batch():
    """P and its divergence, u and its strain, and the two that lead back; the force has none beside it."""
    grid = cy.CylinderGrid(16, 12)
    with double():
        cell = system(cy.Parameters(), grid)
        spectrum = jnp.asarray(cell.spectrum(cy.initial.disordered(grid, 40)))

        def rate(spectrum):
            return filaments.nonlinear(cell.at(spectrum), cell.terms)

        assert transforms(rate, spectrum) == 7 * [(16, 12)]
        together = transforms(transforms_together(rate), spectrum)
    assert together == [(2, 16, 12), (16, 12), (2, 16, 12), (2, 16, 12)]


def test_transforms_of_different_kinds_or_that_wait_for_each_other_stay_apart():
    def several(a, b):
        first = jnp.fft.fft2(a)
        return jnp.fft.ifft2(first * b), jnp.fft.fft2(b), jnp.fft.ifft2(b), jnp.fft.fft2(b[:4])

    with double():
        a, b = _random(1), _random(2)
        found, expected = transforms_together(several)(a, b), several(a, b)
        shapes = transforms(transforms_together(several), a, b)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13)
    assert sorted(shapes) == [(2, 8, 8), (4, 8), (8, 8), (8, 8)]


def _random(seed):
    parts = np.random.default_rng(seed).normal(size=(2, 8, 8))
    return jnp.asarray(parts[0] + 1j * parts[1])
