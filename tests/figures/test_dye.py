"""Movies of dye show the frames of a transport, on one scale, and the command writes one of a run."""

import av
import numpy as np
import pytest
from typer.testing import CliRunner

import cyclosis as cy
from cyclosis.cli import app
from cyclosis.figures.dye import dye

GRID = cy.CylinderGrid(16, 16)


def drop(r, theta, z):
    return np.exp(-4 * (r**2 + (z - 2.5) ** 2)) + 0 * theta


def carried(frames):
    flow = cy.vacuole.flow(GRID, cy.vacuole.helical_bands(GRID, np.sin, 5.0))
    return cy.vacuole.transport(flow, 20.0, start=drop, t_end=4.0, n_r=8, frames=frames)


def pictures(path):
    with av.open(str(path)) as film:
        return [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]


def test_dye_spreads_and_fades(tmp_path):
    shown = pictures(dye(carried([0.0, 2.0, 4.0]), tmp_path / "dye.mp4", seconds=1.0, height=180))
    assert len(shown) == 3
    # The section in the middle is dark where there is dye: at first a spot on the axis, which fades.
    row, column = shown[0].shape[0] // 2, round(0.16 * shown[0].shape[1])
    middle = [one[row - 6 : row + 6, column - 6 : column + 6].mean() for one in shown]
    assert middle[0] + 60 < middle[1] < middle[2]


def test_one_frame_is_no_movie(tmp_path):
    with pytest.raises(cy.InputError, match="at least 2 frames"):
        dye(carried([4.0]), tmp_path / "dye.mp4")


def stored(folder, times):
    run = cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID), t_end=1.0, save_at=times)
    cy.write(run, folder / "run.nc")
    return str(folder / "run.nc")


@pytest.mark.slow
def test_the_command_carries_dye_during_a_run(tmp_path):
    found = CliRunner().invoke(app, ["vacuole", stored(tmp_path, [0.0, 0.5, 1.0]), "--dye", "50"])
    assert found.exit_code == 0, found.output
    assert len(pictures(tmp_path / "run-vacuole" / "dye.mp4")) == 97


@pytest.mark.slow
def test_the_command_draws_every_figure_it_has(tmp_path):
    options = ["--uptake", "--dispersion", "--pitch", "4", "--poincare", "--dye", "50", "--gif"]
    found = CliRunner().invoke(app, ["vacuole", stored(tmp_path, [0.0, 0.5, 1.0]), *options])
    assert found.exit_code == 0, found.output
    names = {path.name for path in (tmp_path / "run-vacuole").iterdir()}
    drawn = {"section", "cutaway", "circulation", "uptake", "dispersion", "poincare"}
    assert names == {f"{name}.png" for name in drawn} | {"dye.mp4", "dye.gif"}
    assert len(pictures(tmp_path / "run-vacuole" / "dye.gif")) == 97


@pytest.mark.parametrize(
    ("times", "options", "named"),
    [
        ([0.0, 1.0], ["--dye", "-1"], "peclet"),
        ([1.0], ["--dye", "50"], "frames"),
        ([1.0], ["--gif"], "gif"),
        ([1.0], ["--pitch", "5"], "pitch"),
        ([1.0], ["--uptake", "--pitch", "0"], "pitch"),
    ],
)
def test_the_command_refuses_before_it_writes(tmp_path, times, options, named):
    bad = CliRunner().invoke(app, ["vacuole", stored(tmp_path, times), *options])
    assert isinstance(bad.exception, cy.InputError)
    assert named in str(bad.exception)
    assert not (tmp_path / "run-vacuole").exists()
