"""Terminals with few letters, in strange places, full or closed: what can be written is written."""

import os
import subprocess

import pytest

import cyclosis as cy
from cyclosis.cli import terminal
from measure.commandline import call, every
from measure.files import COMMAND

SMALL = "--n-theta 16 --n-z 16 --t-end 1"
LINES = (
    "doctor",
    "info RUN",
    "run --n-theta 16 --n-z 16 --kind stripes --t-end 0.5 --out α-new.nc",
    "run --n-theta 16 --n-z 16 --t-end 0.5 --protocol P.toml --out p.nc",
    "info p.nc",
    "figure history RUN --out β.png",
    "movie RUN --frames 2 --seconds 0.5 --out γ.gif",
    "export RUN --out δ",
    "experiment list",
    "experiment timescales --quick --out ε",
    "stability dispersion",
    "stability profile --points 64",
    "stability spectrum --points 64 --count 3",
    "stability threshold --over mu=0.04:0.06:2",
    "stability branch kappa --from 0.49 --to 0.51 --points 64 --longest 1",
    "sweep status STORE",
    "sweep verify STORE",
    "info ζ.nc",
    "run --stepper η",
    "θ",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    grid = cy.CylinderGrid(16, 16, 5.0)
    cy.write(cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0), folder / "RUN")
    tables = {"axes": {"alpha_p": {"values": [0.01]}}, "grid": {"n_theta": 16, "n_z": 16}}
    from cyclosis.sweep.store.store import Store

    Store.create(folder / "STORE", cy.Sweep.from_tables(tables))
    step = '[[protocol]]\nat = 0.1\naction = "fragment"\nwhere = { shape = "strips", count = 3 }\n'
    (folder / "P.toml").write_text(step)
    return folder


@pytest.mark.parametrize(
    ("line", "encoding"),
    [*((line, "ascii") for line in LINES), *((line, "cp1252") for line in LINES[1:4]), (LINES[12], "cp1252")],
)
def test_every_command_on_a_terminal_with_few_letters(line, encoding, folder, monkeypatch):
    monkeypatch.chdir(folder)
    for name in ("α-new.nc", "p.nc") if line.startswith("run") else ():
        (folder / name).unlink(missing_ok=True)
    force = " --force" if line.startswith(("figure", "movie", "export", "experiment timescales")) else ""
    code, out, err = call(*(line + force).split(), encoding=encoding)
    assert b"unexpected" not in err, err
    assert (code == 2) == (b"cannot be used" in err), (code, err)
    (out + err).decode(encoding)
    assert "α" not in line or b"alpha-new.nc" in out


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
@pytest.mark.parametrize(("words", "command"), [*every()], ids=lambda value: str(value)[:30])
def test_help_on_a_terminal_with_few_letters(words, command, encoding):
    code, out, err = call(*words, "--help", encoding=encoding)
    assert (code, err) == (0, b"")
    assert "Usage" in out.decode(encoding)


def test_help_with_greek_letters_is_spelt(monkeypatch):
    from measure.commandline import COMMANDS

    monkeypatch.setattr(COMMANDS["info"], "help", "Print α² ≤ π.")
    monkeypatch.setattr("cyclosis.cli.app", lambda **_: print(COMMANDS["info"].get_help(context())))

    def context():
        return COMMANDS["info"].make_context("info", [], resilient_parsing=True)

    assert b"Print alpha2 <= pi." in call("info", "--help", encoding="ascii")[1]


@pytest.mark.parametrize(
    ("text", "spelt"),
    [
        ("α Π₀ σ ς Φ", b"alpha Pi0 sigma sigma Phi"),
        ("|u|² ½ d⁽ˢ⁾", b"|u|2 1/2 d(s)"),
        ("├─ │ └─ ━", b"|- | `- -"),
        ("90.0° ± 1 ≤ ∞", b"90.0 deg +- 1 <= inf"),
        ("é ä ß", b"e a ss"),
        ("日", b"\\u65e5"),
        ("n\udce4me", b"n\xe4me"),
        ("🙂", b"\\U0001f642"),
    ],
)
def test_how_letters_are_spelt(text, spelt):
    terminal.settle()
    assert text.encode("ascii", terminal.PLAIN) == spelt


def started(*arguments, cwd, environment=None, **rest):
    """Start a command in a process of its own; return it with its output as bytes."""
    env = {**os.environ, **(environment or {})}
    return subprocess.run([*COMMAND, *map(str, arguments)], cwd=cwd, env=env, timeout=300, **rest)


PLAIN = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("environment", "line", "words"),
    [
        (PLAIN, "info RUN", b"|- grid"),
        (PLAIN, "experiment list", b"(alpha_p = 0)"),
        ({"PYTHONIOENCODING": "cp1252"}, "info RUN", b"|- grid"),
    ],
)
def test_locales_without_letters(line, words, environment, folder):
    out = started(*line.split(), cwd=folder, environment=environment, capture_output=True)
    assert out.returncode == 0, out.stderr
    assert words in out.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no full device")
def test_output_onto_a_full_disk(folder):
    with open("/dev/full", "wb") as full:
        out = started("info", "RUN", cwd=folder, stdout=full, stderr=subprocess.PIPE)
    assert out.returncode == 1
    assert out.stderr.startswith(b"cyclosis: the output cannot be written (No space left on device)")
    assert out.stderr.count(b"\n") == 1


def test_output_that_nobody_reads(folder):
    ends = os.pipe()
    os.close(ends[0])
    out = started("info", "RUN", cwd=folder, stdout=ends[1], stderr=subprocess.PIPE)
    os.close(ends[1])
    assert (out.returncode, out.stderr) == (1, b"")


@pytest.mark.skipif(os.name != "posix", reason="a shell closes the streams")
@pytest.mark.slow
def test_output_and_errors_that_are_closed(folder):
    line = f"{' '.join(COMMAND)} info absent 2>&-"
    assert subprocess.run(line, shell=True, cwd=folder, stdout=subprocess.DEVNULL).returncode == 2
    line = f"{' '.join(COMMAND)} run {SMALL} --force --out closed.nc >&- 2>&-"
    assert subprocess.run(line, shell=True, cwd=folder).returncode == 0
    assert (folder / "closed.nc").exists()
