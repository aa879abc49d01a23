"""What is undone has not happened: the state, the link and the future of the cell are those without it."""

import json

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from cyclosis.explorer import setup
from cyclosis.explorer.messages import understood
from cyclosis.explorer.session import Session
from cyclosis.explorer.undo import MOST
from cyclosis.model.errors import InputError

SMALL = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.05}}
GIVEN = ({"at": 0.3, "action": "change", "alpha_u": 0.4},)


def forward(session, t):
    while session.live.t < t:
        session.forward()


def wound(session, z=1.0):
    ask = {"do": "brush", "tool": "wound", "points": [[1.0, z]], "radius": 0.6}
    session.brush(understood(json.dumps(ask)))


def test_the_state_before_comes_back_and_goes_on_as_if_nothing_had_been_done():
    session = Session(setup.from_tables(SMALL, GIVEN))
    forward(session, 0.5)
    session.change({"alpha_p": 0.5})
    digest, link = session.digest(), session.setup_now().link()
    forward(session, 0.7)
    before, state = session.setup_now(), session.digest()
    wound(session)
    session.drug("inhibit_myosin")
    forward(session, 1.0)
    session.undo()
    session.undo()
    assert (session.live.t, session.digest()) == (0.7, state)
    assert session.setup_now().link() == before.link()
    assert max(row[0] for row in session.fresh) == 0.7
    session.undo()
    assert session.live.t == 0.5
    assert len(session.live.protocol) == 1
    with pytest.raises(InputError, match="after an intervention"):
        session.undo()
    session.change({"alpha_p": 0.5})
    assert (session.digest(), session.setup_now().link()) == (digest, link)
    forward(session, 1.5)
    ready = config.setup(session.setup.tables, session.setup_now().steps)
    run = cy.simulate(
        ready.params, ready.grid, ready.state, t_end=1.5, save_every=0.1, protocol=ready.protocol
    )
    assert np.array_equal(run.final_state, session.live.state)


def test_pieces_of_one_gesture_are_undone_together_and_few_are_kept(monkeypatch):
    now = 0.0
    monkeypatch.setattr("cyclosis.explorer.undo.clock.monotonic", lambda: now)
    session = Session(setup.from_tables(SMALL))
    for value in (0.9, 0.8, 0.7):
        session.change({"alpha_p": value})
        forward(session, session.live.t + 0.1)
        now += 0.5
    wound(session)
    assert len(session.done) == 2
    # A drug that acts on a parameter is no continuation of the hand that moved it.
    session.change({"alpha_p": 0.6})
    session.drug("cytochalasin")
    assert len(session.done) == 4
    for _ in range(4):
        session.undo()
    assert (session.live.t, session.words(0.0)["undo"]) == (0.0, 0)
    for _ in range(MOST + 3):
        now += 2.0
        wound(session)
    assert len(session.done) == MOST


def test_again_is_the_same_cell_from_the_start_with_what_the_visitor_has_set():
    session = Session(setup.from_tables(SMALL | {"initial": {"seed": 7}}, GIVEN))
    forward(session, 0.5)
    session.change({"alpha_p": 0.5, "kappa": 0.1})
    wound(session)
    session.change({"alpha_u": 0.2})
    session.undo()
    again = session.again()
    assert (again.t, again.steps) == (0.0, GIVEN)
    assert again.tables["initial"] == {"seed": 7}
    assert again.tables["parameters"] == {"d_s": 0.05, "alpha_p": 0.5, "kappa": 0.1}
    session.drug("wash_out")
    assert session.again().tables["parameters"] == SMALL["parameters"]
