"""Devices that JAX is told to use and does not find: one sentence, in Python and on the command line."""

import os
import subprocess
import sys

import pytest

from cyclosis.model import devices
from cyclosis.model.errors import InputError
from measure.files import COMMAND

TINY = """
grid = { n_theta = 16, n_z = 16 }
axes = { alpha_p = { values = [0.5] } }
run = { t_end = 1.0 }
"""
PYTHON = """
import cyclosis as cy
params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
state = cy.initial.stripes(grid)
print(cy.stability.cyclosis(params, 64).count)  # on the host, which is there
for first in (
    lambda: cy.simulate(params, grid, state, 1.0),
    lambda: cy.flow(params, grid, state),
    lambda: cy.rate_of_change(params, grid, state),
    lambda: cy.diagnose(params, grid, state),
    lambda: cy.regime(params, grid, state),
):
    try:
        first()
    except cy.InputError as error:
        print(error.field, error.value)
"""
ABSENT = "nonsense" if devices.gpus() else "cuda"


def started(*command, cwd, **environment):
    env = {**os.environ, **environment}
    return subprocess.run(command, cwd=cwd, env=env, timeout=300, capture_output=True, text=True)


def test_in_python(tmp_path):
    out = started(sys.executable, "-c", PYTHON, cwd=tmp_path, JAX_PLATFORMS=ABSENT)
    assert out.returncode == 0, out.stderr
    assert out.stdout == "2\n" + 5 * f"JAX_PLATFORMS {ABSENT}\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "platform"),
    [
        ("doctor", ABSENT),
        ("run --n-theta 16 --n-z 16 --t-end 1 --out new.nc", ABSENT),
        ("sweep run tiny.toml --out new", "nonsense"),
        ("sweep plan tiny.toml", ABSENT),
        ("experiment recovery --quick --out new", ABSENT),
        ("explore --no-browser --port 0", ABSENT),
    ],
)
def test_on_the_command_line(line, platform, tmp_path):
    (tmp_path / "tiny.toml").write_text(TINY)
    out = started(*COMMAND, *line.split(), cwd=tmp_path, JAX_PLATFORMS=platform)
    assert out.returncode == 2, out.stderr
    assert out.stderr.startswith(f"cyclosis: JAX_PLATFORMS = '{platform}' cannot be used: it must be ")
    assert "unset it, or set it to cpu" in out.stderr
    assert out.stderr.count("\n") == 1
    assert ("packages" in out.stdout) == (line == "doctor"), "the doctor says the rest all the same"
    assert not (tmp_path / "new.nc").exists()
    assert not (tmp_path / "new").exists()


def test_another_variable_that_jax_refuses(tmp_path):
    out = started(*COMMAND, "doctor", cwd=tmp_path, JAX_ENABLE_X64="maybe")
    assert out.returncode == 2
    assert out.stderr.startswith("cyclosis: JAX_ENABLE_X64 = 'maybe' cannot be used: ")


def test_what_is_there_is_taken():
    for asked in ("", "cpu", "cpu,", "tpu"):  # whether there is a TPU only JAX can tell
        devices.require_platforms(asked)
    devices.require_devices()


def test_without_the_part_of_jax_for_gpus_it_is_named(monkeypatch):
    monkeypatch.setattr(devices, "_plugins", set)
    with pytest.raises(InputError, match="without its part for NVIDIA GPUs"):
        devices.require_platforms("cuda,cpu")
    monkeypatch.setattr(devices, "_plugins", lambda: {"cuda"})
    monkeypatch.setattr(devices, "gpus", list)
    monkeypatch.setattr(devices.sys, "platform", "linux")
    with pytest.raises(InputError, match="shows no NVIDIA GPU"):
        devices.require_platforms("gpu")
    monkeypatch.setattr(devices, "gpus", lambda: ["0"])
    devices.require_platforms("cuda")
    devices.require_platforms("a-plugin-of-its-own" if devices._plugins() - {"cuda"} else "cpu")
