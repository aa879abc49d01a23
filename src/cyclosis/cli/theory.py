"""Commands of the theory: growth rates, profiles, spectra, thresholds, branches, maps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError, choice
from . import targets
from .axes import axis
from .looks import chosen_width, within_looks
from .options import FORCE, NO_PROGRESS, OUTPUT, changes, command, commands, with_options

if TYPE_CHECKING:
    from ..model.parameters import Parameters

theory = commands(
    "Growth rates, steady states, their spectra, thresholds and branches, without a simulation."
)

OUT = Annotated[
    list[Path] | None,
    typer.Option(
        "--out",
        metavar="FILE",
        help="File to write: a figure (.png, .pdf, .svg, .eps) or numbers (.nc, .csv); may be repeated.",
        rich_help_panel=OUTPUT,
    ),
]
LENGTH = Annotated[
    float,
    typer.Option(
        metavar="NUMBER",
        min=1e-6,
        max=200.0,
        help="Length of the cell, in radii, into which waves must fit.",
    ),
]
COUNT = Annotated[int, typer.Option("--stripes", metavar="WHOLE", help="Number of stripes, even.")]
POINTS = Annotated[int, typer.Option("--points", metavar="WHOLE", help="Grid points around the axis.")]
FULL = Annotated[
    bool, typer.Option("--full", help="Stable against all perturbations, not only unequal widths.")
]


@within_looks()
@with_options("parameters", "model")
def dispersion(
    base: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="disorder, unidirectional or circumferential, of the kinetic model nematic, z or theta; "
            "default: all that exist.",
        ),
    ] = None,
    waves: Annotated[
        int, typer.Option(metavar="WHOLE", min=0, max=64, help="Most waves around and along listed.")
    ] = 3,
    length: LENGTH = 5.0,
    out: OUT = None,
    force: FORCE = False,
    **options: str | bool | None,
) -> None:
    """Growth rates of small waves about the uniform states: in closed form, or by a matrix if kinetic."""
    from ..models import of_tables
    from ..report import theory as report
    from ..stability.dispersion_table import dispersion_table
    from ..stability.uniform.uniform import BASES, orders

    tables = changes(options)
    params, model = _params(options), of_tables(tables)
    _check(out, force)
    if model.name == "kinetic":
        return _kinetic_dispersion(params, model.options, base, waves, length, out)
    bases = [b for b in BASES if orders(params, b).size] if base is None else [base]
    found = [dispersion_table(params, each, waves, length) for each in bases]
    print("\n\n".join(map(report.dispersion, found)))

    def draw() -> Any:
        from ..figures import dispersion as figure

        return figure.dispersion(params, bases, length, **chosen_width())

    targets.write(out, draw, found[0].to_dataset)


def _kinetic_dispersion(
    params: Parameters,
    settings: Mapping[str, Any],
    base: str | None,
    waves: int,
    length: float,
    out: list[Path] | None,
) -> None:
    from ..report import theory as report
    from ..stability.kinetic.dispersion import dispersion, existing
    from ..stability.kinetic.torques import with_torques

    bases = existing(with_torques(params, settings["torques"])) if base is None else [base]
    found = [dispersion(params, each, waves, length, **settings) for each in bases]
    print("\n\n".join(map(report.kinetic_dispersion, found)))

    def draw() -> Any:
        from ..figures import dispersion as figure

        return figure.kinetic_dispersion(params, bases, length, **settings, **chosen_width())

    targets.write(out, draw, found[0].to_dataset)


@within_looks()
@with_options("parameters")
def profile(
    stripes: COUNT = 2,
    points: POINTS = 256,
    tilted: Annotated[
        bool, typer.Option("--tilted", help="Two tilted stripes that rotate, instead of upright ones.")
    ] = False,
    out: OUT = None,
    force: FORCE = False,
    **options: str | bool | None,
) -> None:
    """The steady state of equal stripes, or of tilted ones that rotate, by Newton's method."""
    from .. import stability
    from ..report import theory as report

    params = _params(options)
    _check(out, force)
    found: Any = stability.drifting(params, points) if tilted else stability.stripes(params, stripes, points)
    print(report.drifting(found) if tilted else report.profile(found))

    def draw() -> Any:
        from ..figures import spectra

        return (spectra.drifting if tilted else spectra.profile)(found, **chosen_width())

    targets.write(out, draw, found.to_dataset)


@within_looks()
@with_options("parameters")
def spectrum(
    stripes: COUNT = 2,
    count: Annotated[int, typer.Option(metavar="WHOLE", min=1, help="Number of eigenvalues.")] = 8,
    axial_mode: Annotated[
        int, typer.Option(metavar="WHOLE", help="Waves of the perturbation along the cell.")
    ] = 0,
    components: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="both, z (the paper's one-dimensional problem) or theta; for axial mode 0."
        ),
    ] = "both",
    length: LENGTH = 5.0,
    points: POINTS = 256,
    out: OUT = None,
    force: FORCE = False,
    **options: str | bool | None,
) -> None:
    """Eigenvalues of perturbations of equal stripes: the non-local Sturm-Liouville problem and beyond."""
    from .. import stability
    from ..report import theory as report

    params = _params(options)
    _check(out, force)
    found = stability.stripes(params, stripes, points)
    modes = found.spectrum(count, axial_mode, length, components)
    print(report.spectrum(found, modes))

    def draw() -> Any:
        from ..figures import spectra

        return spectra.spectrum(found, modes, **chosen_width())

    targets.write(out, draw, modes.to_dataset)


@within_looks()
@with_options("parameters")
def threshold(
    over: Annotated[
        str | None,
        typer.Option(metavar="AXIS", help="NAME=START:STOP:COUNT[:log] of alpha_p, d_s, d_r or mu: a curve."),
    ] = None,
    full: FULL = False,
    length: LENGTH = 5.0,
    out: OUT = None,
    force: FORCE = False,
    **options: str | bool | None,
) -> None:
    """The alpha_u above which cyclosis exists and is stable, each with its error bar.

    The option --alpha-u is ignored.
    """
    from ..report import theory as report
    from ..stability.existence.boundaries import limits
    from ..stability.existence.thresholds import threshold_with_error

    params = _params(options)
    _check(out, force)
    if full and over is not None:
        raise InputError("full", full, "given for one point", "leave out --over")
    if over is None and any(target.suffix.lower() in targets.FIGURE for target in out or []):
        raise InputError("out", "a figure", "of a curve", "give --over, as alpha_p=0.06:1:40:log")
    name, values = ("alpha_p", [float(params.alpha_p)]) if over is None else axis("over", over)
    found = limits(params, values, name)
    print(report.limits(found))
    if full:
        print("\n" + report.threshold(threshold_with_error(params, True, length)))

    def draw() -> Any:
        from ..figures import limits as figure
        from ..stability.existence.onset import neighbourhood

        near = None
        if name == "alpha_p" and params.force_exponent == 2:
            near = neighbourhood(params)
        return figure.limits(found, near, **chosen_width())

    targets.write(out, draw, found.to_dataset)


@within_looks()
@with_options("parameters")
def branch(
    parameter: Annotated[str, typer.Argument(metavar="PARAMETER", help="Parameter that varies.")],
    low: Annotated[float, typer.Option("--from", metavar="NUMBER", help="Lower end of its range.")],
    high: Annotated[float, typer.Option("--to", metavar="NUMBER", help="Upper end of its range.")],
    stripes: COUNT = 2,
    tilted: Annotated[bool, typer.Option("--tilted", help="Begin with tilted stripes that rotate.")] = False,
    crossing: Annotated[
        int,
        typer.Option(
            metavar="WHOLE", min=0, max=10, help="How many times to continue along branches that cross."
        ),
    ] = 0,
    points: POINTS = 128,
    longest: Annotated[
        float, typer.Option(metavar="NUMBER", help="Longest step: rms change of P with that of the range.")
    ] = 0.02,
    length: LENGTH = 5.0,
    measures: Annotated[
        str,
        typer.Option(
            metavar="A,B,...",
            help="To draw, separated by commas: max_P, max_u, mean_P_theta, mean_P_z, rms_P, rms_u, drift.",
        ),
    ] = "max_P,mean_P_theta",
    eigenvalues: Annotated[
        bool, typer.Option("--eigenvalues", help="Draw the growth rates along the branch instead.")
    ] = False,
    log: Annotated[bool, typer.Option("--log", help="Draw PARAMETER on a logarithmic scale.")] = False,
    out: OUT = None,
    force: FORCE = False,
    **options: str | bool | None,
) -> None:
    """Continue steady and drifting stripes in a parameter: folds, branch points, Hopf points, stability.

    The branch begins at the value of PARAMETER that its option gives.
    """
    from .. import stability
    from ..stability.branches.branch import MEASURES
    from ..stability.branches.diagram import diagram, label

    params = _params(options)
    _check(out, force)
    chosen = [choice("measures", name.strip(), MEASURES) for name in measures.split(",")]
    start: Any = stability.drifting(params, points) if tilted else stability.stripes(params, stripes, points)
    found = diagram(start, parameter, (low, high), crossing, longest=longest, length=length)
    print("\n\n".join(f"{label(each)}: {each}" for each in found))

    def draw() -> Any:
        from ..figures import bifurcation, spectra

        if eigenvalues:
            return spectra.eigenvalues(found[0], log, **chosen_width())
        return bifurcation.bifurcation(found, chosen, log, **chosen_width())

    targets.write(out, draw, found[0].to_dataset)


@within_looks()
@with_options("parameters")
def regime_map(
    x: Annotated[str, typer.Option(metavar="AXIS", help="Horizontal axis, NAME=START:STOP:COUNT[:log].")],
    y: Annotated[str, typer.Option(metavar="AXIS", help="Vertical axis, in the same form.")],
    length: LENGTH = 5.0,
    out: OUT = None,
    force: FORCE = False,
    quiet: NO_PROGRESS = False,
    **options: str | bool | None,
) -> None:
    """Which states are stable over two parameters, from theory alone."""
    from ..progress import Bar
    from ..report import theory as report
    from ..stability.regime_map import regime_map as compute

    params = _params(options)
    _check(out, force)
    with Bar("points", hidden=quiet) as bar:
        found = compute(params, axis("x", x), axis("y", y), length, bar)
    print(report.regime_map(found))

    def draw() -> Any:
        from ..figures import regime_map as figure

        log = [axis.partition("=")[0] for axis in (x, y) if axis.endswith(":log")]
        return figure.regime_map(found, log=log, **chosen_width())

    targets.write(out, draw, found.to_dataset)


def _params(options: Mapping[str, str | bool | None]) -> Parameters:
    from ..model.parameters import Parameters

    return Parameters(**changes(options)["parameters"])


def _check(out: list[Path] | None, force: bool) -> None:
    for target in out or []:
        targets.check(target, force, targets.THEORY)


command(
    theory,
    "stability dispersion --alpha-p 0.1",
    "stability dispersion --out waves.png",
    "stability dispersion --model kinetic --torques rate --base nematic",
)(dispersion)
command(theory, "stability profile --alpha-u 0.3 --out profile.png")(profile)
command(theory, "stability spectrum --count 4")(spectrum)
command(theory, "stability threshold", "stability threshold --over alpha_p=0.06:1:40:log --out curve.png")(
    threshold
)
command(theory, "stability branch kappa --from 0.3 --to 0.6 --out branch.png")(branch)
command(theory, "stability map --x kappa=0.1:1:8 --y alpha_u=0.1:1:8 --out map.png", name="map")(regime_map)
