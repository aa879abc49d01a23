"""Figures of closed cells, on made-up states on small grids."""

import json

import matplotlib.collections
import numpy as np
import pytest
import xarray
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures import closed_cells, closed_map, closed_solid, frames, scene, style
from cyclosis.figures.emergence import emergence
from cyclosis.figures.history import history
from cyclosis.figures.ribbons import ZONE_WIDTH
from cyclosis.figures.roses import roses
from cyclosis.figures.streamlines import STEP, filled
from cyclosis.figures.subjects import subject_of
from cyclosis.figures.tracers import Tracers

GRID = cy.ClosedGrid(cy.Capsule(length=2.0), k_max=8)
BALL = cy.ClosedGrid(cy.Sphere(), k_max=6)
SKIN = closed_cells.skin_of(GRID)
MIDDLE = 0.5 * SKIN.length
ROUND = closed_cells.skin_of(BALL)
STREAMS = cy.closed.rotation(GRID)
CHART = closed_cells.on_chart(GRID, STREAMS)
FLAT = closed_cells.skin_of(cy.ClosedGrid(cy.Spheroid(0.6), 6))
SKINS = pytest.mark.parametrize("skin", [SKIN, ROUND, FLAT], ids=["capsule", "sphere", "spheroid"])


def axes():
    return Figure(figsize=(3, 4)).add_subplot()


def pixels(ax):
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba(), dtype=float)[::-1, :, :3] / 255
    return lambda x, y: image[tuple(np.rint(ax.transData.transform((x, y))).astype(int)[::-1])]


def dataset_of(grid, states):
    """Return the dataset of a run through states, with made-up records."""
    model, times = cy.models.closed, np.arange(float(len(states)))
    P = np.stack(states)
    order = np.sqrt(grid.mean(np.sum(P**2, axis=1)))
    data = {name: (g.dims, g.values) for name, g in model.geometry(grid).items()}
    data |= {"P": (("time", "component", "theta", "s"), P), "u": (("time", "component", "theta", "s"), P)}
    for name in ("order", "peak_speed", "rms_speed", "power_input"):
        data[name] = ("time", order)
    for name in ("viscous_dissipation", "friction_dissipation"):
        data[name] = ("time", 0.5 * order)
    for name in ("mean_vector", "circulation"):
        data[name] = (("time", "axis"), np.outer(order, [0.0, 1.0, 0.0]))
    coords = {"time": times, "theta": grid.theta, "s": grid.s, "component": ["theta", "s"]}
    configuration = json.dumps({"model": {"kind": "closed"}, "grid": model.table_of(grid)})
    return xarray.Dataset(data, coords, {"configuration": configuration})


@pytest.fixture(scope="module")
def run():
    """Streams that form from noise."""
    noise = cy.closed.disordered(GRID, seed=0)
    shares = np.linspace(0.0, 1.0, 8)
    return dataset_of(GRID, [share * STREAMS + (1 - share) * noise for share in shares])


# The chart


@pytest.mark.parametrize("grid", [GRID, BALL], ids=["capsule", "sphere"])
def test_fields_on_the_chart_are_those_of_the_grid(grid):
    """Against sums of harmonics at points, also next to the poles and on them."""
    skin, state = closed_cells.skin_of(grid), cy.closed.noise(grid, seed=1)
    vectors = skin.in_space(closed_cells.on_chart(grid, state))
    chosen = [(0, 0), (7, 1), (100, 40), (3, skin.s.size // 2), (50, -2), (9, -1)]
    points = [skin.at(skin.theta[i], skin.s[j]) for i, j in chosen]
    expected = grid.cartesian(state, points)
    found = [vectors[:, i, j] for i, j in chosen]
    # The chart's points lie within 1e-6 radii of those it names.
    assert np.array(found) == pytest.approx(expected, abs=1e-4 * np.abs(state).max())


@SKINS
def test_points_and_chart_are_inverse(skin):
    rng = np.random.default_rng(0)
    theta, s = rng.uniform(-3, 3, 200), rng.uniform(0.05, 0.95, 200) * skin.length
    found = skin.chart(skin.at(theta, s))
    assert found[0] == pytest.approx(theta)
    assert found[1] == pytest.approx(s, abs=2e-3)
    around, along, normal = skin.frames(theta, s)
    assert np.cross(around, along, axis=0) == pytest.approx(normal, abs=1e-3)


@SKINS
def test_equal_areas_get_equally_many_points(skin):
    fractions = np.stack([np.full(2000, 0.3), (np.arange(2000) + 0.5) / 2000])
    _, s = skin.chart(skin.places(fractions))
    middle = 0.5 * skin.length
    assert np.mean(s < middle) == pytest.approx(0.5, abs=2e-3)
    fine = np.linspace(0, skin.length, 4001)
    r = np.interp(fine, skin.s, skin.r)
    cap = 0.2 * skin.length
    share = np.trapezoid(np.where(fine < cap, r, 0), fine) / np.trapezoid(r, fine)
    assert np.mean(s < cap) == pytest.approx(share, abs=3e-3)


# The map


@SKINS
def test_the_map_keeps_areas(skin):
    """A patch has the same area on the map as on the surface, wherever it is."""
    for theta, s in ((1.0, 0.2), (3.0, 0.5), (6.0, 0.8)):
        size = 0.02
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size / 2
        x, y = closed_map.mapped(skin, theta + corners[:, 0], s * skin.length + corners[:, 1])
        area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
        r = np.interp(s * skin.length, skin.s, skin.r)
        assert area == pytest.approx(r * size**2, rel=1e-2)
    edge = closed_map._edge(skin).to_polygons()[0]
    x, y = edge.T
    whole = 0.5 * abs(np.sum(x[:-1] * y[1:] - y[:-1] * x[1:]))
    assert whole == pytest.approx(skin.area, rel=1e-6)


def test_the_whole_surface_is_as_large_as_its_grid_says():
    assert SKIN.area == pytest.approx(GRID.area, rel=1e-4)


def test_a_line_across_the_seam_is_drawn_on_both_sides():
    theta = np.linspace(-0.1, 0.1, 20)
    polygon = SKIN.ribbon(SKIN.at(theta, np.full(20, MIDDLE)), np.full(20, 0.05))
    copies = closed_map.copies(SKIN, polygon)
    assert len(copies) == 2
    right, left = (copy[:, 0].mean() for copy in copies)
    # One turn is 2π r wide, at every point.
    r = np.interp(SKIN.chart(polygon.T)[1], SKIN.s, SKIN.r)
    assert right - left == pytest.approx(2 * np.pi * r.mean(), abs=1e-9)
    around = SKIN.ribbon(SKIN.at(np.linspace(0, 6, 40), np.full(40, 0.002)), np.full(40, 1e-4))
    assert all(np.ptp(copy[:, 0]) < 0.1 for copy in closed_map.copies(SKIN, around))


# The solid


@SKINS
@pytest.mark.parametrize("tilt", [0.0, 0.6])
def test_what_a_pixel_shows_is_the_nearest_point_on_its_line_of_sight(skin, tilt):
    theta, s, _ = closed_solid._hits(skin, tilt, 41)
    left, right, bottom, top = closed_solid.extent(skin, tilt)
    rows = theta.shape[0]
    x = np.broadcast_to((np.arange(41) + 0.5) * (right - left) / 41 + left, theta.shape)
    y = np.broadcast_to(((np.arange(rows) + 0.5) * (top - bottom) / rows + bottom)[:, None], theta.shape)
    inside = closed_solid.outline_of(skin, tilt).contains_points(
        np.stack([x.ravel(), y.ravel()], 1), radius=-0.02
    ).reshape(theta.shape) & closed_solid.outline_of(skin, tilt).contains_points(
        np.stack([x.ravel(), y.ravel()], 1), radius=0.02
    ).reshape(theta.shape)
    assert inside.sum() > 0.5 * inside.size
    places, normals = closed_solid.seen(skin, skin.at(theta[inside], s[inside]).T, 0.0, tilt)
    assert places == pytest.approx(np.stack([x[inside], y[inside]], 1), abs=5e-3)
    assert np.all(normals[:, 2] > -0.02)


@SKINS
@pytest.mark.parametrize("tilt", [0.0, 0.6])
def test_the_silhouette_encloses_all_points_and_touches_some(skin, tilt):
    outline = closed_solid.outline_of(skin, tilt)
    theta, s = np.meshgrid(np.linspace(0, 2 * np.pi, 60), skin.s[::3], indexing="ij")
    places, _ = closed_solid.seen(skin, skin.at(theta.ravel(), s.ravel()).T, 0.4, tilt)
    grown = type(outline)(1.004 * outline.vertices, closed=True)
    assert grown.contains_points(places).all()
    shrunk = type(outline)(0.98 * outline.vertices, closed=True)
    assert not shrunk.contains_points(places).all()
    assert closed_solid.extent(skin, tilt)[3] == pytest.approx(outline.vertices[:, 1].max(), abs=2e-3)


def test_colours_are_those_of_the_cylinder():
    """Up is purple and down is green, on the solid and on the map; streams cross over the pole."""
    P = CHART
    up = P[1, :, SKIN.s.size // 2]
    angle = SKIN.theta[int(np.argmax(up))]
    for view, sign in ((angle, 1), (angle + np.pi, -1)):
        ax = axes()
        closed_solid.draw_closed(ax, SKIN, P, P, view_angle=view, tilt=0.0, streamlines=False)
        colour = pixels(ax)(0.0, 0.0)
        assert colour == pytest.approx(style.polarity_rgb(sign * up.max()), abs=0.02)
    ax = axes()
    closed_map.paint_closed(ax, SKIN, P, P, streamlines=False)
    x, y = closed_map.mapped(SKIN, angle, 0.5 * SKIN.length)
    assert pixels(ax)(float(x), float(y)) == pytest.approx(style.polarity_rgb(up.max()), abs=0.02)


def test_the_near_side_is_drawn_as_on_the_cylinder():
    """theta grows to the right."""
    places, _ = closed_solid.seen(SKIN, SKIN.at([0.3, 0.8], [MIDDLE, MIDDLE]).T, 0.3, 0.0)
    assert places[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert places[1, 0] == pytest.approx(np.sin(0.5), abs=1e-3)


def test_a_polygon_that_passes_behind_does_not_cut_across_the_picture():
    """A circle around a tilted cell: of its hidden half nothing lies within the silhouette."""
    theta = np.linspace(0, 2 * np.pi, 121)
    ring = SKIN.ribbon(SKIN.at(theta, np.full(121, MIDDLE)), np.full(121, 0.05))
    places = closed_solid.cut(*closed_solid.seen(SKIN, ring, 0.0, 0.6), 10.0)
    ax = axes()
    outline = closed_solid.outline_of(SKIN, 0.6)
    drawn = matplotlib.collections.PolyCollection([places], facecolors="black")
    ax.add_collection(drawn)
    drawn.set_clip_path(outline, ax.transData)
    ax.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal")
    at = pixels(ax)
    assert at(0.0, -np.sin(0.6)).max() < 0.1  # the near half
    assert at(0.0, np.sin(0.6)).min() > 0.9  # the far half
    assert at(0.0, 0.0).min() > 0.9
    behind = SKIN.at([3.0, 3.1, 3.2], [MIDDLE, MIDDLE + 0.1, MIDDLE]).T
    assert closed_solid.cut(*closed_solid.seen(SKIN, behind, 0.0, 0.6), 9.0).size == 0


# Lines and marks


def test_zones_are_drawn_between_streams_and_not_where_streams_cross_over_the_poles():
    polygons = SKIN.zones(CHART)
    points = np.concatenate(polygons)
    angles = np.arctan2(points[:, 1], points[:, 0])
    # P is a rotation about the y axis: P_s = 0 where x = 0.
    body = np.hypot(points[:, 0], points[:, 1]) > 0.9
    assert np.abs(np.cos(angles[body])).max() < 0.05
    # On that line |P| = 0.9 |z|/H, and beside it at most 0.9 sin(0.5): the line ends where they are equal.
    assert np.abs(points[:, 2]).max() < np.sin(0.5) * GRID.surface.half_height + 0.05
    covered = np.histogram(points[:, 2], np.linspace(-0.8, 0.8, 9))[0]
    assert covered.min() > 0
    widths = [np.ptp(p[:, 0]) for p in polygons if np.abs(p[:, 2]).max() < 0.4]
    assert np.median(widths) == pytest.approx(ZONE_WIDTH, rel=0.05)


def test_disorder_has_no_zones_and_no_marks():
    noise = cy.closed.disordered(GRID, seed=3)
    assert SKIN.zones(closed_cells.on_chart(GRID, noise)) == []
    assert closed_cells.marks_of(GRID, noise) == []


def test_contrast_is_that_of_the_cylinder():
    """In the middle of a long cell."""
    P = np.zeros((2, SKIN.around, SKIN.s.size))
    P[1] = 0.8 * np.sin(SKIN.theta - 0.3)[:, None]
    found, crossing = SKIN.beside(SKIN.in_space(P), np.array([0.3]), np.array([MIDDLE]))
    cylinder = cy.CylinderGrid(64, 16)
    same = np.stack([0 * cylinder.theta[:, None] + 0 * cylinder.z] * 2)
    same[1] = 0.8 * np.sin(cylinder.theta)[:, None]
    # In the plane that touches the surface 0.5 radii lead to the angle 0.464.
    assert found[0] == pytest.approx(cy.zones.contrast(cylinder, same)[0, 0], rel=0.08)
    assert crossing[0] == pytest.approx(0.0, abs=0.02)


def test_streamlines_follow_the_flow_over_the_poles():
    """About the y axis of a sphere they are circles y = const, evenly spread over the whole of it."""
    flow = closed_cells.on_chart(BALL, cy.closed.rotation(BALL))
    lines = filled(ROUND, flow, 0.2, 1.25, 0.02)
    points = np.concatenate([points for points, _ in lines], axis=1)
    assert np.hypot.reduce(points) == pytest.approx(np.ones(points.shape[1]), abs=1e-3)
    assert max(np.ptp(points[1]) for points, _ in lines) < 5e-3
    assert all((points.shape[1] - 1) * STEP <= 1.25 + STEP for points, _ in lines)
    assert np.abs(points[2]).max() > 0.95
    # Lines run with the flow e_y x (x, y, z): at the north pole towards +x.
    top = [np.diff(points[0])[np.argmax(points[2, :-1])] for points, _ in lines if points[2].max() > 0.95]
    assert top
    assert min(top) > 0


def test_streaming_lines_stay_on_the_surface():
    tracers = Tracers(ROUND, fade=3)
    flow = closed_cells.on_chart(BALL, cy.closed.rotation(BALL))
    for _ in range(6):
        before = tracers.heads
        ribbons = tracers.advance(flow, 0.9, 0.05)
    assert len(ribbons) == tracers.heads.shape[1] > 20
    assert np.hypot.reduce(tracers.heads) == pytest.approx(np.ones(len(ribbons)), abs=1e-3)
    assert before.shape[0] == 3


def test_marks_are_where_the_defects_are():
    """The asters of a state from pole to pole: the north one in the middle of the upper end."""
    P = cy.closed.source_to_sink(GRID)
    marks = closed_cells.marks_of(GRID, P)
    assert [mark[0] for mark in marks] == [1, 1]
    ax, chart = axes(), closed_cells.on_chart(GRID, P)
    closed_solid.draw_closed(ax, SKIN, chart, chart, view_angle=1.0, streamlines=False, marks=marks)
    (places,) = {tuple(np.ravel(c.get_offsets())) for c in ax.collections if c.get_offsets().size == 2} - {
        (0.0, 0.0)
    }
    # The pole is at (0, H cos tilt) in the picture, the other one is hidden.
    assert places == pytest.approx((0.0, GRID.surface.half_height * np.cos(closed_solid.TILT)), abs=1e-6)
    ax = axes()
    closed_map.paint_closed(
        ax, SKIN, chart, chart, streamlines=False, marks=[(1, -0.5, MIDDLE), (-1, 2.0, 1.0)]
    )
    offsets = np.concatenate([c.get_offsets() for c in ax.collections])
    for theta, s in ((2 * np.pi - 0.5, MIDDLE), (2.0, 1.0)):
        expected = np.stack(closed_map.mapped(SKIN, theta, s))
        assert np.hypot(*(offsets - expected).T).min() < 1e-9


def test_a_sphere_is_turned_so_that_its_circulation_is_upright():
    P = cy.closed.rotation(BALL)  # about the y axis
    turn = closed_cells.upright(BALL, P, P)
    assert turn @ [0, 1, 0] == pytest.approx([0, 0, 1], abs=1e-9)
    assert turn @ turn.T == pytest.approx(np.eye(3))
    upright = closed_cells.turned(BALL, P, turn)
    assert upright[1] == pytest.approx(np.zeros(BALL.shape), abs=1e-9)
    assert np.all(upright[0] > 0)
    assert np.array_equal(closed_cells.upright(BALL, 0 * P, 0 * P), np.eye(3))


# Whole figures


def test_emergence(run):
    figure = emergence(run, times=[0, 7])
    titles = [ax.get_title() for ax in figure.axes if "t$" in ax.get_title()]
    maps = [ax for ax in figure.axes if ax.get_xlabel()]
    assert titles == ["$t$ = 0", "$t$ = 7"]
    assert len(maps) == 1
    assert maps[0].get_ylabel() == "$s$"
    assert {ax.get_title() for ax in figure.axes} >= {"$P_s$"}


def test_the_default_view_shows_a_zone(run):
    """Streams are about the y axis: zones at ±π/2, and purple to the right of the one that is shown."""
    view = subject_of(run).facing(STREAMS)
    assert np.cos(view - 0.25) == pytest.approx(0.0, abs=1e-6)
    middle = STREAMS[1][:, GRID.n_s // 2]
    assert np.interp(view, GRID.theta, middle, period=2 * np.pi) > 0


def test_paths_are_measured_by_area(run):
    way = frames.travelled(run)
    change = run["P"].values[1] - run["P"].values[0]
    assert way[1] == pytest.approx(np.sqrt(GRID.mean(np.sum(change**2, axis=0))))


def test_a_frame_of_a_movie(run):
    subject = subject_of(run)
    look = subject.look(STREAMS, STREAMS)
    ribbons = Tracers(subject.portrait.wall, 2).advance(look.u, 0.9, 0.05)
    stage = scene.SceneLayout(scene.Scene(subject.surface, np.array([0.0, 9.0]), np.array([0.1, 0.9]), 180))
    shot = scene.Shot(look.P, look.u, ribbons, 0.0, 4.0, 0.5, look.marks)
    picture = stage.drawn(shot)
    assert picture.shape == (180, 320, 3)
    assert np.array_equal(picture, stage.drawn(shot))  # nothing of the frame before is left
    other = stage.drawn(scene.Shot(look.P, look.u, ribbons, 1.5, 4.0, 0.5, look.marks))
    assert not np.array_equal(picture, other)


def test_history_counts_defects_that_sum_to_two(run):
    figure = history(run)
    (panel,) = [ax for ax in figure.axes if ax.get_ylabel() == "defects"]
    plus, minus = (line.get_ydata() for line in panel.get_lines())
    known = np.isfinite(plus)
    assert known.any()
    assert np.all(plus[known] - minus[known] == 2)
    assert plus[-1] == 2
    with pytest.raises(cy.InputError, match="circulation"):
        history(run.drop_vars("circulation"))


def test_what_has_no_meaning_is_refused(run):
    with pytest.raises(cy.InputError, match="periodic cylinder"):
        roses(run)
    with pytest.raises(cy.InputError, match="periodic cylinder"):
        cy.vacuole.flow(run)
    with pytest.raises(cy.InputError, match=r"s in the dataset .* whole cell"):
        emergence(run.isel(s=slice(0, 12)))
    with pytest.raises(cy.InputError, match="configuration"):
        emergence(run.assign_attrs(configuration="{}"))


def test_a_notebook_shows_the_map():
    picture = cy.models.closed.picture(GRID, STREAMS)
    assert picture.startswith('<img alt="P_s on an equal-area map')
