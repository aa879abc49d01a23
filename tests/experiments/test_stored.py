"""Stored members: exact, found again, and computed again once anything that determines them has changed."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import stored
from cyclosis.experiments.closed_cells import End
from cyclosis.experiments.lab import Lab
from cyclosis.experiments.statistics import in_words, proportion

CALLS = []
FRAMES = xarray.Dataset(
    {"P": (("frame", "component"), np.float32([[0.1, 0.2]]))},
    {"component": ["theta", "z"], "frame_time": ("frame", [0.3])},
    {"length": 5.0, "words": "frames"},
)


def given(value, *_):
    CALLS.append(value)
    return VALUES[value]


VALUES = {
    "array": np.linspace(0.0, 1.0, 7) / 3,
    "complex": np.array([1 + 2j]),
    "number": 0.1 + 0.2,
    "whole": 2**60,
    "single": np.float32(0.1),
    "nothing": None,
    "words": ["a", "b"],
    "tuple": (1.5, np.arange(3), (True, "x")),
    "named": End(1.0, 0.1, 0.2, 0.3, np.nan),
    "table": {"P": np.ones((2, 2)), "n": 3},
    "frames": FRAMES,
}


def equal(a, b):
    if isinstance(a, xarray.Dataset):
        return a.identical(b) and all(a[n].dtype == b[n].dtype for n in a.variables)
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(equal(a[key], b[key]) for key in a)
    if isinstance(a, tuple | list):
        return type(a) is type(b) and len(a) == len(b) and all(map(equal, a, b))
    if isinstance(a, np.ndarray | np.generic):
        return type(a) is type(b) and a.dtype == b.dtype and np.array_equal(a, b)
    return type(a) is type(b) and (a == b or (a != a and b != b))


@pytest.mark.parametrize("name", VALUES)
def test_a_stored_value_is_the_same_and_is_not_computed_again(name, tmp_path):
    CALLS.clear()
    first = stored.member(str(tmp_path), given, name)
    again = stored.member(str(tmp_path), given, name)
    assert equal(first, VALUES[name])
    assert equal(again, VALUES[name])
    assert [name] == CALLS


def test_a_damaged_file_counts_as_missing(tmp_path):
    stored.member(str(tmp_path), given, "array")
    (file,) = tmp_path.iterdir()
    data = bytearray(file.read_bytes())
    for broken in (data[:-1], data[:200] + bytes([data[200] ^ 1]) + data[201:], b""):
        file.write_bytes(broken)
        CALLS.clear()
        assert equal(stored.member(str(tmp_path), given, "array"), VALUES["array"])
        assert CALLS == ["array"]
        assert file.read_bytes() == data


def test_everything_that_determines_a_member_is_in_its_name(monkeypatch):
    field = np.ones((4, 4))
    items = [
        ("a", 1),
        ("a", 1.0),
        ("a", True),
        ("a", (1,)),
        ("a", np.nextafter(1.0, 2.0)),
        ("a", field),
        ("a", field + 1e-16 * np.eye(4) * 3),
        ("a", cy.Parameters()),
        ("a", cy.Parameters(alpha_p=0.1)),
        ("a", cy.Parameters(alpha_p=field)),
    ]
    names = [stored.digest(given, item) for item in items] + [stored.digest(equal, items[0])]
    assert len(set(names)) == len(names)
    assert names == [stored.digest(given, item) for item in items] + [stored.digest(equal, items[0])]
    monkeypatch.setattr(stored, "definition", lambda: "another")
    assert stored.digest(given, items[0]) not in names
    with pytest.raises(stored.Unstorable):
        stored.digest(given, (object(),))


def test_what_cannot_be_stored_is_computed_each_time(tmp_path):
    CALLS.clear()
    VALUES["object"] = thing = object()
    assert stored.member(str(tmp_path), given, "object") is thing
    assert stored.member(str(tmp_path), given, "array", thing) is VALUES["array"]
    assert CALLS == ["object", "array"]
    assert list(tmp_path.iterdir()) == []
    del VALUES["object"]


@pytest.mark.slow
def test_an_experiment_goes_on_with_the_members_that_are_stored(tmp_path):
    items = [(0, 10), (3, 10), (10, 10)]
    told = []
    with Lab(
        tmp_path, 1, workers=1, told=lambda label, now: told.append((label, now.done, now.total))
    ) as lab:
        found = lab.each("shares", proportion, items)
        assert found == [proportion(*item) for item in items]
        assert told == [("shares", done, 3) for done in (1, 2, 3)]
        # A member that is stored is read, which shows if it is another.
        file = tmp_path / "shares" / f"{stored.digest(proportion, items[1])}.member"
        file.write_bytes(stored._sealed((0.5, 0.4, 0.6)))
        assert lab.each("shares", proportion, items)[1] == (0.5, 0.4, 0.6)
        assert in_words((0.5, 0.4, 0.6))


def test_a_story_is_stored_and_is_the_same_run(tmp_path, monkeypatch):
    lab, grid = Lab(tmp_path, 1), cy.CylinderGrid(16, 16)
    steps = cy.Protocol(cy.change(at=0.5, alpha_p=0.5))
    ask = (cy.Parameters(), grid, cy.initial.stripes(grid), 1.0, (0.5, 1.0), steps)
    run = lab.story(*ask, rtol=1e-3)
    monkeypatch.setattr("cyclosis.experiments.lab.simulate", None)
    again = lab.story(*ask, rtol=1e-3)
    assert np.array_equal(again.frames[-1], run.frames[-1])
    assert again.times.tolist() == run.times.tolist()
    assert again.params == run.params
    with pytest.raises(TypeError):
        lab.story(*ask, rtol=1e-4)
