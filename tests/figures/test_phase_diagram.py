import json

import numpy as np
import pytest
from scipy.stats import binomtest

import cyclosis as cy
from cyclosis.analysis.outcomes import REGIONS
from cyclosis.figures import phase_diagram, plane, style, swept, thresholds
from cyclosis.stability.uniform import dispersion
from figures.sweeps import FIGURE5, PARAMETERS, C, D, M, U, colours, sweep, texts, with_regimes

SMALL = {"alpha_p": [0.1, 0.2, 0.4], "alpha_u": [0.05, 0.15]}


@pytest.fixture(scope="module", autouse=True)
def _few_places():
    """Curves that take Newton's method, at few places: what they are is tested elsewhere."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(thresholds, "PLACES", 6)
        yield


@pytest.fixture(scope="module")
def figure5():
    return sweep()


@pytest.fixture
def small():
    """Three by two points of four members, with a point in D, one in C, one in C/U, and one without any."""
    codes = [
        [[D, D, D, D], [U, C, C, C]],
        [[C, C, C, C], [C, C, C, -1]],
        [[-1, -1, -1, -1], [C, C, M, -1]],
    ]
    return with_regimes(sweep(SMALL, seeds=4), np.array(codes, dtype=np.int8))


def lightness(colour):
    return colour[..., :3] @ [0.2126, 0.7152, 0.0722]


# Axes


def test_cells_meet_halfway_between_the_values():
    np.testing.assert_allclose(swept.axis("kappa", [0.1, 0.2, 0.4]).edges, [0.05, 0.15, 0.3, 0.5])
    log = swept.axis("kappa", [0.1, 1.0, 10.0])
    np.testing.assert_allclose(log.edges, 0.1 * 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5]))
    alone = swept.axis("kappa", [0.3])
    assert alone.edges[0] < 0.3 < alone.edges[1]
    assert swept.axis("kappa", [0.0]).edges[0] < 0


@pytest.mark.parametrize(
    ("values", "log"),
    [
        (FIGURE5["alpha_p"], False),
        (np.geomspace(0.025, 1, 20), True),
        ([1, 3, 10, 30, 100], True),
        ([0.0, 0.1, 10.0], False),
        ([0.1, 10.0], False),
        ([0.1, 0.2, 0.4], False),
    ],
)
def test_the_scale_is_that_on_which_values_are_even(values, log):
    assert swept.axis("kappa", values).log is log


def test_axes_are_labelled_by_the_symbols_of_the_definitions():
    assert swept.axis("alpha_p", [1.0]).symbol == "$α_p$"
    assert swept.axis("d_s", [1.0]).symbol == "$d^{(s)}$"
    assert swept.axis("length", [1.0]).symbol == r"$\ell$"
    assert swept.axis("my_axis", [1.0]).symbol == "my axis"


# What is taken from a dataset


def test_outcomes_of_a_small_sweep(small):
    found = swept.swept(small)
    assert [axis.name for axis in found.axes] == ["alpha_p", "alpha_u"]
    assert found.trials.tolist() == [[4, 4], [4, 3], [0, 3]]
    np.testing.assert_array_equal(found.share, [[0, 0.75], [1, 1], [np.nan, 2 / 3]])
    names = [*REGIONS, "missing"]
    assert [[names[k] for k in row] for row in found.regions] == [
        ["D", "C/U"],
        ["C", "C"],
        ["missing", "mixed"],
    ]
    assert found.disordered.tolist() == [[True, False], [False, False], [False, False]]
    assert found.present == ["disordered", "unidirectional", "cyclosis", "multistripe"]
    assert found.summary == "18 runs, 0 to 4 at each point, 6 missing"
    assert swept.swept(sweep()).summary == "20\N{THIN SPACE}000 runs, 50 at each point"


def test_doubtful_members_are_mentioned(small):
    small["status"][0, 1, :3] = 2
    small["status"][1, 0, 0] = 3
    assert swept.swept(small).summary.endswith("6 missing, 3 underresolved, 1 diverged")
    small["status"].attrs = {}
    assert swept.swept(small).summary.endswith("6 missing")


def test_percentages_and_intervals(small):
    percent, low, high = phase_diagram.percentages(swept.swept(small))
    np.testing.assert_allclose(percent, [[0, 75], [100, 100], [np.nan, 200 / 3]])
    exact = binomtest(3, 4).proportion_ci(method="wilson")
    assert (low[0, 1], high[0, 1]) == (pytest.approx(100 * exact.low), pytest.approx(100 * exact.high))
    assert np.isnan([percent[2, 0], low[2, 0], high[2, 0]]).all()


def test_other_codes_orders_and_decoded_files_mean_the_same(small):
    expected = swept.swept(small).regime
    decoded = small.assign(regime=small["regime"].where(small["regime"] >= 0))
    decoded["regime"].attrs = small["regime"].attrs
    assert decoded["regime"].dtype.kind == "f"
    turned = small.transpose("seed", "alpha_u", "alpha_p")
    shuffled = small.isel(alpha_p=[2, 0, 1], alpha_u=[1, 0])
    attrs = {"flag_values": [10, 12, 11], "flag_meanings": "cyclosis unidirectional multistripe"}
    renamed = small["regime"].copy(data=np.array([-1, 12, 10, 11, -1, -1, -1, -1])[small["regime"].values])
    renamed.attrs = attrs
    np.testing.assert_array_equal(swept.swept(decoded).regime, expected)
    np.testing.assert_array_equal(swept.swept(shuffled).regime, expected)
    np.testing.assert_array_equal(swept.swept(turned).regime, np.swapaxes(expected, 0, 1))
    again = swept.swept(small.assign(regime=renamed)).regime
    np.testing.assert_array_equal(again, np.where(expected == D, -1, expected))


def test_further_axes_are_chosen_by_select_and_single_values_drop_out():
    data = sweep(SMALL | {"kappa": [0.3, 0.5], "mu": [0.2]}, seeds=3)
    found = swept.swept(data, {"kappa": 0.3})
    assert [axis.name for axis in found.axes] == ["alpha_p", "alpha_u"]
    assert (found.params.kappa, found.params.mu) == (0.3, 0.2)
    np.testing.assert_array_equal(found.regime, swept.swept(data.isel(kappa=0, mu=0, drop=True)).regime)
    assert [axis.name for axis in swept.swept(data, {"alpha_u": 0.15, "alpha_p": 0.1}).axes] == ["kappa"]


@pytest.mark.parametrize(
    ("change", "options", "words"),
    [
        (lambda data: None, {}, "dataset"),
        (lambda data: data.drop_vars("regime"), {}, "dataset"),
        (lambda data: data.isel(seed=0), {}, "dimensions"),
        (lambda data: data.drop_vars("kappa"), {}, "dimensions"),
        (lambda data: data, {}, "axes to draw"),
        (lambda data: data, {"select": {"kappa": 0.4}}, "0.3, 0.5"),
        (lambda data: data, {"select": {"kappa": "x"}}, "number"),
        (lambda data: data, {"select": {"alpha_x": 0.4}}, "alpha_x"),
        (lambda data: data.isel(kappa=0), {"select": {"alpha_p": 0.1, "alpha_u": 0.05}}, "none"),
        (lambda data: data.isel(kappa=0), {"log": ["kappa"]}, "log"),
        (lambda data: data.isel(kappa=0).assign_coords(alpha_u=[0.0, 1.0]), {"log": ["alpha_u"]}, "above 0"),
        (lambda data: data.isel(kappa=0), {"cuts": [0.07]}, "alpha_u = 0.07"),
        (lambda data: data.isel(kappa=0), {"cuts": []}, "number of cuts"),
        (lambda data: data.isel(kappa=0), {"width": 50}, "width"),
        (lambda data: data.isel(kappa=0), {"curves": [("x", [1, 2], [1])]}, "curve"),
        (lambda data: data.isel(kappa=0), {"curves": [3]}, "curve"),
    ],
)
def test_what_cannot_be_drawn_is_refused(change, options, words):
    data = change(sweep(SMALL | {"kappa": [0.3, 0.5]}, seeds=2))
    with pytest.raises(cy.InputError, match=words):
        phase_diagram.phase_diagram(data, **options)


def test_unknown_regimes_are_refused(small):
    small["regime"].attrs["flag_meanings"] = "asleep awake"
    with pytest.raises(cy.InputError, match="regimes"):
        phase_diagram.phase_diagram(small)


# Theory


def curve(name, axes, params=None):
    found = thresholds.thresholds(params or cy.Parameters(), axes)
    return next(curve for curve in found if curve.name == name)


def test_closed_forms_over_the_paper_s_axes():
    x, y = (swept.axis(name, values) for name, values in FIGURE5.items())
    for name, exact in (
        (thresholds.TILT, dispersion.tilt_threshold),
        (thresholds.STRIPES, dispersion.stripes_threshold),
    ):
        line = curve(name, (x, y))
        np.testing.assert_array_equal(line.y, exact(cy.Parameters(), line.x))
        assert np.isnan(line.y[line.x <= 0.025]).all()
        turned = curve(name, (y, x))
        np.testing.assert_array_equal(turned.x, line.y)
        np.testing.assert_array_equal(turned.y, line.x)
    assert set(curve(thresholds.DISORDER, (x, y)).x) == {0.025}


def test_closed_forms_over_other_axes():
    alpha_u, kappa = swept.axis("alpha_u", [0.1, 0.2]), swept.axis("kappa", [0.1, 0.5])
    line = curve(thresholds.TILT, (kappa, alpha_u))
    inside = line.x >= 0
    np.testing.assert_allclose(line.y[inside], line.x[inside] / 0.975)
    assert np.isnan(line.y[~inside]).all()
    length = swept.axis("length", [4.0, 5.0])
    assert set(curve(thresholds.TILT, (length, alpha_u)).y) == {0.5 / 0.975}
    assert set(curve(thresholds.TILT, (alpha_u,)).x) == {0.5 / 0.975}
    assert set(curve(thresholds.DISORDER, (swept.axis("d_r", [0.1, 0.2]), kappa)).x) == {1.0}
    diagonal = curve(thresholds.DISORDER, (swept.axis("alpha_p", [0.1, 0.2]), swept.axis("d_r", [0.1, 0.3])))
    np.testing.assert_array_equal(diagonal.x, diagonal.y)
    assert thresholds.thresholds(cy.Parameters(), (kappa, length)) == []


@pytest.mark.parametrize(
    "configuration",
    [
        {"parameters": PARAMETERS, "run": {"terms": ["bundling", "diffusion"]}},
        {"parameters": PARAMETERS | {"kappa": -1.0}},
        {"parameters": PARAMETERS | {"kappa": [[0.5] * 8] * 8}},
        {"parameters": PARAMETERS | {"wrong": 1.0}},
        {"parameters": PARAMETERS, "protocol": [{"at": 1.0, "action": "wash_out"}]},
        [],
    ],
)
def test_where_no_theory_applies_none_is_drawn(configuration):
    data = sweep(SMALL, seeds=2, configuration=configuration)
    assert swept.swept(data).params is None
    assert not [text for text in texts(phase_diagram.phase_diagram(data)) if "beyond" in text]
    data.attrs = {}
    assert swept.swept(data).params is None


def test_with_repulsion_along_the_cell_only_disorder_has_a_threshold():
    data = sweep(SMALL, seeds=2, configuration={"parameters": PARAMETERS | {"repulsion_angle": np.pi / 2}})
    found = swept.swept(data)
    assert [line.name for line in thresholds.thresholds(found.params, found.axes)] == [thresholds.DISORDER]


# Regions and cuts


def test_borders_run_between_different_regions_that_are_known():
    x, y = swept.axis("a", [0.0, 1.0]), swept.axis("b", [0.0, 1.0])
    lines = plane.borders(x, y, np.array([[0, 1], [0, 0]]))
    assert sorted(line.tolist() for line in lines) == [[[-0.5, 0.5], [0.5, 0.5]], [[0.5, 0.5], [0.5, 1.5]]]
    assert plane.borders(x, y, np.array([[0, -1], [0, -1]])) == []


def test_names_stand_where_regions_have_most_room():
    x, y = swept.axis("a", np.arange(10.0)), swept.axis("b", np.arange(10.0))
    inside = np.zeros((10, 10), dtype=bool)
    inside[0, 0] = inside[4:9, 5:10] = True
    at = plane.roomiest(x, y, inside, [], 1.0)
    assert at == (pytest.approx(6.0, abs=0.2), pytest.approx(7.0, abs=0.2))
    across = thresholds.BorderCurve("c", np.linspace(-1, 12, 500), np.full(500, 6.5))
    assert plane.roomiest(x, y, inside, [across], 1.0)[1] == pytest.approx(8.0, abs=0.2)


def test_cuts_cross_the_mixed_points(figure5):
    found = swept.swept(figure5)
    assert phase_diagram.chosen_cuts(found) == [3, 2, 1, 0]
    assert phase_diagram.chosen_cuts(found, [0.025, 1.0, 0.128]) == [19, 2, 0]
    whole = swept.swept(with_regimes(figure5, C))
    assert phase_diagram.chosen_cuts(whole) == [19, 13, 6, 0]
    assert phase_diagram.chosen_cuts(swept.swept(sweep(SMALL, seeds=2)), [0.15]) == [1]


# Figures


def test_figure5(figure5):
    figure = phase_diagram.phase_diagram(figure5)
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(style.WIDTH)
    percent = phase_diagram.percentages(swept.swept(figure5))[0]
    np.testing.assert_array_equal(colours(figure.axes[0]), percent.T)
    found = texts(figure)
    assert {"D", "C", "C/U", "$α_p$", "$α_u$", "% cyclosis"} <= set(found)
    assert {thresholds.DISORDER, thresholds.TILT, thresholds.STRIPES} <= set(found)
    assert [text for text in found if "=" in text and text.startswith("$α_u$")] == [
        "$α_u$ = 0.179",
        "$α_u$ = 0.128",
        "$α_u$ = 0.0763",
        "$α_u$ = 0.025",
    ]
    assert any("000 runs, 50 at each point" in text for text in found)
    cuts = [ax for ax in figure.axes if "=" in ax.get_title("left")]
    np.testing.assert_array_equal(cuts[-1].lines[0].get_ydata(), percent[:, 0])
    bars = [segment[:, 1] for segment in cuts[-1].collections[1].get_segments()]
    _, low, high = phase_diagram.percentages(swept.swept(figure5))
    np.testing.assert_allclose(bars, np.stack([low[:, 0], high[:, 0]], axis=1))


def test_names_of_regions_lie_in_them(figure5):
    figure = phase_diagram.phase_diagram(figure5)
    found = swept.swept(figure5)
    x, y = found.axes
    for text in figure.axes[0].texts:
        i, j = (
            np.searchsorted(axis.edges, at) - 1 for axis, at in zip((x, y), text.get_position(), strict=True)
        )
        assert list(REGIONS)[found.regions[i, j]] == text.get_text()


def test_curves_of_the_caller_join_the_theory(figure5):
    figure = phase_diagram.phase_diagram(figure5, curves=[("mine", [0.1, 0.9], [0.3, 0.4])])
    line = next(line for line in figure.axes[0].lines if line.get_label() == "mine")
    assert line.get_xydata().tolist() == [[0.1, 0.3], [0.9, 0.4]]
    assert "mine" in texts(figure)


def test_missing_points_stay_hatched(small):
    figure = phase_diagram.phase_diagram(small)
    assert colours(figure.axes[0]).mask.tolist() == [[False, False, True], [False, False, False]]
    assert figure.axes[0].patches[0].get_hatch() == plane.MISSING
    assert any("6 missing" in text for text in texts(figure))
    assert any("unnamed" in text for text in texts(figure))


def test_one_axis_is_a_curve_with_its_band_and_regions(figure5):
    figure = phase_diagram.phase_diagram(figure5, select={"alpha_p": 0.127})
    ax, strip = figure.axes
    percent, low, high = phase_diagram.percentages(swept.swept(figure5, {"alpha_p": 0.127}))
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), percent)
    band = ax.collections[0].get_paths()[0].vertices
    assert (band[:, 1].min(), band[:, 1].max()) == (low.min(), high.max())
    assert [text.get_text() for text in strip.texts] == ["C/U", "C"]
    assert {thresholds.TILT, thresholds.STRIPES} <= set(texts(figure))


ODD = {
    "one seed": lambda data: data.isel(seed=[0]),
    "one axis": lambda data: data.isel(alpha_u=0),
    "one point": lambda data: data.isel(alpha_p=[3], alpha_u=[2]),
    "one row": lambda data: data.isel(alpha_p=[3]),
    "two by two": lambda data: data.isel(alpha_p=[0, 3], alpha_u=[0, 9]),
    "all missing": lambda data: with_regimes(data, -1),
    "one axis, all missing": lambda data: with_regimes(data, -1).isel(alpha_p=0),
    "some missing": lambda data: with_regimes(data, np.where(np.arange(50) < 30, data["regime"], -1)),
    "log axes": lambda data: data.assign_coords(alpha_p=np.geomspace(1e-3, 10, 20)),
    "negative values": lambda data: data.assign_coords(alpha_p=-data["alpha_p"]).rename(
        alpha_p="repulsion_angle"
    ),
    "every regime": lambda data: with_regimes(data, np.arange(50) % 7),
    "axes of another kind": lambda data: data.rename(alpha_p="kappa", alpha_u="length"),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_sweeps_are_drawn(figure5, name, tmp_path):
    data = ODD[name](figure5)
    for draw in (phase_diagram.phase_diagram, phase_diagram.regimes_and_time):
        figure = draw(data)
        assert figure.axes
        assert any("runs" in text for text in texts(figure))
        figure.canvas.draw()
    style.save(figure, tmp_path / "odd.pdf")


def test_logarithmic_axes_on_request(figure5):
    figure = phase_diagram.phase_diagram(figure5, log=["alpha_p", "alpha_u"])
    ax = figure.axes[0]
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert phase_diagram.phase_diagram(figure5, log=["alpha_u"]).axes[0].get_xscale() == "linear"


@pytest.mark.parametrize("colours", [plane.SHARE, plane.SOME, plane.TIME])
def test_colours_grow_darker_all_along(colours):
    shades = lightness(colours(np.linspace(0, 1, 200)))
    assert np.all(np.diff(shades) <= 1e-9)
    assert shades[0] - shades[-1] > 0.5


def test_the_configuration_is_that_of_the_run():
    assert json.loads(sweep(SMALL, seeds=1).attrs["configuration"])["parameters"]["kappa"] == 0.5


@pytest.mark.parametrize("name", ["force_exponent", "repulsion_angle"])
def test_no_limits_of_stripes_are_drawn_over_what_they_depend_on_unknown(name):
    axes = (swept.axis(name, [0.0, 1.5]), swept.axis("alpha_u", [0.05, 0.5]))
    names = [line.name for line in thresholds.thresholds(cy.Parameters(), axes)]
    assert thresholds.STABLE not in names
    assert thresholds.EXISTS not in names


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("protocol.wash.at", "time of wash"),
        ("protocol.2.over", "duration of 2"),
        ("protocol.wound.where.radius", "radius of wound"),
        ("protocol.drug.alpha_u", "α_u of drug"),
        ("alpha_u", "$α_u$"),
    ],
)
def test_axes_over_a_protocol_are_named_in_words(name, label):
    assert swept.axis(name, [0.1, 0.2]).symbol == label
