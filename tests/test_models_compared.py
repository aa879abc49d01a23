"""The page that judges the claims by every model says what the datasets hold, counted here again."""

import importlib.util
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image

import cyclosis as cy

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def compared():
    spec = importlib.util.spec_from_file_location("compared", DOCS / "compared" / "__init__.py")
    module = sys.modules["compared"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def data(compared):
    stored = compared.Stored()
    compared.page(stored)
    return {name: stored[name] for name in list(stored.used)}


def cells(compared, data, title):
    """The row of a title, by column."""
    (row,) = (row for row in compared.ROWS if row.title == title)
    return row.cells(compared.Stored(data))


def numbers(cell):
    return [float(x) for x in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", cell[1])]


def test_onsets_are_those_of_linear_theory(compared, data):
    found = cells(compared, data, "Onset")
    params = cy.Parameters()
    assert numbers(found["polar"])[0] == pytest.approx(params.d_r, rel=1e-3)
    assert numbers(found["vacuole"])[0] == pytest.approx(params.d_r, rel=1e-3)
    assert numbers(found["kinetic"])[0] == pytest.approx(cy.kinetic.thresholds(params).along, abs=5e-4)
    assert found["kinetic"][0] == "does not"
    assert found["polar"][0] == "agrees"


def test_ends_are_those_of_the_members(compared, data):
    """One stream is regime 1 of a closed cell, two streams regime 2."""
    ends = data["ends"]["end"].sel(number="regime")
    cylinder = ends.sel(shape="cylinder 5").values
    two = (cylinder == 2).sum(axis=-1)
    either = (two > 0) & (two < 20)
    first = {shape: ends.sel(shape=shape).values[..., :10][either] for shape in ("capsule 5", "spheroid 3")}
    capsule, spheroid = ((found == 2).sum() for found in first.values())
    found = cells(compared, data, "One stream or two")
    assert numbers(found["polar"]) == [
        either.sum(),
        64,
        two[either].sum(),
        20 * either.sum(),
        (two == 20).sum(),
    ]
    assert numbers(found["closed"]) == [capsule, 10 * either.sum(), spheroid, 10 * either.sum()]
    rings = data["closure"]["ring"].sel(model="kinetic", number="outcome").values[6:]
    split = ((rings == 3).any(axis=-1) & (rings == 2).any(axis=-1)).sum()
    all_two = ((rings == 3) | np.isnan(rings)).all(axis=-1).sum()
    assert numbers(found["kinetic"]) == [split, 72, all_two]


def test_what_the_drug_leaves_is_counted(compared, data):
    found = cells(compared, data, "The drug")
    usual = data["cytochalasin"]["streams"].sel(alpha_u=0.5)
    left = [int(usual.sel(way=way).sum()) for way in ("from disorder", "established")]
    assert numbers(found["polar"]) == [left[0], 200, left[1], 200]
    fading = data["closure"]["fading"].sel(closure="kinetic", fading_kappa=0.5, quantity="along")
    lasting = int((fading.isel(fading_time=-1) > 0.2).sum())
    assert numbers(found["kinetic"])[-2:] == [lasting, 6]
    speed = data["drug-capsule"]["peak_speed"]
    for alpha_u, told in ((0.5, numbers(found["closed"])[:2]), (0.2, numbers(found["closed"])[3:5])):
        assert told == [int((speed.sel(alpha_u=alpha_u) > 0.05).sum()), 5]


def test_the_treated_capsules_were_treated(data):
    """Each was followed for 200 R/U without bundling, and without alignment by flow nothing lasts."""
    assert (data["drug-capsule"]["t_final"] == 300.0).all()
    streams = data["drug-capsule"]["peak_speed"].mean("seed")
    assert (streams.diff("alpha_u") > -1e-3).all(), "more alignment with the flow leaves less flow"


def test_capsules_need_bundling_and_repulsion_alone(compared, data):
    regime = data["processes-capsule"]["regime"]
    two = (regime == 2).sum("seed")
    for alpha_p in (0.0, 1.0):
        for kappa in (0.0, 0.5):
            for alpha_u in (0.0, 0.5):
                expected = 5 if alpha_p and kappa else 0
                assert int(two.sel(alpha_p=alpha_p, kappa=kappa, alpha_u=alpha_u)) == expected
    assert cells(compared, data, "Motors")["closed"][0] == "does not"


def test_kinetic_stripes_become_equal(data):
    """Mirror images of one state: both widths of every pattern, and both hands."""
    widths = data["widths-kinetic"]["stripe_width"]
    assert np.allclose(widths.sum("zone").values[widths.notnull().any("zone").values], 1.0)
    strong = widths.sel(alpha_u=[0.5, 1.0]).isel(zone=slice(2)).values
    assert np.abs(strong[np.isfinite(strong)] - 0.5).max() < 1e-3


def test_a_row_whose_models_disagree_says_which_to_believe(compared, data):
    for row in compared.ROWS:
        stored = compared.Stored(data)
        verdicts = {verdict for verdict, _ in row.cells(stored).values() if verdict}
        if len(verdicts) > 1:
            assert re.search(r"[Bb]elieve", row.why(stored)), row.title


def test_the_picture_shows_the_verdicts_of_the_page(compared, data):
    shown = json.loads(Image.open(DOCS / "images" / "models-compared.png").text["Description"])
    assert shown == compared.verdicts(compared.Stored(data))


def disturbed(dataset, factor):
    """The dataset with all numbers multiplied and in another order, and all codes and flags zero."""
    out = dataset.copy(deep=True)
    for name, variable in dataset.data_vars.items():
        if variable.dtype.kind == "f":
            out[name] = factor * variable.copy(data=np.roll(variable.values, 1))
        elif variable.dtype.kind in "iub":
            out[name] = xarray.zeros_like(variable)
    scaled = {key: value * factor for key, value in dataset.attrs.items() if isinstance(value, float)}
    return out.assign_attrs(scaled)


def written(compared, data):
    """The page of these data, or why it cannot be written."""
    try:
        return compared.page(compared.Stored(data))
    except (ValueError, ZeroDivisionError) as error:
        return str(error)


@pytest.mark.slow
def test_the_page_depends_on_every_dataset_that_it_names(compared, data):
    """No number in it is typed by hand: another dataset makes another page, or none."""
    before = compared.page(compared.Stored(data))
    names = {path.stem for path in (DOCS / "data" / "compared").glob("*.nc")}
    assert names <= set(data)
    for name in data:
        others = [written(compared, {**data, name: disturbed(data[name], x)}) for x in (1.25, 0.01)]
        assert any(other != before for other in others), name


def test_a_sentence_that_the_data_contradict_is_refused(compared, data):
    held = data["ends"].copy(deep=True)
    held["growth"] = -abs(held["growth"])
    with pytest.raises(ValueError, match="unstable everywhere on the capsule"):
        compared.page(compared.Stored({**data, "ends": held}))
