"""Compiled programs are kept from one process to the next, safely and within bounds."""

import os
import subprocess
import sys
import time
import zlib

import pytest

from cyclosis.model import programs

COMPUTE = """
import sys, jax
said = []
jax.monitoring.register_event_listener(lambda name, **_: said.append(name.rpartition("/")[2]))
import cyclosis as cy
params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
state = cy.initial.stripes(grid)
found = {found}
print(said.count("cache_hits"), said.count("cache_misses"), found.tobytes().hex())
"""
FLOW = COMPUTE.format(found="cy.flow(params, grid, state)")
COMPUTE = COMPUTE.format(found="cy.simulate(params, grid, state, t_end=1.0).final_state")


def own(environment, **more):
    """Return an environment without the choices of whoever runs these tests."""
    chosen = ("JAX_COMPILATION", "JAX_PERSISTENT", "JAX_ENABLE_COMP", programs.VARIABLE)
    return {name: value for name, value in environment.items() if not name.startswith(chosen)} | more


def computed(script=COMPUTE, **more):
    """Return how many programs a new process has loaded and compiled anew, and the state that it found."""
    command = [sys.executable, "-W", "error", "-c", script]
    done = subprocess.run(command, env=own(os.environ, **more), capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    loaded, compiled, state = done.stdout.split()
    return int(loaded), int(compiled), state


def test_a_second_process_loads_what_the_first_has_compiled(tmp_path):
    loaded, compiled, flow = computed(FLOW, CYCLOSIS_PROGRAMS=str(tmp_path))
    assert loaded == 0
    assert compiled >= 1
    assert computed(FLOW, CYCLOSIS_PROGRAMS=str(tmp_path)) == (compiled, 0, flow), "the same bits"
    assert computed(FLOW, CYCLOSIS_PROGRAMS="off") == (0, 0, flow), "nothing is kept"
    assert [path.name.startswith("jax-") for path in tmp_path.iterdir()] == [True]


@pytest.mark.slow
def test_a_run_of_a_second_process_is_loaded_too(tmp_path):
    loaded, compiled, state = computed(CYCLOSIS_PROGRAMS=str(tmp_path))
    assert loaded == 0
    assert compiled >= 3
    assert computed(CYCLOSIS_PROGRAMS=str(tmp_path)) == (compiled, 0, state), "the same bits"


@pytest.mark.slow
def test_programs_left_half_written_are_compiled_again(tmp_path):
    _, compiled, state = computed(CYCLOSIS_PROGRAMS=str(tmp_path))
    (folder,) = tmp_path.iterdir()
    for path in folder.glob("*-cache"):
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert computed(CYCLOSIS_PROGRAMS=str(tmp_path)) == (0, compiled, state)
    assert computed(CYCLOSIS_PROGRAMS=str(tmp_path)) == (compiled, 0, state)


@pytest.mark.slow
def test_several_processes_share_one_folder(tmp_path):
    environment = own(os.environ, CYCLOSIS_PROGRAMS=str(tmp_path))
    command = [sys.executable, "-W", "error", "-c", COMPUTE]
    started = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    said = [process.communicate(timeout=300) for process in started]
    assert [process.returncode for process in started] == [0, 0, 0], said
    assert len({out.split()[2] for out, _ in said}) == 1


@pytest.mark.slow
def test_what_the_user_chose_for_jax_stays(tmp_path):
    mine = {"JAX_COMPILATION_CACHE_DIR": str(tmp_path / "mine"), "CYCLOSIS_PROGRAMS": str(tmp_path / "ours")}
    script = COMPUTE + "assert jax.config.jax_persistent_cache_min_compile_time_secs == 1.0\n"
    computed(script, **mine)
    assert (tmp_path / "mine").is_dir()
    assert not (tmp_path / "ours").exists()
    computed(CYCLOSIS_PROGRAMS=str(tmp_path / "ours"), JAX_ENABLE_COMPILATION_CACHE="false")
    assert not (tmp_path / "ours").exists()


def test_the_folder_is_private_where_home_cannot_be_written(tmp_path, monkeypatch):
    monkeypatch.delenv(programs.VARIABLE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert programs.programs_folder().is_relative_to(tmp_path / "cache" / "cyclosis" / "programs")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(programs.tempfile, "gettempdir", lambda: str(tmp_path))
    folder = programs.programs_folder()
    assert folder.is_relative_to(tmp_path / f"cyclosis-{os.getuid()}")
    assert folder.parent.stat().st_mode & 0o077 == 0
    folder.parent.chmod(0o777)
    assert programs.programs_folder().parent.name != f"cyclosis-{os.getuid()}", "others could write there"


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "jax-1-abc"
    folder.mkdir()
    return folder


def stored(folder, name, age, size=1000):
    path = folder / name
    path.write_bytes(zlib.compress(os.urandom(size)))
    os.utime(path, (time.time() - age, time.time() - age))
    return path


def test_the_programs_unused_for_longest_go_first(folder):
    paths = [stored(folder, f"p{age}-cache", age) for age in (10, 20, 30, 40)]
    programs.check(folder, most=2500)
    assert [path.exists() for path in paths] == [True, True, False, False]


def test_only_new_programs_are_unpacked(folder):
    old, new = stored(folder, "old-cache", 100), stored(folder, "new-cache", 50)
    programs.check(folder)
    for path in (old, new):
        facts = path.stat()
        path.write_bytes(path.read_bytes()[:500])
        os.utime(path, (facts.st_atime, facts.st_mtime))
    new.write_bytes(new.read_bytes())
    programs.check(folder)
    assert old.exists(), "it was checked before"
    assert not new.exists()


def test_folders_of_other_versions_go_once_unused(folder):
    others = [folder.parent / name for name in ("jax-0-abc", "jax-2-abc", "mine")]
    for other in others:
        other.mkdir()
    programs.check(others[0])
    programs.check(others[1])
    past = time.time() - 1.1 * programs.OUTDATED
    os.utime(others[0] / programs.CHECKED, (past, past))
    programs.check(folder)
    assert [other.exists() for other in others] == [False, True, True]


def test_a_folder_that_is_gone_is_no_error(tmp_path):
    programs.check(tmp_path / "gone")
