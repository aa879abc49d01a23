"""Closed cells against the cylinder: how they are compared, and verdicts on made-up ends."""

import numpy as np
import pytest
import scipy.stats
import xarray

import cyclosis as cy
from cyclosis.experiments import closed_cells, closed_views, ends, ends_figure, ends_growth
from cyclosis.experiments import ends_verdict as subject
from cyclosis.experiments.closed_cells import CAPSULE, CYLINDER, PRINCIPAL, SHAPES, SPHEROID, End

GRID = cy.ClosedGrid(cy.Capsule(2.0), k_max=8)
ONE, TWO, OTHER = (subject.REGIMES.index(name) for name in ("source-to-sink", "cyclosis", "undecided"))
PLACES = ("U", "C/U", "C")


def made(capsule=(ONE, None, TWO), spheroid=(ONE, None, TWO), growing=True):
    """Return data at α_p = 0.5 and three α_u: one stream, either, two; None is what cylinders have there."""
    either = np.where(np.arange(20) % 2, ONE, TWO)
    cylinder = np.stack([np.full(20, ONE), either, np.full(20, TWO)])
    end = np.zeros((3, 1, 3, 20, len(End._fields)))
    end[0, 0, ..., 0] = cylinder
    for k, given in enumerate((capsule, spheroid)):
        end[k + 1, 0, ..., 0] = [
            own if regime is None else np.full(20, regime)
            for own, regime in zip(cylinder, given, strict=True)
        ]
        end[k + 1, 0, :, 10:] = np.nan
    grows = np.full((2, 1, 3, 3), -0.5)
    grows[0, ..., 1] = 0.02 if growing else -0.02
    epsilon = np.array([0.0, 0.05, 0.1])
    over = np.stack([np.stack([0 * epsilon, epsilon - 0.02, -epsilon], axis=-1)] * 2)
    picture = closed_views.seen(GRID, cy.closed.rotation(GRID), cy.closed.rotation(GRID), 0.0)
    names = [f"{shape}, {alpha_p:g}, {alpha_u:g}" for shape, alpha_p, alpha_u in ends_growth.PUSHED]
    return xarray.Dataset(
        {
            "end": (("shape", "alpha_p", "alpha_u", "seed", "number"), end),
            "growth": (("closed", "alpha_p", "alpha_u", "wave"), grows),
            "over_epsilon": (("without", "weak_alpha_u", "epsilon", "wave"), np.stack([over] * 3)),
            "parts": (("pushed", "defect", "part"), np.full((3, 2, len(ends_growth.PARTS)), 0.01)),
            "line": (("other", "line_alpha_u", "line_seed", "number"), end[:1, 0]),
            "fine": (("point", "fine_seed", "number"), end[1, 0, 2:, :10]),
            "picture": (("frame", "field", "across", "up"), np.stack([picture] * 4)),
        },
        {
            "shape": list(SHAPES),
            "alpha_p": [0.5],
            "alpha_u": [0.0125, 0.05, 1.0],
            "number": list(End._fields),
            "closed": list(SHAPES[1:]),
            "wave": list(ends_growth.WAVES),
            "without": ["nothing", "advection", "shear"],
            "weak_alpha_u": [0.0, 0.025],
            "epsilon": epsilon,
            "pushed": names,
            "defect": list(ends_growth.WAVES[1:]),
            "part": list(ends_growth.PARTS),
            "other": ["cylinder 7, principal"],
            "line_alpha_u": [0.0125, 0.05, 1.0],
            "point_shape": ("point", [CAPSULE]),
            "point_k_max": ("point", [24.0]),
            "point_alpha_p": ("point", [1.0]),
            "point_alpha_u": ("point", [0.5]),
        },
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made(), "agrees"),
        (made(capsule=(TWO, TWO, TWO)), "in part"),
        (made(spheroid=(ONE, ONE, TWO)), "in part"),  # 0 of 10 against 10 of 20: p = 0.009
        (made(spheroid=(OTHER, ONE, TWO)), "in part"),
        (made(spheroid=(ONE, None, ONE)), "does not"),
    ],
)
def test_the_verdict_follows_from_the_data(data, outcome):
    assert subject.verdict(data).outcome == outcome


def test_places_and_shares_are_counted():
    data = made(capsule=(TWO, TWO, TWO), spheroid=(OTHER, ONE, TWO))
    where = subject.regions(data)
    assert where["C"].tolist() == [[False, False, True]]
    assert where["C/U"].tolist() == [[False, True, False]]
    assert subject.differs(data, CAPSULE).tolist() == [[True, False, False]]
    assert subject.share(data, CYLINDER, where["C/U"], 1) == (10, 20)
    assert subject.share(data, SPHEROID, where["C/U"], 0) == (10, 10)
    words = subject.verdict(data).measured
    assert "10 of 20 of them, but 10 of 10 capsules and 0 of 10 spheroids have two" in words
    assert "Capsules differ beyond chance at 1 and spheroids at 1 of 3 places, 0 of them" in words
    assert subject.decisive(data).startswith("10 of 10 capsules and 0 of 10 spheroids")


def test_ends_with_one_stream_that_grow_apart_are_transient():
    assert subject.transient(made(), CAPSULE) == (15, 15)
    assert subject.transient(made(growing=False), CAPSULE) == (0, 15)
    assert subject.onset(made(), 0.0) == pytest.approx(0.02)


def test_seeds_are_compared_as_wholes():
    assert subject.overall(made(), CAPSULE) > 0.9
    assert subject.overall(made(capsule=(ONE, ONE, TWO)), CAPSULE) < 0.025
    many = made(capsule=(ONE, ONE, TWO)).isel(alpha_p=[0] * 5)  # the same seeds at more places
    assert subject.overall(many, CAPSULE) > 1e-3
    assert subject.overall(made().isel(alpha_u=[2]), CAPSULE) == 1.0


def test_the_test_is_fishers_for_the_kind_that_differs_most():
    ours, theirs = np.array([0, 9, 1]), np.array([14, 6, 0])
    expected = min(
        scipy.stats.fisher_exact([[a, 10 - a], [b, 20 - b]]).pvalue for a, b in zip(ours, theirs, strict=True)
    )
    assert subject.fisher(ours, theirs) == expected < 1e-3


def test_the_figure_shows_cells_and_maps():
    assert len(ends_figure.draw(made(capsule=(TWO, TWO, TWO))).axes) == 4 + 4
    stripes = ends_figure._stripes(np.array([1, 0, 1, 1, -1]))
    assert np.bincount(stripes).tolist() == [5, 15]


def test_more_seeds_are_computed_where_the_first_ends_are_mixed(monkeypatch):
    asked = []

    def made_up(lab, cells, seeds):
        asked.append((cells, seeds))
        found = np.zeros((len(cells), len(seeds), len(End._fields)))
        found[1:, :, 0] = np.where(np.arange(len(seeds)) == 1, TWO, ONE)
        found[0, :, 0] = ONE
        return found

    class Lab:
        quick, seeds = False, 10

    monkeypatch.setattr(ends, "_ends", made_up)
    found = ends._table(Lab(), [(CAPSULE, 1), (CAPSULE, 2)])
    assert asked == [([(CAPSULE, 1), (CAPSULE, 2)], range(10)), ([(CAPSULE, 2)], range(10, 20))]
    assert np.isnan(found[0, 10:]).all()
    assert not np.isnan(found[1]).any()
    words = subject.verdict(made()).measured
    assert "At k_max 24: 10 of 10 capsules at (1, 0.5)" in words
    assert "cylinder 7: 0 of 20, 10 of 20, 20 of 20" in words


def test_a_picture_shows_streams_where_they_are():
    turning = cy.closed.rotation(GRID)  # up where x < 0, seen from the y axis on the left or right
    x, y, colour, _, u_y = closed_views.seen(GRID, turning, turning, 0.5 * np.pi)
    middle = np.abs(y) < 0.3
    assert np.sign(u_y[middle & (x > 0.3)]).tolist() == np.sign(colour[middle & (x > 0.3)]).tolist()
    assert np.unique(np.sign(colour[middle & (x > 0.3)])).size == 1
    assert np.sign(colour[middle & (x > 0.3)])[0] == -np.sign(colour[middle & (x < -0.3)])[0]
    assert np.abs(colour[middle & (np.abs(x) < 0.01)]).max() < 0.05  # the zone between faces the viewer
    assert closed_views.facing(GRID, turning) % np.pi == pytest.approx(0.5 * np.pi)


def test_disorder_has_one_density_on_every_shape():
    closed = closed_cells.start(GRID, 1)
    cylinder = cy.CylinderGrid(16, 20, 5.0)
    P = [closed_cells.start(cylinder, seed) for seed in range(4)]
    # A harmonic and a wave have one mean square per area, whatever they are truncated at.
    per_mode = np.mean([np.mean(np.sum(p**2, axis=0)) for p in P]) / (2 * 16 * 20) * 2 * np.pi * 5
    modes = 2 * int(np.asarray(cy.closed.space.closed_space(GRID).keep).sum())
    found = GRID.mean(np.sum(closed**2, axis=0)) / modes * GRID.area
    assert found == pytest.approx(per_mode, rel=0.25)


def test_a_zone_has_points_enough():
    assert closed_cells.k_max(0.5, 0.05) == 16.0
    assert closed_cells.k_max(1.0, 1.0) == 20.0


@pytest.mark.slow
def test_a_displaced_sink_is_pushed_on_and_a_source_back():
    sink, source = (
        dict(zip(ends_growth.PARTS, ends_growth.pushed(CAPSULE, 0.5, 0.0, rank), strict=True))
        for rank in (0, 2)
    )
    assert sink["push"] > 0.3 > -0.3 > source["push"]
    rates = ends_growth.growth(CAPSULE, PRINCIPAL, 0.5, 0.0, 0.1, "", 16.0)
    assert [sink["rate"], source["rate"]] == pytest.approx(rates[1:], abs=1e-6)
    still = ends_growth.growth(CAPSULE, PRINCIPAL, 0.5, 0.0, 0.0, "", 16.0)
    assert still[1] == pytest.approx(still[2], abs=1e-4)  # without ε both ends are alike
