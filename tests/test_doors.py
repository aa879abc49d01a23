"""Every public function refuses what it cannot mean: values that JAX traces, and arguments in other places.

The functions are found by walking the public names, so that a new one is tested too: it needs no more than an
example value here for each of its arguments whose name is new.
"""

import importlib
import inspect
import re
import types
from functools import cache
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.model import bumps
from cyclosis.model.scales import layer_mu

GRID = cy.CylinderGrid(16, 16)
PARAMS = cy.Parameters()
STATE = cy.initial.stripes(GRID)
CLOSED = cy.ClosedGrid(cy.Sphere(), k_max=4)
ON_CLOSED = {"grid": CLOSED, "state": np.zeros((2, *CLOSED.shape)), "m": 1, "rank": 0}
"""Examples for the functions that take a closed grid alone."""
MODULES = (
    *(cy, cy.stability, cy.stability.dispersion, cy.stability.elliptic, cy.stability.profile),
    *(cy.zones, cy.diagnostics, cy.initial, bumps, cy.ensemble, cy.regions, cy.vacuole, cy.closed),
    cy.observations,
)
API = Path(__file__).parents[1] / "docs" / "api"
DOCUMENTED = re.compile(r"^\.\. autofunction:: (cyclosis\.figures\.\w+)\.(\w+)$", re.MULTILINE)
INNER = {"measure", "tail"}
"""Functions of a `System`, which JAX may trace."""
NUMERIC = ("float", "int", "bool", "Array")
"""What the annotation of an argument says that takes numbers."""
EXAMPLES = {
    **{"params": PARAMS, "grid": GRID, "state": STATE, "P": STATE, "u": STATE, "guess": STATE, "time": 0.0},
    **{"t_end": 1.0, "save_every": 1.0, "checkpoint_seconds": 30.0, "dealias": "none"},
    **{"values": np.ones((16, 16)), "shape": (16, 16), "at": 1.0, "over": 0.0, "size": 0.1, "angle": 0.5},
    **{"magnitude": 0.5, "keep": 0.5, "filaments_per_square": 100.0, "noise_grid": (16, 16), "seed": 0},
    **{"theta": 1.0, "z": 1.0, "radius": 0.5, "theta0": 0.0, "theta1": 1.0, "z0": 0.0, "z1": 1.0},
    **{
        "start": 0.5,
        "stop": 1.0,
        "axis": "z",
        "count": 2,
        "share": 0.5,
        "offset": 0.0,
        "path": "nowhere.png",
    },
    **{
        "rng": np.random.default_rng(0),
        "frame": 0,
        "n_theta": 64,
        "n_z": 16,
        "length": 5.0,
        "base": "disorder",
    },
    **{"contrast": 0.5, "stretch": False, "closure": "paper", "c": 1.0},
    **{"m": 1.0, "q": 0.0, "root": 0, "alpha_p": 1.0, "alpha_u": [0.1, 0.2], "full": False, "most": 10.0},
    **{"name": "alpha_p", "x": ("alpha_p", [0.1, 0.2]), "y": ("kappa", [0.1, 0.2]), "parameter": "alpha_u"},
    **{"bounds": (0.1, 1.0), "longest": 0.02, "depth": 1, "duration": 1.0, "hand": "right", "options": {}},
    **{"profile": np.cos(GRID.theta), "angles": [1.0, 2.0], "axial_mode": 0, "components": "both"},
    **{"precision": "float64", "fields": True, "force": False, "continues": False, "store": "nowhere"},
    **{"workers": 1, "sweep": None, "width": 180.0, "tilt": 0.2, "view_angle": 0.0, "times": [0.0, 1.0]},
    **{"map_times": [0.0, 1.0], "frames": 2, "seconds": 1.0, "turns": 0.5, "height": 90, "paths": "film.gif"},
    **{"ax": None, "streamlines": True, "peak_speed": 1.0, "pixels": 16, "separation": 0.5, "slowest": 0.0},
    **{"dataset": None, "select": None, "cuts": None, "log": False, "bases": ("disorder",), "largest": 6.0},
    **{"found": None, "modes": None, "branch": None, "branches": [], "theory": True, "near": None},
    **{"members": [], "radius_um": 500.0, "speed_um_per_s": 100.0, "friction_Pa_s_per_m": 1.0},
    **{"flow": cy.vacuole.flow(GRID, STATE), "lines": 3, "pitches": (1.0, 2.0, 3.0, 4.0), "pitch": 5.0},
    **{"peclet": 10.0, "wall": cy.vacuole.Sealed(), "wavenumber": 1.0, "n_r": 8, "dt": 0.1, "every": 0.5},
    **{"starts": [[0.5, 0.0, 0.0]], "save_at": [1.0], "order": 3, "refine": 1, "n_s": 16, "region": None},
    **{"transport": None, "peclets": [1.0, 10.0], "tracers": 2},
    **{"source": GRID, "t": 0.0, "radii": [0.0, 1.0], "a": 1.0, "b": 1.0},
    **{
        "image": np.eye(32),
        "columns": 1,
        "rows": 1,
        "kernel_px": 9.0,
        "obs": None,
        "measured": None,
        "data": None,
    },
    **{"vx": np.ones((16, 16)), "vy": np.ones((16, 16)), "good": None, "simulated": None, "format": None},
    **{"frame_s": 0.3, "pixel_um": 5.0, "every_s": 1.0, "step_px": 1.0, "noise_px": 0.1, "window_px": 32.0},
    **{
        "origin_px": (0.0, 0.0),
        "focus_um": [0.0],
        "line_px": None,
        "max_gap": 3,
        "speed": 1.0,
        "radius_um": 500.0,
        "speed_um_s": 75.0,
        "mirrored": False,
    },
    **{"max_angle_deg": 80.0, "outside": "drop", "depth_um": 100.0, "scales": None, "depth_px": 10.0},
    **{"thickness_to_radius": 0.4, "no_slip_walls": 1, "ribbons": None, "figure": None},
    **{
        "data": None,
        "parameters": None,
        "fix": None,
        "method": "auto",
        "scales": None,
        "draws": 8,
        "window": 0.1,
    },
    **{
        "geometry": None,
        "progress": None,
        "pairs": 2,
        "gap": 1,
        "average": 1,
        "steady_stage": True,
        "size_px": (64, 64),
    },
    **{"view": "map", "centred": True},
    **{"first": None, "second": None, "names": ("A", "B")},
}


@cache
def short_run():
    return cy.simulate(PARAMS, GRID, STATE, t_end=0.1)


def public(module):
    names = getattr(module, "__all__", None) or [name for name in vars(module) if not name.startswith("_")]
    for name in names:
        value = getattr(module, name)
        home = getattr(value, "__module__", "")
        own = (
            module in (cy, cy.stability, cy.ensemble, cy.regions, cy.vacuole, cy.observations)
            or home == module.__name__
        )
        if isinstance(value, types.FunctionType) and home.startswith("cyclosis.") and own:
            yield value


FUNCTIONS = {
    f"{value.__module__.removeprefix('cyclosis.')}.{value.__name__}": value
    for module in MODULES
    for value in public(module)
    if value.__name__ not in INNER
}
FUNCTIONS |= {
    f"figures.{module.rpartition('.')[2]}.{name}": getattr(importlib.import_module(module), name)
    for module, name in DOCUMENTED.findall((API / "figures.md").read_text())
}
CLASSES = {c.__name__: c for c in (cy.Parameters, cy.CylinderGrid, cy.Scales, cy.ensemble.EnsembleSettings)}
FUNCTIONS |= CLASSES | {"scales.layer_mu": layer_mu}


def arguments(function):
    """The arguments of a function by name."""
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return {n: p for n, p in inspect.signature(function).parameters.items() if p.kind not in kinds}


def example(function, name):
    """A value that an argument may have; the test tells which one is missing here."""
    if function in CLASSES.values():
        default = arguments(function)[name].default
        return 2 if default is None else default
    if name == "run":
        return short_run()
    if name in ON_CLOSED and str(getattr(arguments(function).get("grid"), "annotation", "")) == "ClosedGrid":
        return ON_CLOSED[name]
    assert name in EXAMPLES, f"give {function.__name__} an example of {name} in EXAMPLES"
    if (function.__name__, name) in (("profile_modes", "P"), ("elliptic_profile", "theta")):
        return np.cos(GRID.theta)
    return EXAMPLES[name]


def needed(function):
    return {
        name: example(function, name)
        for name, item in arguments(function).items()
        if item.default is inspect.Parameter.empty
    }


def numeric(function):
    """The arguments of a function that take numbers."""
    for name, item in arguments(function).items():
        text = str(item.annotation)
        if (
            any(word in text for word in NUMERIC)
            and "Callable" not in text
            and name not in ("params", "grid")
        ):
            yield name


CASES = [(label, name) for label, function in FUNCTIONS.items() for name in numeric(function)]


def test_the_walk_finds_the_doors():
    """A guard of the guard: these take states, fields and numbers, and are found."""
    names = {label.rpartition(".")[2] for label in FUNCTIONS}
    assert {"simulate", "flow", "rate_of_change", "regime", "diagnose", "spectra", "cyclosis"} <= names
    assert {"growth_rates", "limits", "crossings", "fitted", "draw", "draw_map", "interpolate"} <= names
    assert len(FUNCTIONS) > 80
    assert len(CASES) > 150


TRANSFORMS = {
    "grad": lambda f, x: jax.grad(f)(x),
    "vmap": lambda f, x: jax.vmap(f)(jnp.stack([x, x])),
    "jit": lambda f, x: jax.jit(f)(x),
}


@pytest.mark.parametrize(("label", "name"), CASES)
def test_traced_numbers_are_refused(label, name):
    """And in one sentence that says where they may go: a gradient of zero would be wrong without a word."""
    function = FUNCTIONS[label]
    value = example(function, name)
    row = isinstance(value, list | tuple)
    for transform in TRANSFORMS.values():

        def call(x):
            given = [x, x] if row else x if value is None else jnp.asarray(value, jnp.float32) * x
            function(**needed(function) | {name: given})
            return x

        with pytest.raises(cy.InputError, match=r"JAX traces .* cyclosis\.traced") as refused:
            transform(call, jnp.float32(1.0))
        assert len(str(refused.value).splitlines()) == 1


WITH_CELL = [label for label, f in FUNCTIONS.items() if {"params", "grid", "run"} & arguments(f).keys()]


@pytest.mark.parametrize("label", WITH_CELL)
def test_arguments_in_other_places_are_told_apart(label):
    """simulate(grid, params, state) and the like: which argument is wrong, and the order of the arguments."""
    function, right = FUNCTIONS[label], needed(FUNCTIONS[label])
    wrong = {"params": (GRID, STATE, "alpha"), "grid": (PARAMS, STATE, (16, 16)), "run": (GRID, "run.nc")}
    for name in {"params", "grid", "run"} & right.keys():
        for value in wrong[name]:
            with pytest.raises(cy.InputError, match=rf"^{name} = .* cyclosis\..*write {function.__name__}\("):
                function(**right | {name: value})


def test_the_swap_that_users_make():
    with pytest.raises(
        cy.InputError, match=r"a cyclosis.Parameters; write simulate\(params, grid, state\)\.$"
    ):
        cy.simulate(GRID, PARAMS, STATE)
    with pytest.raises(cy.InputError, match=r"write Member\(params, grid, state\)"):
        cy.ensemble.Member(GRID, PARAMS, lambda: STATE)
    with pytest.raises(cy.InputError, match="a function that makes the initial state"):
        cy.ensemble.Member(PARAMS, GRID, STATE)
    with pytest.raises(cy.InputError, match=r"write mask\(grid\)"):
        cy.regions.disc(1.0, 1.0, 0.5).mask(PARAMS)
    with pytest.raises(cy.InputError, match=r"write flow\(params, grid, P\)"):
        cy.traced.flow(GRID, PARAMS, STATE)


def test_traced_values_inside_lists_and_further_settings_are_refused():
    def inside(call):
        with pytest.raises(cy.InputError, match=r"cyclosis\.traced"):
            jax.grad(lambda x: (call(x), x)[1])(1.0)

    def objects(x):
        array = np.empty((2, 16, 16), dtype=object)
        for place in np.ndindex(array.shape):
            array[place] = x
        return array

    inside(lambda x: cy.Parameters(kappa=[[x, x], [x, x]]))
    inside(lambda x: cy.flow(PARAMS, GRID, objects(x)))
    inside(lambda x: cy.simulate(PARAMS, GRID, STATE, rtol=x))
    inside(lambda x: cy.simulate(PARAMS, GRID, STATE, save_at=[0.0, x]))
    inside(lambda x: cy.change(at=1.0, alpha_p=x))
    inside(lambda x: cy.Parameters(zero_theta_flux=x))
    inside(lambda x: GRID.check_state(x * STATE))
    inside(lambda x: cy.stability.stripes(PARAMS, 2, 64).at([x]))


def test_computing_inside_jit_is_refused_and_inside_grad_it_is_a_constant():
    with pytest.raises(cy.InputError, match=r"inside jax\.jit"):
        jax.jit(lambda x: x * cy.flow(PARAMS, GRID, STATE).max())(1.0)
    fastest = cy.flow(PARAMS, GRID, STATE).max()
    assert float(jax.grad(lambda x: x * cy.flow(PARAMS, GRID, STATE).max())(1.0)) == pytest.approx(fastest)
