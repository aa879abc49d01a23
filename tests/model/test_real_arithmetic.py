"""Complex arithmetic in pairs of real arrays gives the same numbers, and leaves no complex arithmetic."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.model import system as systems
from cyclosis.model.precision import double
from cyclosis.model.real_arithmetic import in_real_arithmetic
from cyclosis.model.system import system

RNG = np.random.default_rng(0)
A, B = RNG.normal(size=(2, 6, 4)) + 1j * RNG.normal(size=(2, 6, 4))
R = RNG.normal(size=(6, 4))
GRID = cy.CylinderGrid(34, 32)
ALLOWED = {"fft", "complex", "real", "imag"}
"""What may touch a complex array: transforms, and putting together and taking apart."""

FUNCTIONS = {
    "sum": lambda a, b, r: a + b + r,
    "difference": lambda a, b, r: (r - a) - (b - r),
    "product": lambda a, b, r: a * b * r * (2j * b) * 3.0,
    "quotient by reals": lambda a, b, r: a / r + r / 2.0 * b,
    "quotient": lambda a, b, r: a / b + r / a,
    "conjugate": lambda a, b, r: jnp.conj(a) * b + jnp.conj(r * (1 + 0j)),
    "parts": lambda a, b, r: a.real * b.imag + (r * (1 + 0j)).imag + 1j * jnp.real(a),
    "powers": lambda a, b, r: a**2 + b**3 + jnp.square(a),
    "negative": lambda a, b, r: -a + (-(r + 0j)),
    "transforms": lambda a, b, r: jnp.fft.ifft2(jnp.fft.fft2(a) * b) + jnp.fft.fft2(r.astype(complex)),
    "moved": lambda a, b, r: jnp.roll(jnp.flip(a, (0, 1)), (1, 1), (0, 1)) + a.T.reshape(6, 4),
    "cut": lambda a, b, r: jnp.concatenate(jnp.split(a * b, 3)[::-1]) + jnp.concatenate(jnp.split(r + 0j, 2)),
    "stacked": lambda a, b, r: jnp.stack([a, r + 0j, b])[::2].sum(axis=0),
    "of reals": lambda a, b, r: jnp.concatenate([r + 0j, r + 0j]) * 1j,
    "chosen": lambda a, b, r: jnp.where(r > 0, a, 0.0) + jnp.where(r < 0, r + 0j, 1j),
    "another primitive": lambda a, b, r: jnp.exp(a) + jnp.cumsum(b, axis=0) + jnp.abs(a),
    "branches": lambda a, b, r: jax.lax.cond(r[0, 0] > 0, lambda x: x * b, lambda x: x - b, a),
    "no complex number": lambda a, b, r: r * jnp.sin(r),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_numbers_are_the_same(name):
    function = FUNCTIONS[name]
    with double():
        expected, found = function(A, B, R), in_real_arithmetic(function)(*map(jnp.asarray, (A, B, R)))
        assert found.dtype == jnp.asarray(expected).dtype
        np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-14)


def test_it_passes_through_transformations_of_functions():
    def loss(function):
        return lambda a: jnp.sum(jnp.abs(function(a, B, R)) ** 2)

    function = FUNCTIONS["product"]
    rewritten = in_real_arithmetic(function)
    with double():
        one, other = (jax.grad(loss(f))(jnp.asarray(A)) for f in (function, rewritten))
        np.testing.assert_allclose(other, one, rtol=1e-13)
        many = jnp.stack([A, B, A + B])
        one, other = (jax.vmap(lambda a, f=f: f(a, B, R))(many) for f in (function, rewritten))
        np.testing.assert_allclose(other, one, rtol=1e-13)


def used(jaxpr):
    """Return the names of all primitives that touch complex arrays, in a program and those inside it."""
    found = set()
    for equation in jaxpr.eqns:
        inner = equation.params.get("jaxpr")
        if inner is not None:
            found |= used(inner.jaxpr)
        elif any(jnp.iscomplexobj(atom.aval) for atom in (*equation.invars, *equation.outvars)):
            found.add(equation.primitive.name)
    return found


@pytest.mark.parametrize("dealias", ["none", "cubic"])
@pytest.mark.parametrize("given", [{}, {"force_exponent": 1.5}, {"repulsion_angle": 0.3}])
def test_the_right_hand_side_in_pairs(given, dealias, monkeypatch):
    cell = system(cy.Parameters(**given), GRID, dealias=dealias)
    spectrum = cell.spectrum(cy.initial.disordered(GRID, 100, seed=1))

    def rate():
        return lambda Z: cell.nonlinear(cell.at(Z))

    with double():
        assert used(jax.make_jaxpr(rate())(spectrum).jaxpr) <= ALLOWED
        found = jax.jit(rate())(spectrum)
        monkeypatch.setattr(systems, "SMALL", GRID.n_theta * GRID.n_z)
        assert "mul" in used(jax.make_jaxpr(rate())(spectrum).jaxpr)
        expected = jax.jit(rate())(spectrum)
    assert np.abs(found - expected).max() < 1e-14 * np.abs(expected).max()


def test_a_custom_term_stays_as_its_author_wrote_it():
    def turning(t, P, u, params, grid):
        square = jax.custom_jvp(lambda x: x**2)
        square.defjvp(lambda values, slopes: (values[0] ** 2, 2 * values[0] * slopes[0]))
        return square(P) * 1e-3

    state = cy.initial.stripes(GRID)
    rate = cy.rate_of_change(cy.Parameters(), GRID, state, terms=[turning])
    np.testing.assert_allclose(rate, 1e-3 * state**2, atol=1e-17)
