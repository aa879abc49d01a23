"""What a notebook shows: short trees, escaped, each with a picture that says what the cell is."""

import base64
import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import cyclosis as cy
from cyclosis.display.notebook import cylinder, map_of, tree
from cyclosis.figures import style


def pixels(html):
    data = re.search(r"base64,([^\"]+)", html).group(1)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")).astype(float)


def test_a_run_is_a_tree_and_its_last_state():
    grid = cy.CylinderGrid(16, 16, 5.0)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0), t_end=1.0)
    html = run._repr_html_()
    # The picture is an element without an end, as HTML has it.
    root = ElementTree.fromstring(html.replace('"></div>', '"/></div>'))
    assert root.find("pre").text == repr(run)
    assert len(repr(run).splitlines()) == 5
    assert pixels(html).shape == (16, 16, 3)


def test_up_and_down_have_the_colours_of_the_figures_and_the_axis_points_up():
    P = np.zeros((2, 8, 4))
    P[1, 0, 3] = 1.0  # the lower left corner is theta = 0, z = 0: this is the upper left one
    P[1, 7, 0] = -1.0
    seen = pixels(map_of(P, 5.0))
    assert seen.shape == (4, 8, 3)
    assert seen[0, 0] / 255 == pytest.approx(style.polarity_rgb(1.0), abs=0.01)
    assert seen[3, 7] / 255 == pytest.approx(style.polarity_rgb(-1.0), abs=0.01)
    assert seen[1, 3].max() < 40


@pytest.mark.parametrize("length", [0.5, 5.0, 100.0])
def test_a_grid_is_drawn_to_scale(length):
    path = re.search(r'd="([^"]+)"', cylinder(length)).group(1)
    h = float(re.search(r"v([\d.]+)a", path).group(1))
    r = float(re.search(r"a([\d.]+),", path).group(1))
    if length < 50:  # thinner than a line otherwise
        assert h / r == pytest.approx(length, rel=0.02)
    assert h < 110
    assert "16 around x 8 along" in cy.CylinderGrid(16, 8, length)._repr_html_()


def test_parameters_stand_in_their_plane():
    def place(**values):
        found = re.search(r'cx="([\d.]+)" cy="([\d.]+)"', cy.Parameters(**values)._repr_html_())
        return tuple(map(float, found.groups()))

    (x0, y0), (x1, y1) = place(alpha_p=0.2, alpha_u=0.2), place(alpha_p=0.8, alpha_u=0.2)
    assert x1 > x0
    assert y1 == y0
    assert place(alpha_p=0.2, alpha_u=0.9)[1] < y0
    assert "<field (16, 16)>" not in cy.Parameters(alpha_p=np.ones((16, 16)))._repr_html_()


def test_what_is_shown_is_escaped():
    assert "<b>" not in tree("<b>", [("<b>", "<b>")])
