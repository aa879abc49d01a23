import pickle

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.model.definitions import PARAMETERS, TABLES


def test_the_defaults_are_the_papers():
    p = cy.Parameters()
    assert (p.alpha_p, p.alpha_u, p.epsilon, p.d_s, p.d_r, p.kappa, p.mu) == (
        1,
        0.5,
        0.1,
        0.025,
        0.025,
        0.5,
        0.05,
    )
    assert (p.repulsion_angle, p.zero_theta_flux, p.force_exponent) == (0, False, 2)


@pytest.mark.parametrize("item", PARAMETERS, ids=lambda item: item.name)
@pytest.mark.parametrize("bad", ["x", None, float("nan"), float("inf"), -11.0, 1e9, 1j, [], {}, True])
def test_every_parameter_refuses_what_it_cannot_be(item, bad):
    if item.kind == "flag" and bad is True:
        return
    with pytest.raises(cy.InputError) as caught:
        cy.Parameters(**{item.name: bad})
    assert caught.value.field == item.name
    assert all((caught.value.rule, caught.value.remedy)), "the message names rule and remedy"
    assert str(caught.value).count("\n") == 0


def test_field_parameters_are_checked_copied_and_frozen():
    field = np.full((8, 10), 0.3)
    p = cy.Parameters(alpha_p=field, kappa=field.tolist())
    field[:] = 7
    assert np.all(p.alpha_p == 0.3)
    assert p.shape == (8, 10)
    with pytest.raises(ValueError, match="read-only"):
        p.alpha_p[0, 0] = 1
    with pytest.raises(cy.InputError, match="one grid"):
        cy.Parameters(alpha_p=np.ones((8, 8)), alpha_u=np.ones((8, 10)))
    with pytest.raises(cy.InputError, match="d_s"):
        cy.Parameters(d_s=np.ones((8, 8)))
    with pytest.raises(cy.InputError, match="not finite"):
        cy.Parameters(kappa=np.full((8, 8), np.nan))


def test_equality_hash_and_replace_go_by_value():
    a, b = cy.Parameters(kappa=np.ones((8, 8))), cy.Parameters(kappa=np.ones((8, 8)))
    assert a == b
    assert hash(a) == hash(b)
    assert a != a.replace(mu=0.1)
    with pytest.raises(cy.InputError, match="alpha_q"):
        a.replace(alpha_q=1)


def test_numpy_numbers_are_numbers():
    p = cy.Parameters(alpha_p=np.float32(0.5), alpha_u=np.array(0.25), zero_theta_flux=np.bool_(True))
    assert (p.alpha_p, p.alpha_u, p.zero_theta_flux) == (0.5, 0.25, True)


def test_every_default_passes_its_own_check():
    for table, items in TABLES.items():
        for item in items:
            assert item.check(item.default) == item.default, (table, item.name)


def test_mistakes_survive_a_pool_of_processes():
    with pytest.raises(cy.InputError) as refused:
        cy.Parameters(alpha_p=-1.0)
    again = pickle.loads(pickle.dumps(refused.value))
    assert (str(again), again.remedy) == (str(refused.value), refused.value.remedy)


def test_an_empty_field_is_refused_and_equal_fields_have_equal_hashes():
    with pytest.raises(cy.InputError, match="two-dimensional"):
        cy.Parameters(alpha_p=[[]])
    plus, minus = (cy.Parameters(kappa=np.full((8, 8), sign * 0.0)) for sign in (1, -1))
    assert plus == minus
    assert hash(plus) == hash(minus)
