import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config

GRID = cy.CylinderGrid(32, 24, 5.0)


def test_disorder_has_the_papers_statistics():
    grid = cy.CylinderGrid(256, 256, 5.0)
    state = cy.initial.disordered(grid, filaments_per_square=1000, seed=3)
    assert state.shape == (2, 256, 256)
    n = state.size
    assert state.var() == pytest.approx(1 / 2000, rel=5 * np.sqrt(2 / n))
    assert abs(state.mean()) < 5 * np.sqrt(1 / 2000 / n)
    assert abs(np.mean(state[0] * state[1])) < 5 / 2000 / np.sqrt(n / 2)


def test_the_stream_of_random_numbers_is_fixed():
    drawn = np.random.default_rng(7).normal(size=(2, 32, 24)) * np.sqrt(1 / 400)
    assert np.array_equal(cy.initial.disordered(GRID, 200, seed=7), drawn)


def test_one_noise_grid_gives_one_state_on_every_grid():
    coarse = cy.initial.disordered(GRID, seed=5, noise_grid=(16, 16))
    fine = cy.initial.disordered(cy.CylinderGrid(64, 96, 5.0), seed=5, noise_grid=(16, 16))
    assert fine[:, ::2, ::4] == pytest.approx(coarse, abs=1e-15)


def test_too_few_filaments_are_refused():
    with pytest.raises(cy.InputError, match="filaments_per_square"):
        cy.initial.disordered(GRID, filaments_per_square=0.5)


def test_ordered_states_are_what_they_say():
    assert np.all(cy.initial.unidirectional(GRID, 0.7) == np.array([0, 0.7])[:, None, None])
    assert np.all(cy.initial.circumferential(GRID, 0.7) == np.array([0.7, 0])[:, None, None])
    four = cy.initial.stripes(GRID, 4, 0.5)
    assert cy.zones.zone_angles(four[1].mean(axis=1)) == pytest.approx(np.arange(4) * np.pi / 2, abs=1e-12)
    with pytest.raises(cy.InputError, match="even"):
        cy.initial.stripes(GRID, 3)
    with pytest.raises(cy.InputError, match="n_theta"):
        cy.initial.stripes(GRID, 32)


def test_noise_adds_to_a_state_and_is_bounded():
    noisy = cy.initial.with_noise(cy.initial.stripes(GRID), GRID, seed=1)
    assert noisy - cy.initial.stripes(GRID) == pytest.approx(cy.initial.noise(GRID, seed=1), abs=1e-15)
    with pytest.raises(cy.InputError, match="at most 1"):
        cy.initial.with_noise(cy.initial.unidirectional(GRID, 1.0), GRID, 10)


def test_states_come_back_from_files(tmp_path):
    state = cy.initial.stripes(GRID, 2, 0.5)
    np.save(tmp_path / "s.npy", state)
    assert np.array_equal(cy.initial.from_file(str(tmp_path / "s.npy"), GRID), state)
    finer = cy.initial.from_file(str(tmp_path / "s.npy"), cy.CylinderGrid(64, 48, 5.0))
    assert finer[:, ::2, ::2] == pytest.approx(state, abs=1e-14)


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY nonsense", b"plain text"])
@pytest.mark.parametrize("suffix", [".npy", ".nc"])
def test_damaged_files_are_named(tmp_path, content, suffix):
    path = tmp_path / f"bad{suffix}"
    path.write_bytes(content)
    with pytest.raises(cy.InputError, match="path"):
        cy.initial.from_file(str(path), GRID)


@pytest.fixture
def long_run(tmp_path):
    """The file of a run in a cell of length 10."""
    grid = GRID.resized(16, 16)
    long = cy.CylinderGrid(16, 16, 10.0)
    run = cy.simulate(cy.Parameters(), long, cy.initial.stripes(grid, 2, 0.5), t_end=1.0)
    return cy.write(run, tmp_path / "ten.nc")


def test_a_state_of_a_longer_cell_is_taken_only_when_it_is_to_be_stretched(long_run):
    with pytest.raises(cy.InputError, match=r"length of the cell .* = 10\.0 .* of the grid, 5; .*stretch"):
        cy.initial.from_file(str(long_run), GRID)
    own = cy.initial.from_file(str(long_run), cy.CylinderGrid(32, 24, 10.0))
    assert np.array_equal(cy.initial.from_file(str(long_run), GRID, stretch=True), own)
    with pytest.raises(cy.InputError, match="stretch = 'yes'"):
        cy.initial.from_file(str(long_run), GRID, stretch="yes")


def test_a_table_asks_for_a_stored_state_to_be_stretched(long_run):
    given = {"kind": "file", "path": str(long_run)}
    with pytest.raises(cy.InputError, match="length of the cell"):
        config.initial_state(given, GRID)
    stretched = config.initial_state(given | {"stretch": True}, GRID)
    assert np.array_equal(stretched, cy.initial.from_file(str(long_run), GRID, stretch=True))
    with pytest.raises(cy.InputError, match="used only where initial kind is file"):
        config.initial_state({"kind": "stripes", "stretch": True}, GRID)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (lambda data: data.drop_attrs(), "length of the cell"),
        (lambda data: data.isel(z=slice(8)), "z in .* the whole cell, of 10"),
        (lambda data: data.isel(theta=slice(8)), "theta in .* the whole cell"),
        (lambda data: data.transpose("time", "component", "z", "theta", ...), "in this order"),
        (lambda data: data.isel(time=0), "over \\(time, component, theta, z\\)"),
    ],
)
def test_what_others_made_of_a_file_is_not_misread(long_run, tmp_path, changed, words):
    with cy.open_dataset(long_run) as data:
        changed(data).to_netcdf(tmp_path / "changed.nc", engine="h5netcdf")
    with pytest.raises(cy.InputError, match=words):
        cy.initial.from_file(str(tmp_path / "changed.nc"), GRID)


def test_a_file_that_does_not_say_its_length_spans_the_grid(long_run, tmp_path):
    with cy.open_dataset(long_run) as data:
        bare = data.drop_attrs().drop_vars(["theta", "z"])
        bare.to_netcdf(tmp_path / "bare.nc", engine="h5netcdf")
    whole = cy.initial.from_file(str(long_run), GRID, stretch=True)
    assert np.array_equal(cy.initial.from_file(str(tmp_path / "bare.nc"), GRID), whole)
