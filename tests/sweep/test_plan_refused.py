"""Configurations of sweeps that are refused, each in one sentence that says what would do."""

import json
import random
import re

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.sweep.plan.sweep import Sweep
from sweep import fakes

SENTENCE = re.compile(r"^.+ = .+ cannot be used: it must be .+; .+\.$", re.DOTALL)


def axis(**values):
    return {"axes": {"alpha_p": values}}


REFUSED = {
    "axes missing": ({"axes": None}, "axes"),
    "axes empty": ({"axes": {}}, "axes"),
    "axes a number": ({"axes": 3}, "axes"),
    "axis a number": ({"axes": {"alpha_p": 3}}, "axis alpha_p"),
    "axis a list": ({"axes": {"alpha_p": [1, 2]}}, "axis alpha_p"),
    "axis unknown": ({"axes": {"alpha_q": {"values": [1]}}}, "alpha_p"),
    "axis a flag": ({"axes": {"zero_theta_flux": {"values": [0]}}}, "axes key"),
    "axis a whole number": ({"axes": {"n_theta": {"values": [16]}}}, "axes key"),
    "axis seed": ({"axes": {"seed": {"values": [1]}}}, "axes key"),
    "axis key unknown": (axis(begin=1), "axis alpha_p key"),
    "axis without values": (axis(values=[]), "values"),
    "axis described twice": (axis(values=[1], start=0), "start of axis alpha_p"),
    "axis half described": (axis(start=0.1, stop=1), "count of axis alpha_p"),
    "axis empty table": (axis(), "start of axis alpha_p"),
    "axis of nothing": (axis(start=0.1, stop=1, count=0), "count"),
    "axis of one": (axis(start=0.1, stop=1, count=1), "count"),
    "axis of half": (axis(start=0.1, stop=1, count=2.5), "count"),
    "axis too long": (axis(start=0.1, stop=1, count=10**6), "count"),
    "axis backwards": (axis(start=1, stop=0.1, count=3), "stop of axis"),
    "axis on a point": (axis(start=1, stop=1, count=3), "stop of axis"),
    "axis denser than numbers": (axis(start=1, stop=1 + 1e-12, count=50), "count of axis"),
    "axis log from zero": (axis(start=0, stop=1, count=3, spacing="log"), "start of axis"),
    "axis spacing": (axis(start=0.1, stop=1, count=3, spacing="cubic"), "spacing"),
    "axis not a number": (axis(values=[float("nan")]), "values"),
    "axis infinite": (axis(start=0.1, stop=float("inf"), count=3), "stop"),
    "axis of texts": (axis(values=["a"]), "values"),
    "axis with repeats": (axis(values=[0.1, 0.1]), "values"),
    "axis unsorted": (axis(values=[0.2, 0.1]), "values"),
    "axis out of range": (axis(values=[0.1, 2000]), "alpha_p"),
    "axis from out of range": (axis(start=-1, stop=1, count=3), "alpha_p"),
    "axis length out of range": ({"axes": {"length": {"values": [0]}}}, "length"),
    "axis magnitude out of range": ({"axes": {"magnitude": {"values": [1.5]}}}, "magnitude"),
    "axis that the state does not use": ({"axes": {"magnitude": {"values": [0.5]}}}, "magnitude"),
    "axis and parameter": ({"parameters": {"alpha_p": 1.0}}, "alpha_p"),
    "axis and length": ({"axes": {"length": {"values": [2]}}, "grid": {"length": 5.0}}, "length"),
    "axis and noise": (
        {
            "axes": {"filaments_per_square": {"values": [900]}},
            "initial": {"filaments_per_square": 1000},
        },
        "filaments_per_square",
    ),
    "too many": (
        {
            "axes": {
                name: {"start": 0.1, "stop": 1, "count": 2000} for name in ("alpha_p", "alpha_u", "kappa")
            },
        },
        "number of members",
    ),
    "too many seeds": ({"ensemble": {"seeds": 10**9}}, "number of members"),
    "no seeds": ({"ensemble": {"seeds": 0}}, "seeds"),
    "half a seed": ({"ensemble": {"seeds": 1.5}}, "seeds"),
    "true seeds": ({"ensemble": {"seeds": True}}, "seeds"),
    "negative seed": ({"ensemble": {"first_seed": -1}}, "first_seed"),
    "no block": ({"ensemble": {"block": 0}}, "block"),
    "seed of a run": ({"initial": {"seed": 3}}, "seed"),
    "seeds without noise": ({"initial": {"kind": "unidirectional"}}, "seeds"),
    "unknown table": ({"paramters": {}}, "did you mean parameters"),
    "unknown parameter": ({"parameters": {"kapa": 1}}, "did you mean kappa"),
    "unknown ensemble key": ({"ensemble": {"seed": 3}}, "did you mean seeds"),
    "run of a single run": ({"run": {"save_every": 1.0}}, "save_every"),
    "stepper": ({"run": {"stepper": "rk4"}}, "stepper"),
    "finish": ({"run": {"finish": "soon"}}, "finish"),
    "no time": ({"run": {"t_end": 0.0}}, "t_end"),
    "no lanes": ({"run": {"lanes": 0}}, "lanes"),
    "rtol in float32": ({"run": {"precision": "float32", "rtol": 1e-9}}, "rtol"),
    "term twice": ({"run": {"terms": ["bundling", "bundling"]}}, "terms"),
    "unknown term": ({"run": {"terms": ["nonsense"]}}, "terms"),
    "unknown quantity": ({"record": {"quantities": ["mean_Q"]}}, "quantities"),
    "quantity twice": ({"record": {"quantities": ["order", "order"]}}, "quantities"),
    "no quantities": ({"record": {"quantities": []}}, "quantities"),
    "fields a text": ({"record": {"fields": "yes"}}, "fields"),
    "fields too large": (
        {"record": {"fields": True}, "grid": {"n_theta": 4096, "n_z": 4096}, "ensemble": {"block": 64}},
        "block",
    ),
    "too loud": ({"initial": {"filaments_per_square": 2.0}}, "filaments_per_square"),
    "too loud for its order": (
        {"initial": {"kind": "unidirectional", "filaments_per_square": 100.0}},
        "filaments_per_square",
    ),
    "full order and noise": (
        {"initial": {"kind": "unidirectional", "filaments_per_square": 1e9, "magnitude": 1.0}},
        "filaments_per_square",
    ),
    "unresolved stripes": (
        {"initial": {"kind": "stripes", "stripes": 12, "filaments_per_square": 1e6}},
        "stripes",
    ),
    "odd stripes": ({"initial": {"kind": "stripes", "stripes": 3, "filaments_per_square": 1e6}}, "stripes"),
    "no path": ({"initial": {"kind": "file"}}, "path"),
    "no such file": ({"initial": {"kind": "file", "path": "/no/such.npy"}, "ensemble": {"seeds": 1}}, "path"),
    "checksum without a file": ({"initial": {"sha256": "0" * 64}}, "sha256"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_mistakes_are_refused_in_one_sentence(case):
    changes, named = REFUSED[case]
    given = fakes.tables(**{k: v for k, v in changes.items() if isinstance(v, dict) and k != "axes"})
    if "axes" in changes:
        given["axes"] = changes["axes"]
    with pytest.raises(cy.InputError) as refused:
        Sweep.from_tables(given)
    assert SENTENCE.match(str(refused.value))
    assert named in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("given", [None, 3, [], "text", {1: {}}, {"axes": {1: {}}}])
def test_what_is_no_configuration_is_refused(given):
    with pytest.raises(cy.InputError):
        Sweep.from_tables(given)


def test_an_axis_written_twice_is_refused(tmp_path):
    path = tmp_path / "twice.toml"
    path.write_text("[axes]\nkappa = { values = [1.0] }\nkappa = { values = [2.0] }\n")
    with pytest.raises(cy.InputError, match="valid TOML"):
        Sweep.from_toml(path)


def test_noise_is_refused_exactly_where_it_would_fail():
    """The bound on |P| > 1 is met: what is accepted can be made, and far beyond it states do fail."""
    with pytest.raises(cy.InputError) as refused:
        fakes.sweep(initial={"filaments_per_square": 3.0}, ensemble={"seeds": 300})
    enough = float(re.search(r"raise it to ([\d.]+)", str(refused.value)).group(1))
    planned = fakes.sweep(initial={"filaments_per_square": enough}, ensemble={"seeds": 300})
    largest = [np.hypot(*planned.build(number).state()).max() for number in range(300)]
    assert 0.7 < max(largest) <= 1.0
    largest = [np.hypot(*cy.initial.noise(fakes.GRID, 3.0, seed)).max() for seed in range(300)]
    assert max(largest) > 1.0


VALUES = [
    *("nan", "inf", "-inf", "-1", "1e300", "1e-300", "0", "0.5", "3", "99999999999999999999999", "true"),
    *('"text"', '""', '"\\u0000"', "[]", "[1, 2]", "[[1, 2], [3]]", '["order"]', '["nonsense"]', "{}"),
    *("{values = [1.0]}", "{start = 0, stop = 1, count = 3}", "{start = nan, stop = 1, count = 3}"),
    *("{start = 1, stop = 2, count = 99999999}", "{values = [nan]}", "{values = []}", "{values = 3}"),
    *('{start = 1e-300, stop = 1, count = 3, spacing = "log"}', "1979-05-27", "07:32:00", "[nan]"),
]
KEYS = {
    "parameters": ["alpha_p", "kappa", "mu", "alpha_q"],
    "grid": ["n_theta", "n_z", "length", "n"],
    "initial": ["kind", "seed", "filaments_per_square", "noise_grid", "magnitude", "path", "sha256"],
    "axes": ["alpha_p", "alpha_u", "length", "filaments_per_square", "magnitude", "n_z", "zero_theta_flux"],
    "ensemble": ["seeds", "first_seed", "block", "seed"],
    "run": ["t_end", "finish", "precision", "rtol", "atol", "dealias", "terms", "lanes", "save_every"],
    "record": ["quantities", "fields", "everything"],
}
BROKEN = [b"", b"\xff\xfe\x00", b"[axes", b"x = ", b"axes = 3", b"[[axes]]\n", b"a" * 10_000, b"\0" * 64]


def broken(rng):
    """Return a configuration file with one to four mutations of a good one."""
    good = {"grid": {"n_theta": "8", "n_z": "8"}, "axes": {"kappa": "{values = [0.1, 0.2]}"}}
    written = {name: dict(good.get(name, {})) for name in KEYS}
    for _ in range(rng.randint(1, 4)):
        name = rng.choice(list(KEYS))
        written[name][rng.choice(KEYS[name])] = rng.choice(VALUES)
    if rng.random() < 0.1:
        written[rng.choice(["axis", "x y", "run2"])] = {"a": "1"}
    lines = [f'["{n}"]\n' + "".join(f"{k} = {v}\n" for k, v in t.items()) for n, t in written.items()]
    content = "".join(lines).encode()
    if rng.random() < 0.1:
        content = rng.choice(BROKEN)
    if rng.random() < 0.1:
        spot = rng.randrange(len(content) + 1)
        content = content[:spot] + rng.randbytes(3) + content[spot:]
    return content


def test_broken_configurations_never_give_anything_but_a_sentence(tmp_path):
    rng, refused, path = random.Random(20130827), 0, tmp_path / "sweep.toml"
    for _ in range(400):
        path.write_bytes(broken(rng))
        planned, message = attempt(path)
        if planned is None:
            assert SENTENCE.match(message), path.read_bytes()
            refused += 1
        else:
            assert Sweep.from_tables(json.loads(json.dumps(planned.tables))) == planned
            assert planned.build(0).state().shape[0] == 2
    assert refused > 200


def attempt(path):
    try:
        return Sweep.from_toml(path), ""
    except cy.InputError as error:
        return None, str(error)
