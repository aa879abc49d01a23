import numpy as np
import pytest
from scipy.stats import binomtest

import cyclosis as cy
from cyclosis.analysis.outcomes import separation
from cyclosis.analysis.wilson import wilson
from cyclosis.figures import basins, style, swept
from figures.sweeps import CODE, sweep

D, U, C, M = (CODE[name] for name in ("disordered", "unidirectional", "cyclosis", "multistripe"))
AXES = {"alpha_p": [0.1, 0.2, 0.3], "alpha_u": [0.05, 0.1]}
NUMBERS = np.geomspace(1.0, 1e4, 5)


@pytest.fixture(scope="module")
def figure5():
    return sweep()


@pytest.fixture
def small():
    """Two parameter points in C/U, one in C and one without members; five seeds."""
    data = sweep({"alpha_p": [0.1, 0.2], "alpha_u": [0.05, 0.1]}, seeds=5)
    codes = np.array([[[C, U, C, M, -1], [C, C, C, C, C]], [[U, U, C, C, U], [-1, -1, -1, -1, -1]]])
    k0 = np.array([1e-3, -2e-3, 1e-4, -1e-3, 5e-4])
    m1 = np.array([4e-3, 2e-3, 8e-4, 3e-3, 5e-4])
    data["regime"] = (data["regime"].dims, codes.astype(np.int8), data["regime"].attrs)
    data["initial_k0"], data["initial_m1"] = ("seed", k0), ("seed", m1)
    return data


def beside(data, select=None):
    return swept.swept(data, select, beside=(basins.NUMBER,))


def texts(figure):
    found = [text.get_text() for text in figure.texts]
    for ax in figure.axes:
        found += [ax.get_title("left"), ax.get_xlabel(), ax.get_ylabel()]
    return [text for text in found if text]


def test_members_are_those_of_both_outcomes_where_both_occur(small):
    found = basins.members(beside(small))
    assert found.cyclosis.tolist() == [True, False, True, False, False, True, True, False]
    assert found.point.tolist() == [0, 0, 0, 1, 1, 1, 1, 1]
    assert found.seed.tolist() == [0, 1, 2, 0, 1, 2, 3, 4]
    np.testing.assert_allclose(found.ratio, [4, 1, 8, 4, 1, 8, 3, 1])


def test_states_are_merged_over_points(small):
    k0, m1, share = basins.states(basins.members(beside(small)))
    assert k0.tolist() == [1e-4, 5e-4, 1e-3, 1e-3, 2e-3]
    assert m1.tolist() == [8e-4, 5e-4, 3e-3, 4e-3, 2e-3]
    assert share.tolist() == [1.0, 0.0, 1.0, 0.5, 0.0]


def test_lines_of_the_points_and_of_all(small):
    found = basins.members(beside(small))
    lines = basins.line_by_point(found)
    assert lines[0].threshold == pytest.approx(2.0)
    assert lines[0].correct == 1.0
    # Between 1 and 3 only the member at 4 is wrong, between 4 and 8 only that at 3: the wider gap is taken.
    assert lines[1].threshold == pytest.approx(np.sqrt(3))
    assert lines[1].correct == 0.8
    assert basins.predicted(lines, found) == pytest.approx(7 / 8)
    together = separation(found.ratio, found.cyclosis)
    assert together.threshold == pytest.approx(np.sqrt(3))
    assert together.correct == 7 / 8
    assert together.guess == 0.5


def test_bins_of_ratios_count_every_seed_once(figure5):
    found = basins.members(beside(figure5))
    shares = basins.by_ratio(found)
    assert shares.at.size == 5
    assert np.all(np.diff(shares.at) > 0)
    assert np.all(np.diff(shares.share) > 0)
    edges = np.quantile(found.ratio, np.linspace(0, 1, 6))
    inside = (found.ratio >= edges[2]) & (found.ratio < edges[3])
    share, trials = found.cyclosis[inside].mean(), np.unique(found.seed[inside]).size
    assert shares.share[2] == pytest.approx(share)
    low, high = wilson(share * trials, trials)
    assert (shares.low[2], shares.high[2]) == (pytest.approx(float(low)), pytest.approx(float(high)))


def test_share_against_the_number_of_filaments():
    data = sweep({"filaments_per_square": NUMBERS[::-1]}, alpha_p=0.2, alpha_u=0.08, seeds=60)
    shares = basins.by_number(beside(data))
    np.testing.assert_array_equal(shares.at, NUMBERS)
    hits = np.sum(data["regime"].values[::-1] == C, axis=1)
    np.testing.assert_allclose(shares.share, hits / 60)
    for k, count in enumerate(hits):
        exact = binomtest(int(count), 60).proportion_ci(method="wilson")
        assert (shares.low[k], shares.high[k]) == (pytest.approx(exact.low), pytest.approx(exact.high))


def test_a_seed_is_one_trial_over_all_points_and_missing_ones_are_none():
    data = sweep(AXES | {"filaments_per_square": NUMBERS}, seeds=20)
    codes = data["regime"].values.copy()
    codes[..., 0, :] = -1
    codes[..., 1, 15:] = -1
    data["regime"] = (data["regime"].dims, codes, data["regime"].attrs)
    sweep_ = beside(data)
    shares = basins.by_number(sweep_)
    assert np.isnan([shares.share[0], shares.low[0]]).all()
    both = sweep_.regions == basins._BOTH
    regime = codes[both]
    np.testing.assert_allclose(shares.share[1], np.mean(regime[:, 1, :15] == C))
    exact = (wilson(shares.share[1] * 15, 15), wilson(shares.share[2] * 20, 20))
    assert (shares.low[1], shares.high[1]) == tuple(float(end) for end in exact[0])
    assert (shares.low[2], shares.high[2]) == tuple(float(end) for end in exact[1])


def test_the_figure_states_its_numbers(figure5):
    figure = basins.basins(figure5)
    found = basins.members(beside(figure5))
    lines = basins.line_by_point(found)
    one = separation(found.ratio, found.cyclosis)
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(style.WIDTH)
    assert len(figure.axes) == 4  # and the key of the map
    sentence = figure.texts[0].get_text()
    for number in (one.correct, one.guess, basins.predicted(lines, found)):
        assert f"{100 * number:.0f} %" in sentence
    assert f"{len(lines)} points in C/U" in sentence
    scatter, ratios, own = figure.axes[:3]
    assert scatter.get_title("left") == f"$m_1$ = {one.threshold:.2g} $k_0$"
    ends = scatter.lines[0].get_xydata()
    np.testing.assert_allclose(ends[:, 1] / ends[:, 0], one.threshold)
    k0, m1, share = basins.states(found)
    np.testing.assert_allclose(scatter.collections[0].get_offsets(), np.stack([k0, m1], axis=1))
    np.testing.assert_allclose(scatter.collections[0].get_array(), 100 * share)
    assert ratios.lines[-1].get_xdata()[0] == one.threshold
    drawn = own.collections[2].get_array().T
    where = np.argwhere(beside(figure5).regions == basins._BOTH)
    for k, line in lines.items():
        assert drawn[tuple(where[k])] == pytest.approx(line.threshold)


def test_panels_follow_the_axes():
    def labels(data, **options):
        return [label for label in texts(basins.basins(data, **options)) if "N$" in label or "α" in label]

    number = {"filaments_per_square": NUMBERS}
    assert len(labels(sweep(AXES | number))) == 3
    assert labels(sweep(number, alpha_p=0.2, alpha_u=0.08)) == ["$N$, filaments per grid square"]
    assert len(labels(sweep(AXES))) == 2
    assert labels(sweep(AXES), select={"alpha_p": 0.1}) == []
    assert labels(sweep(AXES | number), select={"alpha_p": 0.1, "filaments_per_square": 100.0}) == []


ODD = {
    "narrow": (lambda data: data, {"width": 140}),
    "logarithmic axes": (lambda data: data, {"log": ["alpha_p", "alpha_u"]}),
    "one axis": (lambda data: data.isel(alpha_u=0), {}),
    "two seeds": (lambda data: data.isel(seed=[2, 8]), {}),
    "no noise in some": (
        lambda data: data.assign(initial_m1=data["initial_m1"].where(data["seed"] > 9, 0.0)),
        {},
    ),
    "one amplitude for all": (lambda data: data.assign(initial_k0=0 * data["initial_k0"] + 1e-3), {}),
    "outcomes without reason": (
        lambda data: data.assign(initial_m1=data["initial_m1"][..., ::-1].assign_coords(seed=data["seed"])),
        {},
    ),
    "some missing": (lambda data: data.where(data["seed"] > 20), {}),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_sweeps_are_drawn(figure5, name, tmp_path):
    change, options = ODD[name]
    data = change(figure5)
    data["regime"].attrs = figure5["regime"].attrs
    figure = basins.basins(data, **options)
    assert any("runs at" in text for text in texts(figure))
    style.save(figure, tmp_path / "basins.pdf")


@pytest.mark.parametrize(
    ("change", "options", "words"),
    [
        (lambda data: data.drop_vars("initial_m1"), {}, "initial_m1"),
        (lambda data: data.isel(alpha_u=[-1]), {}, "both cyclosis and"),
        (lambda data: data.assign(initial_m1=0 * data["initial_m1"]), {}, "both cyclosis and"),
        (lambda data: data.expand_dims(kappa=[0.1, 0.2]), {}, "one or two"),
        (lambda data: data, {"select": {"kappa": 0.1}}, "select"),
        (lambda data: data, {"width": "wide"}, "width"),
        (lambda data: 3, {}, "dataset"),
    ],
)
def test_what_cannot_be_drawn_is_refused(figure5, change, options, words):
    with pytest.raises(cy.InputError, match=words):
        basins.basins(change(figure5), **options)
