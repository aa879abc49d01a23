"""A thousand broken configurations: never a traceback, always field, value, rule and remedy."""

import random
import re
import sys

import pytest

from cyclosis import cli
from cyclosis.model.definitions import TABLES

SENTENCE = re.compile(r"^cyclosis: .+ = .+ cannot be used: it must be .+; .+\.\n$")
CASES = 1000
VALUES = [
    "nan",
    "inf",
    "-inf",
    "-1",
    "-1e300",
    "1e300",
    "1e-300",
    "0",
    "0.5",
    "3",
    "7",
    "17",
    "99999999999999999999999",
    "true",
    '"text"',
    '""',
    '"\\u0000"',
    '"ä∞"',
    "[]",
    "[1, 2]",
    "[[1, 2], [3]]",
    '["bundling"]',
    '["nonsense"]',
    "{}",
    "{a = 1}",
    "1979-05-27",
    "07:32:00",
    "[nan]",
    "[[1.0, nan], [2.0, 3.0]]",
    "[16, 16, 16]",
    "[9, 3]",
    '"adaptive"',
]
BROKEN = [
    b"",
    b"\xff\xfe\x00",
    b"[run",
    b"x = ",
    b"[run]\nt_end = 1\nt_end = 2",
    b"run = 3",
    b"[[run]]\nt_end = 1",
    b"a" * 100_000,
    b"[grid]\nn_theta = 64\n[grid]\n",
    b"[parameters]\nalpha_p = " + b"[" * 5000,
    b"\0" * 64,
    b"[nonsense]\nx = 1",
    b"[run]\nstepper = 'rk5'",
    b"[initial]\nkind = 'file'\npath = '/dev/null'",
]


class ReachedTheSolver(Exception):
    pass


def call(monkeypatch, capsys, *arguments):
    """Run the command line in this process; return its exit code and what it printed on stderr."""

    def stop(*_, **__):
        raise ReachedTheSolver

    monkeypatch.setattr("cyclosis.dynamics.simulate.simulate", stop)
    monkeypatch.setattr(sys, "argv", ["cyclosis", *arguments])
    monkeypatch.setenv("CYCLOSIS_TRACEBACK", "1")
    capsys.readouterr()
    try:
        with pytest.raises(SystemExit) as ended:
            cli.main()
    except ReachedTheSolver:
        return 0, ""
    return ended.value.code, capsys.readouterr().err


def judged(code, message, case):
    if code != 0:
        assert code == 2, case
        assert SENTENCE.match(message), (case, message)
    return code


def random_case(rng, path):
    """Write a configuration with one to three mutations; return the arguments that use it."""
    tables = {name: {} for name in TABLES}
    for _ in range(rng.randint(1, 3)):
        name = rng.choice(list(TABLES))
        key = rng.choice([item.name for item in TABLES[name]] + ["alpha_q", "n_thta", "t end", "kappa"])
        tables[name][key] = rng.choice(VALUES)
    if rng.random() < 0.1:
        tables[rng.choice(["paramters", "x y", "run2"])] = {"a": "1"}
    lines = []
    for name, table in tables.items():
        lines.append(f'["{name}"]')
        lines += [f'"{key}" = {value}' for key, value in table.items()]
    text = "\n".join(lines).encode()
    if rng.random() < 0.1:
        text = rng.choice(BROKEN)
    if rng.random() < 0.1:
        spot = rng.randrange(len(text) + 1)
        text = text[:spot] + rng.randbytes(3) + text[spot:]
    path.write_bytes(text)
    arguments = ["--config", str(path), "--out", str(path.with_suffix(".nc"))]
    if rng.random() < 0.3:
        item = rng.choice([item for items in TABLES.values() for item in items])
        arguments += [f"--{item.name.replace('_', '-')}={rng.choice(VALUES)}"]
    return arguments


@pytest.mark.slow
def test_a_thousand_configurations(monkeypatch, capsys, tmp_path):
    rng, refused = random.Random(20130827), 0
    for number in range(CASES):
        arguments = random_case(rng, tmp_path / "run.toml")
        code, message = call(monkeypatch, capsys, "run", *arguments)
        refused += judged(code, message, (number, arguments, (tmp_path / "run.toml").read_bytes()[:300])) != 0
    assert refused > CASES // 2, "the fuzz must mostly break things"


@pytest.mark.parametrize("content", BROKEN[1:], ids=range(len(BROKEN) - 1))
def test_files_that_are_no_configuration(monkeypatch, capsys, tmp_path, content):
    (tmp_path / "run.toml").write_bytes(content)
    code, message = call(monkeypatch, capsys, "run", "--config", str(tmp_path / "run.toml"))
    assert judged(code, message, content) == 2


@pytest.mark.parametrize(
    "item", [item for items in TABLES.values() for item in items], ids=lambda item: item.name
)
def test_every_option_refuses_nonsense(monkeypatch, capsys, item):
    code, message = call(monkeypatch, capsys, "run", f"--{item.name.replace('_', '-')}=\x01non sense,")
    assert judged(code, message, item.name) == 2 or item.kind == "text"


@pytest.mark.parametrize("command", [["info"], ["figure", "emergence"]])
@pytest.mark.parametrize("content", [None, b"", b"CDF\x01", b"\x89HDF\r\n\x1a\n" + b"\0" * 200])
def test_files_that_are_no_run(monkeypatch, capsys, tmp_path, command, content):
    path = tmp_path / "run.nc"
    if content is not None:
        path.write_bytes(content)
    code, message = call(monkeypatch, capsys, *command, str(path))
    assert judged(code, message, content) == 2


def test_contradictions_are_refused(monkeypatch, capsys, tmp_path):
    for arguments in (
        ["--dt", "0.1"],
        ["--stepper", "rk4", "--rtol", "1e-3"],
        ["--save-at", "1,2", "--save-every", "1"],
        ["--stripes", "4"],
        ["--kind", "stripes", "--seed", "3"],
        ["--kind", "file"],
        ["--out", str(tmp_path)],
        ["--out", str(tmp_path / "no" / "run.nc")],
        ["--config", str(tmp_path)],
    ):
        code, message = call(monkeypatch, capsys, "run", *arguments)
        assert judged(code, message, arguments) == 2
