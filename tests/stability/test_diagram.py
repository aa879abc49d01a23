import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.branches.diagram import diagram, label

N = 64


@pytest.fixture(scope="module")
def over_kappa():
    start = cy.stability.cyclosis(cy.Parameters(), N)
    return diagram(start, "kappa", (0.0, 0.6), length=None, longest=0.08)


def test_every_branch_is_met_once(over_kappa):
    names = [label(branch) for branch in over_kappa]
    assert names[0] == "stripes"
    assert names.count("tilted stripes") == 1
    assert names.count("circumferential") == 1
    for branch in over_kappa:
        for other in over_kappa:
            if other is not branch:
                apart = {point.index for point in other.points}
                inside = next(k for k in range(2, other.parameter.size) if k not in apart)
                assert not branch.holds(other.state(inside), 1e-3)


def test_a_branch_holds_its_own_states_however_turned(over_kappa):
    branch = over_kappa[0]
    state = branch.state(3)
    assert branch.holds(state)
    turned = type(state)(
        state.theta, np.roll(state.P, 5, axis=1), state.u, state.drift, state.residual, state.params
    )
    assert branch.holds(turned)


def test_depth_bounds_how_far_it_goes():
    start = cy.stability.cyclosis(cy.Parameters(), N)
    alone = diagram(start, "kappa", (0.4, 0.6), depth=0, length=None, longest=0.1)
    assert len(alone) == 1
    with pytest.raises(cy.InputError, match="depth"):
        diagram(start, "kappa", (0.4, 0.6), depth=-1)


def test_unequal_stripes_end_where_the_unidirectional_state_breaks_up():
    """Both ends of the saddle branch are exact: the threshold of equal stripes, and a closed form."""
    params = cy.Parameters(alpha_p=0.1, alpha_u=0.05)
    found = diagram(
        cy.stability.cyclosis(params, N), "alpha_u", (0.001, 0.4), depth=2, length=None, longest=0.05
    )
    assert [label(branch) for branch in found] == ["stripes", "uneven order", "unidirectional"]
    ends = sorted(point.value for point in found[1].points if point.ends)
    assert ends[0] == pytest.approx(cy.stability.threshold(params), rel=1e-6)
    assert ends[1] == pytest.approx(float(cy.stability.stripes_threshold(params)), rel=1e-9)
    assert not found[1].stable.any()
    crossing = [point.value for point in found[2].of("branch point")]
    assert min(abs(np.array(crossing) - ends[1])) < 1e-9
