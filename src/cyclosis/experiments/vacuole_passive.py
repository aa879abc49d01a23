"""Whether the drag of the vacuole, which the paper leaves out, would change what it found."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from ..dynamics.simulate import simulate
from ..figures.regime_maps import COLOURS as REGIME_COLOURS
from ..figures.story import Panel, cells, reference, story
from ..figures.style import DOWN, INK, LEGEND, QUIET, UP
from ..model import initial
from ..model.errors import InputError
from ..model.grid import Array, CylinderGrid
from ..model.parameters import Parameters
from ..models import coupled_model
from ..models.coupled import USUAL
from ..stability import unidirectional_order
from ..stability.existence.crossings import existing_from, stable_from
from ..vacuole import flow as flow_of
from . import dragged
from .experiment import Experiment
from .lab import Lab
from .vacuole_passive_verdict import KINDS, VALUES, decisive, verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Computed

DRAGS, QUICK_DRAGS = (0.0, USUAL, 0.1, 0.3), (0.0, USUAL, 0.3)
"""Values of β of cells from disorder: none, that of a thin layer, and more."""
FIGURE_5 = (
    *((0, 9), (0, 19), (1, 0), (1, 3), (2, 1), (3, 3), (6, 2), (19, 0)),
    *((19, 2), (1, 9), (4, 19), (9, 9), (14, 14), (19, 9), (17, 19), (19, 19)),
)
"""Places in Figure 5, as numbers of α_p and α_u: disorder, one stream, either, and two stripes."""
SMALL_KAPPA = (0.03, 0.2)
"""Values of κ at which Figure 4's cell streams around its axis, or has tilted stripes."""
PLACES = (
    *((float(VALUES[i]), float(VALUES[j]), 0.5) for i, j in FIGURE_5),
    *((1.0, 0.5, kappa) for kappa in SMALL_KAPPA),
)
QUICK_PLACES = (*PLACES[:1], PLACES[2], PLACES[7], *PLACES[-4:])
GRID, LATE = CylinderGrid(48, 48, 5.0), 600.0
FIGURE_4, CORNER = Parameters(alpha_p=1.0, alpha_u=0.5), Parameters(alpha_p=1.0, alpha_u=1.0)
SHOWN = ((0.5, 0.0), (0.5, 0.3), (1.0, 0.0), (1.0, 0.3))
"""α_u and β of the cells that are drawn."""
TILT = 0.02
"""Mean |P_theta| above which two stripes are tilted."""

CURVE, QUICK_CURVE = tuple(np.round(np.linspace(0.0, 0.3, 16), 3)), (0.0, 0.1, 0.2, 0.3)
EDGES, QUICK_EDGES = (0.03, 0.1, 0.3), (0.3,)
"""Values of β at which the border of upright stripes is found in the plane of Figure 5."""
WEAK = Parameters(alpha_p=0.1)
"""Where one stream breaks up, and stripes need flow to keep equal widths."""
DRUG = Parameters(alpha_p=0.0)
"""Bundling is inhibited, and stripes that are established survive above a fold."""

GROWN, QUICK_GROWN = (0.0, USUAL, 0.1, 0.2, 0.3), (0.0, 0.3)
SMALL = 1e-4
"""Perturbation whose growth is measured."""
FINE: dict[str, Any] = {"rtol": 1e-9, "atol": 1e-13}


def end(alpha_p: float, alpha_u: float, kappa: float, beta: float, seed: int) -> tuple[float, float]:
    """Return the kind of end, a number in `KINDS`, and mean |P_theta| of a cell from disorder."""
    params, model = Parameters(alpha_p=alpha_p, alpha_u=alpha_u, kappa=kappa), coupled_model(beta)
    start = initial.disordered(GRID, seed=seed)
    run = simulate(params, GRID, start, LATE, save_every=LATE, rtol=1e-3, model=model)
    assert model.regime is not None
    found = model.regime(model.problem(params, GRID), run.final_state)
    around = abs(float(found.mean_P[0]))
    return kind(found.name, around), around


def kind(regime: str, around: float) -> int:
    """Return the number in `KINDS` of a regime with a mean |P_theta|."""
    if regime in ("cyclosis", "travelling"):
        return 3 if around > TILT else 2
    return {"disordered": 0, "unidirectional": 1, "circumferential": 4}.get(regime, 5)


def growth(params: Parameters, beta: float, state: Array, component: int, m: int, until: float) -> float:
    """Return the rate at which wave m of a component of a ring (2, n_theta, 1) grows, over its later half."""
    grid = CylinderGrid(state.shape[1], 1)
    run = simulate(
        params, grid, state, until, save_at=(0.5 * until, until), model=coupled_model(beta), **FINE
    )
    one, two = (abs(np.fft.rfft(frame[component, :, 0])[m]) for frame in list(run.frames)[-2:])
    return float(np.log(two / one) / (0.5 * until))


def crossing(rates: list[float], sides: Array) -> float:
    """Return where a rate given on two `sides` is zero, by a straight line."""
    return float(sides[0] - rates[0] * (sides[1] - sides[0]) / (rates[1] - rates[0]))


def ordering(beta: float, m: int) -> tuple[float, float]:
    """Return the α_p above which wave m of P_z grows from disorder, measured, and d_r + d_s m²."""
    theory = FIGURE_4.d_r + FIGURE_4.d_s * m**2
    state = np.zeros((2, 16, 1))
    state[1, :, 0] = SMALL * np.cos(m * CylinderGrid(16, 1).theta)
    sides = np.array([0.9, 1.1]) * theta if (theta := theory) else np.zeros(2)
    rates = [growth(FIGURE_4.replace(alpha_p=float(x)), beta, state, 1, m, 40.0) for x in sides]
    return crossing(rates, sides), theory


def breaking(beta: float) -> tuple[float, float]:
    """Return the α_u above which one stream breaks up, measured, and in theory."""
    theory = dragged.breaking_up(WEAK, beta)
    state = np.zeros((2, 16, 1))
    state[1, :, 0] = unidirectional_order(WEAK) + SMALL * np.cos(CylinderGrid(16, 1).theta)
    sides = np.array([0.9, 1.1]) * theory
    rates = [growth(WEAK.replace(alpha_u=float(x)), beta, state, 1, 1, 40.0) for x in sides]
    return crossing(rates, sides), theory


def leaning(beta: float) -> tuple[float, float]:
    """Return the rate at which stripes of Figure 4 tilt, measured, and in theory."""
    state = dragged.upright(FIGURE_4, beta)[1].reshape(2, -1, 1).copy()
    state[0] += SMALL
    return growth(FIGURE_4, beta, state, 0, 0, 100.0), dragged.tilt_rate(FIGURE_4, beta)


def theory(beta: float) -> Array:
    """Return the numbers of `dragged.Stripes` in Figure 4, and α_u of equal widths and of the fold."""
    widths = stable_from(dragged.DraggedStripes(WEAK, beta)).alpha_u
    fold = existing_from(dragged.DraggedStripes(DRUG, beta)).alpha_u
    return np.array([*dragged.stripes(FIGURE_4, beta), widths, fold])


def leant(beta: float) -> Array:
    """Return tilt rate, final |<P_theta>| and |drift| of stripes (2, 3), in Figure 4 and at its corner."""
    both = (FIGURE_4, CORNER)
    return np.array([[dragged.tilt_rate(each, beta), *dragged.tilted(each, beta)] for each in both])


def edge(beta: float, alpha_u: float) -> float:
    """Return the α_p from which on stripes tilt in the plane of Figure 5, NaN if they do not."""
    return dragged.tilting_alpha_p(FIGURE_4.replace(alpha_u=alpha_u), beta, 0.1, 1.0)


def expected(alpha_p: float, alpha_u: float, kappa: float, beta: float) -> float:
    """Return the growth rate of a tilt at a place; NaN where there are no stripes."""
    try:
        return dragged.tilt_rate(Parameters(alpha_p=alpha_p, alpha_u=alpha_u, kappa=kappa), beta)
    except InputError:
        return np.nan


def cell(alpha_u: float, beta: float) -> Array:
    """Return P and u (2, 2, n_theta, n_z) of a cell from disorder at α_p = 1, at the end."""
    params = Parameters(alpha_p=1.0, alpha_u=alpha_u)
    start = initial.disordered(GRID, seed=0)
    run = simulate(params, GRID, start, LATE, save_every=LATE, rtol=1e-3, model=coupled_model(beta))
    return np.stack([run.final_state, flow_of(run, t=LATE).surface])


def measure(lab: Lab) -> xarray.Dataset:
    """Return the ends of cells from disorder over β, theory of stripes over β, and measured growth."""
    found = xarray.merge([_ends(lab), _theory(lab), _growth(lab)])
    seen = np.array(lab.each("cells", cell, SHOWN)).astype(np.float32)
    frame = ("frame", "component", "theta", "z")
    found["P"], found["u"] = (frame, seen[:, 0]), (frame, seen[:, 1])
    return found.assign_coords(component=["theta", "z"], theta=GRID.theta, z=GRID.z).assign_attrs(
        length=GRID.length
    )


def _ends(lab: Lab) -> xarray.Dataset:
    drags, places = (QUICK_DRAGS, QUICK_PLACES) if lab.quick else (DRAGS, PLACES)
    each = [(*place, beta) for beta in drags for place in places]
    shape = (len(drags), len(places))
    rows = lab.each("ends", end, [(*one, seed) for one in each for seed in range(lab.seeds)])
    ends = np.reshape(rows, (*shape, lab.seeds, 2))
    tilt = np.reshape(lab.each("places", expected, each), shape)
    alpha_p, alpha_u, kappa = np.transpose(places)
    return xarray.Dataset(
        {
            "kind": (("beta", "place", "seed"), ends[..., 0].astype(np.int8)),
            "around": (("beta", "place", "seed"), ends[..., 1].astype(np.float32)),
            "theory_tilt": (("beta", "place"), tilt),
        },
        {
            "beta": list(drags),
            "place_alpha_p": ("place", alpha_p),
            "place_alpha_u": ("place", alpha_u),
            "place_kappa": ("place", kappa),
        },
    )


def _theory(lab: Lab) -> xarray.Dataset:
    curve = QUICK_CURVE if lab.quick else CURVE
    curve = tuple(sorted({*curve, USUAL}))
    names = (*dragged.Stripes._fields, "alpha_u_widths", "fold")
    numbers = np.array(lab.each("theory", theory, [(beta,) for beta in curve]))
    lean = np.array(lab.each("leaning", leant, [(beta,) for beta in curve]))
    edges, strengths = (QUICK_EDGES, VALUES[[9, 14, 19]]) if lab.quick else (EDGES, VALUES)
    border = lab.each("edges", edge, [(beta, float(x)) for beta in edges for x in strengths])
    drags = lab.each("drags", dragged.tilting_drag, [(each, 0.5) for each in (FIGURE_4, CORNER)])
    return xarray.Dataset(
        {
            **{name: ("curve", numbers[:, k]) for k, name in enumerate(names)},
            "break_up": ("curve", [dragged.breaking_up(WEAK, beta) for beta in curve]),
            "lean": (("curve", "cell", "number"), lean),
            "tilting_drag": ("cell", drags),
            "edge": (("edge_beta", "edge_alpha_u"), np.reshape(border, (len(edges), -1))),
        },
        {
            "curve": list(curve),
            "cell": ["figure 4", "corner"],
            "number": ["rate", "around", "drift"],
            "edge_beta": list(edges),
            "edge_alpha_u": list(strengths),
        },
    )


def _growth(lab: Lab) -> xarray.Dataset:
    grown = QUICK_GROWN if lab.quick else GROWN
    one = [(beta,) for beta in grown]
    rows = [
        lab.each("uniform order", ordering, [(beta, 0) for beta in grown]),
        lab.each("waves of order", ordering, [(beta, 1) for beta in grown]),
        lab.each("breaking up", breaking, one),
        lab.each("tilts", leaning, one),
    ]
    return xarray.Dataset(
        {"grown": (("what", "grown_beta", "way"), np.array(rows))},
        {
            "what": ["order", "wave", "break-up", "tilt"],
            "grown_beta": list(grown),
            "way": ["measured", "theory"],
        },
    )


# Drawn

_REGIMES = ("disordered", "unidirectional", "cyclosis", "travelling", "circumferential", "undecided")
COLOURS = tuple(REGIME_COLOURS[name][0] for name in _REGIMES)


def draw(data: xarray.Dataset) -> Figure:
    """Draw four cells, speed and thresholds over β, how far stripes tilt, and the places of Figure 5."""
    titles = [f"α$_u$ = {alpha_u:g}, β = {beta:g}" for alpha_u, beta in SHOWN]
    beta = np.asarray(data["curve"].values)

    def numbers(ax: Any) -> None:
        lines = (
            ("fold", "α$_u$ without bundling", DOWN, "-"),
            ("break_up", "α$_u$ of break-up", INK, "-"),
            ("alpha_u_widths", "α$_u$ of equal widths", INK, ":"),
            ("peak_speed", "speed", UP, "-"),
        )
        for name, label, colour, dashes in lines:
            value = data[name].values
            ax.plot(beta, value / value[0], color=colour, linestyle=dashes, linewidth=1.2, label=label)
        measured = data["grown"].sel(what="break-up", way="measured").values
        ax.plot(data["grown_beta"], measured / measured[0], "o", color=INK, markersize=3.4)
        order = data["grown"].sel(what="order", way="measured").values
        ax.plot(data["grown_beta"], order / order[0], "o", color=QUIET, markersize=3.4)
        reference(ax, 1.0, "α$_p$ of order")
        _over_beta(ax, "relative to β = 0")
        ax.legend(
            **(LEGEND | {"loc": "upper left", "bbox_to_anchor": (0, 1.06), "ncols": 1, "fontsize": 8.0})
        )
        ax.set_ylim(0.7, 1.62)

    def leans(ax: Any) -> None:
        for name, colour in (("corner", UP), ("figure 4", INK)):
            around = np.asarray(data["lean"].sel(cell=name, number="around").values)
            onset = float(data["tilting_drag"].sel(cell=name))
            past = beta > onset
            label = "α$_u$ = 1" if name == "corner" else "α$_u$ = 0.5 (Figure 4)"
            x, y = ([0.0, onset, *beta[past]], [0.0, 0.0, *around[past]])
            ax.plot(x, y, color=colour, linewidth=1.2, label=label)
        place = (data["place_alpha_p"] == 1.0) & (data["place_alpha_u"] == 1.0)
        ends = data["around"].isel(place=int(np.argmax(place.values)))
        for seed in range(ends.sizes["seed"]):
            ax.plot(data["beta"], ends.isel(seed=seed), "o", color=UP, markersize=3.0, alpha=0.5)
        reference(ax, USUAL, "thin layer", upright=True)
        _over_beta(ax, "|<P$_θ$>| at the end")
        ax.set_ylim(-0.02, None)
        ax.legend(fontsize=8.0, frameon=False, loc="upper left", borderpad=0, handlelength=1.3)

    def plane(ax: Any) -> None:
        for k, value in enumerate(data["edge_beta"].values):
            border = data["edge"].isel(edge_beta=k)
            ax.plot(border, data["edge_alpha_u"], color=INK, linewidth=0.9 + 0.3 * k)
            known = np.flatnonzero(np.isfinite(border.values))
            if known.size:
                low = float(data["edge_alpha_u"][known[0]])
                ax.text(1.05, low, f"β = {value:g}", fontsize=7.0, va="center")
        ax.text(
            0.4, 0.4, f"left half: β = 0,\nright half: {float(data['beta'][-1]):g}", fontsize=7.5, va="top"
        )
        usual = np.flatnonzero(data["place_kappa"].values == FIGURE_4.kappa)
        for place in usual:
            ends = data["kind"].isel(place=place)
            likely = [int(np.bincount(ends.isel(beta=k).values).argmax()) for k in (0, -1)]
            x, y = float(data["place_alpha_p"][place]), float(data["place_alpha_u"][place])
            for side, end_of in zip(("left", "right"), likely, strict=True):
                ax.plot(
                    x, y, "o", fillstyle=side, color=COLOURS[end_of], markerfacecoloralt="none",
                    markersize=7.0, markeredgecolor=INK, markeredgewidth=0.4, clip_on=False,
                )  # fmt: skip
        ax.set_xlim(0, 1.28)
        ax.set_ylim(0, 1.03)
        ax.set_xticks([0, 0.5, 1.0])
        ax.set_xlabel("α$_p$", labelpad=1.0)
        ax.set_ylabel("α$_u$", labelpad=1.0)
        for number in (0, 1, 2, 3):
            ax.plot([], [], "o", color=COLOURS[number], markersize=5.0, label=KINDS[number])
        ax.legend(
            fontsize=7.5, frameon=False, loc="lower left", bbox_to_anchor=(-0.12, 1.0), ncols=2, borderpad=0,
            handletextpad=0.1, columnspacing=0.6, labelspacing=0.2,
        )  # fmt: skip

    def _over_beta(ax: Any, label: str) -> None:
        ax.set_xlim(0, beta[-1])
        ax.set_xlabel("drag β", labelpad=1.0)
        ax.set_ylabel(label, labelpad=1.0)

    return story(cells(data, titles), [Panel(numbers), Panel(leans), Panel(plane)], str(verdict(data)))


EXPERIMENT = Experiment(
    name="vacuole-passive",
    headline="The vacuole is carried along and does not act back on the streams.",
    claim="The cytoplasm is so much more viscous than the fluid of the vacuole that the flow in the vacuole "
    "is purely passive, driven by the streams without affecting them.",
    source="Model (geometry)",
    method="The flow is resisted by β Z(m, q), the drag of Stokes flow in the vacuole, β = η/(νR) from 0 to "
    "0.3 (0.007: a layer of a fiftieth of the radius, as viscous as the vacuole). Disordered cells at 16 "
    "places of Figure 5, and at two smaller κ, are integrated to t = 600 with the same seeds at β = 0, "
    "0.007, 0.1 and 0.3. Ends change beyond chance where McNemar's exact test, corrected for all kinds and "
    "places, is below 0.05. Steady stripes, their growth rates and thresholds are found by Newton's method "
    "over β, and growth is measured in runs. The vacuole counts as passive if no end changes beyond chance, "
    "at one place or as one stream for two at all, and speed and thresholds change by at most 5 %.",
    seeds=20,
    quick_seeds=3,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
