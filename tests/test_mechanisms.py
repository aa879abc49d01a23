"""The drawings of the mechanisms turn filaments as the model does, are up to date, and suit both schemes."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

import cyclosis as cy

DOCS = Path(__file__).parents[1] / "docs"
ANGLES = (0.5, 0.5 + np.pi, 1.15, 1.15 + np.pi, np.pi - 0.35, np.pi / 2)


@pytest.fixture(scope="module")
def mechanisms():
    sys.path.insert(0, str(DOCS))
    try:
        return importlib.import_module("mechanisms")
    finally:
        sys.path.remove(str(DOCS))


def turned(term, P, params, grid):
    """The rate at which a term turns the order P, counter-clockwise, over its length squared."""
    rate = cy.rate_of_change(params, grid, P, terms=[term])
    return (P[0] * rate[1] - P[1] * rate[0]) / (P**2).sum(axis=0)


@pytest.mark.parametrize("angle", ANGLES)
def test_repulsion_turns_filaments_as_drawn(mechanisms, angle):
    grid, params = cy.CylinderGrid(8, 8), cy.Parameters(kappa=1.0)
    P = 0.3 * np.array([np.cos(angle), np.sin(angle)])[:, None, None] * np.ones((8, 8))
    np.testing.assert_allclose(turned("repulsion", P, params, grid), mechanisms.repelled(angle), atol=1e-12)


def test_flow_turns_filaments_as_drawn(mechanisms):
    """The drawings have u = e_x or u = y e_x; here the flow of two stripes, whose shear and speed vary."""
    grid, params = cy.CylinderGrid(32, 8), cy.Parameters(alpha_u=1.0, epsilon=1.0)
    P = cy.initial.stripes(grid, magnitude=0.8)
    P = P + 0.3 * np.array([1.0, 0.0])[:, None, None]
    u = cy.flow(params, grid, P)
    angle = np.arctan2(P[1], P[0])
    size = np.hypot(*P)
    # In axes whose first is along the flow, e_z, the angle is that from e_z, clockwise.
    u_z, u_theta = u[1], u[0].mean()
    along = np.vectorize(mechanisms.dragged)(angle - np.pi / 2) * u_z
    across = np.vectorize(mechanisms.dragged)(angle) * u_theta
    np.testing.assert_allclose(turned("flow_alignment", P, params, grid), (along + across) / size, atol=1e-10)


def test_shear_turns_filaments_as_drawn(mechanisms):
    """The drawing has u = y e_x. Here u_z varies with θ: in axes (z, θ) angles are π/2 less, and reversed."""
    grid, params = cy.CylinderGrid(32, 8), cy.Parameters(epsilon=1.0)
    P = cy.initial.stripes(grid, magnitude=0.8) + 0.3 * np.array([1.0, 0.0])[:, None, None]
    waves = 1j * np.fft.fftfreq(32, 1 / 32)[:, None]
    slope = np.fft.ifft(waves * np.fft.fft(cy.flow(params, grid, P)[1], axis=0), axis=0).real
    drawn = np.vectorize(mechanisms.sheared)(np.pi / 2 - np.arctan2(P[1], P[0]))
    np.testing.assert_allclose(turned("shear", P, params, grid), -drawn * slope, atol=1e-10)


def labels(text):
    """The labels of a drawing, which matplotlib writes as comments beside their outlines."""
    return re.findall(r"<!-- (.*?) -->", text)


def test_stored_drawings_are_those_of_the_code(mechanisms):
    stored = {path.stem.removeprefix("mechanism-") for path in (DOCS / "images").glob("mechanism-*.svg")}
    assert stored == set(mechanisms.DRAWINGS)
    for name, drawing in mechanisms.DRAWINGS.items():
        text = (DOCS / "images" / f"mechanism-{name}.svg").read_text()
        with mechanisms.matplotlib.rc_context(mechanisms.STYLE):
            drawn = mechanisms.written(drawing())
        assert labels(text) == labels(drawn), f"run python docs/mechanisms.py: {name} is out of date"
        assert text.count("<path") == drawn.count("<path")


def test_each_colour_has_a_light_and_a_dark_value(mechanisms):
    for path in (DOCS / "images").glob("mechanism-*.svg"):
        text = path.read_text()
        light, dark = re.search(r"<style>svg\{(.*?)\}@media .*?\{svg\{(.*?)\}\}", text).groups()
        used = set(re.findall(r"var\(--(\w+)\)", text))
        assert used
        assert used <= {pair.split(":")[0] for pair in light.replace("--", "").split(";")}
        assert used <= {pair.split(":")[0] for pair in dark.replace("--", "").split(";")}
        assert "#0102" not in text


def test_every_card_of_the_gallery_has_its_picture():
    scripts = {path.stem for path in DOCS.parent.glob("examples/*.py")}
    assert scripts == {path.stem for path in (DOCS / "images" / "gallery").glob("*.png")}
    for name in scripts:
        with PIL.Image.open(DOCS / "images" / "gallery" / f"{name}.png") as picture:
            assert picture.size == (480, 270)
