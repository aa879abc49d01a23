"""Doing an experiment: what it leaves, that it goes on, and what is refused."""

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

import cyclosis as cy
from cyclosis.cli import app
from cyclosis.experiments import NAMES, experiment, perform
from cyclosis.experiments.experiment import OUTCOMES
from cyclosis.experiments.perform import verdict_of


@pytest.mark.parametrize("name", NAMES)
def test_every_experiment_says_what_it_is(name):
    found = experiment(name)
    assert found.name == name
    assert found.seeds >= found.quick_seeds >= 1
    assert len(found.headline) <= 80, "it must fit a table"
    for text in (found.headline, found.claim, found.source, found.method):
        assert len(text) >= len("Results")
        assert "\n" not in text


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    return perform("recovery", tmp_path_factory.mktemp("bench"), seeds=2, quick=True, workers=1)


@pytest.mark.slow
def test_it_leaves_a_dataset_a_figure_and_a_verdict(done):
    assert done.verdict.outcome in OUTCOMES
    assert done.figure.stat().st_size > 20_000
    with xarray.open_dataset(done.file, engine="h5netcdf") as stored:
        assert verdict_of(stored) == done.verdict
        assert stored.attrs["command"] == "cyclosis experiment recovery --quick --seeds 2"
        again = done.experiment.verdict(stored)
        assert again == done.verdict
        assert stored.sizes["seed"] == 2


@pytest.mark.slow
def test_it_goes_on_from_its_stores(done):
    again = perform("recovery", done.file.parent, seeds=2, quick=True, workers=1, force=True)
    assert np.array_equal(again.dataset["zone_shift"], done.dataset["zone_shift"], equal_nan=True)


def test_standing_files_unknown_names_and_other_datasets_are_refused(tmp_path):
    (tmp_path / "recovery.nc").touch()
    with pytest.raises(cy.InputError, match="force"):
        perform("recovery", tmp_path, seeds=2, quick=True)
    with pytest.raises(cy.InputError, match="one of emergence"):
        perform("levitation", tmp_path)
    with pytest.raises(cy.InputError, match="seeds"):
        perform("recovery", tmp_path / "new", seeds=0)
    with pytest.raises(cy.InputError, match="experiment"):
        verdict_of(xarray.Dataset())


def test_the_command_lists_every_experiment_with_its_claim():
    out = CliRunner().invoke(app, ["experiment", "list"]).stdout
    for name in NAMES:
        assert name in out
    result = CliRunner().invoke(app, ["experiment", "levitation"])
    assert isinstance(result.exception, cy.InputError)
