import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.sweep.plan.configuration import differences
from cyclosis.sweep.plan.sweep import Sweep
from sweep import fakes

ROOT = Path(__file__).parents[2]
SENTENCE = re.compile(r"^.+ = .+ cannot be used: it must be .+; .+\.$", re.DOTALL)


def changed(**changes):
    return fakes.sweep(**changes).digest


# What a sweep is.


def test_the_papers_figure():
    planned = Sweep.from_toml(ROOT / "sweeps" / "figure5.toml")
    assert planned.shape == (20, 20, 50)
    assert planned.members == 20_000
    assert planned.blocks == 400
    assert list(planned.axes) == ["alpha_p", "alpha_u"]
    assert planned.axes["alpha_p"][0] == 0.025
    assert planned.axes["alpha_p"][-1] == 1.0
    assert planned.axes["alpha_u"] == pytest.approx(np.linspace(0.025, 1, 20), rel=1e-11)
    assert planned.block(399).members == range(19_950, 20_000)
    assert planned.settings.t_end == 2000.0
    assert planned.settings.finish == "certified"
    assert planned.record == ()
    assert not planned.fields


@pytest.mark.parametrize("path", sorted((ROOT / "sweeps").glob("*.toml")), ids=lambda path: path.stem)
def test_every_sweep_that_comes_with_the_package_is_in_order(path):
    planned = Sweep.from_toml(path)
    grid = planned.build(planned.members - 1).grid
    assert planned.build(0).state().shape == (2, *grid.shape)


def test_members_are_numbered_in_c_order():
    planned = fakes.sweep()
    seen = [planned.member(number) for number in range(planned.members)]
    expected = [
        ({"alpha_p": p, "kappa": k}, s) for p in (0.1, 0.5, 1.0) for k in (0.0, 0.5) for s in (7, 8, 9, 10)
    ]
    assert seen == expected
    assert all(isinstance(value, float) for point, _ in seen for value in point.values())


def test_blocks_cover_every_member_once():
    planned = fakes.sweep()
    assert [len(planned.block(i).members) for i in range(planned.blocks)] == [5, 5, 5, 5, 4]
    covered = [n for i in range(planned.blocks) for n in planned.block(i).members]
    assert covered == list(range(planned.members))


@pytest.mark.parametrize("number", [-1, 24, 1.0, "1", None, True])
def test_members_and_blocks_that_do_not_exist_are_refused(number):
    planned = fakes.sweep()
    for look in (planned.member, planned.build, planned.block):
        with pytest.raises(cy.InputError):
            look(number)


def test_a_member_has_its_parameters_its_grid_and_its_seeds_state():
    planned = fakes.sweep(parameters={"mu": 0.07})
    member = planned.build(9)
    point, seed = planned.member(9)
    assert member.params == cy.Parameters(mu=0.07, **point)
    assert member.grid == fakes.GRID
    assert np.array_equal(member.state(), cy.initial.disordered(fakes.GRID, seed=seed))


def test_a_seed_gives_the_same_state_at_every_point():
    planned = fakes.sweep()
    by_seed = {}
    for number in range(planned.members):
        state, seed = planned.build(number).state(), planned.member(number)[1]
        assert np.array_equal(by_seed.setdefault(seed, state), state)
    states = list(by_seed.values())
    assert len(states) == 4
    assert not np.array_equal(states[0], states[1])


def test_lengths_noise_and_magnitudes_can_be_swept():
    axes = {"length": {"values": [2.0, 5.0]}, "filaments_per_square": {"values": [1e4, 1e6]}}
    axes |= {"magnitude": {"values": [0.3, 0.6]}}
    planned = Sweep.from_tables(
        {"grid": {"n_theta": 8, "n_z": 8}, "initial": {"kind": "unidirectional"}, "axes": axes}
    )
    member = planned.build(planned.members - 1)
    assert member.grid == cy.CylinderGrid(8, 8, 5.0)
    assert planned.build(0).grid == cy.CylinderGrid(8, 8, 2.0)
    expected = cy.initial.with_noise(cy.initial.unidirectional(fakes.GRID, 0.6), fakes.GRID, 1e6, 0)
    assert np.array_equal(member.state(), expected)
    assert "length" not in planned.tables["grid"]


def test_an_ordered_state_without_noise():
    planned = Sweep.from_tables(
        {"initial": {"kind": "stripes", "stripes": 4}, "axes": {"kappa": {"values": [0.1]}}}
    )
    assert planned.members == 1
    grid = cy.CylinderGrid()
    assert np.array_equal(planned.build(0).state(), cy.initial.stripes(grid, 4))


def test_spacing():
    def values(**axis):
        return Sweep.from_tables({"axes": {"alpha_u": axis}}).axes["alpha_u"]

    assert values(start=0.0, stop=0.9, count=4) == (0.0, 0.3, 0.6, 0.9)
    assert values(start=0.001, stop=1.0, count=4, spacing="log") == (0.001, 0.01, 0.1, 1.0)
    assert values(values=[0.1, 7, 8.5]) == (0.1, 7.0, 8.5)
    third = 1 / 3
    assert values(start=third, stop=2 * third, count=2) == (third, 2 * third), (
        "the ends are as they were given"
    )


def test_usual_blocks_are_whole_points_or_slices_of_one():
    def block(seeds, **grid):
        return fakes.sweep(ensemble={"seeds": seeds, "block": None}, grid=grid).block_size

    assert [block(seeds) for seeds in (1, 4, 50, 64, 65, 100, 128, 400)] == [64, 64, 50, 64, 33, 50, 64, 50]
    assert block(67) == 34, "a prime number is sliced all the same"
    assert block(1, n_theta=2048, n_z=2048) == 4, "final states of a block fit into memory"


def test_fields_of_parameters_must_fit_the_grid():
    field = np.linspace(0, 1, 64).reshape(8, 8)
    planned = fakes.sweep(parameters={"alpha_u": field.tolist()})
    assert np.array_equal(planned.build(3).params.alpha_u, field)
    assert planned.digest != fakes.sweep().digest
    assert planned.digest != changed(parameters={"alpha_u": (field + 1e-15).tolist()})
    assert Sweep.from_tables(json.loads(json.dumps(planned.tables))) == planned
    with pytest.raises(cy.InputError, match="grid"):
        fakes.sweep(parameters={"alpha_u": field[:, :7].tolist()})


# What makes two sweeps one.


def test_tables_are_complete_plain_and_stable():
    planned = fakes.sweep()
    again = Sweep.from_tables(json.loads(json.dumps(planned.tables)))
    assert again.tables == planned.tables
    assert again.axes == planned.axes
    assert again == planned
    assert hash(again) == hash(planned)
    assert pickle.loads(pickle.dumps(planned)) == planned


def test_the_digest_does_not_depend_on_how_it_is_written():
    base = fakes.sweep().digest
    assert changed(run={"t_end": 2000, "rtol": 1e-4}, initial={"kind": "disordered"}) == base
    assert changed(axes={"kappa": {"values": [0, 0.5]}}) == base
    assert changed(record={"quantities": ["budget", "rms_speed", "stripe_widths", "regime"]}) == base
    backwards = dict(reversed(fakes.tables().items()))
    assert Sweep.from_tables(backwards).digest == base


def test_the_digest_covers_everything_that_decides_results():
    variants = [
        fakes.sweep().digest,
        changed(parameters={"mu": 0.051}),
        changed(grid={"n_z": 10}),
        changed(grid={"length": 5.1}),
        changed(initial={"filaments_per_square": 900.0}),
        changed(initial={"noise_grid": [8, 8]}),
        changed(axes={"kappa": {"values": [0.0, 0.5000000001]}}),
        changed(ensemble={"seeds": 5}),
        changed(ensemble={"first_seed": 6}),
        changed(ensemble={"block": 6}),
        changed(record={"quantities": ["budget"]}),
        changed(record={"fields": True}),
        *(
            changed(run={key: value})
            for key, value in {
                "t_end": 100.0,
                "finish": "t_end",
                "precision": "float32",
                "rtol": 1e-5,
                "atol": 1e-9,
                "dealias": "full",
                "terms": ["bundling", "diffusion"],
                "lanes": 4,
            }.items()
        ),
    ]
    assert len(set(variants)) == len(variants)


def test_the_order_of_the_axes_matters():
    axes = fakes.TABLES["axes"]
    turned = fakes.tables() | {"axes": dict(reversed(axes.items()))}
    assert Sweep.from_tables(turned) != fakes.sweep()


def test_a_hundred_million_members_are_planned_without_listing_them():
    big = {
        "axes": {
            "alpha_p": {"start": 0.001, "stop": 1.0, "count": 1000},
            "alpha_u": {"start": 0.001, "stop": 1.0, "count": 1000},
        },
        "ensemble": {"seeds": 100},
    }
    planned = Sweep.from_tables(big)
    assert planned.members == 10**8
    assert planned.blocks == 2 * 10**6
    assert planned.block(1_999_999).members[-1] == 10**8 - 1
    assert planned.member(10**8 - 1) == ({"alpha_p": 1.0, "alpha_u": 1.0}, 99)
    assert len(planned.digest) == 64
    assert len(pickle.dumps(planned)) < 100_000


# Initial states out of a file.


@pytest.fixture
def state_file(tmp_path):
    path = tmp_path / "state.npy"
    np.save(path, cy.initial.stripes(fakes.GRID, 2, 0.5))
    return path


def from_file(path, **initial):
    return fakes.tables(initial={"kind": "file", "path": str(path)} | initial, ensemble={"seeds": 1})


def test_a_state_out_of_a_file(state_file, monkeypatch):
    monkeypatch.chdir(state_file.parent)
    planned = Sweep.from_tables(from_file(state_file.name))
    monkeypatch.chdir("/")
    assert np.array_equal(planned.build(0).state(), np.load(state_file))
    noisy = Sweep.from_tables(from_file(state_file, filaments_per_square=1000))
    expected = cy.initial.with_noise(np.load(state_file), fakes.GRID, 1000, seed=7)
    assert np.array_equal(noisy.build(0).state(), expected)


def test_the_digest_covers_the_bytes_of_the_file_and_not_its_place(state_file, tmp_path):
    base = Sweep.from_tables(from_file(state_file))
    moved = tmp_path / "elsewhere.npy"
    moved.write_bytes(state_file.read_bytes())
    assert Sweep.from_tables(from_file(moved)) == base
    np.save(state_file, 0.99 * np.load(state_file))
    assert Sweep.from_tables(from_file(state_file)) != base


def test_a_file_that_has_changed_is_refused_when_a_member_is_built(state_file):
    planned = Sweep.from_tables(from_file(state_file))
    np.save(state_file, 0.9 * np.load(state_file))
    with pytest.raises(cy.InputError, match="restore"):
        planned.build(0).state()
    with pytest.raises(cy.InputError, match="sha256"):
        Sweep.from_tables(planned.tables)


@pytest.fixture
def long_file(tmp_path):
    """The file of a run in a cell of length 10, twice that of the sweeps here."""
    long = cy.CylinderGrid(8, 8, 10.0)
    run = cy.simulate(cy.Parameters(), long, cy.initial.stripes(long, 2, 0.5), t_end=0.1, save_every=0.1)
    return cy.write(run, tmp_path / "ten.nc")


def test_a_state_of_another_length_is_stretched_only_when_asked_for(long_file):
    with pytest.raises(cy.InputError, match=r"length of the cell .* stretch = true"):
        Sweep.from_tables(from_file(long_file))
    planned = Sweep.from_tables(from_file(long_file, stretch=True))
    expected = cy.initial.from_file(str(long_file), fakes.GRID, stretch=True)
    assert np.array_equal(planned.build(0).state(), expected)
    given = from_file(long_file) | {"grid": {"n_theta": 8, "n_z": 8}}
    given["axes"] = {"length": {"values": [10.0, 12.0]}}
    with pytest.raises(cy.InputError, match="that of the grid, 12"):
        Sweep.from_tables(given)


def test_what_may_be_done_with_a_file_does_not_make_another_sweep(state_file):
    plain = Sweep.from_tables(from_file(state_file))
    assert "stretch" not in plain.tables["initial"]
    assert Sweep.from_tables(from_file(state_file, stretch=False)).tables == plain.tables
    assert Sweep.from_tables(from_file(state_file, stretch=True)) == plain
    assert differences(plain.tables, Sweep.from_tables(from_file(state_file, stretch=True)).tables) == []


def test_a_store_can_be_read_without_the_file(state_file):
    planned = Sweep.from_tables(from_file(state_file, filaments_per_square=1000))
    state_file.unlink()
    assert Sweep.from_tables(planned.tables, files=False) == planned
    with pytest.raises(cy.InputError, match="path"):
        planned.build(0).state()
