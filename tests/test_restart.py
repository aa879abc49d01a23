"""A run that was stopped, saved, killed or starved goes on bitwise as if nothing had happened."""

import errno
import random
import shutil
import signal
from pathlib import Path

import h5py
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset import guarded, parts
from cyclosis.dataset.netcdf import digest
from measure.files import SETTINGS, call, differences, everything, killing, started, wait_for_parts

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters(alpha_p=0.9)
VARIED = cy.Parameters(alpha_p=np.full(GRID.shape, 0.9))
STATE = cy.initial.disordered(GRID, 100)
STEPPERS = {
    "adaptive": {"stepper": "adaptive"},
    "etdrk4": {"stepper": "etdrk4", "dt": 0.07},
    "rk4": {"stepper": "rk4", "dt": 0.03},
    "float32": {"precision": "float32"},
}


def begin(t_end, **settings):
    """Simulate; where the adaptive stepper is asked for by name, alpha_p is a field."""
    params = VARIED if settings.get("stepper") == "adaptive" else PARAMS
    return cy.simulate(params, GRID, STATE, t_end, 2.0, **settings)


def stream(path, t_end=12.0, checkpoint_seconds=1e9, **settings):
    writer = cy.RunWriter(path)
    settings = {
        "checkpoint": writer,
        "checkpoint_seconds": checkpoint_seconds,
        "record_every": 0.5,
    } | settings
    writer.finish(begin(t_end, **settings))
    return path


@pytest.fixture(scope="module", params=STEPPERS)
def straight(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    return stream(folder / "straight.nc", **STEPPERS[request.param]), STEPPERS[request.param], folder


@pytest.fixture(scope="module")
def whole(straight):
    """The same run in memory."""
    return begin(12.0, record_every=0.5, **straight[1])


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    return stream(tmp_path_factory.mktemp("short") / "run.nc", t_end=2.0)


@pytest.fixture
def short(kept, tmp_path):
    """A short run of the test's own."""
    return Path(shutil.copy(kept, tmp_path))


def test_the_same_seed_twice(straight, tmp_path):
    path, settings, _ = straight
    assert differences(path, stream(tmp_path / "again.nc", **settings)) == []


@pytest.mark.slow
def test_checkpoints_change_nothing(straight, tmp_path):
    path, settings, _ = straight
    assert differences(path, stream(tmp_path / "often.nc", checkpoint_seconds=0.0, **settings)) == []


def test_a_file_streamed_equals_a_file_written_from_memory(straight, whole, tmp_path):
    path, _, _ = straight
    assert differences(path, cy.write(whole, tmp_path / "memory.nc")) == []


def test_stopping_at_a_saved_time_and_going_on(straight, tmp_path):
    path, settings, _ = straight
    stopped = stream(tmp_path / "run.nc", t_end=6.0, **settings)
    cy.resume_file(stopped, t_end=12.0)
    assert differences(path, stopped) == []


def test_stopping_in_memory_and_going_on(straight, whole):
    _, settings, _ = straight
    half = begin(6.0, record_every=0.5, **settings)
    onward = cy.resume(half, 12.0)
    assert np.array_equal(onward.final_state, whole.final_state)
    assert onward.times.tolist() == whole.times.tolist()
    assert all(np.array_equal(onward.records[n], whole.records[n]) for n in whole.records)
    assert len(half.frames) == 4, "the first half keeps its own frames"


def test_interrupting_between_saved_times_and_going_on(straight, tmp_path):
    """Interruption falls where the clock says, in the middle of a way between two saved times."""
    path, settings, _ = straight

    def stop(snapshot):
        if snapshot.t > 3.1:
            raise KeyboardInterrupt

    writer = cy.RunWriter(tmp_path / "run.nc")
    with pytest.raises(KeyboardInterrupt) as stopped:
        begin(12.0, record_every=0.5, checkpoint=writer, progress=stop, **settings)
    assert stopped.value.run.status == "interrupted"
    writer.finish(stopped.value.run)
    cy.resume_file(tmp_path / "run.nc")
    assert differences(path, tmp_path / "run.nc") == []


@pytest.mark.slow
def test_ctrl_c_saves_says_how_to_resume_and_exits_130(tmp_path):
    arguments = ["run", *SETTINGS, "--out", "run.nc", "--checkpoint-seconds", "0"]
    process = started(tmp_path, *arguments)
    wait_for_parts(process, tmp_path / "run.nc")
    process.send_signal(signal.SIGINT)
    out = process.communicate(timeout=120)[0]
    assert process.returncode == 130
    assert "cyclosis resume run.nc" in out
    assert call(tmp_path, "resume", "run.nc", "--quiet").returncode == 0
    assert call(tmp_path, "run", *SETTINGS, "--out", "straight.nc").returncode == 0
    assert differences(tmp_path / "straight.nc", tmp_path / "run.nc") == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "options", ["", "--stepper etdrk4 --dt 0.07", "--stepper rk4", "--precision float32"]
)
def test_going_on_in_a_new_process(tmp_path, options):
    own = f"run --n-theta 32 --n-z 24 --d-s 0.1 --save-every 2 --record-every 0.5 --quiet {options}".split()
    assert call(tmp_path, *own, "--t-end", "12", "--out", "straight.nc").returncode == 0
    assert call(tmp_path, *own, "--t-end", "6", "--out", "run.nc").returncode == 0
    assert call(tmp_path, "resume", "run.nc", "--t-end", "12", "--quiet").returncode == 0
    assert differences(tmp_path / "straight.nc", tmp_path / "run.nc") == []


@pytest.mark.slow
def test_kill_9_at_random_moments(tmp_path):
    assert killing(tmp_path, rounds=4, seed=5) == []


@pytest.mark.slow
def test_a_disk_that_fills_up_at_any_write_keeps_what_was_saved(tmp_path, monkeypatch):
    """Every write to the disk fails in turn; each time one sentence, a readable rest, and the same end."""
    settings = STEPPERS["adaptive"] | {"t_end": 4.0}
    good = stream(tmp_path / "good.nc", checkpoint_seconds=0.0, **settings)
    counter = {"left": 0}

    class Disk:
        """A raw file whose writes fail once the disk is full."""

        def __init__(self, path, mode, buffering):
            self._raw = open(path, mode, buffering=buffering)  # noqa: SIM115

        def write(self, data):
            counter["left"] -= 1
            if counter["left"] < 0:
                raise OSError(errno.ENOSPC, "No space left on device")
            return self._raw.write(data)

        def __getattr__(self, name):
            return getattr(self._raw, name)

    monkeypatch.setattr(guarded, "open", Disk, raising=False)
    counter["left"] = 10**9
    stream(tmp_path / "counted.nc", checkpoint_seconds=0.0, **settings)
    writes = 10**9 - counter["left"]
    for fails_at in sorted(random.Random(3).sample(range(writes), 6)):
        counter["left"] = fails_at
        target = tmp_path / f"full-{fails_at}.nc"
        with pytest.raises(cy.InputError, match="free some disk space"):
            stream(target, checkpoint_seconds=0.0, **settings)
        counter["left"] = 10**9
        assert not target.exists()
        if parts.is_unfinished(target):
            cy.open_dataset(target).close()
            cy.resume_file(target)
            assert differences(good, target) == [], fails_at


def test_a_diverged_run_keeps_its_checkpoints_and_is_not_resumed(tmp_path):
    writer = cy.RunWriter(tmp_path / "run.nc")
    run = cy.simulate(
        cy.Parameters(),
        GRID,
        STATE,
        50.0,
        1.0,
        stepper="rk4",
        dt=0.5,
        checkpoint=writer,
        checkpoint_seconds=0.0,
    )
    assert run.status == "diverged"
    stored = sorted(parts.folder_of(tmp_path / "run.nc").glob("*.nc"))
    for part in stored:
        restart = everything(part)
        assert np.all(np.isfinite(restart["restart/spectrum"]))
        assert not restart["restart/failed"]
    writer.finish(run)
    state = everything(tmp_path / "run.nc")["P"][-1]
    assert np.hypot(*state).max() <= 1.01 + 1e-9
    with pytest.raises(cy.InputError, match="diverged"):
        cy.resume_file(tmp_path / "run.nc", t_end=100.0)


@pytest.mark.slow
def test_altered_files_are_named_or_the_change_touched_nothing(tmp_path):
    """Flip one byte anywhere: the file is refused, or not one bit of its contents has changed."""
    path = stream(tmp_path / "run.nc", **STEPPERS["adaptive"])
    whole, rng, refused = path.read_bytes(), random.Random(1), 0
    for _ in range(60):
        spot = rng.randrange(len(whole))
        altered = tmp_path / "altered.nc"
        altered.write_bytes(whole[:spot] + bytes([whole[spot] ^ (1 << rng.randrange(8))]) + whole[spot + 1 :])
        message = refusal(altered)
        refused += bool(message)
        assert "altered" in message or differences(path, altered) == [], spot
    assert refused > 30


ALTERATIONS = {
    "an attribute": lambda file: file.attrs.modify("length", 5.5),
    "a recorded number": lambda file: file["order"].__setitem__(1, 0.5),
    "a time": lambda file: file["time"].__setitem__(1, 1.5),
    "the restart": lambda file: file["restart/rung"].__setitem__((), 3),
}


@pytest.mark.parametrize("alter", ALTERATIONS.values(), ids=ALTERATIONS)
def test_what_another_program_alters_is_named(short, alter):
    """A change for which HDF5 writes its own checksums anew."""
    assert refusal(short) == ""
    with h5py.File(short, "r+") as file:
        alter(file)
    assert "altered" in refusal(short)
    with pytest.raises(cy.InputError, match="altered"):
        cy.open_dataset(short)


def refusal(path):
    try:
        cy.load(path)
    except cy.InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_files_are_named(short, share):
    whole = short.read_bytes()
    short.write_bytes(whole[: int(len(whole) * share)])
    for use in (cy.open_dataset, cy.load, cy.resume_file):
        with pytest.raises(cy.InputError, match=r"truncated or altered"):
            use(short)


@pytest.mark.parametrize(("schema", "remedy"), [(0, "version that wrote it"), (99, "update cyclosis")])
def test_files_of_another_schema_are_refused(short, schema, remedy):
    with h5py.File(short, "a") as file:
        file.attrs["schema"] = schema
        file.attrs["digest"] = digest(file, cy.models.polar)
    for use in (cy.open_dataset, cy.load):
        with pytest.raises(cy.InputError, match=remedy):
            use(short)


def test_an_unfinished_run_is_in_nobodys_way_and_nobody_in_its(tmp_path):
    writer = cy.RunWriter(tmp_path / "run.nc")
    run = cy.simulate(PARAMS, GRID, STATE, 4.0, 2.0, checkpoint=writer)
    assert parts.is_unfinished(tmp_path / "run.nc")
    assert cy.open_dataset(tmp_path / "run.nc").sizes["time"] == 0
    with pytest.raises(cy.InputError, match="resume_file") as refused:
        cy.RunWriter(tmp_path / "run.nc")
    assert "`cyclosis resume " in refused.value.at_terminal
    writer.finish(run)
    assert not parts.is_unfinished(tmp_path / "run.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_a_finished_file_is_not_streamed_over_unless_forced(short):
    with pytest.raises(cy.InputError, match="force"):
        cy.RunWriter(short)
    assert cy.open_dataset(short).sizes["time"] == 2


def test_a_user_term_is_needed_again_to_go_on(tmp_path):
    def pull(t, P, u, params, grid):
        return -0.1 * P

    terms = [*cy.TERMS, pull]
    whole = cy.simulate(PARAMS, GRID, STATE, 4.0, 2.0, terms=terms)
    path = cy.write(cy.simulate(PARAMS, GRID, STATE, 2.0, 2.0, terms=terms), tmp_path / "run.nc")
    with pytest.raises(cy.InputError, match="pull"):
        cy.resume_file(path, 4.0)
    with pytest.raises(cy.InputError, match="those of the run"):
        cy.resume_file(path, 4.0, terms=[pull])
    assert np.array_equal(cy.resume_file(path, 4.0, terms=terms).final_state, whole.final_state)


def test_a_run_does_not_go_on_with_other_terms():
    run = cy.simulate(PARAMS, GRID, cy.initial.stripes(GRID), t_end=0.5, save_every=0.5)
    with pytest.raises(cy.InputError, match=r"those of the run: .*bundling"):
        cy.resume(run, 1.0, terms=["diffusion", "rotational_diffusion"])


@pytest.mark.parametrize("t_end", [1.0, 2.0])
def test_there_must_be_something_left_to_do(short, t_end):
    with pytest.raises(cy.InputError, match="later than the time reached"):
        cy.resume_file(short, t_end)


@pytest.mark.slow
def test_the_cost_of_a_checkpoint_does_not_grow(tmp_path):
    """The parts of a long run are no larger than those of its beginning."""
    writer = cy.RunWriter(tmp_path / "run.nc")
    sizes = []

    def spy(run):
        writer(run)
        sizes.append(max(parts.folder_of(tmp_path / "run.nc").glob("*.nc")).stat().st_size)

    cy.simulate(PARAMS, GRID, STATE, 16.0, 0.5, checkpoint=spy, checkpoint_seconds=0.0)
    assert len(sizes) > 30
    assert max(sizes[-10:]) <= 1.1 * max(sizes[2:12])
