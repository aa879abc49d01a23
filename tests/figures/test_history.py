import json
import re

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.figures import clock, style, theory
from cyclosis.figures.history import history

GRID = cy.CylinderGrid(160, 8, 5.0)
TIMES = np.arange(0.0, 9.0)
CONFIGURATION = {
    "parameters": dict(cy.Parameters().items()),
    "run": {"terms": [term.name for term in cy.TERMS]},
}


def dataset(P, u, configuration=CONFIGURATION, record="time"):
    """A run of nine frames that grows to P and u, with quantities of the right shapes."""
    share = (TIMES / 8)[:, None, None, None]
    zones = cy.zones.zone_angles(P[1].mean(axis=1))
    widths = cy.zones.stripe_widths(zones)
    steps = TIMES if record == "time" else np.linspace(0, 8, 33)
    data = {
        name: (("time", "component", "theta", "z"), share * field) for name, field in (("P", P), ("u", u))
    }
    for name, values in (("zone_angle", zones), ("stripe_width", widths)):
        data[name] = (("time", "zone"), np.tile(np.append(values, np.nan), (9, 1)))
    for name in ("order", "peak_speed", "rms_speed"):
        data[name] = (record, steps / 8)
    for name, factor in (("power_input", 1.0), ("viscous_dissipation", 0.2), ("friction_dissipation", 0.8)):
        data[name] = (record, factor * steps / 8)
    data["mean_P"] = ((record, "component"), np.stack([0 * steps, 0.1 * steps / 8], axis=1))
    coords = {"time": TIMES, "component": ["theta", "z"], "theta": GRID.theta, "z": GRID.z, record: steps}
    return xarray.Dataset(data, coords, {"length": 5.0, "configuration": json.dumps(configuration)})


def straight(values):
    return np.stack([np.zeros(GRID.shape), values[:, None] + np.zeros(GRID.shape)])


@pytest.fixture(scope="module")
def steady():
    P, u = cy.stability.cyclosis(cy.Parameters()).at(GRID.theta, zone=1.0)
    return dataset(straight(P), straight(u))


def notes(figure):
    return [text.get_text() for ax in figure.axes for text in ax.texts]


@pytest.mark.parametrize("width", [80.0, 89.0, 149.0, 150.0])
def test_a_narrow_history_has_two_panels_in_a_row_and_nothing_overlaps(steady, width):
    figure = history(steady, width)
    figure.canvas.draw()
    boxes = [ax.get_tightbbox().transformed(figure.transFigure.inverted()) for ax in figure.axes]
    assert len({round(ax.get_position().x0, 3) for ax in figure.axes}) == (3 if width >= 150 else 2)
    for k, box in enumerate(boxes):
        assert box.x0 >= 0
        assert box.x1 <= 1.001
        assert box.y0 >= -0.001
        assert box.y1 <= 1
        assert width >= 150 or not any(box.overlaps(other) for other in boxes[:k])
    with pytest.raises(cy.InputError, match="width"):
        history(steady, 79.0)


def test_six_panels_with_labels_from_the_table(steady):
    figure = history(steady)
    assert len(figure.axes) == 6
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(style.WIDTH)
    legends = [
        text.get_text() for ax in figure.axes if ax.get_legend() for text in ax.get_legend().get_texts()
    ]
    assert r"$\langle |\mathbf{P}|^2\rangle ^{1/2}$" in legends
    assert {style.mathtext("μ <|∇u|²>"), style.mathtext("<F·u>"), style.mathtext("<|u|²>")} <= set(legends)
    assert {"up", "down", "run", "theory"} <= set(legends)


def test_the_difference_from_theory_is_stated(steady):
    shifted = steady.copy()
    shifted["u"] = steady["u"] + 0.002
    first, second = notes(history(shifted))
    assert re.search(r"10\^\{-(8|9|\d\d)\}", first)
    assert second == r"largest difference $2 \times 10^{-3}$"


def test_the_theory_is_put_at_the_zone_that_turns_upward(steady):
    line = history(steady).axes[4].lines[-1]
    rising = np.interp(1.0 + np.array([-0.1, 0.0, 0.1]), line.get_xdata(), line.get_ydata())
    assert rising[0] < -0.2 < rising[1] + 0.2
    assert rising[2] > 0.2


def test_quantities_may_have_their_own_times(steady):
    P, u = (steady[name].values[-1] for name in ("P", "u"))
    figure = history(dataset(P, u, record="record_time"))
    assert figure.axes[0].lines[0].get_xdata().size == 33


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"parameters": {"alpha_u": "field"}}, np.sin(GRID.theta), "these parameters"),
        ({"parameters": {"alpha_p": 0.01, "alpha_u": 0.05}}, np.sin(GRID.theta), "these parameters"),
        ({"run": {"terms": ["bundling"]}}, np.sin(GRID.theta), "these terms"),
        ({"run": {"terms": [*CONFIGURATION["run"]["terms"], "mine"]}}, np.sin(GRID.theta), "these terms"),
        ({}, np.sin(2 * GRID.theta), "no two-stripe state"),
        ({}, 0.5 + 0 * GRID.theta, "no two-stripe state"),
    ],
)
def test_where_there_is_no_theory_a_few_words_say_so(changes, field, words):
    configuration = {name: table | changes.get(name, {}) for name, table in CONFIGURATION.items()}
    data = dataset(straight(0.9 * field), straight(0.5 * field), configuration)
    assert words in theory.expected(data)
    assert all(words in note for note in notes(history(data)))


def test_bad_datasets_are_refused(steady):
    with pytest.raises(cy.InputError, match="power_input"):
        history(steady.drop_vars("power_input"))
    with pytest.raises(cy.InputError, match="saved frames"):
        history(steady.isel(time=[0]))
    with pytest.raises(cy.InputError, match="dataset"):
        history(None)
    with pytest.raises(cy.InputError, match="width"):
        history(steady, width=10)


@pytest.mark.parametrize(("first", "last"), [(0, 200), (0, 0.3), (50, 60), (0, 1e5), (7, 7.01)])
def test_ticks_keep_their_distance(first, last):
    ticks = clock.ticks(first, last)
    assert ticks[0] == first
    assert ticks[-1] <= last
    places = np.sqrt((np.array(ticks) - first) / (last - first))
    assert len(ticks) >= 3
    assert np.all(np.diff(places) > 0.13)


def test_symbols_are_set_as_mathematics():
    assert style.mathtext("max |u|") == r"$\max\,|\mathbf{u}|$"
    for item in cy.diagnostics.QUANTITIES:
        assert "½" not in style.mathtext(item.symbol)


def test_the_theory_is_that_of_the_parameters_at_the_end():
    step = {"at": 4.0, "action": "change", "alpha_p": 0.01, "alpha_u": 0.05}
    P, u = straight(0.9 * np.sin(GRID.theta)), straight(0.5 * np.sin(GRID.theta))
    found = [
        theory.expected(dataset(P, u, CONFIGURATION | {"protocol": steps}))
        for steps in ([step], [step, {"at": 6.0, "action": "wash_out"}])
    ]
    assert found[0] == "no theory for these parameters"
    assert np.array_equal(found[1].P, theory.expected(dataset(P, u)).P)
