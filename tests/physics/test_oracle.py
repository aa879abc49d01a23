"""One right-hand side equals the model's equations, evaluated by an independent program."""

import pytest

import cyclosis as cy
import oracle
from measure import band_limited, check, right_hand_side


def test_the_oracle_obeys_the_momentum_balance():
    """The oracle's own flow solves -μ ∇²u + u + Π₀ e_z + ∇Π' = F: what is left over is a gradient."""
    p, length = cy.Parameters(mu=0.3), 3.0
    P = band_limited(1, (24, 20), (2, 2))
    F, u = oracle.force(p, P), oracle.flow(p, length, P)
    left = F - (u - p.mu * oracle.both([oracle.laplacian(c, length) for c in u], u[0].shape))
    # The curl of a gradient vanishes; so does the divergence of u.
    curl = oracle.gradient(left[1], length)[0] - oracle.gradient(left[0], length)[1]
    divergence = oracle.gradient(u[0], length)[0] + oracle.gradient(u[1], length)[1]
    assert abs(curl).max() < 1e-12
    assert abs(divergence).max() < 1e-12
    assert abs(left[0].mean()) < 1e-14  # no mean pressure gradient around the axis
    assert abs(u[1].mean()) < 1e-14


@pytest.mark.parametrize("name", right_hand_side.CASES)
def test_right_hand_side_without_aliasing(name):
    """All terms on; grids, couplings, flux options and force laws vary."""
    check(right_hand_side.alias_free(name))


@pytest.mark.parametrize("state", ["alias-free", "broadband"])
def test_each_term_alone(state):
    check(right_hand_side.single_terms(state))


def test_fused_transport():
    """(P·∇)u - (u·∇)P = curl s - u ∇·P and P·(P·∇)u = P·E·P, exactly where nothing aliases."""
    check(right_hand_side.fused_transport())


def test_broadband_state():
    """With every product formed as written the same numbers come out, aliases included."""
    check(right_hand_side.all_terms_broadband())


def test_force_laws():
    check(right_hand_side.force_laws())


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(24, 16), (15, 21)])
def test_full_padding_removes_all_aliasing(shape):
    check(right_hand_side.padded(shape))
