"""A cell of the explorer is its exported protocol, to the bit; a link holds all of it."""

import json
import tomllib

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from cyclosis.explorer import about, setup
from cyclosis.explorer.messages import understood
from cyclosis.explorer.session import Session

SMALL = {"grid": {"n_theta": 32, "n_z": 32}, "parameters": {"d_s": 0.05}}


def forward(session, t):
    while session.live.t < t:
        session.forward()


@pytest.fixture(scope="module")
def scripted():
    """A cell after a fixed script of actions."""
    session = Session(setup.from_tables(SMALL))
    forward(session, 1.0)
    session.change({"alpha_p": 0.5})
    session.change({"alpha_p": 0.4, "mu": 0.1})
    forward(session, 1.5)
    ask = {"do": "brush", "tool": "wound", "points": [[1.0, 1.0], [1.2, 4.99]], "radius": 0.6}
    for tool in ("wound", "fragment", "align"):
        session.brush(understood(json.dumps(ask | {"tool": tool})))
        forward(session, session.live.t + 0.3)
    session.drug("cytochalasin")
    forward(session, 3.0)
    session.drug("wash_out")
    forward(session, 4.0)
    return session


def test_the_exported_configuration_gives_the_same_bits(scripted):
    tables = tomllib.loads(scripted.setup_now().toml())
    steps = tables.pop("protocol")
    ready = config.setup(config.check(tables), steps)
    run = cy.simulate(
        ready.params, ready.grid, ready.state, protocol=ready.protocol, **ready.settings.as_dict()
    )
    assert run.t_final == scripted.live.t == 4.0
    assert np.array_equal(run.final_state, scripted.live.state)


def test_a_link_round_trip_gives_the_same_hash(scripted):
    link = scripted.setup_now().link()
    other = Session(setup.from_link(link))
    forward(other, 4.0)
    assert other.digest() == scripted.digest()
    assert other.setup_now().link() == link


def test_changes_at_one_time_are_one_step(scripted):
    assert scripted.setup_now().steps[0] == {"at": 1.0, "action": "change", "alpha_p": 0.4, "mu": 0.1}


@pytest.mark.parametrize(
    ("tables", "steps", "part"),
    [
        ({"grid": {"n_z": 4096}}, (), "at most 128"),
        ({"initial": {"kind": "file", "path": "x.nc"}}, (), "in the explorer"),
        ({"run": {"t_end": 1e9}}, (), "decides on the others"),
        ({"parameters": {"alpha_p": [[1.0]]}}, (), "numbers in the explorer"),
        ({}, [{"at": 1, "where": {"parts": [{"shape": "image", "path": "x"}]}}], "left out"),
        ([], (), "a set of tables"),
    ],
)
def test_what_a_visitor_may_not_do_is_said(tables, steps, part):
    with pytest.raises(cy.InputError, match=part):
        setup.from_tables(tables, steps)


@pytest.mark.parametrize("link", ["", "x", "A" * 50_000, "eNo", "é"])
def test_a_text_that_is_no_link_is_refused(link):
    with pytest.raises(cy.InputError, match="the part of an address"):
        setup.from_link(link)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{}",
        "[]",
        "null",
        "[" * 9999,
        '{"do": "fly"}',
        '{"do": "seen"}',
        '{"do": "speed", "value": 1e9}',
        '{"do": "play", "more": 1}',
        '{"do": "brush", "tool": "wound", "points": [], "radius": 1}',
        '{"do": "vacuole"}',
        '{"do": "vacuole", "on": 1}',
        '{"do": "vacuole", "on": true, "tracers": 0}',
        '{"do": "vacuole", "on": true, "tracers": 1001}',
        '{"do": "vacuole", "on": true, "pace": 1e9}',
        '{"do": "vacuole", "on": true, "pace": NaN}',
    ],
)
def test_a_malformed_message_is_refused_in_a_sentence(text):
    with pytest.raises(cy.InputError, match="must be"):
        understood(text)


@pytest.mark.slow
def test_the_page_is_told_of_every_setting():
    told = about.about()
    assert len(told["diagram"]["share"]) == len(told["diagram"]["alpha_p"]) == 20
    assert all(item["usual"] or item["kind"] == "flag" for item in told["parameters"])
    found = about.curves(cy.Parameters())
    assert found["applies"]
    assert len(found["curves"]) >= 3


def test_a_cell_is_told_as_it_is_and_no_noise_is_added():
    told = setup.from_tables({"initial": {"kind": "stripes", "magnitude": 0.5}}).filled()["initial"]
    assert told == {"kind": "stripes", "magnitude": 0.5, "stripes": 2}
    assert "filaments_per_square" in setup.from_tables({}).filled()["initial"]


def test_a_cell_needs_another_kind_of_program_only_when_its_protocol_comes_to_it():
    later = [{"at": 40.0, "action": "change", "alpha_u": 0.1, "over": 5.0}]
    session = Session(setup.from_tables({"grid": {"n_theta": 16, "n_z": 16}}, later))
    assert session.kinds() == {session.kind}
    soon = [later[0] | {"at": 0.1}]
    assert len(Session(setup.from_tables({"grid": {"n_theta": 16, "n_z": 16}}, soon)).kinds()) == 2


def told(session):
    """What a picture says of the regime."""
    data = session.picture()
    return json.loads(data[8 : 8 + int.from_bytes(data[:4], "little")])["regime"]


def test_a_picture_has_the_numbers_behind_its_words(scripted):
    P = scripted.live.state
    found, numbers = cy.regime(scripted.live.params_now, scripted.live.grid, P), told(scripted)
    crossed = cy.zones.crossings(P)
    assert numbers["name"] == found.name
    assert numbers["order"] == found.order
    assert numbers["around"] == pytest.approx(np.mean(P[0] ** 2) / np.mean(np.sum(P**2, axis=0)))
    assert numbers["boundaries"] == [crossed.min(), crossed.max()]
    assert numbers["mean"] == found.mean_P.tolist()
    assert numbers["drift"] == found.drift.tolist()


def test_the_pace_is_the_rate_at_which_changes_grow():
    """Uniform order relaxes at twice its distance to the threshold: P' = (a - α_p P²) P."""
    start = {"initial": {"kind": "unidirectional", "magnitude": 0.9}, "run": {"save_every": 0.25}}
    session = Session(setup.from_tables(SMALL | start | {"parameters": {"alpha_u": 0.0, "kappa": 0.0}}))
    assert told(session)["pace"] is None
    forward(session, 6.0)
    assert told(session)["pace"] == pytest.approx(-2 * (1.0 - 0.025), rel=0.01)
    assert f"relaxing at {told(session)['pace']:.3f}" in told(session)["reason"]
    forward(session, 20.0)
    assert told(session)["pace"] == "steady"
    assert told(session)["reason"].endswith(", steady")
