"""Ten questions for a class, each with a cell to begin with, what to try, and what is then seen.

`tests/explorer/test_worksheet.py` tries each and looks. The cells have 32 x 32 points, so that a browser
computes them fast.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from math import pi
from typing import Any

from .preset import STRIPES, UP, Table, align, cell, change
from .setup import SetUp, from_tables

GRID = {"n_theta": 32, "n_z": 32}


@dataclass(frozen=True)
class Question:
    """A question: the cell as tables and steps, what to try, and the `answer` that the cell gives."""

    question: str
    attempt: str
    answer: str
    tables: dict[str, Table] = field(default_factory=dict)
    protocol: tuple[Table, ...] = ()

    def setup(self) -> SetUp:
        """Return the cell."""
        return from_tables(self.tables, self.protocol)


def _cell(start: Table | None = None, **parameters: float) -> dict[str, Table]:
    return cell(start, GRID, **parameters)


WORKSHEET = (
    Question(
        "Where do the two streams come from?",
        "Press Play and watch the map. Write down when patches appear, when they merge, and when two "
        "streams run along the whole cell. Then go back to the beginning and check your times.",
        "Patches of order appear by t = 5, and from t = 10 on there are two streams, one up and one down. "
        "Back at the beginning the same seed gives the same times: nothing here is chance but the start.",
        _cell({"seed": 0}),
    ),
    Question(
        "Is every cell the same?",
        "Run the cell to t = 60 and note where the white lines are. Do so again with New seed, three times.",
        "Two streams form each time, but in other places. The laws decide what forms, and chance decides "
        "where.",
        _cell({"seed": 1}),
    ),
    Question(
        "Is bundling needed?",
        "Here filaments hardly bundle: α_p is 0.02, less than d_r, the rate at which order is lost. Run "
        "the cell to t = 60. Then set α_p to 0.1, and run it to t = 200.",
        "Below α_p = 0.025 the cell stays in disorder, and nothing streams. With 0.1 order grows, at first "
        "unseen, and fills the cell by t = 200: neighbours must agree faster than chance turns them.",
        _cell({"seed": 0}, alpha_p=0.02),
    ),
    Question(
        "Does the flow matter?",
        "Here the flow hardly turns filaments: α_u is 0.025. Run the cell to t = 200 and look at the peak "
        "speed. Then set α_u to 0.8, and go back to the beginning.",
        "One direction takes over the whole cell, and at last nothing streams, since no fluid passes the "
        "ends. With α_u = 0.8 the same beginning leads to two streams by t = 30.",
        _cell({"seed": 0}, alpha_u=0.025),
    ),
    Question(
        "What does cytochalasin do?",
        "Run two streams to t = 20. Give cytochalasin and watch the peak speed for 40 time units. Then "
        "choose Fragment with the widest brush, go over the whole cell, and wait. At last wash the drug "
        "out.",
        "The streams go on, a tenth slower at most: the flow keeps the filaments in line. Once they are "
        "fragmented they do not come back, until the drug is washed out.",
        _cell(STRIPES),
    ),
    Question(
        "Does a wound heal?",
        "Choose Wound, draw a disc on one stream, and measure how long it takes to close. Try larger "
        "wounds. Undo takes you back to just before.",
        "A wound of radius 0.8 is closed within 5 time units: filaments at its edge turn those inside.",
        _cell(STRIPES),
    ),
    Question(
        "Are the streams equally wide?",
        "At t = 1 the upward stream is made wider. Note the widths (the question mark beside the clock "
        "shows them) at t = 2, 20 and 60. Repeat it with α_u = 0.1.",
        "They become equal: with α_u = 0.5 by t = 60, with 0.1 much more slowly. What flows up must come "
        "down, and this moves the boundaries.",
        _cell(STRIPES),
        (align(1.0, UP, 0.9, pi, 3.9),),
    ),
    Question(
        "What keeps filaments along the cell?",
        "Two streams run, and at t = 5 κ becomes 0. Run the cell to t = 60, in the colours of direction "
        "(under Appearance). Then wash out.",
        "Filaments turn to run around the cell, where no ends stop the flow. Within 50 time units after "
        "washing out they run along it again.",
        _cell(STRIPES),
        (change(5.0, kappa=0.0),),
    ),
    Question(
        "Can a pattern move without changing?",
        "Here κ is 0.3. Run the cell to t = 150, and watch one white line for 100 time units more. Look "
        "for the κ from which on it stands still.",
        "The streams lean and turn about the axis, once in some 900 time units. From κ = 0.4707 on, they "
        "are upright and stand still.",
        _cell(STRIPES, kappa=0.3),
    ),
    Question(
        "How wide is an indifferent zone?",
        "Two streams run. Look at the profile, and compare d_s = 0.005 with d_s = 0.1, 20 time units after "
        "each change.",
        "The larger d_s is, the more slowly P_z changes from up to down: order spreads from place to "
        "place, and the zones between the streams widen.",
        _cell(STRIPES),
    ),
)


@cache
def described() -> list[dict[str, Any]]:
    """Return the questions as they are sent to the page, each with the link of its cell."""
    return [
        {
            "question": item.question,
            "attempt": item.attempt,
            "answer": item.answer,
            "link": item.setup().link(),
        }
        for item in WORKSHEET
    ]
