"""Every setting of a run, defined once: symbol, name, meaning, default, range.

Validation, the command line's options, the configuration file and the documentation's tables all read
these definitions. Nothing heavy is imported here.
"""

from __future__ import annotations

from typing import Any

from .equation import TERM_NAMES as TERM_NAMES
from .setting import Definition as Definition

PARAMETERS = (
    Definition("alpha_p", "α_p", "spontaneous alignment (bundling) rate", 1.0, field=True, usual=(0.0, 1.0)),
    Definition(
        "alpha_u", "α_u", "polar alignment of filaments with the flow", 0.5, field=True, usual=(0.0, 1.0)
    ),
    Definition(
        "epsilon",
        "ε",
        "passive advection and shear alignment left by restriction",
        0.1,
        maximum=10.0,
        usual=(0.0, 1.0),
    ),
    Definition("d_s", "d⁽ˢ⁾", "spatial diffusion constant", 0.025, maximum=10.0, usual=(0.0, 0.1)),
    Definition("d_r", "d⁽ʳ⁾", "rotational diffusion constant", 0.025, maximum=10.0, usual=(0.0, 0.2)),
    Definition("kappa", "κ", "strength of the repulsive direction", 0.5, field=True, usual=(0.0, 1.0)),
    Definition(
        "mu",
        "μ",
        "viscosity of the layer relative to its wall friction",
        0.05,
        maximum=100.0,
        usual=(0.0, 1.0),
    ),
    Definition(
        "repulsion_angle",
        "φ_d",
        "angle of the repulsive direction d from e_theta, in radians",
        0.0,
        minimum=-10.0,
        maximum=10.0,
        field=True,
        usual=(-1.6, 1.6),
    ),
    Definition(
        "zero_theta_flux",
        "-",
        "also hold the mean circumferential flow at zero",
        False,
        kind="flag",
    ),
    Definition(
        "force_exponent", "n", "exponent of the force law F = |P|^n P", 2.0, maximum=10.0, usual=(0.0, 4.0)
    ),
)

GRID = (
    Definition("n_theta", "n_θ", "grid points around the axis", 64, "whole", 8, 8192),
    Definition(
        "n_z",
        "n_z",
        "grid points along the axis; 1 for states that vary around it only",
        64,
        "whole",
        8,
        8192,
        also=1,
    ),
    Definition("length", "ℓ", "axial period in units of the radius", 5.0, "number", 1e-2, 1e4),
)

SURFACE = (
    Definition(
        "shape",
        "-",
        "shape of a closed cell (default: capsule, with length for its straight part)",
        None,
        "choice",
        allowed=("capsule", "spheroid", "sphere"),
        optional=True,
    ),
    Definition(
        "smoothing",
        "w",
        "smoothing of the ends of a capsule, in radii (default: 0.4)",
        None,
        "number",
        0.1,
        1.0,
        optional=True,
    ),
    Definition(
        "aspect",
        "c",
        "half height of a spheroid over its equatorial radius (default: 2)",
        None,
        "number",
        0.2,
        20.0,
        optional=True,
    ),
    Definition(
        "k_max",
        "k",
        "largest wavenumber on a closed cell, in waves per radian of a unit sphere (default: 24)",
        None,
        "number",
        2.0,
        96.0,
        optional=True,
    ),
    Definition(
        "n_s",
        "n_s",
        "latitudes of a closed cell (default: twice as many as k_max needs)",
        None,
        "whole",
        8,
        4096,
        optional=True,
    ),
)
"""Settings of [grid] that only closed cells have."""

INITIAL = (
    Definition(
        "kind",
        "P(0)",
        "initial state",
        "disordered",
        "choice",
        allowed=("disordered", "unidirectional", "circumferential", "stripes", "file"),
    ),
    Definition("seed", "s", "seed of the random numbers", 0, "whole", 0, 2**63 - 1),
    Definition(
        "filaments_per_square",
        "N",
        "filaments per grid square, noise variance 1/(2N); omit it in ordered states for no noise",
        1000.0,
        "number",
        1e-3,
        1e15,
    ),
    Definition(
        "noise_grid",
        "-",
        "grid [n_theta, n_z] on which the noise is drawn",
        None,
        "shape",
        8,
        8192,
        optional=True,
        also=1,
    ),
    Definition("magnitude", "|P|", "magnitude of an ordered initial state", 0.9, "number", 0.0, 1.0),
    Definition("stripes", "-", "number of stripes of an initial state of stripes", 2, "whole", 2, 512),
    Definition("path", "-", "file that an initial state is read from", None, "text", optional=True),
    Definition(
        "frame",
        "-",
        "frame of that file, counted from 0, or from the end if negative",
        -1,
        "whole",
        -(10**9),
        10**9,
    ),
    Definition(
        "stretch",
        "-",
        "whether the state in that file is stretched along z where its cell has another length",
        False,
        "flag",
    ),
    Definition(
        "bump",
        "-",
        "height of a bump of the concentration, relative to its surroundings; a gap if negative",
        None,
        "number",
        -0.999,
        100.0,
        optional=True,
    ),
    Definition(
        "bump_theta", "-", "angle of its centre, in radians", 3.141592653589793, "number", -10.0, 10.0
    ),
    Definition(
        "bump_z",
        "-",
        "position of its centre along the axis, in radii (default: half way)",
        None,
        "number",
        -1e4,
        1e4,
        optional=True,
    ),
    Definition("bump_width", "-", "standard deviation of the bump, in radii", 0.5, "number", 0.01, 100.0),
)

STEPPERS = ("adaptive", "multistep", "etdrk4", "rk4")
"""The time steppers, the default first; `dynamics.steppers.METHODS` defines each."""
ADAPTIVE = STEPPERS[:2]
"""Those that choose their steps by a tolerance; the others take `dt`."""

RUN = (
    Definition("t_end", "t", "time at which the run ends", 200.0, "number", 0.0, 1e9),
    Definition("save_every", "-", "time between saved fields", 1.0, "number", 1e-6, 1e9),
    Definition(
        "save_at",
        "-",
        "times of saved fields, instead of save_every",
        None,
        "numbers",
        0.0,
        1e9,
        optional=True,
    ),
    Definition(
        "record_every",
        "-",
        "time between recorded scalars (default: where fields are saved)",
        None,
        "number",
        1e-6,
        1e9,
        optional=True,
    ),
    Definition("stepper", "-", "time stepper", STEPPERS[0], "choice", allowed=STEPPERS),
    Definition(
        "rtol", "-", "relative error allowed in a step of the adaptive steppers", 1e-4, "number", 1e-13, 1e-1
    ),
    Definition(
        "atol", "-", "absolute error allowed in a step (root mean square of P)", 1e-10, "number", 0.0, 1e-1
    ),
    Definition(
        "dt",
        "Δt",
        "time step of the fixed steppers (default: 0.1, or rk4's stability bound)",
        None,
        "number",
        1e-9,
        1e3,
        optional=True,
    ),
    Definition(
        "dealias",
        "-",
        "padding of products against aliasing",
        "none",
        "choice",
        allowed=("none", "quadratic", "cubic", "full"),
    ),
    Definition(
        "precision", "-", "floating-point precision", "float64", "choice", allowed=("float64", "float32")
    ),
    Definition(
        "terms", "-", "terms of the filament equation that act", TERM_NAMES, "names", allowed=TERM_NAMES
    ),
    Definition(
        "steady_rate",
        "-",
        "stop as steady once |dP/dt| / |P| has stayed below this for a time of 10 and has not grown",
        None,
        "number",
        1e-14,
        1.0,
        optional=True,
    ),
)

MODEL = (
    Definition("kind", "-", "model", "polar", "choice", allowed=("polar", "kinetic", "coupled", "closed")),
    Definition(
        "modes", "N", "angular modes of the kinetic model (default: 48)", None, "whole", 2, 512, optional=True
    ),
    Definition(
        "torques",
        "-",
        "how bundling and flow alignment turn filaments in the kinetic model (default: literal)",
        None,
        "choice",
        allowed=("literal", "rate"),
        optional=True,
    ),
    Definition(
        "closure",
        "-",
        "what stands for the higher angular moments in the polar model",
        "paper",
        "choice",
        allowed=("paper", "von_mises", "wrapped_normal", "weak"),
    ),
    Definition(
        "concentration",
        "-",
        "whether the polar model has a concentration of filaments, carried by the flow and spread by d_s",
        False,
        "flag",
    ),
    Definition(
        "force_density",
        "-",
        "how the force depends on the concentration: linear is c |P|^n P, power is |cP|^n cP",
        "linear",
        "choice",
        allowed=("linear", "power"),
    ),
    Definition(
        "vacuole_drag",
        "β",
        "drag of the vacuole in the coupled model, in units of the wall friction (default: 0.007)",
        None,
        minimum=0.0,
        maximum=100.0,
        optional=True,
    ),
    Definition(
        "repulsion",
        "-",
        "how the repulsive direction follows from the curvature of a closed cell (default: principal)",
        None,
        "choice",
        allowed=("principal", "polynomial", "bounded"),
        optional=True,
    ),
)

SCALES = (
    Definition(
        "radius_um",
        "R",
        "radius of the cell in micrometres, to show results in units; with speed_um_s",
        None,
        "number",
        1e-3,
        1e6,
        optional=True,
    ),
    Definition(
        "speed_um_s",
        "U",
        "speed that perfectly aligned filaments drive, in micrometres per second",
        None,
        "number",
        1e-6,
        1e6,
        optional=True,
    ),
)

TABLES = {
    "model": MODEL,
    "parameters": PARAMETERS,
    "grid": (*GRID, *SURFACE),
    "initial": INITIAL,
    "run": RUN,
    "scales": SCALES,
}


def option(table: str, item: Definition) -> str:
    """Return the option of the command line that sets a value."""
    return "--model" if (table, item.name) == ("model", "kind") else f"--{item.name.replace('_', '-')}"


def definition(table: str, name: str) -> Definition:
    """Return the definition of `name` in one of `TABLES`."""
    return next(item for item in TABLES[table] if item.name == name)


def defaults(table: str) -> dict[str, Any]:
    """Return every default of one of `TABLES`."""
    return {item.name: item.default for item in TABLES[table]}
