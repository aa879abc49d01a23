"""Files and folders that are missing, empty, torn, forbidden or full, given to every command in turn.

The answer is one sentence and exit code 2 (1 for a disk that fills), and what stood before stands.
"""

import re
import resource
import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

import cyclosis as cy
from measure.commandline import COMMANDS, mortal, said

SENTENCE = re.compile(r"^cyclosis: .+ cannot be used: it must be .+; .+\.\n$")
SMALL = "--n-theta 16 --n-z 16 --t-end 0.5"
READING = {
    "info": "info IN",
    "resume": "resume IN --t-end 9",
    "movie": "movie IN --out m.gif",
    "export": "export IN --out surface",
    "figure emergence": "figure emergence IN --out e.png",
    "figure history": "figure history IN --out h.png",
    "figure roses": "figure roses IN --out r.png",
    "figure snapshot": "figure snapshot IN --out s.png",
    "figure compare": "figure compare IN IN --out c.png",
    "vacuole": "vacuole IN --out inside",
    "fit": "fit IN --out fit.nc",
    "measure": "measure IN --y down --speed px/s",
    "compare": "compare IN IN --out c.png",
    "observe": "observe IN --out observed",
    "figure phase-diagram": "figure phase-diagram IN --out d.png",
    "sweep plan": "sweep plan IN",
    "sweep run": "sweep run IN --out store-new --workers 1",
    "sweep status": "sweep status IN",
    "sweep verify": "sweep verify IN",
    "sweep repair": "sweep repair IN --workers 1",
    "sweep export": "sweep export IN --out x.csv",
    "run": f"run {SMALL} --config IN --out new.nc",
    "run, protocol": f"run {SMALL} --protocol IN --out new.nc",
    "run, state": f"run {SMALL} --kind file --path IN --out new.nc",
}
"""Every command that reads a file."""
WRITING = {
    "run": f"run {SMALL} --out OUT.nc",
    "movie": "movie RUN --frames 2 --seconds 0.5 --out OUT.gif",
    "export": "export RUN --out OUT",
    "figure emergence": "figure emergence RUN --times 0,0.1,0.2,0.3,0.4,0.5 --map-times 0,0.2,0.5 "
    "--out OUT.png",
    "figure history": "figure history RUN --out OUT.pdf",
    "figure roses": "figure roses KINETIC --out OUT.png",
    "figure snapshot": "figure snapshot RUN --out OUT.svg",
    "figure compare": "figure compare RUN RUN --out OUT.eps",
    "vacuole": "vacuole RUN --out OUT",
    "fit": "fit RUN --method profile --quiet --out OUT.nc",
    "measure": "measure FIELD --y down --speed px/s --radius-px 40 --axis 0 --centre 0,40 --out OUT.nc",
    "compare": "compare RUN RUN --out OUT.png",
    "observe": "observe RUN --as piv --radius-px 30 --out OUT",
    "figure phase-diagram": "figure phase-diagram EXPORT --out OUT.png",
    "sweep run": "sweep run SWEEP --out OUT --workers 1",
    "sweep export": "sweep export STORE --out OUT.csv",
    "experiment": "experiment timescales --quick --out OUT",
    "stability dispersion": "stability dispersion --out OUT.csv",
    "stability profile": "stability profile --points 64 --out OUT.nc",
    "stability spectrum": "stability spectrum --points 64 --count 2 --out OUT.png",
    "stability threshold": "stability threshold --over mu=0.04:0.06:2 --out OUT.csv",
    "stability branch": "stability branch kappa --from 0.49 --to 0.51 --points 64 --longest 1 --out OUT.csv",
    "stability map": "stability map --x kappa=0.4:0.5:2 --y alpha_u=0.5:0.6:2 --quiet --out OUT.nc",
}
"""Every command that writes a file."""
NEITHER = {"doctor", "explore"}
MAKES_FOLDERS = ("export", "experiment", "vacuole", "observe")


@pytest.fixture(scope="module")
def stands(tmp_path_factory):
    """A folder with a run, a sweep, an empty store and an export."""
    folder = tmp_path_factory.mktemp("files")
    grid = cy.CylinderGrid(16, 16, 5.0)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 0.5, save_every=0.1)
    cy.write(run, folder / "RUN")
    ring = cy.CylinderGrid(16, 1)
    m = cy.kinetic.dressed(cy.initial.stripes(ring, magnitude=0.5), 8)
    angles = cy.simulate(cy.Parameters(d_r=0.1), ring, m, 0.5, save_every=0.1, model=cy.models.kinetic)
    cy.write(angles, folder / "KINETIC")
    sweep = (
        "grid = { n_theta = 16, n_z = 16 }\naxes = { alpha_p = { values = [0.01] } }\nrun = { t_end = 1.0 }\n"
    )
    (folder / "SWEEP").write_text(sweep)
    rows = [f"{x} {y} 1.0 0.5 0 0" for y in range(8, 80, 8) for x in range(0, 160, 8)]
    (folder / "FIELD").write_text("# x\ty\tu\tv\tflags\tmask\n" + "\n".join(rows) + "\n")
    from cyclosis.sweep.store.store import Store

    Store.create(folder / "STORE", cy.Sweep.from_toml(folder / "SWEEP"))
    shutil.copy(Path(__file__).parents[1] / "docs" / "data" / "figure5.nc", folder / "EXPORT.nc")
    return folder


@pytest.fixture
def place(tmp_path, monkeypatch):
    """An empty folder, the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def spelt(line, stands):
    names = {"RUN": "RUN", "SWEEP": "SWEEP", "STORE": "STORE", "EXPORT": "EXPORT.nc", "KINETIC": "KINETIC"}
    names["FIELD"] = "FIELD"
    return [str(stands / names[word]) if word in names else word for word in line.split()]


def tree(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_every_command_is_tried():
    tried = {name.partition(",")[0] for name in (*READING, *WRITING)} | NEITHER
    assert tried == set(COMMANDS)


def missing(path):
    return path


def a_folder(path):
    path.mkdir()
    return path


def empty(path):
    path.touch()
    return path


def torn(path):
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(range(256)) * 4)
    return path


def text(path):
    path.write_text("Dear diary, today the cell streamed.\n")
    return path


def forbidden(path):
    path.write_bytes(b"\x89HDF\r\n\x1a\n")
    path.chmod(0)
    return path


def in_a_forbidden_folder(path):
    path.mkdir()
    (path / "run.nc").touch()
    path.chmod(0)
    return path / "run.nc"


def in_a_file(path):
    path.touch()
    return path / "run.nc"


def a_loop(path):
    path.symlink_to(path)
    return path


def too_long(path):
    return path.with_name("long" * 100)


@pytest.mark.parametrize(
    "make",
    [missing, a_folder, empty, torn, text, forbidden, in_a_forbidden_folder, in_a_file, a_loop, too_long],
)
@pytest.mark.parametrize("name", READING)
def test_what_cannot_be_read_is_named_in_a_sentence(name, make, place):
    if make is empty and name == "run":
        return  # an empty configuration is one
    given = make(place / "given")
    before = tree(place)
    with mortal():
        code, out, err = said(*READING[name].replace("IN", str(given)).split())
    assert code == 2, (out, err)
    assert SENTENCE.match(err), err
    assert out == ""
    (place / "given").is_dir() and (place / "given").chmod(0o755)
    if make is not in_a_forbidden_folder:
        assert tree(place) == before


@pytest.mark.parametrize("where", ["missing/folder", "forbidden", "a-file"])
@pytest.mark.parametrize("name", WRITING)
def test_where_nothing_can_be_written_nothing_is_begun(name, where, stands, place):
    """Before anything is computed, for all that is not certain to be made."""
    (place / "forbidden").mkdir()
    (place / "forbidden").chmod(0o555)
    (place / "a-file").touch()
    if name in ("experiment", "sweep run") and where.startswith("missing"):
        return  # these make all the folders
    before = tree(place)
    with mortal():
        code, out, err = said(*spelt(WRITING[name].replace("OUT", f"{where}/out"), stands))
    assert code == 2, (out, err)
    assert SENTENCE.match(err), err
    assert tree(place) == before


@contextmanager
def full(size):
    """Let no file grow beyond a size, as a disk does that is full; programs that JAX keeps are left alone."""
    import jax

    least = "jax_persistent_cache_min_compile_time_secs"
    before = getattr(jax.config, least)
    jax.config.update(least, 1e9)  # half a program in the cache would stay there
    kept = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, kept[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, kept)
        jax.config.update(least, before)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in WRITING if name != "sweep run"])
def test_a_disk_that_fills(name, stands, place):
    """Errors of workers of a sweep are results of its blocks, and have tests of their own."""
    words = spelt(WRITING[name].replace("OUT", str(place / "out")), stands)
    with full(0):
        code, out, err = said(*words)
    assert code in (1, 2), (out, err)
    assert re.match(r"^cyclosis: .+ cannot be (used|written).+\.\n$", err), err
    left = [path for path in place.rglob("*") if path.is_file()]
    assert left == [] or name in MAKES_FOLDERS, left
