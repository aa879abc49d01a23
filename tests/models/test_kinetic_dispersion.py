"""Growth rates about the uniform states of the kinetic model: the table, its figure and the command."""

import csv

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

import cyclosis as cy
from cyclosis.cli import app
from cyclosis.figures.dispersion import kinetic_dispersion

PARAMS = cy.Parameters(alpha_p=0.8, d_r=0.08)
MODES = 24


def said(*arguments, code=0):
    result = CliRunner().invoke(app, ["stability", "dispersion", *map(str, arguments)])
    assert result.exit_code == code, result.exception
    return result.stdout


@pytest.mark.parametrize("base", ["nematic", "z", "theta"])
def test_the_table_lists_the_leading_rates_of_the_matrices(base):
    table = cy.kinetic.dispersion(PARAMS, base, 2, 4.0, MODES)
    state = cy.kinetic.uniform_state(PARAMS, base, MODES)
    assert table.order == pytest.approx(abs(state[1]), abs=1e-15)
    assert sorted(zip(table.m, table.j, strict=True)) == [(m, j) for m in range(3) for j in range(3)]
    assert np.all(np.diff(table.rates[:, 0].real) <= 1e-11)
    for m, j, q, rates in zip(table.m, table.j, table.q, table.rates, strict=True):
        assert q == pytest.approx(2 * np.pi * j / 4.0)
        exact = cy.kinetic.growth_rates(PARAMS, state, int(m), q)[:2]
        assert rates.real == pytest.approx(exact.real, abs=1e-10)
    data = table.to_dataset()
    assert data.attrs["modes"] == MODES
    assert data["growth_stronger"].values == pytest.approx(table.rates[:, 0].real)


def test_mirror_images_grow_alike_unless_d_is_oblique():
    for base in ("nematic", "z", "theta"):
        state = cy.kinetic.uniform_state(PARAMS, base, MODES)
        one, other = (cy.kinetic.growth_rates(PARAMS, state, 1, q)[0].real for q in (0.9, -0.9))
        assert one == pytest.approx(other, abs=1e-10)
    oblique = cy.kinetic.dispersion(PARAMS.replace(repulsion_angle=0.5), "nematic", 1, modes=MODES)
    assert sorted(zip(oblique.m, oblique.j, strict=True)) == [(0, 0), (0, 1), (1, -1), (1, 0), (1, 1)]


def test_torques_by_rates_double_both_couplings():
    twice = PARAMS.replace(alpha_p=2 * PARAMS.alpha_p, alpha_u=2 * PARAMS.alpha_u)
    found = cy.kinetic.dispersion(PARAMS, "z", 1, modes=MODES, torques="rate")
    assert found.rates == pytest.approx(cy.kinetic.dispersion(twice, "z", 1, modes=MODES).rates, abs=1e-13)


def test_nematic_disorder_is_neutral_at_its_threshold():
    at = cy.kinetic.thresholds(cy.Parameters()).along
    table = cy.kinetic.dispersion(cy.Parameters(alpha_p=at), waves=0, modes=60)
    assert np.abs(table.rates[0].real).min() < 1e-9


def test_too_few_modes_are_reported(tmp_path):
    for modes in (12, 13):  # the nematic has no odd moments
        assert not cy.kinetic.dispersion(cy.Parameters(), waves=0, modes=modes).resolved
    assert cy.kinetic.dispersion(cy.Parameters(), waves=0).resolved
    out = said("--model", "kinetic", "--modes", 12, "--waves", 0, "--base", "nematic")
    assert "underresolved: |m_12| is 3.3e-02 of the first moments; take more modes" in out
    assert "underresolved" not in said("--model", "kinetic", "--waves", 0, "--base", "nematic")


def test_the_command_prints_every_state_and_writes_the_first(tmp_path):
    table = tmp_path / "waves.csv"
    out = said("--model", "kinetic", "--waves", 1, "--out", table, "--out", tmp_path / "waves.nc")
    heads = [line for line in out.splitlines() if "|P|" in line]
    assert [head.split()[0] for head in heads] == ["nematic", "z", "theta"]
    assert "0.498997" in out
    with open(table) as file:
        assert float(next(csv.DictReader(file))["growth_stronger"]) == pytest.approx(0.498997, abs=1e-6)
    with xarray.open_dataset(tmp_path / "waves.nc", engine="h5netcdf") as data:
        assert data.attrs["base"] == "nematic"
    weak = said("--model", "kinetic", "--waves", 0, "--alpha-p", 0.01)
    assert "z (" not in weak
    assert "1.44313" in said("--model", "kinetic", "--torques", "rate", "--waves", 0, "--base", "nematic")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "kinetic", "--base", "disorder"], "nematic, z, theta"),
        (["--model", "kinetic", "--d-r", "0"], "above 0"),
        (["--model", "kinetic", "--base", "theta", "--alpha-p", "0.01"], "uniform state along theta"),
        (["--torques", "rate"], "used only where"),
        (["--modes", "12"], "used only where"),
        (["--model", "bipolar"], "polar, kinetic"),
    ],
)
def test_bad_input_gets_one_sentence(arguments, words):
    result = CliRunner().invoke(app, ["stability", "dispersion", *arguments])
    assert isinstance(result.exception, cy.InputError)
    assert words in str(result.exception)


@pytest.mark.parametrize("name", ["profile", "spectrum", "threshold", "branch kappa --from 0 --to 1"])
def test_other_commands_of_the_theory_do_not_offer_the_model(name):
    result = CliRunner().invoke(app, ["stability", *name.split(), "--model", "kinetic"])
    assert result.exit_code != 0
    assert "--model" in str(result.exception) + result.output


@pytest.mark.slow
def test_the_figure_draws_the_rates_of_the_table():
    figure = kinetic_dispersion(PARAMS, ["nematic", "theta"], modes=MODES)
    assert len(figure.axes) == 4
    upper = figure.axes[1]
    dots = next(line for line in upper.lines if line.get_marker() == "o" and line.get_xdata().size == 6)
    state = cy.kinetic.uniform_state(PARAMS, "nematic", MODES)
    exact = [cy.kinetic.growth_rates(PARAMS, state, m, 0.0)[0].real for m in range(1, 7)]
    assert dots.get_ydata() == pytest.approx(exact, abs=1e-10)
    missing = kinetic_dispersion(PARAMS.replace(alpha_p=0.01), modes=MODES)
    assert [text.get_text() for ax in missing.axes for text in ax.texts].count("no such state") == 2
