import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

import cyclosis as cy
from cyclosis.figures import cylinder, ribbons, style
from cyclosis.figures.unwrapped import draw_map

GRID = cy.CylinderGrid(24, 24, 5.0)
THETA, Z = np.meshgrid(GRID.theta, GRID.z, indexing="ij")
STRIPES = np.stack([0 * THETA, np.sin(THETA)])
DRAWINGS = [cylinder.draw, draw_map]


def axes():
    return Figure(figsize=(3, 4)).add_subplot()


def pixels(ax):
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba(), dtype=float)[::-1, :, :3] / 255
    return lambda x, y: image[tuple(np.rint(ax.transData.transform((x, y))).astype(int)[::-1])]


def luminance(rgb):
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def test_colours_say_sign_and_magnitude():
    """Purple is red and blue above green, green the reverse; luminance grows with |P_z| on both sides."""
    up, down = (style.polarity_rgb(sign * np.linspace(0.02, 1, 200)) for sign in (1, -1))
    assert np.all(np.minimum(up[:, 0], up[:, 2]) > up[:, 1])
    assert np.all(np.maximum(down[:, 0], down[:, 2]) < down[:, 1])
    for side in (up, down):
        assert np.all(np.diff(luminance(side)) >= 0)
        assert luminance(side[0]) < 0.02
    assert luminance(style.polarity_rgb(0.0)) < 0.01
    # Full order up and down differ in grayscale, and both differ from the dark lines drawn over them.
    assert luminance(down[-1]) - luminance(up[-1]) > 0.2
    assert luminance(up[-1]) > 0.25


def test_half_of_the_surface_is_hidden():
    theta = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    x, y, visible = cylinder.project(theta, 2.0, view_angle=1.0, tilt=0.3)
    assert np.array_equal(visible, np.cos(theta - 1.0) > 0)
    # A circle is seen as an ellipse.
    assert np.hypot(x, (y - 2 * np.cos(0.3)) / np.sin(0.3)) == pytest.approx(1.0)
    assert np.all(y[visible] < 2 * np.cos(0.3))  # its near half is the lower one
    near = cylinder.project([1.0, 1.2], [0.0, 1.0], view_angle=1.0, tilt=0.0)
    assert near[0] == pytest.approx([0.0, np.sin(0.2)])  # theta grows to the right
    assert near[1] == pytest.approx([0.0, 1.0])


def test_polygons_stay_on_the_visible_side():
    window = (-0.5 * np.pi, 0.5 * np.pi)
    zones = ribbons.zone_ribbons(GRID, STRIPES, window)
    assert zones
    assert all(abs(polygon[:, 0].mean()) < 0.1 for polygon in zones)  # the zone at pi is behind
    lines, strength = ribbons.stream_ribbons(GRID, STRIPES, window, 1.0)
    assert len(lines) == strength.size > 10
    assert all(window[0] <= p[:, 0].min() and p[:, 0].max() <= window[1] for p in lines)


def test_lines_widen_downstream():
    s = np.linspace(0, 1, 30)
    outline = ribbons.ribbon(0 * s, s, np.linspace(0.01, 0.1, 30))
    widths = [np.ptp(outline[np.abs(outline[:, 1] - z) < 0.02, 0]) for z in (0.1, 0.5, 0.9)]
    assert widths == pytest.approx([0.019, 0.055, 0.091], abs=0.003)
    lines, _ = ribbons.stream_ribbons(GRID, np.abs(STRIPES), (-4.0, 4.0), 1.0)
    upwards = [p for p in lines if np.ptp(p[:, 1]) > 0.5]
    thick = [np.ptp(p[p[:, 1] > p[:, 1].max() - 0.1, 0]) for p in upwards]
    thin = [np.ptp(p[p[:, 1] < p[:, 1].min() + 0.1, 0]) for p in upwards]
    assert np.all(np.array(thick) > 2 * np.array(thin))


def test_slow_flow_is_drawn_faintly_or_not_at_all():
    window = (0.0, 2 * np.pi)
    fast, slow = (ribbons.stream_ribbons(GRID, s * STRIPES, window, 1.0)[1] for s in (1.0, 0.1))
    assert slow.max() < 0.4 < fast.max() <= 1.0
    assert ribbons.stream_ribbons(GRID, 0.01 * STRIPES, window, 1.0)[0] == []
    assert ribbons.stream_ribbons(GRID, 0 * STRIPES, window, 0.0)[0] == []


def test_disorder_has_no_zones():
    assert ribbons.zone_ribbons(GRID, cy.initial.disordered(GRID, seed=1), (0.0, 2 * np.pi)) == []


def test_zones_of_steady_cyclosis_have_their_whole_width():
    P_z = cy.stability.cyclosis(cy.Parameters()).at(GRID.theta, zone=1.03)[0]
    found = ribbons.zone_ribbons(GRID, np.stack([0 * THETA, P_z[:, None] + 0 * Z]), (0.0, 2 * np.pi))
    assert {round(p[:, 0].mean(), 2) for p in found} == {1.03, round(1.03 + np.pi, 2)}
    for polygon in found:
        assert np.ptp(polygon[:, 0]) == pytest.approx(ribbons.ZONE_WIDTH, rel=0.01)
        assert np.ptp(polygon[:, 1]) > GRID.length


def test_a_zone_ends_where_there_is_no_order_around_it():
    """Streams in the lower half of the cell only: P_z changes sign in the upper half too."""
    P_z = np.where(Z < 2.5, 0.9, 1e-3) * np.sin(THETA - 1.0)
    found = ribbons.zone_ribbons(GRID, np.stack([0 * THETA, P_z]), (0.0, 2 * np.pi))
    inside = [p[(p[:, 1] > 0) & (p[:, 1] < GRID.length), 1] for p in found]
    heights = np.concatenate(inside)
    assert np.any((heights > 1.0) & (heights < 2.0))
    assert not np.any((heights > 3.5) & (heights < 4.0))


def test_a_drawn_cylinder_shows_its_near_side():
    """With theta = 0 in front the upward stripe is on the right, the downward one on the left."""
    ax = axes()
    cylinder.draw(ax, GRID, STRIPES, STRIPES, view_angle=0.0, streamlines=False)
    at = pixels(ax)
    left, right, zone = at(-0.7, 2.5), at(0.7, 2.5), at(0.0, 2.5)
    assert left[1] > max(left[0], left[2])
    assert right[1] < min(right[0], right[2])
    assert zone.min() > 0.9
    assert at(-0.99, 0.02 - np.sin(cylinder.TILT)).min() > 0.95  # below the near rim there is paper


@pytest.mark.parametrize("draw", DRAWINGS)
def test_streamlines_can_be_left_out(draw):
    counts = []
    for wanted in (False, True):
        ax = axes()
        draw(ax, GRID, STRIPES, STRIPES, streamlines=wanted)
        counts.append(sum(len(c.get_paths()) for c in ax.collections if isinstance(c, PolyCollection)))
    assert counts[1] > counts[0] + 10


@pytest.mark.parametrize("tilt", [0.0, 1.0])
def test_every_tilt_can_be_drawn(tilt):
    ax = axes()
    cylinder.draw(ax, GRID, STRIPES, STRIPES, view_angle=-7.0, tilt=tilt)
    pixels(ax)


@pytest.mark.parametrize("draw", DRAWINGS)
def test_mismatched_fields_are_refused(draw):
    with pytest.raises(cy.InputError, match="state"):
        draw(axes(), GRID, np.zeros((2, 8, 8)), STRIPES)
    with pytest.raises(cy.InputError, match="the flow"):
        draw(axes(), GRID, STRIPES, np.zeros((2, 8, 8)))


def test_bad_angles_are_refused():
    with pytest.raises(cy.InputError, match="tilt"):
        cylinder.draw(axes(), GRID, STRIPES, STRIPES, tilt=2.0)
