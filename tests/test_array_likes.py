"""Arrays that carry more than numbers are used rightly or refused in one sentence, at every door."""

import dask.array
import jax
import matplotlib.figure
import numpy as np
import pandas
import pytest
import scipy.sparse
import xarray

import cyclosis as cy
from cyclosis.figures import cylinder
from cyclosis.figures.frames import indices_at
from cyclosis.figures.streamlines import streamlines
from cyclosis.figures.unwrapped import draw_map

GRID = cy.CylinderGrid(16, 12, 5.0)
PARAMS = cy.Parameters()
RNG = np.random.default_rng(3)
STATE = 0.5 * cy.interpolate(RNG.uniform(-1, 1, (2, 8, 8)), GRID.shape)
FIELD = RNG.uniform(0.1, 1.0, GRID.shape)
RUN = cy.simulate(PARAMS, GRID, STATE, t_end=0.2, save_every=0.1)
NAMED = {"component": ["theta", "z"], "theta": GRID.theta, "z": GRID.z}


class Quantity:
    """A number or an array with a unit, as those of pint: no array, but NumPy can read it."""

    def __init__(self, magnitude, units):
        self.magnitude, self.units = magnitude, units

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.magnitude, dtype)

    def __float__(self):
        return float(self.magnitude)

    def __getattr__(self, name):
        return getattr(self.magnitude, name)


class UnitArray(np.ndarray):
    """An array with a unit, as those of astropy: NumPy takes it for one of its own."""

    unit = "um"


def axes():
    return matplotlib.figure.Figure().add_subplot()


STATES = {
    "check_state": lambda x: GRID.check_state(x),
    "simulate": lambda x: cy.simulate(PARAMS, GRID, x, t_end=0.1).final_state,
    "flow": lambda x: cy.flow(PARAMS, GRID, x),
    "rate_of_change": lambda x: cy.rate_of_change(PARAMS, GRID, x),
    "traced": lambda x: np.asarray(cy.traced.flow(PARAMS, GRID, x, precision="float32")),
    "diagnose": lambda x: cy.diagnose(PARAMS, GRID, x)["power_input"],
    "spectra": lambda x: cy.spectra(GRID, x)["axial"],
    "regime": lambda x: cy.regime(PARAMS, GRID, x).drift,
    "zones": lambda x: [zone.z for zone in cy.zones.indifferent_zones(GRID, x)],
    "crossings": lambda x: cy.zones.crossings(x),
    "zones_of": lambda x: cy.zones.zones_of(x),
    "fitted": lambda x: cy.initial.fitted(cy.CylinderGrid(20, 20, 5.0), x),
    "with_noise": lambda x: cy.initial.with_noise(x, GRID),
    "interpolate": lambda x: cy.interpolate(x, (20, 20)),
    "follow": lambda x: (
        cy.ensemble.follow(
            [cy.ensemble.Member(PARAMS, GRID, lambda: x)],
            cy.ensemble.EnsembleSettings(t_end=0.1, finish="t_end"),
        )[0].state
    ),
    "cylinder": lambda x: cylinder.draw(axes(), GRID, x, STATE, streamlines=False),
    "map": lambda x: draw_map(axes(), GRID, x, STATE, streamlines=False),
    "streamlines": lambda x: [line.z for line in streamlines(GRID, x, separation=1.0)],
}
SLOW = {
    "steady_state": lambda x: cy.stability.steady_state(PARAMS, GRID, x),
    "leading_modes": lambda x: cy.stability.leading_modes(PARAMS, GRID, x),
    "flow of a picture": lambda x: cylinder.draw(axes(), GRID, STATE, x),
}
"""What takes states as the others do, and seconds to use one: only their refusals are tested."""
FIELDS = {
    "Parameters": lambda x: cy.Parameters(kappa=x).kappa,
    "alpha_p": lambda x: cy.flow(cy.Parameters(alpha_p=x), GRID, STATE),
    "replace": lambda x: PARAMS.replace(repulsion_angle=x).repulsion_angle,
    "traced field": lambda x: np.asarray(
        cy.traced.rate_of_change(PARAMS, GRID, STATE, precision="float32", alpha_u=x)
    ),
    "interpolate": lambda x: cy.interpolate(x, (20, 20)),
}
ROWS = {
    "save_at": lambda x: cy.simulate(PARAMS, GRID, STATE, t_end=0.2, save_at=x).times,
    "frames": lambda x: indices_at(RUN.to_dataset(), x),
    "m": lambda x: cy.stability.growth_rates(PARAMS, "disorder", x, 0.0),
    "q": lambda x: cy.stability.growth_matrix(PARAMS, "disorder", 0.0, x),
    "orders": lambda x: cy.stability.unidirectional_order(PARAMS, x),
    "tilt": lambda x: cy.stability.tilt_threshold(PARAMS, x),
    "stripes_threshold": lambda x: cy.stability.stripes_threshold(PARAMS, x),
    "elliptic": lambda x: cy.stability.elliptic_profile(PARAMS, x),
    "at": lambda x: cy.stability.stripes(PARAMS, 2, 64).at(x)[0],
    "zone_angles": lambda x: cy.zones.zone_angles(x),
    "stripe_widths": lambda x: cy.zones.stripe_widths(x),
    "sweep": lambda x: [*cy.Sweep.from_tables({"axes": {"alpha_p": {"values": x}}}).axes["alpha_p"]],
}
TIMES = np.array([0.0, 0.1, 0.2])


def masked(x):
    return np.ma.masked_array(x, mask=np.arange(x.size).reshape(x.shape) == 1)


REFUSED = {
    "masked": masked,
    "masked inside a list": lambda x: list(masked(x)),
    "units": lambda x: Quantity(x, "1/s"),
    "units inside a list": lambda x: [Quantity(part, "metre") for part in x],
    "units of an array": lambda x: x.view(UnitArray),
    "units in attributes": lambda x: xarray.DataArray(x, attrs={"units": "s"}),
    "complex": lambda x: x.astype(complex),
    "text": lambda x: x.astype(str),
    "objects": lambda x: x.astype(object),
    "flags": lambda x: x > 0,
    "structured": lambda x: np.rec.fromarrays([x, x]),
    "moments": lambda x: x.astype("datetime64[s]"),
    "sparse": lambda x: scipy.sparse.coo_array(x.reshape(x.shape[0], -1)),
    "nothing": lambda x: None if x.ndim > 1 else [None] * 3,
    "a function": lambda x: np.sin,
    "a table": lambda x: {"P": x},
    "a dataset": lambda x: xarray.Dataset({"P": xarray.DataArray(x)}),
}
USED = {
    "read-only": lambda x: frozen(x.copy()),
    "big-endian": lambda x: x.astype(">f8"),
    "Fortran order": lambda x: np.asfortranarray(x),
    "not contiguous": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "nothing masked": lambda x: np.ma.masked_array(x, mask=np.zeros(x.shape, bool)),
    "no mask": lambda x: np.ma.masked_array(x),
    "a list": lambda x: x.tolist(),
    "a list of arrays": lambda x: list(x),
    "dask": dask.array.from_array,
    "xarray without names": lambda x: xarray.DataArray(x, attrs={"units": "1"}),
    "no unit": lambda x: Quantity(x, "dimensionless"),
    "long double": lambda x: x.astype(np.longdouble),
}
ROUGH = {
    "single precision": lambda x: x.astype(np.float32),
    "half precision": lambda x: x.astype(np.float16),
    "jax": jax.numpy.asarray,  # single precision where x64 is off
}
STATE_LIKES = {
    "order of xarray": lambda x: named(x).transpose("z", "theta", "component"),
    "another order": lambda x: named(x).transpose("theta", "component", "z"),
    "components swapped": lambda x: named(x).isel(component=[1, 0]),
    "turned over": lambda x: named(x).isel(z=slice(None, None, -1)),
    "names alone": lambda x: xarray.DataArray(x, dims=tuple(NAMED)).transpose("z", "component", "theta"),
    "a variable": lambda x: xarray.Variable(tuple(NAMED), x).transpose("z", "component", "theta"),
    "components of xarray": lambda x: [
        xarray.DataArray(part, {"theta": GRID.theta, "z": GRID.z}, ("theta", "z")).T for part in x
    ],
}
FIELD_LIKES = {
    "order of xarray": lambda x: field(x).T,
    "turned over": lambda x: field(x).isel(theta=slice(None, None, -1)),
    "pandas": lambda x: pandas.DataFrame(x),
    "pandas with names": lambda x: field(x).T.to_pandas(),
}
ROW_LIKES = {
    "pandas": pandas.Series,
    "pandas index": pandas.Index,
    "xarray": lambda x: xarray.DataArray(x, {"theta": 2 * np.pi / x.size * np.arange(x.size)}, ("theta",)),
}


def named(x):
    return xarray.DataArray(x, NAMED, tuple(NAMED))


def field(x):
    return xarray.DataArray(x, {"theta": GRID.theta, "z": GRID.z}, ("theta", "z"))


def frozen(x):
    x.setflags(write=False)
    return x


DOORS = {
    **{f"state:{name}": (call, STATE, STATE_LIKES) for name, call in STATES.items()},
    **{f"field:{name}": (call, FIELD, FIELD_LIKES) for name, call in FIELDS.items()},
    **{f"row:{name}": (call, TIMES, ROW_LIKES) for name, call in ROWS.items()},
}
"""What takes an array, an array for it, and the likes of that kind of array."""


def alike(found, expected):
    if isinstance(expected, str) or expected is None:
        return found == expected
    if isinstance(expected, list):
        return len(found) == len(expected) and all(map(alike, found, expected))
    return np.array_equal(np.asarray(found), np.asarray(expected), equal_nan=True)


@pytest.fixture(scope="module")
def plain():
    """What every door makes of a plain array, computed once."""
    found = {}

    def of(door):
        if door not in found:
            call, value, _ = DOORS[door]
            found[door] = call(value)
        return found[door]

    return of


@pytest.mark.parametrize("like", REFUSED)
@pytest.mark.parametrize("door", [*DOORS, *SLOW])
def test_what_no_numbers_are_is_refused_in_a_sentence(door, like):
    call, value = DOORS[door][:2] if door in DOORS else (SLOW[door], STATE)
    with pytest.raises(cy.InputError) as refused:
        call(REFUSED[like](value))
    sentence = str(refused.value)
    assert "cannot be used" in sentence
    assert "\n" not in sentence


@pytest.mark.parametrize("like", USED)
@pytest.mark.parametrize("door", DOORS)
def test_other_arrays_of_the_same_numbers_are_used_rightly(door, like, plain):
    call, value, _ = DOORS[door]
    assert alike(call(USED[like](value)), plain(door))


@pytest.mark.parametrize("like", ROUGH)
@pytest.mark.parametrize("door", DOORS)
def test_less_precise_numbers_are_used_as_they_are(door, like):
    call, value, _ = DOORS[door]
    rounded = ROUGH[like](value)
    exact = np.asarray(rounded, dtype=np.float64)
    if "save_at" in door or "frames" in door:  # rounding may carry the last time over the end
        rounded, exact = rounded[:2], exact[:2]
    assert alike(call(rounded), call(exact))


@pytest.mark.parametrize(
    ("door", "like"), [(door, like) for door, (_, _, likes) in DOORS.items() for like in likes]
)
def test_names_and_coordinates_are_used_rightly(door, like, plain):
    call, value, likes = DOORS[door]
    assert alike(call(likes[like](value)), plain(door))


ANY_GRID = ("crossings", "zones_of", "interpolate")
"""What takes states of any cell."""


def wrong(array, **coordinates):
    return array.assign_coords(coordinates)


WITH_NAMES = xarray.DataArray(STATE, NAMED, tuple(NAMED))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (wrong(WITH_NAMES, z=GRID.z * 2), "z of .*even from 0 to 4.58333"),
        (wrong(WITH_NAMES, z=GRID.z + 0.1), "z of .*0.1 to 4.68333"),
        (wrong(WITH_NAMES, theta=np.degrees(GRID.theta)), "theta of .*0 to 337.5"),
        (wrong(WITH_NAMES, component=["r", "z"]), "component of .*theta, z"),
        (wrong(WITH_NAMES, z=list("abcdefghijkl")), "z of .*a to l"),
        (WITH_NAMES.rename(theta="phi"), r"dimensions of .*\(component, theta, z\), in any order"),
        (WITH_NAMES.expand_dims(time=[0.0]), "dimensions of .*select the rest"),
        (WITH_NAMES.isel(component=0), "dimensions of "),
    ],
)
@pytest.mark.parametrize("name", [n for n in (*STATES, *SLOW) if n not in ANY_GRID])
def test_coordinates_of_another_grid_are_refused(name, given, words):
    with pytest.raises(cy.InputError, match=words):
        (STATES | SLOW)[name](given)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (wrong(field(FIELD), z=GRID.z + 1), "z of "),
        (wrong(field(FIELD), theta=GRID.theta * 2), "theta of "),
        (field(FIELD).rename(z="x"), "dimensions of "),
        (wrong(field(FIELD), z=GRID.z * 2), "length of the parameter fields = 10"),
    ],
)
def test_fields_of_another_grid_are_refused(given, words):
    with pytest.raises(cy.InputError, match=words):
        cy.flow(cy.Parameters(kappa=given), GRID, STATE)


def test_the_length_of_fields_stays_known_when_another_value_changes():
    params = cy.Parameters(kappa=field(FIELD)).replace(alpha_p=0.5)
    cy.flow(params, GRID, STATE)
    with pytest.raises(cy.InputError, match="length of the parameter fields"):
        cy.flow(params, cy.CylinderGrid(16, 12, 7.0), STATE)
    with pytest.raises(cy.InputError, match="length of the parameter fields"):
        cy.simulate(params, cy.CylinderGrid(16, 12, 7.0), STATE)
    cy.flow(params.replace(kappa=0.5), cy.CylinderGrid(16, 12, 7.0), STATE)
    with pytest.raises(cy.InputError, match="that of one cell"):
        cy.Parameters(kappa=field(FIELD), alpha_u=wrong(field(FIELD), z=GRID.z * 2))


def test_a_frame_of_our_own_dataset_is_a_state_in_any_order():
    frame = RUN.to_dataset()["P"].isel(time=-1)
    for dims in (("component", "theta", "z"), ("z", "theta", "component"), ("theta", "z", "component")):
        assert np.array_equal(GRID.check_state(frame.transpose(*dims)), RUN.frames[-1])


SCALARS = {
    "array": np.array(0.25),
    "single": np.float32(0.25),
    "half": np.float16(0.25),
    "long": np.longdouble(0.25),
    "xarray": xarray.DataArray(0.25),
    "unit": Quantity(0.25, "dimensionless"),
    "unit of an array": Quantity(np.array(0.25), ""),
    "not masked": np.ma.masked_array(0.25),
    "jax": jax.numpy.asarray(0.25),
}
NOT_ONE = {
    "masked": np.ma.masked,
    "masked array": np.ma.masked_array(0.25, mask=True),
    "unit": Quantity(0.25, "1/s"),
    "unit in attributes": xarray.DataArray(0.25, attrs={"units": "s"}),
    "complex": np.complex128(0.25),
    "text": np.str_("0.25"),
    "object": np.array(0.25, dtype=object),
    "flag": np.bool_(True),
    "row": np.array([0.25]),
    "not a number": np.float64("nan"),
    "moment": np.datetime64("2020-01-01"),
    "missing": pandas.NA,
}
NUMBERS = {
    "parameter": lambda x: cy.Parameters(d_s=x).d_s,
    "coupling": lambda x: cy.Parameters(alpha_u=x).alpha_u,
    "length": lambda x: cy.CylinderGrid(16, 16, x).length,
    "t_end": lambda x: cy.simulate(PARAMS, GRID, STATE, t_end=x).t_final,
    "time": lambda x: cy.rate_of_change(PARAMS, GRID, STATE, time=x).shape and 0.25,
    "magnitude": lambda x: cy.initial.unidirectional(GRID, x)[1, 0, 0],
    "step": lambda x: cy.change(at=x, alpha_p=1.0).at,
    "region": lambda x: cy.regions.disc(1.0, 1.0, x).radius,
    "scale": lambda x: cy.Scales(radius_um=x).radius_um,
    "tilt": lambda x: cylinder.checked_tilt(x),
    "zone": lambda x: cy.stability.stripes(PARAMS, 2, 64).at([1.0], zone=x)[0].size and 0.25,
}


@pytest.mark.parametrize("like", SCALARS)
@pytest.mark.parametrize("door", NUMBERS)
def test_one_number_in_whatever_array_is_used(door, like):
    assert NUMBERS[door](SCALARS[like]) == 0.25


@pytest.mark.parametrize("like", NOT_ONE)
@pytest.mark.parametrize("door", NUMBERS)
def test_what_is_not_one_number_is_refused(door, like):
    if door == "coupling" and like == "row":
        pytest.skip("a field of a wrong shape, tested above")
    with pytest.raises(cy.InputError) as refused:
        NUMBERS[door](NOT_ONE[like])
    assert "\n" not in str(refused.value)


def test_whole_numbers_and_flags():
    assert cy.CylinderGrid(np.int16(16), np.array(12)).shape == (16, 12)
    assert cy.Parameters(zero_theta_flux=np.array(True)).zero_theta_flux is True
    for broken in (np.ma.masked, Quantity(16, "metre"), 16.0, np.array([16])):
        with pytest.raises(cy.InputError):
            cy.CylinderGrid(broken, 16)
    for broken in (np.ma.masked, Quantity(True, "metre"), 1, np.array([True])):
        with pytest.raises(cy.InputError):
            cy.Parameters(zero_theta_flux=broken)


def test_arrays_that_are_combined_by_position_must_not_have_other_names():
    m = xarray.DataArray([[1.0, 2.0]], dims=("a", "b"))
    with pytest.raises(cy.InputError, match="dimensions of m and q"):
        cy.stability.growth_rates(PARAMS, "disorder", m, m.T)
    with pytest.raises(cy.InputError, match="broadcast"):
        cy.stability.growth_rates(PARAMS, "disorder", [1.0, 2.0], [1.0, 2.0, 3.0])


def test_what_is_given_is_never_written_to():
    state, kappa = STATE.copy(), FIELD.copy()
    params = cy.Parameters(kappa=kappa)
    cy.simulate(params, GRID, state, t_end=0.1)
    cy.regime(params, GRID, state)
    assert np.array_equal(state, STATE)
    kappa[:] = 0.0
    assert np.array_equal(params.kappa, FIELD)


def test_without_a_grid_coordinates_must_still_be_those_of_one():
    assert cy.zones.crossings(wrong(WITH_NAMES, z=GRID.z * 2)).shape == (12,)
    for given in (wrong(WITH_NAMES, z=GRID.z + 0.1), wrong(WITH_NAMES, theta=GRID.theta + 1)):
        for door in ANY_GRID:
            with pytest.raises(cy.InputError, match="that of the grid, even from 0"):
                STATES[door](given)
