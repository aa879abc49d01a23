"""How command lines are read: help, flags, lists, names that are nearly right, files of the wrong kind."""

import os
import re
import shlex

import pytest

import cyclosis as cy
from measure.commandline import COMMANDS, every, said

SENTENCE = re.compile(r"^cyclosis: .+\.\n$")
SMALL = ("--n-theta", "16", "--n-z", "16", "--t-end", "2")
EXPORT = os.path.join(os.path.dirname(__file__), "..", "docs", "data", "figure5.nc")


def refused(*arguments):
    """Run a command that must be refused; return the sentence."""
    code, out, err = said(*arguments)
    assert code == 2, (arguments, out, err)
    assert SENTENCE.match(err), err
    return err


class Reached(Exception):
    pass


@pytest.fixture
def simulated(monkeypatch):
    """What `run` would have computed: arguments of `simulate`, by command line."""
    found = {}

    def stop(params, grid, state, **rest):
        found.update(rest, params=params, grid=grid, state=state)
        raise Reached

    monkeypatch.setenv("CYCLOSIS_TRACEBACK", "1")
    monkeypatch.setattr("cyclosis.dynamics.simulate.simulate", stop)

    def given(*arguments):
        with pytest.raises(Reached):
            said("run", *arguments)
        return found

    return given


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    grid = cy.CylinderGrid(16, 16, 5.0)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 2.0)
    return cy.write(run, tmp_path_factory.mktemp("stored") / "run.nc")


@pytest.fixture
def store(tmp_path):
    tables = {"axes": {"alpha_p": {"values": [0.01]}}, "grid": {"n_theta": 16, "n_z": 16}}
    from cyclosis.sweep.store.store import Store

    return Store.create(tmp_path / "store", cy.Sweep.from_tables(tables)).path


@pytest.mark.parametrize(("words", "command"), [*every()], ids=lambda value: str(value)[:30])
def test_help_is_readable(words, command, monkeypatch):
    """In 80 columns, with names of values in capitals and no types of Python, however few were given."""
    monkeypatch.setenv("COLUMNS", "80")
    code, out, err = said(*words, "--help")
    assert (code, err) == (0, "")
    assert not re.search(r"<|list\[|\bNone\b|\{", out), out
    assert max(map(len, out.splitlines())) <= 80
    for param in command.params:
        if param.param_type_name == "argument" or not param.is_flag:
            assert param.metavar, f"{words}: {param.name} has no metavar"


@pytest.mark.parametrize("words", COMMANDS)
def test_examples_in_help_parse(words):
    lines = re.findall(r"^    cyclosis (.*)$", said(*words.split(), "--help")[1], re.MULTILINE)
    if words != "doctor":
        assert lines, "every command with arguments shows an example"
    for line in lines:
        named = next(name for name in sorted(COMMANDS, key=len, reverse=True) if line.startswith(name))
        assert named == words
        arguments = COMMANDS[named]._apart(shlex.split(line)[len(named.split()) :])
        parser = COMMANDS[named].make_parser(COMMANDS[named].context_class(COMMANDS[named]))
        _, rest, _ = parser.parse_args(args=arguments)
        assert not rest


def test_the_options_of_a_run_stand_in_groups():
    out = said("run", "--help")[1]
    heads = re.findall(r"^(\w.*):$", out, re.MULTILINE)
    groups = ["Cell, [parameters]", "Grid, [grid]", "Initial state, [initial]", "Run, [run]"]
    assert heads == ["Options", *groups, "Physical units, [scales]", "Output"]
    assert out.index("Cell, [") < out.index("--alpha-p") < out.index("Grid, [") < out.index("--n-z")


VALUED = [
    (words, option)
    for words, command in COMMANDS.items()
    for param in command.params
    if param.param_type_name == "option" and not param.is_flag
    for option in param.opts
]


@pytest.mark.parametrize(("words", "option"), VALUED)
def test_no_option_takes_another_for_its_value(words, option):
    message = refused(*words.split(), option, "--help")
    assert f"{option} = '--help'" in message
    assert f"{option}=VALUE" in message


def test_a_flag_leaves_what_follows_it_alone(simulated, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words, value in {
        "--zero-theta-flux": True,
        "--zero-theta-flux true": True,
        "--zero-theta-flux=False": False,
        "--no-zero-theta-flux": False,
        "--no-zero-theta-flux=false": True,
        "--seed 1": False,
    }.items():
        found = simulated(*words.split(), "--out", "chosen.nc")
        assert found["params"].zero_theta_flux is value, words
        assert found["checkpoint"].target.name == "chosen.nc"
    assert "true or false" in refused("run", "--zero-theta-flux=maybe")


@pytest.mark.parametrize("text", ["0,1,2.5", "[0, 1, 2.5]", "0 1 2.5", " [0,1, 2.5] "])
def test_lists_of_times(simulated, text, tmp_path):
    assert simulated("--save-at", text, "--out", tmp_path / "x.nc")["save_at"] == (0, 1, 2.5)


@pytest.mark.parametrize("text", ["32,24", "[32, 24]", "32x24", "32 x 24", "32 24"])
def test_shapes(simulated, text, tmp_path):
    found = simulated("--noise-grid", text, "--out", tmp_path / "x.nc")
    assert found["provenance"]["initial"]["noise_grid"] == (32, 24)


@pytest.mark.parametrize(
    ("option", "text", "words"),
    [
        ("--save-at", "0;1", "save_at = '0;1' cannot be used: it must be a list of numbers"),
        ("--save-at", "0,,1", "as 0,10,25"),
        ("--save-at", "2,1", "sort them"),
        ("--noise-grid", "wide", "noise_grid = 'wide' cannot be used: it must be two whole numbers"),
        ("--noise-grid", "16", "two whole numbers"),
    ],
)
def test_lists_that_are_none_are_shown_whole_with_their_form(option, text, words):
    assert words in refused("run", option, text)


def test_the_help_of_a_list_gives_a_form_that_is_taken():
    out = " ".join(said("run", "--help")[1].split())
    for form in ("as 0,10,25", "as 32,32", "as advection,shear"):
        assert form in out


def test_times_given_as_an_option_override_those_of_the_file(simulated, tmp_path):
    (tmp_path / "run.toml").write_text("[run]\nsave_every = 3.0\n")
    own = ("--config", tmp_path / "run.toml", "--out", tmp_path / "x.nc")
    assert simulated(*own, "--save-at", "1,2")["save_at"] == (1, 2)
    (tmp_path / "run.toml").write_text("[run]\nsave_at = [1.0, 2.0]\n")
    found = simulated(*own, "--save-every", "0.5")
    assert (found["save_every"], found["save_at"]) == (0.5, None)
    assert "save_every" in refused("run", "--save-at", "1,2", "--save-every", "1")


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        ("exprt x.nc", "export"),
        ("figure histroy x.nc", "history"),
        ("sweep stats x", "status"),
        ("stability spectrm", "spectrum"),
        ("run --alpha-pp 1", "--alpha-p"),
        ("sweep run x --worker 3", "--workers"),
        ("experiment recovry", "recovery"),
        ("experiment Recovery", "recovery"),
        ("run --stepper RK4x", "rk4"),
        ("run --terms bundlin,shear", "bundling"),
        ("run --kind strips", "stripes"),
        ("run --dealias cubik", "cubic"),
        ("stability dispersion --base unidirectionl", "unidirectional"),
        ("stability branch kapa --from 0 --to 1", "kappa"),
        ("stability branch kappa --from 0 --to 1 --measures drfit", "drift"),
        ("stability threshold --over alpha_q=0.1:1:3", "alpha_p"),
        ("stability map --x kapa=0:1:2 --y alpha_u=0:1:2", "kappa"),
        ("stability spectrum --components thet", "theta"),
        (f"figure phase-diagram {EXPORT} --kind regime", "regimes"),
        (f"figure phase-diagram {EXPORT} --log alpha_pp --out x.png", "alpha_p"),
        (f"figure phase-diagram {EXPORT} --select alpha-u=0.5 --out x.png", "alpha_u"),
    ],
)
def test_names_that_are_nearly_right(line, meant, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert refused(*line.split()).rstrip(".\n").endswith(f"did you mean {meant}")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("info", "missing argument 'FILE'; `cyclosis info --help`"),
        ("info a b", "(b); `cyclosis info --help`"),
        ("run --out", "'--out' requires an argument; `cyclosis run --help`"),
        ("run --force=3", "does not take a value"),
        ("run --checkpoint-seconds soon", "--checkpoint-seconds = 'soon' cannot be used"),
        ("explore --port=70000", "--port = '70000' cannot be used: it must be less than or equal to 65535"),
        ("stability spectrum --count=0", "--count = '0' cannot be used"),
    ],
)
def test_mistakes_in_words_get_one_sentence(line, words):
    assert words in refused(*line.split())


def test_nothing_at_all_shows_help():
    for words in ((), ("figure",), ("sweep",), ("stability",)):
        code, out, err = said(*words)
        assert (code, out) == (2, "")
        assert "Commands:" in err


def test_an_experiment_without_a_name_lists_them():
    code, out, err = said("experiment")
    assert code == 2
    assert out == said("experiment", "list")[1]
    assert "`cyclosis experiment NAME`" in err


@pytest.mark.parametrize(
    "line",
    [
        "run --out x.txt",
        "run --out x",
        "run --out -",
        "movie RUN --out x.png",
        "movie RUN --out x.avi",
        "figure history RUN --out x.gif",
        "figure emergence RUN --out x.nc",
        f"figure phase-diagram {EXPORT} --out x.csv",
        "export RUN --out x.mat",
        "export RUN --out x.h5",
        "sweep export STORE --out x.txt",
        "sweep export STORE --out x.h5",
        "stability profile --out x.txt",
        "stability profile --out x.h5",
    ],
)
def test_a_name_that_promises_another_format_is_refused(line, stored, store, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = set(tmp_path.iterdir())
    words = refused(*line.replace("RUN", str(stored)).replace("STORE", str(store)).split())
    assert "x" in words
    assert set(tmp_path.iterdir()) == before


def test_formats_that_are_netcdf_may_be_called_so(simulated, tmp_path):
    for name in ("a.nc", "a.NC", "a.nc4", "a.h5"):
        assert simulated("--out", tmp_path / name)["checkpoint"].target.name == name


def test_a_folder_for_paraview_may_have_a_point_in_its_name(stored, tmp_path):
    (tmp_path / "standing.csv").mkdir()
    for name in ("run.2", "standing.csv"):
        code, out, _ = said("export", stored, "--out", tmp_path / name)
        assert code == 0
        assert f"{name}.pvd" in out


@pytest.mark.parametrize("place", ["/dev/stdout", "/dev/null", "/dev/fd/1", "/proc/self/fd/1"])
def test_no_file_is_made_of_a_stream(place):
    assert "cannot be streamed" in refused("run", *SMALL, "--out", place)


def test_no_pipe_is_replaced_by_a_file(tmp_path):
    os.mkfifo(tmp_path / "pipe.nc")
    for force in ([], ["--force"]):
        assert "cannot be streamed" in refused("run", *SMALL, "--out", tmp_path / "pipe.nc", *force)
    assert (tmp_path / "pipe.nc").is_fifo()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("figure phase-diagram RUN", "it is a file of a run; try `cyclosis info RUN`"),
        ("sweep status RUN", "it is a file of a run"),
        ("sweep verify RUN", "it is a file of a run"),
        ("sweep repair RUN", "it is a file of a run"),
        ("sweep export RUN --out x.csv", "it is a file of a run"),
        ("figure history STORE", "it is the store of a sweep; try `cyclosis sweep status STORE`"),
        ("figure emergence STORE", "it is the store of a sweep"),
        ("info STORE", "it is the store of a sweep"),
        ("resume STORE", "it is the store of a sweep"),
        ("movie STORE", "it is the store of a sweep"),
        ("export STORE", "it is the store of a sweep"),
        (f"info {EXPORT}", "it is an export of a sweep"),
        (f"sweep status {EXPORT}", "it is an export of a sweep"),
        ("info TABLE", "it is a file of numbers of the theory"),
        ("figure phase-diagram TABLE", "it is a file of numbers of the theory"),
        ("figure phase-diagram .", "it is a folder"),
        ("info .", "it is a folder"),
        ("run --kind file --path absent.nc", "path = 'absent.nc'"),
        ("run --kind file --path absent.nc", "there is no such file"),
        ("run --kind file --path absent.npy", "there is no such file"),
    ],
)
def test_files_of_another_kind_are_called_by_their_kind(line, words, stored, store, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = cy.stability.cyclosis(cy.Parameters(), n_theta=64).to_dataset()
    from cyclosis.dataset import write_table

    places = {"RUN": stored, "STORE": store, "TABLE": write_table(table, "profile.nc")}
    for name, place in places.items():
        line, words = line.replace(name, str(place)), words.replace(name, str(place))
    assert words in refused(*line.split())


def test_a_finished_run_goes_on_only_to_a_time_that_is_given(stored):
    words = refused("resume", stored)
    assert "the run is complete at t = 2" in words
    assert "give --t-end" in words


def test_quiet_says_nothing_unless_something_is_amiss(tmp_path):
    own = ("run", *SMALL, "--quiet", "--out")
    assert said(*own, tmp_path / "a.nc") == (0, "", "")
    assert said("resume", tmp_path / "a.nc", "--t-end", "3", "--quiet") == (0, "", "")
    code, out, _ = said(*own, tmp_path / "b.nc", "--stepper", "rk4", "--dt", "5", "--t-end", "50")
    assert code == 1
    assert "Diverged" in out
    assert "b.nc" in out


def test_an_option_of_another_command_is_named_with_it():
    said = refused("stability", "threshold", "--model", "kinetic")
    assert "leave it out; it belongs to `cyclosis stability dispersion`" in said
    assert "`cyclosis run`" in refused("info", "x.nc", "--seed", "3")
