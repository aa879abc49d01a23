"""Figures of theory, sweeps, experiments and the vacuole in units: what is drawn is the same."""

import json

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

import cyclosis as cy
from cyclosis.dataset import with_scales
from cyclosis.figures import looks, quantities, spectra, style
from cyclosis.figures.dispersion import dispersion
from cyclosis.figures.phase_diagram import phase_diagram
from cyclosis.figures.regime_maps import regimes_and_time
from cyclosis.figures.story import Cell, Panel, story
from cyclosis.figures.vacuole_section import vacuole_section
from figures.sweeps import sweep

CHARA = cy.Scales(radius_um=500.0, speed_um_per_s=75.0)


def axes_over(first, last, scale="linear"):
    ax = style.place(style.blank(80.0, 50.0), 10.0, 10.0, 60.0, 30.0)
    ax.set_xscale(scale)
    ax.set_xlim(first, last)
    return ax


def told(ax):
    """Return the places of the ticks, and the numbers beside them."""
    FigureCanvasAgg(ax.figure).draw()
    first, last = ax.get_xlim()
    shown = [tick for tick in ax.xaxis.get_major_ticks() if first <= tick.get_loc() <= last]
    return (
        np.array([tick.get_loc() for tick in shown]),
        np.array([float(tick.label1.get_text().replace("\N{MINUS SIGN}", "-")) for tick in shown]),
    )


@pytest.mark.parametrize(
    ("kind", "last", "scale", "factor", "name"),
    [
        ("time", 9.0, "linear", 500 / 75, "s"),
        ("time", 90.0, "linear", 500 / 75 / 60, "min"),
        ("speed", 1.3, "linear", 75.0, "µm/s"),
        ("length", 1.5, "linear", 500.0, "µm"),
        ("length", 60.0, "log", 0.5, "mm"),
        ("rate", 1.0, "linear", 75 / 500, "1/s"),
        ("rate", 0.1, "linear", 60 * 75 / 500, "1/min"),
        ("wavenumber", 6.0, "linear", 2.0, "1/mm"),
    ],
)
def test_the_numbers_beside_the_ticks_are_those_of_the_unit(kind, last, scale, factor, name):
    ax = axes_over(0.5 if scale == "log" else 0.0, last, scale)
    with looks.chosen(scales=CHARA):
        quantities.name(ax.xaxis, "what", kind)
    places, numbers = told(ax)
    assert ax.get_xlabel() == f"what ({name})"
    assert places.size >= 3
    assert np.allclose(factor * places, numbers, rtol=1e-5)
    plain = axes_over(0.0, last)
    quantities.name(plain.xaxis, "what", kind, "R")
    assert plain.get_xlabel() == "what, R"
    assert np.allclose(*told(plain))


def data_of(figure):
    """Return all that lines of a figure hold."""
    return [np.asarray(line.get_xydata()) for ax in figure.axes for line in ax.lines]


def texts(figure):
    FigureCanvasAgg(figure).draw()
    return {text.get_text() for text in figure.findobj(Text)}


def theory():
    state = cy.stability.cyclosis(cy.Parameters(), n_theta=64)
    return spectra.spectrum(state, state.spectrum(3))


def inside():
    grid = cy.CylinderGrid(16, 16)
    flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
    return vacuole_section(flow, 2.5)


def told_story():
    grid = cy.CylinderGrid(16, 16)
    P = cy.initial.stripes(grid)
    cell = Cell(quantities.when(30.0), P, cy.flow(cy.Parameters(), grid, P), grid.length)
    return story([cell], [Panel(lambda ax: ax.plot([0, 1], [0, 1]))])


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (theory, {"Re σ (1/min)", "Im σ (1/min)"}),
        (lambda: dispersion(cy.Parameters()), {"growth rate (1/s)", "wavenumber $k$ (1/mm)"}),
        (inside, {"$v_z$ (µm/s)", "$z$ = 1.25 mm", "500 µm"}),
        (told_story, {"$t$ = 3.33 min", "500 µm", "R = 500 µm, U = 75 µm/s, R/U = 6.667 s"}),
    ],
)
def test_figures_say_their_units_and_show_the_same(draw, words):
    plain = draw()
    with looks.chosen(scales=CHARA):
        scaled = draw()
    assert words <= texts(scaled)
    assert not words & texts(plain)
    bars = len(data_of(scaled)) - len(data_of(plain))  # a scale bar is one more line
    assert bars == int("500 µm" in words)
    kept = [line for line in data_of(scaled) if any(np.array_equal(line, one) for one in data_of(plain))]
    assert len(kept) == len(data_of(plain))


def test_sweeps_with_scales_have_their_times_in_units():
    data = sweep({"alpha_p": np.array([0.1, 0.5, 1.0]), "protocol.wash.at": np.array([10.0, 20.0, 40.0])}, 2)
    scaled = with_scales(data, CHARA)
    assert json.loads(scaled.attrs["scales"])["radius_um"] == 500.0
    assert "time of wash (min)" in texts(phase_diagram(scaled))
    assert "time of wash" in texts(phase_diagram(data))
    assert any(text.startswith("$t$ (") for text in texts(regimes_and_time(scaled)))
