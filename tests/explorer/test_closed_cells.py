"""Closed cells in the explorer: their bits are those of the exported run, and nonsense is refused."""

import json
import tomllib

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from cyclosis.explorer import about, setup
from cyclosis.explorer.messages import understood
from cyclosis.explorer.session import Session
from cyclosis.explorer.surfaces import surface_of
from cyclosis.models.fields import diagnose

CAPSULE = {
    "model": {"kind": "closed"},
    "grid": {"shape": "capsule", "length": 1.0, "k_max": 6},
    "parameters": {"d_s": 0.05},
}
START = {"initial": {"kind": "stripes"}}
GRID = setup.from_tables(CAPSULE).grid


def forward(session, t):
    while session.live.t < t:
        session.forward()


def stroke(tool, points, radius=0.6):
    return understood(json.dumps({"do": "brush", "tool": tool, "points": points, "radius": radius}))


@pytest.fixture(scope="module")
def scripted():
    """A capsule after a fixed script of actions, over both poles."""
    session = Session(setup.from_tables(CAPSULE | START))
    forward(session, 0.3)
    session.change({"alpha_p": 0.5})
    for tool, place in (("wound", [1.0, 0.05]), ("fragment", [2.0, 1e6]), ("align", [4.0, 2.0])):
        session.brush(stroke(tool, [place, [0.5, 1.0]]))
        forward(session, session.live.t + 0.2)
    session.drug("cytochalasin")
    forward(session, 1.2)
    session.drug("wash_out")
    forward(session, 1.5)
    return session


def header(data):
    return json.loads(data[8 : 8 + int.from_bytes(data[:4], "little")])


@pytest.mark.slow
def test_the_exported_configuration_gives_the_same_bits(scripted):
    tables = tomllib.loads(scripted.setup_now().toml())
    steps = tables.pop("protocol")
    ready = config.setup(config.check(tables), steps)
    run = cy.simulate(
        ready.params,
        ready.grid,
        ready.state,
        model=ready.model,
        protocol=ready.protocol,
        **ready.settings.as_dict(),
    )
    assert run.t_final == scripted.live.t == 1.5
    assert np.array_equal(run.final_state, scripted.live.state)


@pytest.mark.slow
def test_a_link_opens_the_same_cell(scripted):
    link = scripted.setup_now().link()
    other = Session(setup.from_link(link))
    forward(other, 1.5)
    assert other.digest() == scripted.digest()
    assert other.setup_now().link() == link
    assert other.words(0.0)["setup"]["grid"] == {
        **{"shape": "capsule", "length": 1.0, "smoothing": 0.4, "k_max": 6.0},
        **{"n_theta": GRID.n_theta, "n_s": GRID.n_s},
    }


def test_a_stroke_beyond_a_pole_is_on_it():
    surface = surface_of(GRID)
    table = stroke("wound", [[1.0, 0.05], [2.0, 1e6]]).step(0.0, lambda z: surface.nearest(GRID, z))
    strokes = [part["z"] for part in table["where"]["parts"]]
    end = GRID.surface.meridian_length
    assert strokes[0] == 0.05
    assert end - 0.001 < strokes[1] <= end


def test_a_picture_holds_the_fields_on_an_even_chart():
    """Points of the chart are places on the surface, where the field is known without it."""
    surface, grid, P = surface_of(GRID), GRID, cy.closed.noise(GRID, seed=3)
    n_theta, n_s, length = surface.size(grid)
    chart = surface.drawn(grid, P)
    assert chart.shape == (2, n_theta, n_s)
    for i, j in ((0, 1), (3, n_s - 2), (5, n_s // 2)):
        theta, s = 2 * np.pi * i / n_theta, j / (n_s - 1) * length
        place, ahead = grid.position(theta, s), grid.position(theta, s + 1e-6)
        along, around = (ahead - place) / 1e-6, np.array([-np.sin(theta), np.cos(theta), 0.0])
        vector = grid.cartesian(P, [place])[0]
        np.testing.assert_allclose(chart[:, i, j], [vector @ around, vector @ along], atol=1e-5)


def test_a_picture_has_the_defects_and_records_of_a_closed_cell():
    session = Session(setup.from_tables(CAPSULE | START))
    data = session.picture()
    found = header(data)
    told = found["regime"]
    assert told["name"] == "cyclosis"
    assert sum(index for index, _, _ in told["defects"]) == 2
    assert told["boundaries"] == [2, 2]
    traces = about.about()["models"]["closed"]["traces"]
    assert found["records"] == 1 + len(traces)
    points = found["n_theta"] * found["n_z"]
    start = 8 + -(-int.from_bytes(data[:4], "little") // 8) * 8
    assert len(data) == start + 8 * found["records"] + 4 * (4 * points + 2 * found["n_theta"])
    records = dict(
        zip([item["name"] for item in traces], np.frombuffer(data, "<f8", 10, start)[1:], strict=True)
    )
    mean = diagnose(session.live.params_now, GRID, session.live.state)["mean_vector"]
    assert [records[f"mean_vector_{axis}"] for axis in "xyz"] == pytest.approx(np.asarray(mean), abs=1e-12)


def test_the_page_gets_the_meridian():
    outline = surface_of(GRID).outline(GRID)
    s = np.linspace(0, GRID.surface.meridian_length, len(outline["r"]))
    for k in (0, 20, 60, len(s) - 1):
        x, y, z = GRID.position(0.0, s[k])
        assert outline["r"][k] == pytest.approx(np.hypot(x, y), abs=2e-5)
        assert outline["z"][k] == pytest.approx(z, abs=2e-5)
    np.testing.assert_allclose(np.hypot(outline["out"], outline["up"]), 1.0, atol=1e-4)
    assert outline["axial"]
    assert surface_of(cy.CylinderGrid(16, 16)).outline(cy.CylinderGrid(16, 16)) is None


def test_a_live_cell_has_sixteen_waves_unless_it_says_more():
    begun = setup.from_tables({"model": {"kind": "closed"}, "grid": {"shape": "sphere"}})
    assert begun.grid.k_max == 16
    assert tomllib.loads(begun.toml())["grid"] == {"shape": "sphere", "k_max": 16}


@pytest.mark.parametrize(
    ("tables", "part"),
    [
        ({"grid": {"shape": "cube"}}, "shape = 'cube'"),
        ({"grid": {"shape": "capsule", "length": 1e9}}, "length = 1"),
        ({"grid": {"shape": "spheroid", "aspect": -1}}, "aspect = -1"),
        ({"grid": {"shape": "sphere", "length": 2.0}}, "used only where shape is capsule"),
        ({"grid": {"shape": "sphere", "n_z": 32}}, "used only where"),
        ({"grid": {"shape": "sphere", "k_max": 25}}, "at most 24"),
        ({"grid": {"shape": "sphere", "n_s": 4096}}, "at most 16384 in the explorer"),
        ({"grid": {"shape": "capsule", "length": 60.0, "k_max": 24}}, "at most 16384 in the explorer"),
        ({"grid": {"shape": "capsule", "smoothing": 0}}, "smoothing = 0"),
        ({"grid": {"shape": ["sphere"]}}, "shape = "),
        ({"grid": {"shape": "sphere"}, "parameters": {"repulsion_angle": 0.3}}, "0 on a closed surface"),
        ({"grid": {"shape": "sphere"}, "parameters": {"zero_theta_flux": True}}, "false on a closed surface"),
        (
            {"grid": {"shape": "sphere"}, "initial": {"kind": "stripes", "stripes": 4}},
            "2 on a closed surface",
        ),
        ({"model": {"kind": "kinetic"}}, "left out in the explorer"),
        ({"model": {"kind": "coupled"}}, "left out in the explorer"),
        ({"model": {"kind": "polar", "repulsion": "bounded"}}, "only where"),
    ],
)
def test_a_malformed_shape_is_refused_in_a_sentence(tables, part):
    def begin():
        begun = setup.from_tables({"model": {"kind": "closed"}} | tables)
        begun.is_dear()
        Session(begun)

    with pytest.raises(cy.InputError, match=part) as refused:
        begin()
    assert "\n" not in str(refused.value)


def test_the_bounded_repulsion_can_be_shown():
    begun = setup.from_tables({"model": {"kind": "closed", "repulsion": "bounded"}, "grid": {"k_max": 4}})
    assert begun.filled()["model"] == {"kind": "closed", "repulsion": "bounded"}


def test_surfaces_of_one_size_share_a_program_and_others_do_not():
    sizes = [
        surface_of(grid).program(grid)
        for grid in (
            cy.ClosedGrid(cy.Sphere(), k_max=4),
            cy.ClosedGrid(cy.Spheroid(1.01), k_max=4, n_s=cy.ClosedGrid(cy.Sphere(), k_max=4).n_s),
            cy.ClosedGrid(cy.Sphere(), k_max=6),
        )
    ]
    assert sizes[0] == sizes[1] != sizes[2]


def test_the_page_is_told_of_every_shape_and_what_has_no_meaning_there():
    told = about.about()
    settings = {shape["name"]: [item["name"] for item in shape["settings"]] for shape in told["shapes"]}
    assert settings == {
        "cylinder": ["n_theta", "n_z", "length"],
        "capsule": ["length", "smoothing", "k_max"],
        "spheroid": ["aspect", "k_max"],
        "sphere": ["k_max"],
    }
    begun = {
        shape["name"]: {item["name"]: item["default"] for item in shape["settings"]}
        for shape in told["shapes"]
        if shape["model"] == "closed"
    }
    for name, grid in begun.items():
        assert (
            setup.from_tables({"model": {"kind": "closed"}, "grid": {"shape": name} | grid}).grid.k_max == 16
        )
    assert told["models"]["closed"]["unused"] == ("repulsion_angle", "zero_theta_flux")
    assert about.curves(cy.Parameters(), straight=False) == {"applies": False, "curves": []}
