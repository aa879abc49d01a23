import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

from cyclosis.dynamics.steppers import phi, tableau
from cyclosis.model.precision import double


@pytest.mark.parametrize("z", [0.0, -1e-12, -1e-5, -0.1, -0.999999, -1.0, -1.5, -7.0, -50.0, -1e4])
def test_phi_functions_against_high_precision(z):
    """φ_k(z) = Σ z^j / (j + k)!, by its sum in 60 digits."""
    with double():
        ours = [float(value) for value in phi(jnp.asarray(z))]
    with mpmath.workdps(60):
        for k, value in enumerate(ours, start=1):
            x = mpmath.mpf(z)
            exact = mpmath.exp(x)
            if z == 0.0:
                exact = 1 / mpmath.factorial(k)
            else:
                for j in range(k):
                    exact = (exact - 1 / mpmath.factorial(j)) / x
            assert value == pytest.approx(float(exact), rel=3e-15)


def test_without_a_linear_part_the_tableau_is_classical_runge_kutta():
    with double():
        c = jax.device_get(tableau(jnp.zeros((1, 1)), 0.3))
    found = [float(x.item()) for x in c]
    assert found == pytest.approx([1, 1, 0.15, 0, 0.15, 0, 0.3, 0.05, 0.1, 0.05], abs=1e-16)


def test_the_weights_keep_a_fixed_point():
    """With N = -L P in every stage, each stage and the result must be P: steady states are kept."""
    with double():
        linear = jnp.asarray([[-0.01, -1.0, -30.0]])
        c = jax.device_get(tableau(linear, 0.7))
    N = -np.asarray(linear)
    assert c.half + c.a21 * N == pytest.approx(np.ones((1, 3)), abs=1e-14)
    assert c.half + (c.a31 + c.a32) * N == pytest.approx(np.ones((1, 3)), abs=1e-14)
    assert c.full + (c.a41 + c.a43) * N == pytest.approx(np.ones((1, 3)), abs=1e-14)
    assert c.full + (c.w1 + 2 * c.w23 + c.w4) * N == pytest.approx(np.ones((1, 3)), abs=1e-14)
