import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosis as cy
from cyclosis.model.scales import layer_mu

positive = st.floats(1e-3, 1e3)
within = st.floats(1e-3, 1e3 * (1 - 1e-14))
"""The same for parameters that come back rounded, and may not pass 1000 then."""


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.builds(cy.Scales, positive, positive, positive), within, within, within)
def test_there_and_back_loses_nothing(scales, alpha_p, alpha_u, kappa):
    params = cy.Parameters(
        alpha_p=alpha_p, alpha_u=np.full((8, 8), alpha_u), kappa=kappa, zero_theta_flux=True
    )
    back = scales.from_physical(scales.to_physical(params))
    for (name, a), (_, b) in zip(params.items(), back.items(), strict=True):
        assert a == pytest.approx(b, rel=1e-14), name


@settings(max_examples=50, derandomize=True, deadline=None)
@given(positive, positive, positive, st.builds(cy.Scales, positive, positive, positive))
def test_the_model_does_not_see_a_change_of_units(length, time, force, scales):
    """Stretching lengths, times and forces of cell and scales alike leaves the model unchanged."""
    physical = scales.to_physical(cy.Parameters())
    stretched = cy.Scales(
        scales.radius_um * length,
        scales.speed_um_per_s * length / time,
        scales.friction_Pa_s_per_m * force * time / length,
    )
    other = type(physical)(
        bundling_per_s=physical.bundling_per_s / time,
        flow_alignment_per_um=physical.flow_alignment_per_um / length,
        spatial_diffusion_um2_per_s=physical.spatial_diffusion_um2_per_s * length**2 / time,
        rotational_diffusion_per_s=physical.rotational_diffusion_per_s / time,
        repulsion_per_s=physical.repulsion_per_s / time,
        layer_viscosity_Pa_s_m=physical.layer_viscosity_Pa_s_m * force * time * length,
        epsilon=physical.epsilon,
        repulsion_angle=0.0,
        zero_theta_flux=False,
        force_exponent=2.0,
    )
    for (name, a), (_, b) in zip(
        stretched.from_physical(other).items(), cy.Parameters().items(), strict=True
    ):
        assert a == pytest.approx(b, rel=1e-12), name


def test_a_layer_gives_the_papers_viscosity():
    """μ* = h²/(3R²) or h²/(12R²): 0.05 means h/R = 0.39 or 0.77."""
    for walls, ratio in ((1, 0.39), (2, 0.77)):
        assert layer_mu(ratio, walls) == pytest.approx(0.05, rel=0.02)
        scales = cy.Scales.from_layer(
            500, 100, viscosity_Pa_s=0.1, thickness_um=500 * ratio, no_slip_walls=walls
        )
        layer = scales.to_physical(cy.Parameters(mu=layer_mu(ratio, walls))).layer_viscosity_Pa_s_m
        assert layer == pytest.approx(0.1 * 500e-6 * ratio, rel=1e-12)  # μ = η h


def test_the_units_of_a_chara_cell():
    scales = cy.Scales.from_peak_speed(radius_um=500, peak_speed_um_per_s=100, friction_Pa_s_per_m=2.0)
    assert scales.micrometres_per_second(0.9714276568) == pytest.approx(100)
    assert scales.time_s == pytest.approx(500 / scales.speed_um_per_s)
    assert scales.dimensionless_time(scales.seconds(3.0)) == pytest.approx(3.0)
    assert scales.force_Pa == pytest.approx(2.0 * scales.speed_um_per_s * 1e-6)
    assert scales.pressure_Pa_m == pytest.approx(scales.force_Pa * 500e-6)


@pytest.mark.parametrize("bad", [0, -1, np.inf, np.nan, "1", None])
def test_scales_must_be_positive(bad):
    with pytest.raises(cy.InputError, match="radius_um"):
        cy.Scales(radius_um=bad)
    with pytest.raises(cy.InputError, match="no_slip_walls"):
        cy.Scales.from_layer(500, 100, 1.0, 10, no_slip_walls=3)
