"""One clear sentence for input that a closed cell cannot have."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis import config
from cyclosis.closed.shapes import shape_of
from cyclosis.models.closed.shape_table import grid_of
from cyclosis.models.closed.starts import closed_state

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
    with pytest.raises(cy.InputError, match=r"must be a .nc file of a run on a closed surface"):
        config.setup(config.check(tables | {"initial": {"kind": "file", "path": str(run)}}))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Runs of a closed cell and of a cylinder."""
    folder, run = tmp_path_factory.mktemp("runs"), {"t_end": 0.1, "save_every": 0.1}
    made = {}
    for name, grid, state in (
        ("closed", GRID, STATE),
        ("cylinder", CYLINDER, cy.initial.stripes(CYLINDER)),
    ):
        made[name] = folder / f"{name}.nc"
        cy.write(cy.simulate(cy.Parameters(), grid, state, **run), made[name])
    return made


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("cylinder", {}, "the cell in .* = 'a cylinder' cannot be used: it must be a closed surface"),
        ("closed", {"frame": 7}, "frame = 7"),
        ("closed", {"stretch": True}, "stretch = True"),
    ],
)
def test_files_that_hold_no_such_state(files, name, given, words):
    grid = GRID if name == "closed" else cy.ClosedGrid(cy.Sphere(), k_max=6)
    with pytest.raises(cy.InputError, match=words):
        closed_state({"kind": "file", "path": str(files[name]), **given}, grid)


def test_a_run_on_another_shape_is_no_state(files):
    with pytest.raises(cy.InputError, match=r"the surface in .*Capsule"):
        closed_state({"kind": "file", "path": str(files["closed"])}, cy.ClosedGrid(cy.Sphere(), k_max=6))


def test_a_run_gives_the_state_of_a_grid_of_any_resolution(files):
    given = {"kind": "file", "path": str(files["closed"])}
    same = closed_state(given, GRID)
    with cy.open_dataset(files["closed"]) as data:
        assert np.array_equal(same, data["P"][-1].values)
    finer = cy.ClosedGrid(GRID.surface, k_max=GRID.k_max + 3)
    points = np.moveaxis(GRID.xyz, 0, -1).reshape(-1, 3)
    found = [
        grid.cartesian(state, points) for grid, state in ((GRID, same), (finer, closed_state(given, finer)))
    ]
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-10)


def test_fields_may_name_their_dimensions():
    """In any order, and as they do in files of closed cells."""
    alpha_p = 0.5 + 0.1 * np.cos(GRID.theta)[:, None] * np.ones(GRID.shape)
    named = xarray.DataArray(alpha_p, dims=("theta", "s"))
    for given in (named, named.T):
        assert np.array_equal(cy.Parameters(alpha_p=given).alpha_p, alpha_p)
    with pytest.raises(cy.InputError, match="dimensions of alpha_p"):
        cy.Parameters(alpha_p=named.rename(theta="longitude"))
