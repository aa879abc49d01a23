"""A protocol split by a restart, at any moment before, at or after its events, gives bitwise the same run."""

import dataclasses
import signal
import time
from functools import partial

import h5py
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset import parts
from measure.files import call, differences, started

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters(d_s=0.1)
STATE = cy.initial.disordered(GRID, 100)
PATCH = cy.regions.disc(theta=3.1, z=2.5, radius=1.0)
PROTOCOL = cy.Protocol(
    cy.change(at=2.0, alpha_p=0.5),
    cy.change(at=3.3, over=2.0, alpha_p=0.8, mu=0.1, d_s=0.05),
    cy.change(at=4.0, where=PATCH, kappa=0.0),
    cy.fragment(at=4.0, where=~PATCH),
    cy.noise(at=6.7, size=0.05),
    cy.depolymerise(at=8.0, keep=0.5, where=PATCH),
    cy.wash_out(at=9.0, over=1.0),
    seed=4,
)
STEPPERS = {
    "adaptive": {"stepper": "adaptive"},
    "etdrk4": {"stepper": "etdrk4", "dt": 0.13},
    "rk4": {"stepper": "rk4", "dt": 0.05},
    "float32": {"precision": "float32"},
}
TEXT = """
[parameters]
d_s = 0.1
[grid]
n_theta = 32
n_z = 24
[initial]
seed = 4
[run]
t_end = 30.0
save_every = 2.0
stepper = "etdrk4"
dt = 0.02
[[protocol]]
at = 4.0
action = "fragment"
where = { shape = "image", path = "mask.png", invert = true }
[[protocol]]
at = 5.0
over = 10.0
action = "change"
alpha_p = 0.5
[[protocol]]
at = 20.0
action = "noise"
size = 0.05
[[protocol]]
at = 25.0
action = "wash_out"
"""


def stream(path, t_end=12.0, checkpoint_seconds=1e9, **settings):
    writer = cy.RunWriter(path)
    settings = {
        "checkpoint": writer,
        "checkpoint_seconds": checkpoint_seconds,
        "record_every": 0.5,
        "protocol": PROTOCOL,
    } | settings
    writer.finish(cy.simulate(PARAMS, GRID, STATE, t_end, 2.0, **settings))
    return path


SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("etdrk4", "rk4", "float32")]


@pytest.fixture(scope="module", params=["adaptive", *SLOW])
def straight(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    path = stream(folder / "straight.nc", **STEPPERS[request.param])
    assert cy.load(path, fields=False).status == "completed"
    return path, STEPPERS[request.param]


@pytest.mark.slow
def test_checkpoints_change_nothing(straight, tmp_path):
    path, settings = straight
    assert differences(path, stream(tmp_path / "often.nc", checkpoint_seconds=0.0, **settings)) == []


def test_a_file_streamed_equals_a_file_written_from_memory(straight, tmp_path):
    path, settings = straight
    run = cy.simulate(PARAMS, GRID, STATE, 12.0, 2.0, record_every=0.5, protocol=PROTOCOL, **settings)
    assert differences(path, cy.write(run, tmp_path / "memory.nc")) == []
    loaded = cy.load(path)
    assert loaded.protocol == PROTOCOL
    assert loaded.params_at(4.5) == run.params_at(4.5)
    assert [done.time for done in loaded.interventions] == [4.0, 6.7, 8.0]
    for a, b in zip(loaded.interventions, run.interventions, strict=True):
        assert np.array_equal(a.before, b.before)
        assert np.array_equal(a.after, b.after)


def test_ending_at_before_and_after_an_event_and_going_on(straight, tmp_path):
    """2, 4 and 8 are events, 10 the end of a ramp, 6 none; what falls on the end is done."""
    path, settings = straight
    stopped = stream(tmp_path / "run.nc", t_end=2.0, **settings)
    for t_end in (4.0, 6.0, 8.0, 10.0, 12.0):
        early = cy.load(stopped)
        assert np.array_equal(early.frames[-1], early.final_state.astype(early.frames.dtype))
        cy.resume_file(stopped, t_end=t_end)
    assert differences(path, stopped) == []


@pytest.mark.slow
def test_every_checkpoint_can_be_gone_on_from(straight, tmp_path):
    """A checkpoint at every chance, just before events as well: each is resumed to the same end."""
    path, settings = straight
    kept = []

    def keep(run):
        if not kept or run.t_final != kept[-1].t_final or run.restart.done != kept[-1].restart.done:
            kept.append(dataclasses.replace(run, frames=run.frames.copy()))

    whole = cy.simulate(
        PARAMS,
        GRID,
        STATE,
        12.0,
        2.0,
        record_every=0.5,
        protocol=PROTOCOL,
        checkpoint=keep,
        checkpoint_seconds=0.0,
        **settings,
    )
    assert any(run.t_final in (4.0, 8.0) and run.restart.done == done for run in kept for done in (2, 5))
    for number, run in enumerate(kept[:: max(1, len(kept) // 12)]):
        onward = cy.resume(run)
        assert np.array_equal(onward.final_state, whole.final_state)
        assert differences(path, cy.write(onward, tmp_path / f"{number}.nc")) == []


def test_interrupting_and_going_on(straight, tmp_path):
    """One run, interrupted again and again: before anything, at an event, between two and within a ramp."""
    path, settings = straight

    def stopped(moment, go, **rest):
        def stop(snapshot):
            if snapshot.t >= moment:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt) as stopped:
            go(progress=stop, **rest)
        assert stopped.value.run.status == "interrupted"
        return stopped.value.run

    def begin(**rest):
        cy.simulate(PARAMS, GRID, STATE, 12.0, 2.0, record_every=0.5, protocol=PROTOCOL, **settings, **rest)

    writer = cy.RunWriter(tmp_path / "run.nc")
    writer.finish(stopped(0.0, begin, checkpoint=writer))
    for moment in (3.1, 4.0, 4.6, 7.9):
        run = stopped(moment, partial(cy.resume_file, tmp_path / "run.nc"))
        assert moment <= run.t_final < 12.0
    cy.resume_file(tmp_path / "run.nc")
    assert differences(path, tmp_path / "run.nc") == []


def commanded(folder):
    from PIL import Image

    pixels = np.zeros((8, 8), np.uint8)
    pixels[2:5, 3:7] = 255
    Image.fromarray(pixels).save(folder / "mask.png")
    (folder / "run.toml").write_text(TEXT)
    return ["run", "--config", "run.toml", "--quiet"]


@pytest.mark.slow
def test_ctrl_c_and_kill_go_on_in_new_processes_without_the_image(tmp_path):
    """The run is interrupted once, killed once, and resumed where neither image nor configuration is left."""
    run = commanded(tmp_path)
    assert call(tmp_path, *run, "--out", "straight.nc").returncode == 0
    for number, kind in enumerate((signal.SIGINT, signal.SIGKILL)):
        arguments = run if number == 0 else ["resume", "run.nc", "--quiet"]
        place = ["--out", "run.nc"] if number == 0 else []
        process = started(tmp_path, *arguments, *place, "--checkpoint-seconds", "0")
        while len(parts.stored(tmp_path / "run.nc")) < 4 * (number + 1) and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(kind)
        process.communicate()
        for name in ("mask.png", "run.toml"):
            (tmp_path / name).unlink(missing_ok=True)
    out = call(tmp_path, "resume", "run.nc", "--quiet")
    assert out.returncode == 0, out.stderr
    assert differences(tmp_path / "straight.nc", tmp_path / "run.nc") == []


def test_the_protocol_is_part_of_the_provenance(tmp_path):
    path = stream(tmp_path / "run.nc", t_end=5.0)
    with cy.open_dataset(path) as data, cy.open_dataset(path) as again:
        digest = data.attrs["configuration_sha256"]
        assert '"action": "fragment"' in data.attrs["configuration"]
        assert data["P_before"].dims == ("intervention_time", "component", "theta", "z")
        assert again.identical(data)
        memory = cy.load(path).to_dataset()
        assert set(memory.variables) == set(data.variables)
    other = stream(tmp_path / "other.nc", t_end=5.0, protocol=PROTOCOL.with_seed(5))
    with cy.open_dataset(other) as data:
        assert data.attrs["configuration_sha256"] != digest
    plain = cy.write(cy.simulate(PARAMS, GRID, STATE, 2.0, 2.0), tmp_path / "plain.nc")
    with h5py.File(plain) as file:
        assert "protocol" not in file.attrs["configuration"]
        assert "P_before" not in file


def test_what_lies_after_the_end_waits_and_is_told(tmp_path):
    from cyclosis import report

    run = cy.simulate(PARAMS, GRID, STATE, 4.0, 2.0, protocol=PROTOCOL)
    assert len(run.interventions) == 1
    assert "7 steps, 3 of them after t = 4" in report.summary(run)
