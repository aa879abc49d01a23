"""Protocols from the command line, and whatever may be wrong with them."""

import random
import re
import sys

import pytest
from PIL import Image

import cyclosis as cy
from cyclosis import cli
from cyclosis.model.interventions import ACTIONS, SHAPES

SENTENCE = re.compile(r"^cyclosis: .+ = .+ cannot be used: it must be .+; .+\.\n$")
RUN = """
[parameters]
d_s = 0.1
[grid]
n_theta = 24
n_z = 24
[initial]
seed = 3
[run]
t_end = 4.0
"""
PROTOCOL = """
[[protocol]]
at = 1.0
over = 1.0
action = "change"
alpha_p = 0.5

[[protocol]]
at = 2.0
action = "fragment"
where = { shape = "image", path = "MASK" }

[[protocol]]
at = 3
action = "depolymerise"
keep = 0.5
where = { shape = "strips", count = 3, invert = true }

[[protocol]]
at = 9.0
action = "wash_out"
"""


@pytest.fixture
def call(monkeypatch, capsys):
    """Run the command line in this process; return its exit code and what it printed."""

    def called(*arguments):
        monkeypatch.setattr(sys, "argv", ["cyclosis", *map(str, arguments)])
        monkeypatch.setenv("CYCLOSIS_TRACEBACK", "1")
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            cli.main()
        return ended.value.code, capsys.readouterr()

    return called


@pytest.fixture
def files(tmp_path):
    mask = Image.new("L", (16, 16))
    mask.paste(255, (2, 2, 9, 9))
    mask.save(tmp_path / "mask.png")
    (tmp_path / "run.toml").write_text(RUN)
    (tmp_path / "P.toml").write_text(PROTOCOL.replace("MASK", str(tmp_path / "mask.png")))
    (tmp_path / "both.toml").write_text(RUN + PROTOCOL.replace("MASK", str(tmp_path / "mask.png")))
    return tmp_path


def test_a_protocol_in_the_configuration_in_a_file_and_in_python(call, files):
    code, _ = call("run", "--config", files / "both.toml", "--out", files / "a.nc", "--quiet")
    assert code == 0
    code, out = call(
        "run",
        "--config",
        files / "run.toml",
        "--protocol",
        files / "P.toml",
        "--out",
        files / "b.nc",
    )
    assert code == 0
    assert "4 steps, 1 of them after t = 4 and not reached" in out.out
    grid = cy.CylinderGrid(24, 24, 5.0)
    protocol = cy.Protocol(
        cy.change(at=1.0, over=1.0, alpha_p=0.5),
        cy.fragment(at=2.0, where=cy.regions.image(str(files / "mask.png"))),
        cy.depolymerise(at=3.0, keep=0.5, where=~cy.regions.strips(3)),
        cy.wash_out(at=9.0),
        seed=3,
    )
    state = cy.initial.disordered(grid, seed=3)
    run = cy.simulate(cy.Parameters(d_s=0.1), grid, state, 4.0, protocol=protocol)
    for name in ("a.nc", "b.nc"):
        stored = cy.load(files / name)
        assert stored.protocol == protocol
        assert (stored.final_state == run.final_state).all()
    code, out = call("info", files / "a.nc")
    assert code == 0
    for line in (
        "protocol    4 steps, seed 3",
        "t = 1 to 2: alpha_p = 0.5",
        "t = 2: fragment to 1000 filaments per square, in image (16 x 16, light 19.1%)",
        "t = 3: depolymerise to 0.5 of P, in all but strips (count = 3",
        "t = 9: wash out",
    ):
        assert line in out.out


def test_the_protocol_of_the_option_replaces_that_of_the_configuration(call, files):
    (files / "one.toml").write_text('[[protocol]]\nat = 1.0\naction = "wash_out"\n')
    arguments = ("--config", files / "both.toml", "--protocol", files / "one.toml", "--out", files / "c.nc")
    assert call("run", *arguments, "--quiet")[0] == 0
    assert len(cy.load(files / "c.nc").protocol) == 1


def test_an_ordered_state_may_have_a_seed_for_its_protocol_alone(call, files):
    text = RUN.replace("seed = 3", 'kind = "stripes"\nseed = 3')
    (files / "stripes.toml").write_text(text)
    code, out = call("run", "--config", files / "stripes.toml", "--out", files / "d.nc", "--quiet")
    assert code == 2
    assert "seed = 3" in out.err
    (files / "stripes.toml").write_text(text + '[[protocol]]\nat = 1.0\naction = "noise"\nsize = 0.1\n')
    code, out = call("run", "--config", files / "stripes.toml", "--out", files / "d.nc", "--quiet")
    assert code == 0, out.err
    assert cy.load(files / "d.nc").protocol.seed == 3


BAD = {
    "action": ('at = 1.0\naction = "cut"', "one of change, fragment"),
    "off the cell": (
        'at = 1.0\naction = "noise"\nsize = 0.1\n'
        'where = { shape = "disc", theta = 1.0, z = 7.0, radius = 1.0 }',
        "on the cell",
    ),
    "negative time": ('at = -1.0\naction = "wash_out"', "from 0 to 1e"),
    "range": ('at = 1.0\naction = "change"\nalpha_p = -2', "alpha_p in step 1 of the protocol = -2"),
    "unknown parameter": ('at = 1.0\naction = "change"\nalpha_q = 0.1', "did you mean alpha_"),
    "overlap": (
        'at = 1.0\nover = 2.0\naction = "change"\nmu = 0.1\n'
        '[[protocol]]\nat = 2.0\naction = "change"\nmu = 0.2',
        "the end of the ramp of mu",
    ),
    "image": (
        'at = 1.0\naction = "fragment"\nwhere = { shape = "image", path = "no.png" }',
        "check the file",
    ),
}


@pytest.mark.parametrize(("step", "words"), BAD.values(), ids=BAD)
def test_mistakes_get_one_sentence(call, files, step, words):
    (files / "bad.toml").write_text("[[protocol]]\n" + step)
    code, out = call("run", "--config", files / "run.toml", "--protocol", files / "bad.toml")
    assert code == 2
    assert SENTENCE.match(out.err), out.err
    assert words in out.err


@pytest.mark.parametrize(
    "text",
    ["", "[run]\nt_end = 1.0", "protocol = 3", "[protocol]\nat = 1.0", "protocol = [1]", "[[protocol]]"],
)
def test_files_that_are_no_protocol(call, files, text):
    (files / "bad.toml").write_text(text)
    code, out = call("run", "--config", files / "run.toml", "--protocol", files / "bad.toml")
    assert code == 2
    assert SENTENCE.match(out.err), out.err
    code, out = call("run", "--config", files / "run.toml", "--protocol", files / "none.toml")
    assert code == 2
    assert SENTENCE.match(out.err), out.err


VALUES = [
    "nan",
    "-1",
    "0",
    "0.5",
    "3",
    "1e300",
    "true",
    '"x"',
    '""',
    '"z"',
    "[]",
    "[16, 16]",
    "{}",
    "1979-05-27",
]


def random_where(rng, depth=0):
    shape = rng.choice([*SHAPES, "square"])
    keys = [item.name for item in SHAPES.get(shape, ("", ()))[1]] + ["invert", "parts", "pixels", "raduis"]
    pairs = [f'shape = "{shape}"']
    for key in rng.sample(keys, rng.randint(0, len(keys))):
        inner = depth < 2 and key == "parts" and rng.random() < 0.7
        pairs.append(f"{key} = {'[' + random_where(rng, depth + 1) + ']' if inner else rng.choice(VALUES)}")
    return "{ " + ", ".join(pairs) + " }"


def random_step(rng):
    action = rng.choice([*ACTIONS, "cut"])
    known = [item.name for item in ACTIONS[action].keys] if action in ACTIONS else []
    lines = [f"at = {rng.choice(['1.0', '2', *VALUES])}", f'action = "{action}"']
    for key in rng.sample(known, min(len(known), rng.randint(0, 3))):
        lines.append(f"{key} = {rng.choice(VALUES)}")
    if rng.random() < 0.5:
        lines.append(f"where = {rng.choice([random_where(rng), *VALUES])}")
    rng.shuffle(lines)
    return "[[protocol]]\n" + "\n".join(lines[rng.random() < 0.1 :])


@pytest.mark.slow
def test_hundreds_of_broken_protocols(call, files, monkeypatch):
    """Never a traceback, always field, value, rule and remedy; what is accepted reaches the solver."""

    def stop(*_, **__):
        raise SystemExit(0)

    monkeypatch.setattr("cyclosis.dynamics.simulate.simulate", stop)
    rng, refused = random.Random(1302736110), 0
    for number in range(600):
        text = "\n".join(random_step(rng) for _ in range(rng.randint(1, 3)))
        (files / "bad.toml").write_text(text)
        code, out = call(
            "run",
            "--config",
            files / "run.toml",
            "--protocol",
            files / "bad.toml",
            "--out",
            files / f"{number}.nc",
        )
        assert code == 0 or SENTENCE.match(out.err), (text, out.err)
        refused += code != 0
    assert 400 < refused < 600
