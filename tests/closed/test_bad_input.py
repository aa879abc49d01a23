"""One clear sentence for input that a closed cell cannot have."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis import config
from cyclosis.closed.shapes import shape_of
from cyclosis.models.closed.shape_table import grid_of

GRID = cy.ClosedGrid(cy.Capsule(2.0), k_max=6)
OTHER = cy.ClosedGrid(cy.Capsule(2.0), k_max=8)
CYLINDER = cy.CylinderGrid(16, 16)
STATE = cy.closed.rotation(GRID)
PARAMS = cy.Parameters()
FIELD = xarray.DataArray(np.ones(GRID.shape), {"z": np.arange(GRID.n_s) / 4.0}, ("theta", "z"))


def begin(params=PARAMS, state=STATE, grid=GRID, **settings):
    return cy.simulate(params, grid, state, 0.1, **settings)


CASES = {
    "oblique d": (lambda: begin(cy.Parameters(repulsion_angle=0.3)), "repulsion_angle = 0.3"),
    "oblique d, one rate": (
        lambda: cy.rate_of_change(cy.Parameters(repulsion_angle=0.3), GRID, STATE),
        "repulsion_angle = 0.3",
    ),
    "flux around": (lambda: begin(cy.Parameters(zero_theta_flux=True)), "zero_theta_flux = True"),
    "dealias": (lambda: begin(dealias="cubic"), "dealias = 'cubic' cannot be used: it must be none"),
    "field of another grid": (
        lambda: begin(cy.Parameters(alpha_p=np.ones(OTHER.shape))),
        f"shape of the parameter fields .* must be that of the grid, \\({GRID.n_theta}, {GRID.n_s}\\)",
    ),
    "field along z": (
        lambda: begin(cy.Parameters(alpha_p=FIELD)),
        "length of the parameter fields .* left out on a closed surface",
    ),
    "state of another grid": (lambda: begin(state=cy.closed.rotation(OTHER)), "state = an array"),
    "state of a cylinder": (lambda: begin(state=cy.initial.stripes(CYLINDER)), "state = an array"),
    "too long": (lambda: begin(state=1.5 * STATE), r"max \|P\| of"),
    "not finite": (lambda: begin(state=np.nan * STATE), "finite"),
    "model of the cylinder": (lambda: begin(model=cy.models.polar), "grid = ClosedGrid"),
    "closed model of a cylinder": (
        lambda: begin(state=cy.initial.stripes(CYLINDER), grid=CYLINDER, model=cy.models.closed),
        "grid = CylinderGrid",
    ),
    "points off the surface": (lambda: GRID.cartesian(STATE, [[0.0, 0.0, 0.0]]), "off the surface"),
    "points of two numbers": (lambda: GRID.cartesian(STATE, [[0.0, 1.0]]), "array \\(n, 3\\)"),
    "k_max too small": (lambda: cy.ClosedGrid(cy.Sphere(), k_max=1.0), "k_max = 1"),
    "k_max too large": (lambda: cy.ClosedGrid(cy.Sphere(), k_max=200.0), "k_max = 200"),
    "too few points": (lambda: cy.ClosedGrid(cy.Sphere(), k_max=8, n_theta=10), "n_theta = 10"),
    "no surface": (lambda: cy.ClosedGrid("capsule"), "surface = 'capsule'"),
    "unknown shape": (lambda: shape_of({"kind": "torus"}), "shape = 'torus'"),
    "unknown shape of a table": (lambda: grid_of(shape="torus"), "shape = 'torus'"),
    "length of a sphere": (lambda: shape_of({"kind": "sphere", "length": 3.0}), "shape.length = 3"),
    "length of a sphere's table": (lambda: grid_of(shape="sphere", length=3.0), "length = 3"),
    "points along z": (lambda: grid_of(shape="sphere", n_z=32), "n_z = 32"),
    "capsule too long": (lambda: cy.Capsule(100.0), "length = 100"),
    "capsule too sharp": (lambda: cy.Capsule(5.0, 0.01), "smoothing = 0.01"),
    "spheroid too slim": (lambda: cy.Spheroid(50.0), "aspect = 50"),
    "repulsion": (lambda: cy.models.closed_model("azimuthal"), "repulsion = 'azimuthal'"),
    "noise grid": (
        lambda: begin(protocol=[cy.fragment(at=0.05, noise_grid=8)]),
        "noise_grid = 8",
    ),
    "place off the cell": (
        lambda: begin(protocol=[cy.fragment(at=0.05, where=cy.regions.disc(0.0, 9.0, 1.0))]),
        "z = 9.0 cannot be used: it must be on the cell",
    ),
    "magnitude": (lambda: cy.closed.swirl(GRID, 1.2), "magnitude = 1.2"),
    "vacuole": (lambda: cy.vacuole.flow(GRID, STATE), "grid = ClosedGrid"),
}


@pytest.mark.parametrize("name", CASES)
def test_bad_input_gets_one_sentence(name):
    call, words = CASES[name]
    with pytest.raises(cy.InputError, match=words) as refused:
        call()
    text = str(refused.value)
    assert "cannot be used: it must be" in text
    assert text.endswith(".")
    assert "\n" not in text


def test_a_file_of_a_cylinder_is_no_state(tmp_path):
    path = tmp_path / "state.npy"
    np.save(path, cy.initial.stripes(CYLINDER))
    tables = {
        "model": {"kind": "closed"},
        "grid": {"shape": "capsule", "length": 2.0, "k_max": 6},
        "initial": {"kind": "file", "path": str(path)},
    }
    with pytest.raises(cy.InputError, match=r"the state in .*state.npy"):
        config.setup(config.check(tables))
    run = tmp_path / "run.nc"
    run.write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(cy.InputError, match=r"a .npy file with a state of shape"):
        config.setup(config.check(tables | {"initial": {"kind": "file", "path": str(run)}}))
