import json
import random
import re
import time
from pathlib import Path

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store.block_file import Damaged, pack, unpack
from cyclosis.sweep.store.store import MISSING, Store
from sweep import fakes


@pytest.fixture
def planned():
    return fakes.sweep()


@pytest.fixture
def store(planned, tmp_path):
    return Store.create(tmp_path / "store", planned)


def leftovers(store):
    return [path.name for path in store.path.rglob("*") if path.name.endswith(".new")]


# Writing and reading.


def test_what_is_read_is_what_was_written(store, planned):
    fakes.filled(store)
    for index in range(planned.blocks):
        fakes.same(store.read(index), fakes.arrays(planned, index))
    assert store.read(2, ["regime", "profile"]).keys() == {"regime", "profile"}
    assert store.present() == set(range(5))
    assert store.missing() == []
    assert store.verify() == []
    assert not leftovers(store)


def test_the_layout(store):
    fakes.filled(store)
    assert store.path_of(4) == store.path / "blocks" / "000000" / "000000004.nc"
    assert store.path_of(12_345) == store.path / "blocks" / "000012" / "000012345.nc"
    assert sorted(path.name for path in store.path.iterdir()) == ["blocks", "sweep.json"]
    written = json.loads((store.path / "sweep.json").read_text())
    assert written["configuration"] == store.sweep.tables
    assert written["digest"] == store.sweep.digest
    assert written["versions"]["cyclosis"] == cy.__version__
    assert written["created"].startswith("2")


def test_the_same_arrays_are_the_same_bytes(store, planned):
    first = store.write(3, fakes.arrays(planned, 3)).read_bytes()
    time.sleep(0.01)
    assert store.write(3, fakes.arrays(planned, 3)).read_bytes() == first
    assert pack(fakes.sweep(), 3, dict(reversed(fakes.arrays(planned, 3).items()))) == first


def test_a_block_opens_in_any_netcdf_reader(store, planned):
    path = store.write(4, fakes.arrays(planned, 4))
    with xarray.open_dataset(path, engine="scipy") as data:
        assert data.attrs["Conventions"] == "CF-1.11"
        assert data.attrs["sweep"] == planned.digest
        assert data.attrs["block"] == 4
        assert (data.attrs["first_member"], data.attrs["last_member"]) == (20, 23)
        assert json.loads(data.attrs["configuration"]) == planned.tables
        assert data["member"].values.tolist() == [20, 21, 22, 23]
        assert data["seed"].values.tolist() == [7, 8, 9, 10]
        assert data["alpha_p"].values.tolist() == [1.0] * 4
        assert data["component"].values.astype(str).tolist() == ["theta", "z"]
        assert data["term"].values.astype(str).tolist() == planned.tables["run"]["terms"]
        assert data["theta"].values == pytest.approx(fakes.GRID.theta)
        assert data["regime"].attrs["flag_meanings"].split()[2] == "cyclosis"
        assert data["regime"].attrs["flag_values"].tolist() == list(range(len(cy.REGIMES)))
        assert set(data["profile"].coords) >= {"alpha_p", "kappa", "seed"}
        expected = fakes.arrays(planned, 4)
        assert data.data_vars.keys() == expected.keys()
        for name, variable in data.variables.items():
            assert variable.attrs["units"] == "1", name
            assert variable.attrs["long_name"], name
            if name in expected:
                assert np.array_equal(variable.values, expected[name], equal_nan=True), name


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_fields_are_kept_in_their_precision(tmp_path, precision):
    planned = fakes.sweep(record={"fields": True}, run={"precision": precision})
    store = Store.create(tmp_path / "store", planned)
    store.write(0, fakes.arrays(planned, 0))
    P = store.read(0)["P"]
    assert P.dtype == precision
    assert P.shape == (5, 2, 8, 8)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_blocks_of_any_size_survive(tmp_path, count):
    planned = fakes.sweep(ensemble={"block": count})
    store = fakes.filled(Store.create(tmp_path / "store", planned))
    assert store.verify() == []
    fakes.same(store.read(1), fakes.arrays(planned, 1))


def test_arrays_that_are_not_the_sweeps_are_refused(store, planned):
    good = fakes.arrays(planned, 0)
    for bad in (
        {name: values for name, values in good.items() if name != "regime"},
        good | {"surprise": good["order"]},
        good | {"order": good["order"][:-1]},
        good | {"profile": good["profile"][..., :-1]},
    ):
        with pytest.raises(ValueError, match=r"a block of this sweep|has shape"):
            store.write(0, bad)
    assert store.present() == set()


@pytest.mark.parametrize("index", [-1, 5, 1.0, None])
def test_blocks_that_the_sweep_has_not_are_refused(store, planned, index):
    with pytest.raises(cy.InputError, match="block"):
        store.read(index)
    with pytest.raises(cy.InputError, match="block"):
        store.write(index, fakes.arrays(planned, 0))


def test_a_block_can_be_checked_as_the_documentation_says(store, planned):
    page = (Path(__file__).parents[2] / "docs" / "sweeps.md").read_text()
    recipe = next(block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "sha256" in block)
    names = {}
    exec(compile(recipe, "sweeps.md", "exec"), names)
    path = store.write(0, fakes.arrays(planned, 0))
    assert names["intact"](path)
    path.write_bytes(path.read_bytes()[:-1] + b"!")
    assert not names["intact"](path)


# Opening.


def test_a_store_is_opened_again(store, planned):
    fakes.filled(store)
    again = Store.create(store.path, fakes.sweep())
    assert again.present() == store.present()
    assert again.about == store.about, "it was not begun anew"
    assert Store(store.path).sweep == planned


def test_another_configuration_is_refused_with_the_difference(store):
    other = fakes.sweep(
        parameters={"mu": 0.06}, run={"t_end": 100.0}, axes={"alpha_p": {"values": [0.1, 0.5, 0.9]}}
    )
    with pytest.raises(cy.InputError) as refused:
        Store.create(store.path, other)
    message = str(refused.value)
    assert "parameters.mu is 0.05 there and 0.06 here" in message
    assert "run.t_end is 2000.0 there and 100.0 here" in message
    assert "axes.alpha_p is {values = [0.1, 0.5, 1.0]} there and {values = [0.1, 0.5, 0.9]} here" in message
    assert "grid" not in message
    assert "\n" not in message


def test_a_swept_parameter_against_a_fixed_one_is_a_difference(store):
    tables = fakes.tables(parameters={"kappa": 0.5})
    del tables["axes"]["kappa"]
    with pytest.raises(cy.InputError, match=r"parameters.kappa is - there and 0.5 here, axes.kappa is"):
        Store.create(store.path, Sweep.from_tables(tables))


def test_axes_in_another_order_are_a_difference(store):
    axes = dict(reversed(fakes.TABLES["axes"].items()))
    with pytest.raises(cy.InputError, match="alpha_p x kappa there and kappa x alpha_p here"):
        Store.create(store.path, Sweep.from_tables(fakes.tables() | {"axes": axes}))


def test_many_differences_stay_one_readable_sentence(store):
    run = {"t_end": 1.0, "finish": "t_end", "rtol": 1e-3, "atol": 1e-3, "dealias": "full", "lanes": 2}
    with pytest.raises(cy.InputError, match="and 3 more; choose another store"):
        Store.create(store.path, fakes.sweep(run=run, parameters={"mu": 1, "d_s": 1, "d_r": 1}))


@pytest.mark.parametrize("content", [None, b"", b"{}", b"[1]", b"\xff", b"[" * 100_000, b'{"sha256": 1}'])
def test_what_is_no_store_is_refused(tmp_path, content):
    if content is not None:
        (tmp_path / "sweep.json").write_bytes(content)
    with pytest.raises(cy.InputError, match=r"store|altered"):
        Store(tmp_path)


def test_a_flipped_byte_of_the_description_is_noticed(store):
    path = store.path / "sweep.json"
    good = path.read_bytes()
    for place in range(0, len(good), 7):
        path.write_bytes(good[:place] + bytes([good[place] ^ 1]) + good[place + 1 :])
        if json_or_none(path) == json.loads(good):
            continue  # a blank between two values says nothing
        with pytest.raises(cy.InputError):
            Store(store.path)


def json_or_none(path):
    try:
        return json.loads(path.read_bytes())
    except ValueError:
        return None


def test_another_layout_is_refused_not_guessed_at(store, monkeypatch):
    monkeypatch.setattr("cyclosis.sweep.store.store.SCHEMA", 2)
    with pytest.raises(cy.InputError, match="schema"):
        Store(store.path)


@pytest.mark.parametrize("lost", [True, False])
def test_a_lost_or_altered_description_is_written_anew_and_blocks_are_kept(store, planned, lost):
    fakes.filled(store)
    (store.path / "sweep.json").unlink()
    if not lost:
        (store.path / "sweep.json").write_text("{}")
        with pytest.raises(cy.InputError, match="remove it and run the sweep again"):
            Store.create(store.path, planned)
        (store.path / "sweep.json").unlink()
    with pytest.raises(cy.InputError, match="another sweep"):
        Store.create(store.path, fakes.sweep(run={"t_end": 3.0}))
    assert Store.create(store.path, planned).verify() == []


def test_folders_with_other_things_are_refused(planned, tmp_path):
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(cy.InputError, match=r"thesis\.tex"):
        Store.create(tmp_path, planned)
    with pytest.raises(cy.InputError, match="store"):
        Store.create(tmp_path / "thesis.tex", planned)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_an_empty_folder_and_missing_parents_will_do(planned, tmp_path):
    (tmp_path / "empty").mkdir()
    assert Store.create(tmp_path / "empty", planned).missing() == list(range(5))
    assert Store.create(tmp_path / "a" / "b" / "c", planned).path.is_dir()


# Damage.


def test_a_flipped_bit_anywhere_in_a_block_is_noticed(planned):
    good = pack(planned, 1, fakes.arrays(planned, 1))
    unpack(good, planned, 1)
    rng = random.Random(5)
    for place in range(len(good)):
        bad = bytearray(good)
        bad[place] ^= 1 << rng.randrange(8)
        with pytest.raises(Damaged):
            unpack(bytes(bad), planned, 1)


@pytest.mark.parametrize("keep", [0, 1, 3, 4, 50, 500, -1, -4, -500])
def test_a_truncated_block_is_noticed(planned, keep):
    with pytest.raises(Damaged):
        unpack(pack(planned, 1, fakes.arrays(planned, 1))[:keep], planned, 1)


def test_verify_names_every_bad_block_and_no_other(tmp_path):
    planned = fakes.sweep(ensemble={"block": 2})
    store = fakes.filled(Store.create(tmp_path / "store", planned))
    other = fakes.sweep(ensemble={"block": 2}, run={"t_end": 1.0})
    data = store.path_of(1).read_bytes()
    store.path_of(1).write_bytes(data[:700] + bytes([data[700] ^ 4]) + data[701:])
    store.path_of(2).write_bytes(store.path_of(2).read_bytes()[:-9])
    store.path_of(3).unlink()
    store.path_of(4).write_bytes(b"")
    store.path_of(5).write_bytes(pack(other, 5, fakes.arrays(other, 5)))
    store.path_of(6).write_bytes(store.path_of(7).read_bytes())
    xarray.Dataset({"a": ("x", [1.0])}).to_netcdf(store.path_of(8), engine="scipy")
    store.path_of(9).write_bytes(store.path_of(9).read_bytes() + b"\0")
    seen = []
    found = dict(store.verify(seen.append))
    assert sorted(found) == [1, 2, 3, 4, 5, 6, 8, 9]
    assert seen == list(range(1, 13))
    assert found[3] == MISSING
    for index, words in {1: "altered", 2: "truncated", 4: "empty", 5: "another sweep", 6: "block 7"}.items():
        assert words in found[index]
    for index in found:
        assert store.fault(index) == found[index]
        with pytest.raises(cy.InputError, match="verify"):
            store.read(index)
    assert store.fault(0) == ""
    fakes.same(store.read(0), fakes.arrays(planned, 0))


def test_other_files_among_the_blocks_are_no_blocks(store):
    fakes.filled(store, 3)
    folder = store.path_of(0).parent
    for name in ("notes.txt", "000000003.nc~", "3.nc", "000000099.nc", ".000000003.nc.host.1.ab.new"):
        (folder / name).write_bytes(b"x")
    assert store.present() == {0, 1, 2, 4}
    assert store.missing() == [3]
    assert not store.has(3)
    assert store.has(2)


def test_a_block_is_discarded(store):
    fakes.filled(store)
    store.set_aside(2, "never mind")
    store.discard(2)
    store.discard(2)
    assert store.missing() == [2]
    assert store.failed() == {}


def test_blocks_set_aside(store, planned):
    store.set_aside(2, "ValueError: 'quoted' \n ä")
    store.set_aside(4, "no")
    store.write(4, fakes.arrays(planned, 4))
    assert store.failed() == {2: "ValueError: 'quoted' \n ä"}
    assert sorted(path.name for path in (store.path / "failed").iterdir()) == ["000000002.json"]
    (store.path / "failed" / "000000002.json").write_text("{")
    assert list(store.failed()) == [2]


def test_many_blocks_are_counted(tmp_path):
    planned = fakes.sweep(ensemble={"seeds": 100_000, "block": 6})
    assert planned.blocks == 100_000
    store = Store.create(tmp_path / "store", planned)
    for index in range(0, 100_000, 5):
        store.path_of(index).parent.mkdir(parents=True, exist_ok=index % 1000 != 0)
        store.path_of(index).touch()
    assert len(store.present()) == 20_000
    assert len(store.missing()) == 80_000
