import numpy as np
import pytest

import cyclosis as cy
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store import Store, block
from cyclosis.sweep.store.read import open_sweep
from sweep import fakes


@pytest.fixture
def made_up(monkeypatch):
    monkeypatch.setattr(block, "follow", fakes.follow)


def test_a_block_holds_the_sweeps_variables(made_up):
    planned = fakes.sweep(record={"fields": True})
    for index in range(planned.blocks):
        computed = block.compute(planned, index)
        assert list(computed) == [item.name for item in planned.variables]
        for item in planned.variables:
            shape = (len(planned.block(index).members), *(planned.sizes[dim] for dim in item.dims))
            assert computed[item.name].shape == shape, item.name
            assert computed[item.name].dtype == item.dtype, item.name


def test_numbers_are_those_of_the_final_state(made_up):
    planned = fakes.sweep(record={"fields": True, "quantities": ["budget", "rms_speed", "max_P"]})
    computed = block.compute(planned, 3)
    for place, number in enumerate(planned.block(3).members):
        member = planned.build(number)
        outcome = fakes.follow([member])[0]
        expected = cy.diagnose(member.params, member.grid, outcome.state)
        for name in ("mean_P", "order", "peak_speed", "rms_speed", "max_P"):
            assert computed[name][place] == pytest.approx(expected[name], rel=1e-12, abs=1e-15), name
        assert computed["budget"][place] == pytest.approx(list(expected["budget"].values()), abs=1e-15)
        assert np.array_equal(computed["P"][place], outcome.state)
        assert computed["profile"][place] == pytest.approx(outcome.state.mean(axis=2))
        assert computed["regime"][place] == cy.REGIMES.index("cyclosis")
        assert computed["zone_count"][place] == 2
        angles = cy.zones.zone_angles(outcome.state[1].mean(axis=1))
        assert computed["zone_angle"][place][:2] == pytest.approx(angles)
        assert computed["stripe_width"][place][:2] == pytest.approx([0.5, 0.5])
        assert np.isnan(computed["stripe_width"][place][2:]).all()
        assert computed["t_order"][place] == 5.0


def test_terms_that_do_not_act_have_no_part_in_the_budget(made_up):
    planned = fakes.sweep(run={"terms": ["diffusion", "bundling"]})
    assert planned.sizes["term"] == 2
    member = planned.build(0)
    state = fakes.follow([member])[0].state
    expected = cy.diagnose(member.params, member.grid, state, terms=["diffusion", "bundling"])["budget"]
    computed = block.compute(planned, 0)["budget"][0]
    assert computed == pytest.approx([expected["diffusion"], expected["bundling"]], abs=1e-15)


def test_disorder_has_no_zones_and_no_time_of_order(made_up):
    computed = block.compute(fakes.sweep(), 0)
    assert set(computed["regime"]) == {0}
    assert set(computed["zone_count"]) == {0}
    assert np.isnan(computed["t_order"]).all()
    assert np.isnan(computed["zone_angle"]).all()


def test_initial_amplitudes_are_those_of_the_modes(made_up):
    tables = {"grid": {"n_theta": 8, "n_z": 8}, "axes": {"alpha_p": {"values": [1.0]}}}
    planned = Sweep.from_tables(tables | {"initial": {"kind": "stripes", "magnitude": 0.3}})
    computed = block.compute(planned, 0)
    assert computed["initial_m1"][0] == pytest.approx(0.3)
    assert computed["initial_k0"][0] == pytest.approx(0.0, abs=1e-15)
    noisy = fakes.sweep()
    state = noisy.build(0).state()[1]
    computed = block.compute(noisy, 0)
    wave = np.mean(state * np.exp(-1j * fakes.GRID.theta)[:, None])
    assert computed["initial_k0"][0] == pytest.approx(state.mean())
    assert computed["initial_m1"][0] == pytest.approx(2 * abs(wave))


def test_a_member_that_cannot_begin_is_refused_by_name(made_up, tmp_path):
    path = tmp_path / "state.npy"
    np.save(path, cy.initial.stripes(fakes.GRID, 2, 0.5))
    planned = fakes.sweep(initial={"kind": "file", "path": str(path)}, ensemble={"seeds": 1})
    path.unlink()
    with pytest.raises(cy.InputError, match="path"):
        block.compute(planned, 0)


TINY = {
    "grid": {"n_theta": 16, "n_z": 16, "length": 3.0},
    "axes": {"alpha_p": {"values": [0.02, 1.0]}, "alpha_u": {"values": [0.5]}},
    "ensemble": {"seeds": 3},
    "run": {"t_end": 60.0},
    "record": {"fields": True},
}


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """A tiny sweep, really computed, in blocks of different sizes."""
    out = []
    for size in (1, 4, 6):
        tables = TINY | {"ensemble": TINY["ensemble"] | {"block": size}}
        store = Store.create(tmp_path_factory.mktemp("sweep") / "store", Sweep.from_tables(tables))
        for index in reversed(range(store.sweep.blocks)):
            store.write(index, block.compute(store.sweep, index))
        out.append(open_sweep(store.path).load())
    return out


def test_results_do_not_depend_on_the_blocks(computed):
    for other in computed[1:]:
        for name in computed[0].data_vars:
            if name != "seconds":
                assert np.array_equal(
                    computed[0][name], other[name], equal_nan=computed[0][name].dtype.kind == "f"
                ), name


def test_a_real_sweep_gives_what_theory_says(computed):
    data = computed[0]
    below = data.sel(alpha_p=0.02)
    assert (below.regime == cy.REGIMES.index("disordered")).all(), "alpha_p < d_r: disorder is certain"
    assert (data.sel(alpha_p=1.0).order > 0.5).all()
    assert (data.status >= 0).all()
    assert (data.seconds > 0).all()
    assert data.attrs["members_missing"] == 0
    for seed in data.seed.values:
        state = cy.initial.disordered(cy.CylinderGrid(16, 16, 3.0), seed=int(seed))
        assert data.initial_k0.sel(seed=seed).values == pytest.approx(state[1].mean())
