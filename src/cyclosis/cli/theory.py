"""Commands of the theory: growth rates, profiles, spectra, thresholds, branches, maps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..model.errors import InputError, choice
from .options import FORCE, QUIET, changes, commands, with_options

if TYPE_CHECKING:
    from ..model.parameters import Parameters

theory = commands(
    "Growth rates, steady states, their spectra, thresholds and branches, without a simulation."
)

OUT = Annotated[
    list[Path] | None,
    typer.Option("--out", help="File to write: .png or .pdf draws, .nc or .csv keeps numbers; repeatable."),
]
LENGTH = Annotated[
    float, typer.Option(min=1e-6, max=200.0, help="Length of the cell, in radii, into which waves must fit.")
]
COUNT = Annotated[int, typer.Option("--stripes", help="Number of stripes, even.")]
POINTS = Annotated[int, typer.Option("--points", help="Grid points around the axis.")]
FULL = Annotated[
    bool, typer.Option("--full", help="Stable against all perturbations, not only unequal widths.")
]


@theory.command()
@with_options("parameters")
def dispersion(
    base: Annotated[
        str | None, typer.Option(help="disorder, unidirectional or circumferential; default: all that exist.")
    ] = None,
    waves: Annotated[int, typer.Option(min=0, max=64, help="Most waves around and along listed.")] = 3,
    length: LENGTH = 5.0,
    out: OUT = None,
    force: FORCE = False,
    **options: str | None,
) -> None:
    """Growth rates of small waves about the uniform states, in closed form."""
    from ..report import theory as report
    from ..stability.dispersion_table import dispersion_table
    from ..stability.uniform import BASES, orders

    params = _params(options)
    bases = [b for b in BASES if orders(params, b).size] if base is None else [base]
    tables = [dispersion_table(params, each, waves, length) for each in bases]
    _check(out, force)
    print("\n\n".join(map(report.dispersion, tables)))

    def draw() -> Any:
        from ..figures import dispersion as figure

        return figure.dispersion(params, bases, length)

    _write(out, draw, lambda: dispersion_table(params, bases[0], waves, length).to_dataset())


@theory.command()
@with_options("parameters")
def profile(
    stripes: COUNT = 2,
    points: POINTS = 256,
    tilted: Annotated[
        bool, typer.Option("--tilted", help="Two tilted stripes that rotate, instead of upright ones.")
    ] = False,
    out: OUT = None,
    force: FORCE = False,
    **options: str | None,
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

        return spectra.drifting(found) if tilted else spectra.profile(found)

    _write(out, draw, found.to_dataset)


@theory.command()
@with_options("parameters")
def spectrum(
    stripes: COUNT = 2,
    count: Annotated[int, typer.Option(min=1, help="Number of eigenvalues.")] = 8,
    axial_mode: Annotated[int, typer.Option(help="Waves of the perturbation along the cell.")] = 0,
    components: Annotated[
        str, typer.Option(help="both, z (the paper's one-dimensional problem) or theta; for axial mode 0.")
    ] = "both",
    length: LENGTH = 5.0,
    points: POINTS = 256,
    out: OUT = None,
    force: FORCE = False,
    **options: str | None,
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

        return spectra.spectrum(found, modes)

    _write(out, draw, modes.to_dataset)


@theory.command()
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
    **options: str | None,
) -> None:
    """The alpha_u above which cyclosis exists and is stable, each with its error bar.

    The option --alpha-u plays no part.
    """
    from ..report import theory as report
    from ..stability.boundaries import limits
    from ..stability.thresholds import threshold_with_error

    params = _params(options)
    _check(out, force)
    if full and over is not None:
        raise InputError("full", full, "given for one point", "leave out --over")
    if over is None and any(target.suffix.lower() in (".png", ".pdf") for target in out or []):
        raise InputError("out", "a figure", "of a curve", "give --over, as alpha_p=0.06:1:40:log")
    name, values = ("alpha_p", [float(params.alpha_p)]) if over is None else _axis("over", over)
    found = limits(params, values, name)
    print(report.limits(found))
    if full:
        print("\n" + report.threshold(threshold_with_error(params, True, length)))

    def draw() -> Any:
        from ..figures import limits as figure
        from ..stability.onset import neighbourhood

        near = None
        if name == "alpha_p" and params.force_exponent == 2:
            near = neighbourhood(params)
        return figure.limits(found, near)

    _write(out, draw, found.to_dataset)


@theory.command()
@with_options("parameters")
def branch(
    parameter: Annotated[str, typer.Argument(metavar="PARAMETER", help="Parameter that varies.")],
    low: Annotated[float, typer.Option("--from", help="Lower end of its range.")],
    high: Annotated[float, typer.Option("--to", help="Upper end of its range.")],
    stripes: COUNT = 2,
    tilted: Annotated[bool, typer.Option("--tilted", help="Begin with tilted stripes that rotate.")] = False,
    crossing: Annotated[
        int, typer.Option(min=0, max=10, help="How many times to go on along branches that cross.")
    ] = 0,
    points: POINTS = 128,
    longest: Annotated[
        float, typer.Option(help="Longest step: rms change of P with that of the range.")
    ] = 0.02,
    length: LENGTH = 5.0,
    measures: Annotated[
        str,
        typer.Option(
            help="To draw, separated by commas: max_P, max_u, mean_P_theta, mean_P_z, rms_P, rms_u, drift."
        ),
    ] = "max_P,mean_P_theta",
    eigenvalues: Annotated[
        bool, typer.Option("--eigenvalues", help="Draw the growth rates along the branch instead.")
    ] = False,
    log: Annotated[bool, typer.Option("--log", help="Draw PARAMETER on a logarithmic scale.")] = False,
    out: OUT = None,
    force: FORCE = False,
    **options: str | None,
) -> None:
    """Follow steady and drifting stripes through a parameter: folds, branch points, Hopf points, stability.

    It begins at the value of PARAMETER that its own option gives.
    """
    from .. import stability
    from ..stability.branch import MEASURES
    from ..stability.diagram import diagram, label

    params = _params(options)
    _check(out, force)
    chosen = [choice("measures", name.strip(), MEASURES) for name in measures.split(",")]
    start: Any = stability.drifting(params, points) if tilted else stability.stripes(params, stripes, points)
    found = diagram(start, parameter, (low, high), crossing, longest=longest, length=length)
    print("\n\n".join(f"{label(each)}: {each}" for each in found))

    def draw() -> Any:
        from ..figures import bifurcation, spectra

        if eigenvalues:
            return spectra.eigenvalues(found[0], log)
        return bifurcation.bifurcation(found, chosen, log)

    _write(out, draw, found[0].to_dataset)


@theory.command("map")
@with_options("parameters")
def regime_map(
    x: Annotated[str, typer.Option(metavar="AXIS", help="NAME=START:STOP:COUNT[:log] of the axis across.")],
    y: Annotated[str, typer.Option(metavar="AXIS", help="The same of the axis up.")],
    length: LENGTH = 5.0,
    out: OUT = None,
    force: FORCE = False,
    quiet: QUIET = False,
    **options: str | None,
) -> None:
    """Which states are stable over two parameters, from theory alone."""
    from ..progress import Bar
    from ..report import theory as report
    from ..stability.atlas import regime_map as compute

    params = _params(options)
    _check(out, force)
    with Bar("points", hidden=quiet) as bar:
        found = compute(params, _axis("x", x), _axis("y", y), length, bar)
    print(report.regime_map(found))

    def draw() -> Any:
        from ..figures import regime_map as figure

        log = [axis.partition("=")[0] for axis in (x, y) if axis.endswith(":log")]
        return figure.regime_map(found, log=log)

    _write(out, draw, found.to_dataset)


def _params(options: Mapping[str, str | None]) -> Parameters:
    from ..model.parameters import Parameters

    return Parameters(**changes(options)["parameters"])


def _axis(field: str, text: str) -> tuple[str, list[float]]:
    """Return the name and the values of an axis given as NAME=START:STOP:COUNT[:log]."""
    from ..sweep.axes import values

    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        spacing = "linear" if len(parts) == 3 else {"log": "log"}[parts[3]]
        start, stop, count = float(parts[0]), float(parts[1]), int(parts[2])
        if not (2 <= count <= 10_000 and start < stop and len(parts) < 5 and (start > 0 or spacing != "log")):
            raise ValueError
    except (ValueError, IndexError, KeyError):
        rule = "NAME=START:STOP:COUNT or NAME=START:STOP:COUNT:log, with START < STOP and COUNT from 2"
        raise InputError(field, text, rule, "write it as alpha_u=0.05:1:20") from None
    table = {"start": start, "stop": stop, "count": count, "spacing": spacing}
    return name.strip(), list(values(table))


def _check(out: list[Path] | None, force: bool) -> None:
    """Refuse files that could not be written, before anything is computed."""
    from .. import dataset
    from ..dataset.tables import SUFFIXES

    for target in out or []:
        if target.suffix.lower() not in (*SUFFIXES, ".png", ".pdf"):
            rule = "a file name that ends in .png, .pdf, .nc or .csv"
            raise InputError("out", str(target), rule, "change its suffix")
        dataset.check_writable(target, force)


def _write(out: list[Path] | None, draw: Callable[[], Any], numbers: Callable[[], Any]) -> None:
    from ..dataset.tables import SUFFIXES, write_table

    for target in out or []:
        if target.suffix.lower() in SUFFIXES:
            write_table(numbers(), target)
        else:
            from ..figures import style

            style.save(draw(), target)
        print(f"saved {target}")
