"""Claims on how order begins and ends: from which bundling on, as how many streams, and how fast."""

from __future__ import annotations

from typing import Any

import numpy as np

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments import closure, ends_verdict
from cyclosis.experiments import vacuole_passive_verdict as passive
from cyclosis.experiments.experiment import AGREES
from cyclosis.models.closed.states import REGIMES as CLOSED

from .rows import (
    D_R,
    HALF,
    MOST,
    STRONG,
    THIN,
    Cells,
    Row,
    bears_out,
    judged,
    of,
    onset,
    ring_counts,
    striped,
)


def _onset_cells(data: Any) -> Cells:
    polar, kinetic, drag = onset(data)
    least = data["ends"].sel(alpha_p=data["ends"]["alpha_p"].min(), shape=list(ends_verdict.SHAPES[1:]))
    order = least["end"].sel(number="order").values
    order = order[np.isfinite(order)]
    ordered = of((order > 0.05).sum(), order.size)
    return {
        "polar": (judged(abs(polar / D_R - 1) < 0.01), f"above α_p = {polar:.4g}"),
        "kinetic": (judged(abs(kinetic / D_R - 1) < 0.01), f"above α_p = {kinetic:.3f}"),
        "closed": ("", f"not asked below α_p = {float(least['alpha_p']):g}, where {ordered} cells order"),
        "vacuole": (judged(abs(drag / D_R - 1) < 0.01), f"above α_p = {drag:.4g} at β = {STRONG:g}"),
    }


def _onset_why(data: Any) -> str:
    polar, kinetic, _ = onset(data)
    bears_out(kinetic > 10 * polar, "the kinetic onset is far above the polar one")
    return (
        f"Believe the kinetic {kinetic:.3f}. Repulsion alone lines filaments up across it, as many up as "
        "down, and to turn round a filament "
        "must cross its barrier. A closure of **P** alone has no such state. If α_p and α_u are read as "
        "rates of growth of small order (`torques = "
        f"rate`) the onset is at {kinetic / 2:.3f}, still far above d_r."
    )


# Which end


def _ends_cells(data: Any) -> Cells:
    ends, drag = data["ends"], data["vacuole-passive"]
    where = ends_verdict.regions(ends)
    two, rings = (each.values for each in ring_counts(data))
    either, always = (two > 0) & (two < rings), two == rings
    shares = [ends_verdict.share(ends, shape, where["C/U"], 1) for shape in ends_verdict.SHAPES]
    capsule, spheroid = (share[0] / share[1] for share in shares[1:])
    merged = {beta: passive.merged(drag, beta) for beta in (THIN, STRONG)}
    sure = {beta: passive.mcnemar(*pair) for beta, pair in merged.items()}
    cells = drag["kind"].sel(beta=STRONG, method="nearest").size
    return {
        "polar": (
            judged(where["C/U"].any() and where["C"].any()),
            f"either at {of(where['C/U'].sum(), where['C'].size)} places ({of(*shares[0])} have two), "
            f"always two at {int(where['C'].sum())}",
        ),
        "kinetic": (
            judged(either.any() and always.any()),
            f"either at {of(either.sum(), two.size)} places above the onset, always two at "
            f"{int(always.sum())}",
        ),
        "closed": (
            judged(capsule < MOST and spheroid > 0, 0 < spheroid < 1),
            f"where cylinders have either, {of(*shares[1])} capsules have two and {of(*shares[2])} spheroids",
        ),
        "vacuole": (
            judged(sure[STRONG] > 0.05, sure[THIN] > 0.05),
            f"two become one in {of(merged[THIN][0], cells)} cells at β = {THIN:g}, in "
            f"{merged[STRONG][0]} at {STRONG:g}, and one becomes two in {merged[STRONG][1]}",
        ),
    }


def _ends_why(data: Any) -> str:
    ends = data["ends"]
    capsule, spheroid = (ends["growth"].sel(closed=s).max("wave") for s in ends_verdict.SHAPES[1:])
    stable = [of((rate < 0).sum(), np.isfinite(rate).sum()) for rate in (capsule, spheroid)]
    bears_out((capsule > 0).all(), "one stream is unstable everywhere on the capsule")
    bears_out((spheroid < 0).mean() > HALF, "one stream is stable at most places on the spheroid")
    sure = ends_verdict.regions(ends)["C"]
    shares = [ends_verdict.share(ends, shape, sure, 1) for shape in ends_verdict.SHAPES[1:]]
    bears_out(all(two == total for two, total in shares), "closed cells agree where all cylinders do")
    return (
        "Believe the capsule for cells with rounded ends. One stream there runs from a source at one "
        "pole to a "
        f"sink at the other, is stable at {stable[0]} places, and passes. On the pointed spheroid it is "
        "stable at "
        f"{stable[1]}, by repulsion at the tips, whose form is a guess. A region C/U is then a property of "
        "cylinders and of pointed cells. Where all cylinders have two streams so have all closed cells."
    )


# Two equal stripes


def _widths_cells(data: Any) -> Cells:
    equal, drag = data["equal-stripes"], passive.ratios(data["vacuole-passive"], STRONG)
    own = equal["cell_length"].values != 5.0  # those cells are in the other sweep as well
    stripes = [equal["stripes_over_alpha_u"].values, equal["stripes_over_cell_length"].values[own]]
    uneven = [equal["uneven_over_alpha_u"].values, equal["uneven_over_cell_length"].values[own]]
    found = np.concatenate([each.ravel() for each in stripes])
    found = found[found > 0]
    worst = max(float(np.nanmax(each)) for each in uneven)
    rings = data["widths-kinetic"]
    off = np.abs(striped(rings) - 0.5).max("zone")
    kinetic = off.values[np.isfinite(off.values)]
    more = int((rings["regime"] == REGIMES.index("multistripe")).sum())
    ended = data["ends"]["end"].sel(shape=list(ends_verdict.SHAPES[1:]), number="regime").values
    many, streams = (int((ended == CLOSED.index(name)).sum()) for name in ("multistripe", "cyclosis"))
    return {
        "polar": (
            judged(bool((found == 2).all()) and worst < 0.01),
            f"{of((found == 2).sum(), found.size)} patterns, widths within {worst:.0e} of a half",
        ),
        "kinetic": (
            judged(more == 0 and kinetic.max() < 0.01),
            f"{of(kinetic.size, kinetic.size + more)} striped rings, widths within {kinetic.max():.0e} "
            "of a half",
        ),
        "closed": (
            judged(many == 0),
            f"{of(streams, streams + many)} cells with streams have two; their widths were not asked",
        ),
        "vacuole": (
            judged(np.isfinite(drag["alpha_u_widths"])),
            f"above an α_u {drag['alpha_u_widths']:.3f} times as large at β = {STRONG:g}",
        ),
    }


def _widths_why(data: Any) -> str:
    told = [verdict for verdict, _ in _widths_cells(data).values()]
    bears_out(all(verdict == AGREES for verdict in told), "all models have two equal stripes")
    return (
        "All models agree. This is what the paper's mechanism explains best: it needs neither the "
        "closure nor "
        "the cylinder."
    )


# Course


def course(data: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the median time to half of the order, and the largest |<P_theta>| on the way, by both models."""
    cells = data["closure"]
    when = np.median(closure.at_figure_4(cells, "when"), axis=1)
    return when, cells["around"].max("time").median("cell_seed").values


def _course_cells(data: Any) -> Cells:
    when, around = course(data)
    droplet = float(data["droplet"]["end"].sel(number="ordered").median())
    text = "order is half there at t = {:.1f}, and |<P_θ>| on the way at most {:.2f}"
    return {
        "polar": (judged(around[0] < 0.1), text.format(when[0], around[0])),
        "kinetic": (judged(around[1] < 0.1), text.format(when[1], around[1])),
        "closed": ("", f"order is half there at t = {droplet:.1f} in droplets"),
    }


def _course_why(data: Any) -> str:
    when, around = course(data)
    bears_out(when[1] > 1.5 * when[0] and around[1] > 0.5, "kinetic cells are slower, and first turn around")
    return (
        f"Believe the kinetic course: order takes {when[1] / when[0]:.1f} times as long, and runs around "
        "the axis before streams along "
        "the cell break out of it. Part of the factor is a convention, as the literal closure doubles "
        "weak torques; the detour is not. A film of a recovering "
        "cell could show it."
    )


ROWS = (
    Row(
        "Onset",
        "Disorder orders by itself where α_p exceeds d_r = 0.025: Region D ends there.",
        "Results, Figure 5",
        _onset_cells,
        _onset_why,
    ),
    Row(
        "One stream or two",
        "With weak alignment cells end with one stream or two (C/U), beyond always with two (C). Zero "
        "net flux stands in for the ends.",
        "Results, Figure 5; Model",
        _ends_cells,
        _ends_why,
    ),
    Row(
        "Two equal stripes",
        "There are two stripes, no more, of equal width.",
        "Introduction, Figures 4 and 5",
        _widths_cells,
        _widths_why,
    ),
    Row(
        "The course",
        "Disorder becomes streamlets, and these become streams along the cell (Figure 4).",
        "Time Progression",
        _course_cells,
        _course_why,
    ),
)
"""Rows of the table."""
