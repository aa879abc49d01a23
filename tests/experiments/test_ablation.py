"""Ablation: what is taken out, what becomes of cells, and every verdict, on made-up data."""

import numpy as np
import pytest
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments import ablation as subject
from cyclosis.model.definitions import TERM_NAMES
from cyclosis.model.grid import CylinderGrid

NAMES = list(subject.FATES)


def made_up(together: str, alone: str, without: str, seeds: int = 60) -> xarray.Dataset:
    """Return a dataset in which all cells of a kind of condition that began disordered have one fate.

    Without shear or advection they are as with everything, without diffusion finer than the grid, and
    stripes that are there last wherever bundling alone is missing.
    """
    tried = list(subject.conditions())
    fate = np.empty((len(tried), 2, seeds), dtype=np.int8)
    for k, name in enumerate(tried):
        first = name.split()[0]
        fate[k] = NAMES.index({"everything": together, "only": alone, "without": without}[first])
        if name.startswith("without") and ("shear" in name or "advection" in name):
            fate[k] = NAMES.index(together)
        if name == "without diffusion":
            fate[k] = NAMES.index("finer than the grid")
        if name == "without bundling":
            fate[k, 1] = NAMES.index("two equal stripes")
    fate[1, 0, 0] = NAMES.index("two equal stripes")
    grid = CylinderGrid(12, 12, 5.0)
    P = np.zeros((len(subject.SHOWN), 2, 12, 12), dtype=np.float32)
    P[:, 1] = 0.9 * np.sin(grid.theta)[:, None]
    frame = ("frame", "component", "theta", "z")
    return xarray.Dataset(
        {"P": (frame, P), "u": (frame, 0.8 * P), "fate": (("tried", "start", "seed"), fate)},
        coords={
            "frame_time": ("frame", [200.0] * len(P)),
            "tried": tried,
            "start": ["disorder", "stripes"],
        },
        attrs={"length": 5.0, "end": 200.0},
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made_up("two equal stripes", "disorder", "around the axis"), "agrees"),
        (made_up("two equal stripes", "disorder", "two equal stripes"), "in part"),
        (made_up("two equal stripes", "two equal stripes", "disorder"), "does not"),
        (made_up("one direction", "disorder", "disorder"), "does not"),
    ],
)
def test_verdicts_follow_from_the_data_and_are_drawn(data: xarray.Dataset, outcome: str) -> None:
    assert subject.verdict(data).outcome == outcome
    assert len(subject.draw(data).axes) == len(subject.SHOWN) + 2


def test_the_sentence_says_what_can_be_spared_and_what_lasts() -> None:
    words = subject.verdict(made_up("two equal stripes", "disorder", "around the axis")).measured
    assert "shear and advection can be spared" in words
    assert "without diffusion order becomes finer than the grid" in words
    assert "already last without bundling, to t = 200" in words


def test_conditions_take_out_or_leave_what_they_say() -> None:
    found = subject.conditions()
    every = set(TERM_NAMES)
    assert found["everything"] == ({}, tuple(TERM_NAMES))
    assert found["without bundling"] == ({"alpha_p": 0.0}, tuple(TERM_NAMES))
    assert found["without shear"] == ({}, tuple(name for name in TERM_NAMES if name != "shear"))
    assert found["only bundling"][0] == {"alpha_u": 0.0, "kappa": 0.0, "epsilon": 0.0}
    off, terms = found["only shear"]
    assert off == {"alpha_p": 0.0, "alpha_u": 0.0, "kappa": 0.0}
    assert every - set(terms) == {"advection"}


def test_fates_of_made_up_cells() -> None:
    code = {name: REGIMES.index(name) for name in REGIMES}
    names = [
        "cyclosis",
        "cyclosis",
        "unidirectional",
        "circumferential",
        "undecided",
        "disordered",
        "cyclosis",
    ]
    regime = np.array([code[name] for name in names])
    status = np.array([0, 0, 0, 1, 1, 0, 2])
    width = np.array([0.5, 0.4, np.nan, np.nan, np.nan, np.nan, 0.5])
    found = [NAMES[k] for k in subject.fates(regime, status, width)]
    assert found == [
        "two equal stripes",
        "two unequal stripes",
        "one direction",
        "around the axis",
        "other order",
        "disorder",
        "finer than the grid",
    ]
