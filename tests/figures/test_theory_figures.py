"""Figures of the theory: what is drawn is what was computed."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import cyclosis as cy
from cyclosis.figures import bifurcation, limits, plane, regime_map, spectra, style, thresholds
from cyclosis.figures.dispersion import dispersion
from cyclosis.stability.existence.boundaries import limits as compute_limits
from cyclosis.stability.existence.onset import neighbourhood
from cyclosis.stability.regime_map import RegimeMap
from cyclosis.stability.states import STATES

N = 64


def labels(figure):
    return [text.get_text() for ax in figure.axes if ax.get_legend() for text in ax.get_legend().get_texts()]


def words(figure):
    return [text.get_text() for ax in figure.axes for text in ax.texts]


def test_dispersion_draws_closed_form_rates(tmp_path):
    params = cy.Parameters(kappa=0.2)
    figure = dispersion(params)
    assert len(figure.axes) == 6
    upper = figure.axes[3]  # about order along the cell
    dots = next(line for line in upper.lines if line.get_marker() == "o" and line.get_xdata().size == 6)
    exact = cy.stability.growth_rates(params, "unidirectional", np.arange(1.0, 7.0), 0.0)[:, 0].real
    assert dots.get_ydata() == pytest.approx(exact, abs=1e-14)
    style.save(figure, tmp_path / "dispersion.pdf")


def test_a_state_that_is_not_there_is_said_to_be_missing():
    figure = dispersion(cy.Parameters(alpha_p=0.01, alpha_u=0.0))
    assert words(figure).count("no such state") == 2


@pytest.fixture(scope="module")
def state():
    return cy.stability.cyclosis(cy.Parameters(), 128)


def test_profile_and_spectrum(state, tmp_path):
    figure = spectra.profile(state)
    curve = figure.axes[0].lines[1]
    shown = np.nanmax(curve.get_ydata())
    assert shown == pytest.approx(0.99157205, abs=1e-6)
    modes = state.spectrum(6)
    drawn = spectra.spectrum(state, modes)
    points = drawn.axes[0].lines[2]
    assert set(np.round(points.get_xdata(), 9)) == set(np.round(modes.eigenvalues.real[1:], 9))
    assert drawn.axes[1].get_title(loc="right") == "σ = 0 (rotation)"
    for k, each in enumerate((figure, drawn, spectra.spectrum(state, state.spectrum(4, axial_mode=2)))):
        style.save(each, tmp_path / f"{k}.png")


def test_tilted_stripes_show_both_components():
    found = cy.stability.drifting(cy.Parameters(kappa=0.2), N)
    figure = spectra.drifting(found)
    assert labels(figure) == ["$P_{z}$", "$P_{\\theta}$", "$u_{z}$", "$u_{\\theta}$"]
    assert f"drift {found.drift:.6g}" in [ax.get_title(loc="right") for ax in figure.axes]


@pytest.fixture(scope="module")
def branch():
    start = cy.stability.cyclosis(cy.Parameters(), N)
    return cy.stability.continue_branch(start, "kappa", (0.4, 0.5), longest=0.2)


def test_thick_lines_are_stable_pieces(branch):
    figure = bifurcation.bifurcation([branch], ("max_P", "drift"))
    thick = [line for line in figure.axes[0].lines if line.get_linewidth() > 2]
    stable = np.concatenate([line.get_xdata() for line in thick])
    edge = branch.of("branch point", 0)[0].value
    assert stable.min() == pytest.approx(edge, abs=1e-12)
    assert stable.max() == 0.5
    assert {"stripes", "unstable", "branch point", "of waves along the cell"} <= set(labels(figure))


def test_what_cannot_be_drawn_together_is_refused(branch):
    other = cy.stability.continue_branch(
        cy.stability.cyclosis(cy.Parameters(), N), "alpha_u", (0.4, 0.6), length=None, longest=0.5
    )
    with pytest.raises(cy.InputError, match="one parameter"):
        bifurcation.bifurcation([branch, other])
    with pytest.raises(cy.InputError, match="measure"):
        bifurcation.bifurcation([branch], ("colour",))
    low = cy.stability.continue_branch(
        cy.stability.cyclosis(cy.Parameters(), N), "alpha_u", (0.0, 0.6), length=None, longest=0.5
    )
    for draw in (lambda: bifurcation.bifurcation([low], log=True), lambda: spectra.eigenvalues(low, True)):
        with pytest.raises(cy.InputError, match="logarithmic"):
            draw()


def test_eigenvalues_along_a_branch(branch, tmp_path):
    figure = spectra.eigenvalues(branch)
    drawn = {tuple(line.get_ydata()) for line in figure.axes[0].lines}
    assert tuple(branch.eigenvalues[:, 0].real) in drawn
    style.save(figure, tmp_path / "eigenvalues.png")


@pytest.mark.slow
def test_limits_over_decades_and_about_the_onset(tmp_path):
    params = cy.Parameters()
    near = neighbourhood(params, [0.045, 0.05, 0.055])
    found = compute_limits(params, [0.03, 0.06, 0.2])
    figure = limits.limits(found, near)
    assert {"corner", "pitchfork", "stable stripes", "no stripes"} <= set(words(figure))
    drawn = {tuple(line.get_ydata()) for line in figure.axes[0].lines}
    assert tuple(found.stable) in drawn
    style.save(figure, tmp_path / "limits.png")
    assert len(limits.limits(found).axes) == 2


def made_up_map():
    x, y = np.array([0.1, 0.2, 0.3]), np.array([0.1, 0.2])
    stable = np.zeros((len(STATES), 3, 2), dtype=bool)
    stable[STATES.index("cyclosis"), 1:] = True
    stable[STATES.index("unidirectional"), 2] = True
    stable[STATES.index("disordered"), 2] = True
    cause = np.full(stable.shape, "x")
    return RegimeMap("kappa", x, "alpha_u", y, STATES, stable, stable, cause, cy.Parameters(), 5.0)


def test_sets_of_stable_states_are_named_and_coloured(tmp_path):
    found = made_up_map()
    codes, sets = regime_map.regions(found)
    assert [[sets[code] for code in column] for column in codes] == [["-"] * 2, ["C"] * 2, ["C/U/D"] * 2]
    mixed = np.mean([to_rgb(regime_map.COLOURS[letter]) for letter in "CUD"], axis=0)
    assert regime_map.colour("C/U/D") == pytest.approx(mixed)
    assert regime_map.colour("C/U") == regime_map.COLOURS["C/U"]
    figure = regime_map.regime_map(found)
    assert {"C  cyclosis", "none of these", "C/U/D"} <= set(labels(figure))
    style.save(figure, tmp_path / "map.png")


def test_curves_over_kappa_are_exact():
    axes = (plane.Axis("kappa", np.linspace(0, 0.6, 7)), plane.Axis("alpha_u", np.linspace(0.3, 0.7, 5)))
    found = {curve.name: curve for curve in thresholds.thresholds(cy.Parameters(), axes)}
    tilt, rotation = found[thresholds.TILTS], found[thresholds.ROTATES]
    assert np.interp(0.5, tilt.y, tilt.x) == pytest.approx(0.470696, abs=1e-4)
    assert np.interp(0.5, rotation.y, rotation.x) == pytest.approx(0.048397, abs=1e-4)


@pytest.mark.slow
def test_existence_and_stability_over_alpha_p():
    axes = (plane.Axis("alpha_p", np.linspace(0.0, 0.2, 21)), plane.Axis("alpha_u", np.linspace(0, 0.4, 9)))
    found = {curve.name: curve for curve in thresholds.thresholds(cy.Parameters(), axes)}
    exists, stable = found[thresholds.EXISTS], found[thresholds.STABLE]
    assert np.interp(0.0, exists.x, exists.y) == pytest.approx(0.2267, abs=1e-3)
    onset = int(np.argmin(np.abs(stable.x - 0.05)))
    assert stable.x[onset] == pytest.approx(0.05, abs=1e-12)
    assert stable.y[onset] == pytest.approx(0.0674272, abs=1e-5)
    assert np.interp(0.1, stable.x, stable.y) == pytest.approx(7.47e-3, rel=0.2)


def test_branches_of_one_name_are_numbered(branch):
    assert bifurcation._named([branch] * 3)[1:] == [
        f"{bifurcation._named([branch])[0]} ({k})" for k in (2, 3)
    ]


def test_a_figure_of_nothing_is_refused(branch):
    with pytest.raises(cy.InputError, match="measures"):
        bifurcation.bifurcation([branch], measures=[])
    for options in ({"bases": []}, {"length": 0.0}):
        with pytest.raises(cy.InputError):
            dispersion(cy.Parameters(), **options)
