import csv
import errno
import gzip
import os
import shutil
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pandas
import pytest
import xarray

import cyclosis as cy
from cyclosis.dataset.whole import temporary
from cyclosis.sweep.export import export
from cyclosis.sweep.store.read import open_sweep
from cyclosis.sweep.store.store import Store
from sweep import fakes

SUFFIXES = (".zarr", ".nc", ".csv", ".csv.gz")


@pytest.fixture(scope="module", params=[False, True], ids=["numbers", "fields"])
def filled(request, tmp_path_factory):
    planned = fakes.sweep(record={"fields": request.param})
    return fakes.filled(Store.create(tmp_path_factory.mktemp("filled") / "store", planned), 3).path


@pytest.fixture
def store(filled, tmp_path):
    """A store of the test's own."""
    return Store(shutil.copytree(filled, tmp_path / "store"))


numbers_alone = pytest.mark.parametrize("filled", [False], ids=["numbers"], indirect=True)
"""For what does not depend on what is stored."""


@pytest.fixture
def target(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out" / "sweep"


def read(path):
    if path.suffix == ".zarr":
        return xarray.open_zarr(path, mask_and_scale=False).load()
    with xarray.open_dataset(path, engine="h5netcdf", mask_and_scale=False) as data:
        return data.load()


@pytest.mark.parametrize("suffix", [".zarr", ".nc"])
def test_the_dataset_comes_back(store, target, suffix):
    path = export(store, f"{target}{suffix}")
    assert path == target.with_suffix(suffix)
    stored, expected = read(path), open_sweep(store.path).load()
    xarray.testing.assert_equal(stored, expected)
    assert stored.regime.dtype == "int8"
    assert stored.regime.attrs["flag_meanings"] == " ".join(cy.REGIMES)
    assert list(stored.regime.attrs["flag_values"]) == list(range(len(cy.REGIMES)))
    assert stored.regime.attrs["valid_min"] == 0
    assert stored.attrs == expected.attrs
    for name, variable in stored.variables.items():
        assert variable.attrs["long_name"] == expected[name].attrs["long_name"]
        assert variable.attrs["units"] == "1"
    assert [item.name for item in target.parent.iterdir()] == [path.name]


INTEGERS = {"regime": "int8", "status": "int8", "zone_count": "int16", "evaluations": "int32"}


def plainly(path):
    """What a user gets who knows xarray, or pandas, and not this package."""
    if ".csv" in path.name:
        return pandas.read_csv(path)
    with xarray.open_dataset(path) as data:
        return data.load()


@pytest.mark.parametrize("suffix", [".zarr", ".nc"])
def test_integers_stay_integers_in_plain_xarray(store, target, suffix):
    data, expected = plainly(export(store, f"{target}{suffix}")), open_sweep(store.path).load()
    for name, kind in INTEGERS.items():
        assert data[name].dtype == kind
        assert np.array_equal(data[name].values, expected[name].values)
        assert int((data[name] < 0).sum()) == data.attrs["members_missing"] == 5
    again = data[["regime", "zone_count"]]
    again.to_netcdf(target.with_suffix(".again.nc"))
    assert plainly(target.with_suffix(".again.nc")).regime.dtype == "int8"


def test_integers_stay_integers_in_a_plain_block(store):
    """A block is a file of its own, for anything that reads classic NetCDF."""
    with xarray.open_dataset(next(store.path.glob("blocks/*/*.nc")), engine="scipy") as data:
        assert {name: str(data[name].dtype) for name in INTEGERS} == INTEGERS


def test_integers_stay_integers_in_pandas(store, target):
    """Those of a whole sweep; where members are missing cells are empty, for which `Int64` is to be asked."""
    fakes.filled(store)
    table = plainly(export(store, f"{target}.csv"))
    assert table.regime.isin(cy.REGIMES).all()
    assert len(table) == store.sweep.members
    for name in ("member", "seed", "zone_count", "evaluations"):
        assert table[name].dtype == "int64"
        assert table[name].min() >= 0
    partly = export(fakes.filled(Store.create(target / "store", store.sweep), 0), f"{target}.partly.csv")
    counts = pandas.read_csv(partly, dtype={"zone_count": "Int64"}).zone_count
    assert 0 < counts.isna().sum() < len(counts)


@pytest.mark.parametrize("suffix", [".zarr", ".nc"])
def test_an_export_of_an_earlier_version_opens(store, target, suffix):
    """These named -1 as the fill value."""
    path = target.with_suffix(suffix)
    old = open_sweep(store.path).load()
    for name, kind in INTEGERS.items():
        del old[name].attrs["valid_min"], old[name].attrs["comment"]
        old[name].attrs["_FillValue"] = np.dtype(kind).type(-1)
    if suffix == ".nc":
        old.to_netcdf(path, engine="h5netcdf")
    else:
        old.to_zarr(path, zarr_format=2)
    opened = open_sweep(path)
    for name, kind in INTEGERS.items():
        assert opened[name].dtype == kind
        assert np.array_equal(opened[name].values, old[name].values)


def test_netcdf_is_compressed(tmp_path):
    planned = fakes.sweep(ensemble={"seeds": 500})
    store = Store.create(tmp_path / "store", planned)
    path = export(store, tmp_path / "empty.nc")
    assert path.stat().st_size < 0.1 * open_sweep(store.path).nbytes


def rows(path):
    opened = gzip.open(path, "rt") if path.suffix == ".gz" else open(path, newline="")  # noqa: SIM115
    with opened as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_a_table_has_a_row_for_every_member(store, target, suffix):
    table = rows(export(store, f"{target}{suffix}"))
    planned, data = store.sweep, open_sweep(store.path)
    assert [int(row["member"]) for row in table] == list(range(24))
    for number, row in enumerate(table):
        point, seed = planned.member(number)
        assert {name: float(row[name]) for name in point} == point
        assert int(row["seed"]) == seed
        there = data.sel(point | {"seed": seed})
        if 15 <= number < 20:
            assert {value for name, value in row.items() if name not in (*point, "seed", "member")} == {""}
            continue
        assert row["regime"] == cy.REGIMES[int(there.regime)]
        assert float(row["t_final"]) == float(there.t_final)
        assert float(row["mean_P_z"]) == float(there.mean_P.sel(component="z"))
        assert float(row["budget_bundling"]) == float(there.budget.sel(term="bundling"))
        assert [float(text) for text in row["zone_angle"].split()] == there.zone_angle.values[:3].tolist()
    assert not {"profile", "P", "profile_theta"} & table[0].keys()


def test_chosen_variables(store, target):
    table = rows(export(store, f"{target}.csv", variables=["regime", "mean_P"]))
    assert list(table[0]) == ["member", "alpha_p", "kappa", "seed", "regime", "mean_P_theta", "mean_P_z"]
    assert set(read(export(store, f"{target}.nc", variables=["regime"])).data_vars) == {"regime"}
    with pytest.raises(cy.InputError, match="variables"):
        export(store, f"{target}2.csv", variables=["nonsense"])


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_tables_of_the_same_results_are_the_same_bytes(store, target, suffix):
    first = export(store, f"{target}{suffix}").read_bytes()
    assert export(store.path, f"{target}2{suffix}").read_bytes() == first


@numbers_alone
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nothing_is_overwritten_unless_forced(store, target, suffix):
    path = export(store, f"{target}{suffix}")
    with pytest.raises(cy.InputError, match="force"):
        export(store, path)
    export(store, path, force=True)
    assert [item.name for item in target.parent.iterdir()] == [path.name]


@numbers_alone
def test_folders_with_other_things_are_never_replaced(store, target):
    for name in ("thesis.zarr", "thesis.nc", "thesis.csv"):
        folder = target.parent / name
        folder.mkdir()
        (folder / "thesis.tex").write_text("precious")
        with pytest.raises(cy.InputError, match="out"):
            export(store, folder, force=True)
        assert (folder / "thesis.tex").read_text() == "precious"


@numbers_alone
@pytest.mark.parametrize("name", ["sweep.h5", "sweep", "sweep.gz", ".csv", "no/sweep.nc", "sweep.csv.zip"])
def test_places_and_suffixes_that_will_not_do(store, target, name):
    with pytest.raises(cy.InputError, match="out"):
        export(store, target.parent / name)
    assert list(target.parent.iterdir()) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_block_leaves_nothing(store, target, suffix):
    store.path_of(1).write_bytes(b"")
    with pytest.raises(cy.InputError, match="block 1"):
        export(store, f"{target}{suffix}")
    assert list(target.parent.iterdir()) == []


@numbers_alone
@pytest.mark.parametrize(
    ("suffix", "forced", "failing"),
    [(suffix, forced, 1) for suffix in SUFFIXES for forced in (False, True)] + [(".zarr", True, 2)],
)
def test_a_rename_that_fails_leaves_what_stood(store, target, suffix, forced, failing, monkeypatch):
    path = target.with_name(f"sweep{suffix}")
    before = None
    if forced:
        export(store, path, variables=["regime"])
        before = contents(path)

    calls, replace = [], os.replace

    def refuse(source, place):
        if Path(place).parent == path.parent:  # the writer of Zarr renames its own files as well
            calls.append(place)
            if len(calls) == failing:
                raise OSError(errno.ENOSPC, "No space left on device")
        replace(source, place)

    monkeypatch.setattr(os, "replace", refuse)
    if suffix != ".zarr":
        monkeypatch.delattr(os, "link")  # which is tried first where nothing is to be replaced
    with pytest.raises(cy.InputError, match="free some disk space"):
        export(store, path, force=forced)
    monkeypatch.undo()
    assert [item.name for item in target.parent.iterdir()] == ([path.name] if forced else [])
    if forced:
        assert contents(path) == before


@numbers_alone
def test_what_zarr_still_writes_after_a_failure_goes_as_well(store, target, monkeypatch):
    """Of two files that are written side by side one fails: the other comes in after the error."""
    replace, failed = os.replace, threading.Event()

    def refuse(source, place):
        if Path(place).parts[-2:] == ("regime", ".zarray"):
            failed.set()
            raise OSError(errno.ENOSPC, "No space left on device")
        if Path(place).parts[-2:] == ("regime", ".zattrs"):
            failed.wait(5.0)
            time.sleep(0.03)
            Path(place).parent.mkdir(parents=True, exist_ok=True)
            Path(place).write_bytes(b"late")
            return
        replace(source, place)

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(cy.InputError, match="free some disk space"):
        export(store, f"{target}.zarr")
    monkeypatch.undo()
    time.sleep(0.2)
    assert list(target.parent.iterdir()) == []


def contents(path):
    files = [path] if path.is_file() else sorted(item for item in path.rglob("*") if item.is_file())
    return {str(item): item.read_bytes() for item in files}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize("suffix", [".nc", ".csv", ".csv.gz"])
def test_a_full_disk_is_one_sentence(store, target, suffix, monkeypatch):
    monkeypatch.setattr("secrets.token_hex", lambda _: "x")
    os.symlink("/dev/full", temporary(target.with_name(f"sweep{suffix}")))
    with pytest.raises(cy.InputError, match="free some disk space"):
        export(store, f"{target}{suffix}")
    assert list(target.parent.iterdir()) == []


@numbers_alone
@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("room", [1, 100, 1000])
def test_a_disk_that_fills_up_leaves_nothing(store, target, suffix, room):
    """A write that only partly succeeds is as bad as one that fails."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        with pytest.raises(cy.InputError, match="free some disk space"):
            export(store, f"{target}{suffix}")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert list(target.parent.iterdir()) == []


def test_large_fields_of_parameters_can_be_exported(tmp_path):
    field = np.random.default_rng(0).uniform(size=(64, 64)).tolist()
    planned = fakes.sweep(parameters={"alpha_u": field}, grid={"n_theta": 64, "n_z": 64})
    store = fakes.filled(Store.create(tmp_path / "store", planned))
    assert store.verify() == []
    for suffix in (".nc", ".zarr"):
        stored = read(export(store, tmp_path / f"out{suffix}"))
        assert stored.attrs["configuration"] == open_sweep(store.path).attrs["configuration"]


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_an_export_opens_like_the_store(tmp_path, suffix):
    planned = fakes.sweep()
    store = fakes.filled(Store.create(tmp_path / "store", planned))
    target = export(store, tmp_path / f"out{suffix}")
    names = ["regime", "t_order", "profile"]
    with open_sweep(target, names) as found, open_sweep(tmp_path / "store", names) as expected:
        assert set(found.data_vars) == set(names)
        for name in names:
            np.testing.assert_array_equal(found[name].values, expected[name].values)
            assert found[name].dims == expected[name].dims
        assert found.attrs["digest"] == expected.attrs["digest"]
        assert found.regime.attrs["flag_meanings"] == expected.regime.attrs["flag_meanings"]
    with pytest.raises(cy.InputError, match="export it as well"):
        open_sweep(target, ["nonsense"])


def test_what_is_no_export_is_refused(tmp_path):
    path = tmp_path / "foreign.nc"
    xarray.Dataset({"a": ("x", [1.0])}).to_netcdf(path, engine="h5netcdf")
    for place in (path, tmp_path / "none.nc", tmp_path / "none.zarr"):
        with pytest.raises(cy.InputError, match="sweep"):
            open_sweep(place)


def test_folders_put_in_one_place_at_once_come_one_after_the_other(tmp_path):
    """What stands in the end is one of them, whole, and nothing else is left."""
    target, failed = tmp_path / "sweep.zarr", []
    store = fakes.filled(Store.create(tmp_path / "store", fakes.sweep()))

    def work():
        try:
            for _ in range(3):
                export(store, target, force=True)
        except Exception as error:
            failed.append(error)

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    assert xarray.open_zarr(target).equals(cy.open_sweep(store.path))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["store", "sweep.zarr"]
