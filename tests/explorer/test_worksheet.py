"""Each answer of the worksheet is what its cell shows when the question is tried."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from cyclosis.dynamics.protocol import Protocol, change, depolymerise, fragment, wash_out
from cyclosis.explorer.setup import from_link
from cyclosis.explorer.worksheet import WORKSHEET, described
from cyclosis.model.regions import disc

slow = pytest.mark.slow


def tried(number, t_end, *steps, seed=None, **parameters):
    """Return the run of a question's cell, with further steps, another seed, or other parameters."""
    given = WORKSHEET[number - 1].setup()
    tables = {name: dict(table) for name, table in given.tables.items()}
    tables["parameters"] |= parameters
    if seed is not None:
        tables["initial"]["seed"] = seed
    ready = config.setup(tables, list(given.steps))
    protocol = Protocol(*ready.protocol, *steps, seed=ready.protocol.seed)
    how = {"t_end": t_end, "save_every": 5.0, "protocol": protocol}
    return cy.simulate(ready.params, ready.grid, ready.state, **how)


def frame(run, t):
    return np.asarray(run.frames[int(np.argmin(np.abs(run.times - t)))])


def regime(run, t):
    return cy.regime(run.params_at(t), run.grid, frame(run, t))


def order(run, t):
    return float(np.sqrt((frame(run, t) ** 2).sum(axis=0).mean()))


def speed(run, t):
    return float(np.hypot(*cy.flow(run.params_at(t), run.grid, frame(run, t))).max())


def lines(run, t):
    return cy.zones.zone_angles(frame(run, t)[1].mean(axis=1))


def test_every_question_has_the_link_of_its_cell():
    assert len(WORKSHEET) == 10
    for item, sent in zip(WORKSHEET, described(), strict=True):
        opened = from_link(sent["link"])
        assert (opened.tables, opened.steps, opened.t) == (item.setup().tables, item.protocol, 0.0)
        assert item.question.endswith("?")
        assert opened.ready().grid.shape == (32, 32)


@slow
def test_where_streams_come_from_and_that_every_cell_is_different():
    run = tried(1, 60.0)
    assert regime(run, 5.0).name == "undecided"
    assert {regime(run, t).name for t in range(10, 61, 5)} == {"cyclosis"}
    cells = [tried(2, 60.0, seed=seed) for seed in (1, 2, 3)]
    assert [regime(cell, 60.0).name for cell in cells] == ["cyclosis"] * 3
    first = [lines(cell, 60.0)[0] for cell in cells]
    assert np.abs(np.subtract.outer(first, first)[np.triu_indices(3, 1)]).min() > 0.1


@slow
def test_bundling_and_flow_are_needed():
    run = tried(3, 200.0, change(60.0, alpha_p=0.1))
    assert regime(run, 60.0).name == "disordered"
    assert order(run, 60.0) < 0.01
    assert order(run, 200.0) > 0.5
    alone = tried(4, 200.0)
    assert regime(alone, 200.0).name == "unidirectional"
    assert speed(alone, 200.0) < 1e-3
    assert regime(tried(4, 30.0, alpha_u=0.8), 30.0).name == "cyclosis"


@slow
def test_cytochalasin_keeps_streams_but_not_fragments():
    run = tried(5, 140.0, change(20.0, alpha_p=0.0), fragment(60.0), wash_out(100.0))
    before, under = speed(run, 20.0), speed(run, 55.0)
    assert 0.9 * before < under < before
    assert regime(run, 95.0).name == "disordered"
    assert regime(run, 140.0).name == "cyclosis"


@slow
def test_a_wound_heals_and_streams_become_equally_wide():
    run = tried(6, 10.0, depolymerise(5.0, where=disc(theta=1.5708, z=2.5, radius=0.8)))
    assert np.hypot(*frame(run, 5.0)[:, 8, 16]) == 0.0
    assert np.hypot(*frame(run, 10.0)[:, 8, 16]) > 0.9
    fast, late = tried(7, 60.0), tried(7, 60.0, alpha_u=0.1)
    assert max(regime(fast, 5.0).widths) > 0.55
    assert max(regime(fast, 60.0).widths) < 0.51 < 0.54 < max(regime(late, 60.0).widths)


@slow
def test_repulsion_keeps_filaments_along_the_cell_and_streams_in_place():
    run = tried(8, 110.0, wash_out(60.0))
    assert [regime(run, t).name for t in (0.0, 60.0, 110.0)] == ["cyclosis", "circumferential", "cyclosis"]
    moving, still = tried(9, 250.0), tried(9, 250.0, kappa=0.5)
    found = regime(moving, 250.0)
    assert found.name == "travelling"
    assert 2 * np.pi / abs(found.drift[0]) == pytest.approx(900.0, rel=0.05)
    assert np.abs(lines(moving, 250.0) - lines(moving, 150.0)).min() > 0.5
    assert np.abs(lines(still, 250.0) - lines(still, 150.0)).max() < 0.01


@slow
def test_zones_are_wider_the_faster_order_spreads():
    def share(d_s):
        profile = frame(tried(10, 25.0, change(5.0, d_s=d_s)), 25.0)[1].mean(axis=1)
        return float((np.abs(profile) < 0.8).mean())

    narrow, usual, wide = share(0.005), share(0.025), share(0.1)
    assert narrow < usual < wide
