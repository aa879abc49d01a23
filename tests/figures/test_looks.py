"""Colours, fonts and style sheets that are chosen; colours that everybody can tell apart."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures import looks, style

# Machado, Oliveira & Fernandes (2009), severity 1, for linear RGB.
VISION = {
    "usual": np.eye(3),
    "protan": [[0.1523, 1.0526, -0.2049], [0.1145, 0.7863, 0.0992], [-0.0039, -0.0481, 1.0520]],
    "deutan": [[0.3673, 0.8606, -0.2280], [0.2801, 0.6725, 0.0474], [-0.0118, 0.0429, 0.9689]],
    "tritan": [[1.2555, -0.0767, -0.1788], [-0.0784, 0.9308, 0.1476], [0.0047, 0.6914, 0.3039]],
}
TOLD_APART = 20.0
"""Difference in CIELAB that nobody overlooks; about 2 is the least that is seen side by side."""
_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(rgb, vision):
    """CIELAB of colours (n, 3) as somebody sees them."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ np.asarray(VISION[vision]).T, 0, 1)
    x, y, z = (np.cbrt(np.maximum(seen @ _XYZ.T / _XYZ.sum(axis=1), 0.008856))).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=1)


def around(count, size=1.0):
    angle = 2 * np.pi * np.arange(count) / count
    return size * np.stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("vision", VISION)
def test_the_four_directions_are_told_apart(vision):
    seen = lab(looks.direction_rgb(around(4)), vision)
    apart = np.linalg.norm(seen[:, None] - seen[None], axis=-1)[~np.eye(4, dtype=bool)]
    assert apart.min() > TOLD_APART


def test_colours_of_directions_are_cyclic_and_dark_without_order():
    colours = looks.direction_rgb(around(720))
    steps = np.linalg.norm(colours - np.roll(colours, 1, axis=0), axis=1)
    assert steps.max() < 0.05, "no seam: opposite directions differ by about 1"
    sizes = (0.0, 0.1, 0.5, 1.0)
    lightness = [lab(looks.direction_rgb(around(8, size)), "usual")[:, 0].max() for size in sizes]
    assert lightness[0] < 10
    assert np.all(np.diff(lightness) > 5)


def test_circumferential_order_is_as_bright_as_axial_order():
    """With P_z alone it is black."""
    P = np.array([[1.0, 0.0], [0.0, 1.0]])  # e_theta, e_z
    assert style.state_rgb(P)[0].max() < 0.15
    with looks.chosen(colours="direction"):
        assert style.state_rgb(P).max(axis=1).min() > 0.85


def test_what_is_chosen_ends_with_its_block():
    before = style.polarity_rgb([-1.0, 1.0])
    with looks.chosen(colours="blue-orange"):
        inside = style.polarity_rgb([-1.0, 1.0])
        with looks.chosen(font="DejaVu Sans"), looks.setting(style.TYPE):
            import matplotlib

            assert matplotlib.rcParams["font.family"] == ["DejaVu Sans"]
            assert np.array_equal(style.polarity_rgb([-1.0, 1.0]), inside), "one choice adds to another"
    assert np.abs(inside - before).max() > 0.2
    assert np.array_equal(style.polarity_rgb([-1.0, 1.0]), before)


def test_a_style_sheet_changes_figures(tmp_path):
    sheet = tmp_path / "journal.mplstyle"
    sheet.write_text("axes.linewidth: 2.5\nfont.size: 7\n")
    with looks.chosen(sheet=sheet), looks.setting(style.TYPE):
        ax = style.place(style.blank(50.0, 40.0), 10, 10, 30, 20)
        assert ax.spines["left"].get_linewidth() == 2.5


def test_what_does_not_exist_is_named_in_a_sentence(tmp_path):
    broken = tmp_path / "broken.mplstyle"
    broken.write_bytes(b"\xff\xfe\x00")
    for how, message in (
        ({"colours": "rainbow"}, "one of purple-green, blue-orange"),
        ({"font": "DejaVu Sanss"}, "did you mean DejaVu Sans"),
        ({"sheet": tmp_path / "none.mplstyle"}, "a style sheet of matplotlib"),
        ({"sheet": broken}, "a style sheet of matplotlib"),
    ):
        with pytest.raises(cy.InputError, match=message), looks.chosen(**how):
            pass
