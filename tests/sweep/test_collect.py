import json

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store.read import open_sweep, ranges
from cyclosis.sweep.store.store import Store
from sweep import fakes


@pytest.fixture
def store(tmp_path):
    return Store.create(tmp_path / "store", fakes.sweep())


def member_of(data, planned, number):
    """Return what a dataset holds of a member."""
    point, seed = planned.member(number)
    return data.sel(point | {"seed": seed})


def test_every_member_stands_where_its_axes_say(store):
    fakes.filled(store)
    planned, data = store.sweep, open_sweep(store.path)
    assert data.regime.dims == ("alpha_p", "kappa", "seed")
    assert data.profile.dims == ("alpha_p", "kappa", "seed", "component", "theta")
    assert data.stripe_width.dims == ("alpha_p", "kappa", "seed", "zone")
    assert data.budget.dims == ("alpha_p", "kappa", "seed", "term")
    for index in range(planned.blocks):
        expected = fakes.arrays(planned, index)
        for place, number in enumerate(planned.block(index).members):
            there = member_of(data, planned, number)
            for name, values in expected.items():
                assert np.array_equal(there[name].values, values[place], equal_nan=True), (number, name)


def test_the_dataset_does_not_depend_on_the_blocks(tmp_path):
    datasets = []
    for block in (1, 5, 24, 100):
        planned = fakes.sweep(ensemble={"block": block})
        store = Store.create(tmp_path / str(block), planned)
        whole = fakes.arrays(fakes.sweep(ensemble={"block": 24}), 0)
        for index in range(planned.blocks):
            chosen = list(planned.block(index).members)
            store.write(index, {name: values[chosen] for name, values in whole.items()})
        datasets.append(open_sweep(store.path).drop_attrs())
    for other in datasets[1:]:
        xarray.testing.assert_identical(datasets[0], other)


def test_coordinates_and_attributes_say_what_they_are(store):
    data = open_sweep(fakes.filled(store).path)
    assert data.alpha_p.values.tolist() == [0.1, 0.5, 1.0]
    assert data.seed.values.tolist() == [7, 8, 9, 10]
    assert data.component.values.tolist() == ["theta", "z"]
    assert data.term.values.tolist() == store.sweep.tables["run"]["terms"]
    assert data.alpha_p.attrs["symbol"] == "α_p"
    assert data.regime.dtype == data.status.dtype == "int8"
    assert data.zone_count.dtype == "int16"
    assert data.evaluations.dtype == "int32"
    assert data.regime.attrs["flag_meanings"] == " ".join(cy.REGIMES)
    assert data.regime.attrs["flag_values"].tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert data.status.attrs["flag_meanings"] == "certified completed underresolved diverged"
    for name in ("regime", "status", "zone_count", "evaluations"):
        assert "_FillValue" not in data[name].attrs  # readers that heed it would make floats of all
        assert data[name].attrs["valid_min"] == 0
        assert data[name].attrs["comment"].startswith("-1 where")
    for name, variable in data.variables.items():
        assert variable.attrs["units"] == "1", name
        assert variable.attrs["long_name"], name
    assert json.loads(data.attrs["configuration"]) == store.sweep.tables
    assert data.attrs["digest"] == store.sweep.digest
    assert json.loads(data.attrs["versions"])["cyclosis"] == cy.__version__
    assert (data.attrs["members_computed"], data.attrs["members_missing"]) == (24, 0)
    assert data.attrs["blocks_missing"] == ""


def test_missing_blocks_are_missing_values(store):
    data = open_sweep(fakes.filled(store, 0, 1, 4).path)
    assert (data.attrs["members_computed"], data.attrs["members_missing"]) == (10, 14)
    assert data.attrs["blocks_missing"] == "0-1, 4"
    codes = data.regime.values.ravel()
    assert np.flatnonzero(codes >= 0).tolist() == list(range(10, 20))
    assert set(codes[:10]) == {-1}
    assert set(data.evaluations.values.ravel()[20:]) == {-1}
    assert np.isnan(data.profile.values.reshape(24, -1)[:10]).all()
    assert np.isnan(data.t_final.values.ravel()[20:]).all()


def test_an_empty_store_is_all_missing(store):
    data = open_sweep(store.path)
    assert (data.regime == -1).all()
    assert data.attrs["blocks_missing"] == "0-4"
    assert data.profile.isnull().all()


def test_a_damaged_block_is_refused_and_the_way_out_named(store):
    fakes.filled(store)
    data = bytearray(store.path_of(3).read_bytes())
    data[-100] ^= 8
    store.path_of(3).write_bytes(data)
    with pytest.raises(cy.InputError, match=r"block 3 .*sweep verify.*repair"):
        open_sweep(store.path)


def test_chosen_variables(store):
    fakes.filled(store)
    data = open_sweep(store.path, ["regime", "mean_P"])
    assert set(data.data_vars) == {"regime", "mean_P"}
    assert set(data.coords) == {"alpha_p", "kappa", "seed", "component"}
    with pytest.raises(cy.InputError, match="variables"):
        open_sweep(store.path, ["regimes"])
    with pytest.raises(cy.InputError, match="variables"):
        open_sweep(store.path, ["P"])


def test_what_is_no_store_is_refused(tmp_path):
    with pytest.raises(cy.InputError, match="store"):
        open_sweep(tmp_path)


# Final fields.


@pytest.fixture
def with_fields(tmp_path):
    planned = fakes.sweep(record={"fields": True})
    return fakes.filled(Store.create(tmp_path / "store", planned), 2)


def test_fields_are_read_when_they_are_used(with_fields, monkeypatch):
    planned = with_fields.sweep
    data = open_sweep(with_fields.path)
    assert data.P.dims == ("alpha_p", "kappa", "seed", "component", "theta", "z")
    assert data.P.shape == (3, 2, 4, 2, 8, 8)
    touched = []
    read = Store.read
    monkeypatch.setattr(
        Store, "read", lambda self, index, names: touched.append(index) or read(self, index, names)
    )
    one = member_of(data.P, planned, 23).values
    assert touched == [4]
    assert np.array_equal(one, fakes.arrays(planned, 4)["P"][3])


def test_fields_are_those_of_the_blocks_however_they_are_asked_for(with_fields):
    planned = with_fields.sweep
    data = open_sweep(with_fields.path)
    expected = np.concatenate([fakes.arrays(planned, index)["P"] for index in range(5)])
    expected[10:15] = np.nan
    expected = expected.reshape(data.P.shape)
    for key in (
        np.s_[...],
        np.s_[1, 0, 2],
        np.s_[:, 1, ::2, 1],
        np.s_[..., 3],
        np.s_[2, :, -1, :, 1:3, ::-1],
        np.s_[0:0],
        np.s_[1, 1, 3, 1, 7, 7],
    ):
        assert np.array_equal(data.P[key].values, expected[key], equal_nan=True), key
    some = data.P.isel(alpha_p=[2, 0], seed=[3, 1, 1], theta=[5, 0])
    assert np.array_equal(some.values, expected[[2, 0]][:, :, [3, 1, 1]][..., [5, 0], :], equal_nan=True)
    assert np.array_equal(data.P.transpose("z", ...).values[3], expected[..., 3], equal_nan=True)
    pointwise = data.P.isel(alpha_p=("x", [0, 2]), kappa=("x", [1, 1]), seed=("x", [2, 3]))
    assert np.array_equal(pointwise.values[1], expected[2, 1, 3], equal_nan=True)
    assert np.array_equal(data.P.mean("z").values, expected.mean(-1), equal_nan=True)


def test_fields_are_checked_again_when_they_are_read(with_fields):
    data = open_sweep(with_fields.path)
    block = bytearray(with_fields.path_of(0).read_bytes())
    block[-1] ^= 1
    with_fields.path_of(0).write_bytes(block)
    with pytest.raises(cy.InputError, match="block 0"):
        data.P.values  # noqa: B018


def test_where_the_length_is_swept_z_is_in_periods(tmp_path):
    planned = fakes.sweep(grid={"length": 5.0}, record={"fields": True})
    store = fakes.filled(Store.create(tmp_path / "fixed", planned))
    assert open_sweep(store.path).z.values == pytest.approx(fakes.GRID.z)
    tables = fakes.tables(record={"fields": True})
    tables["axes"] = {"length": {"values": [2.0, 4.0]}}
    del tables["grid"]["length"]
    store = Store.create(tmp_path / "swept", Sweep.from_tables(tables))
    data = open_sweep(store.path)
    assert data.z.values == pytest.approx(np.arange(8) / 8)
    assert "axial periods" in data.z.attrs["long_name"]


# Speed.


@pytest.mark.slow
def test_the_papers_figure_opens(tmp_path):
    planned = fakes.sweep(
        grid={"n_theta": 48, "n_z": 48},
        axes={
            "alpha_p": {"start": 0.1, "stop": 1, "count": 20},
            "kappa": {"start": 0, "stop": 1, "count": 20},
        },
        ensemble={"seeds": 50, "block": None},
    )
    assert planned.blocks == 400
    store = Store.create(tmp_path / "store", planned)
    block = fakes.arrays(planned, 0)
    for index in range(400):
        store.write(index, block)
    data = open_sweep(store.path)
    assert data.regime.shape == (20, 20, 50)


@pytest.mark.parametrize(
    ("listed", "text"), [([], ""), ([0], "0"), ([3, 4, 5, 9, 11, 12], "3-5, 9, 11-12"), (range(7), "0-6")]
)
def test_ranges(listed, text):
    assert ranges(listed) == text
