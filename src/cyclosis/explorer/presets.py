"""Cells to begin with: the paper's figure, every regime, and the cell of every experiment.

The texts describe what runs showed; `tests/explorer/test_presets.py` repeats some of them.
"""

from __future__ import annotations

from .preset import (
    DOWN,
    LONG,
    STRIPES,
    UP,
    Preset,
    align,
    cell,
    change,
    closed_cell,
    fragment,
    turn_over,
    wash_out,
)

FIGURES = (
    Preset(
        "figure4",
        "figures",
        "Figure 4: cyclosis emerges",
        "From disorder, patches of order grow, meet and merge, until two stripes stream past each other. "
        "Wound them, take bundling or alignment away, or begin from another seed.",
        cell({"seed": 0}, {"n_theta": 64, "n_z": 64, "length": 5.0}, alpha_p=1.0, alpha_u=0.5),
    ),
    Preset(
        "figure4-capsule",
        "figures",
        "Figure 4 in a cell with ends",
        "A capsule instead of a cylinder without ends: streams turn over at its poles, and by t = 40 two of "
        "them run along the whole cell. Small discs mark points where filaments have no direction.",
        closed_cell({"seed": 0}, "capsule", {"length": 5.0}, alpha_p=1.0, alpha_u=0.5),
    ),
)

REGIMES = (
    Preset(
        "disordered",
        "regimes",
        "Disorder",
        "Random turning (d_r = 0.025) beats bundling (α_p = 0.02), and the little order there is fades. "
        "Raise α_p above d_r and order grows.",
        cell(alpha_p=0.02),
    ),
    Preset(
        "unidirectional",
        "regimes",
        "One direction",
        "With hardly any alignment by flow one direction takes over the whole cell; nothing can stream, "
        "since no fluid passes the ends. Raise α_u to 0.8: the order tips over and becomes two stripes.",
        cell({"seed": 0}, alpha_u=0.025),
    ),
    Preset(
        "cyclosis",
        "regimes",
        "Cyclosis",
        "Strong alignment by flow: two stripes have formed by t = 15 and are equally wide by t = 50. "
        "Fragment or turn any part of them, and the pattern comes back.",
        cell({"seed": 1}, alpha_p=0.5, alpha_u=1.0),
    ),
    Preset(
        "multistripe",
        "regimes",
        "Four stripes",
        "In theory four stripes are unstable, but so weakly that they outlast your patience, and wounds "
        "heal. Turn or fragment one of them from end to end, and two are left.",
        cell(STRIPES | {"stripes": 4}, alpha_u=0.1),
    ),
    Preset(
        "circumferential-streaming",
        "regimes",
        "Around the axis",
        "No direction is avoided (κ = 0), and filaments turn to run around the cell, where no ends stop the "
        "flow. Set κ back to 0.5 to turn them upright.",
        cell(kappa=0.0),
    ),
    Preset(
        "travelling",
        "regimes",
        "Stripes that turn",
        "With κ below 0.4707 the two stripes tilt and turn about the axis, once in some 870 time units, "
        "without ever changing. Slide κ to 0.1 and they turn the other way round.",
        cell(kappa=0.3),
    ),
    Preset(
        "oscillating",
        "regimes",
        "Stripes that oscillate",
        "In a sliver of the diagram no steady state is stable: the downward stripe narrows and widens "
        "again and again, about every 600 time units. Turn up the speed, and watch the mean of P_z.",
        cell({"kind": "stripes", "magnitude": 0.4}, every=0.5, alpha_p=0.042, alpha_u=0.1059),
        (align(0.0, UP, 0.4, 3.1416, 4.1416),),
    ),
)

EXPERIMENTS = (
    Preset(
        "emergence",
        "experiments",
        "Emergence",
        "The paper: order begins in patches and spreads, in starts and stops, until two streams fill the "
        "cell. Here it does so by t = 20, but without stops. Other seeds take between 10 and 40 time units.",
        cell({"seed": 12}),
    ),
    Preset(
        "shear-straightening",
        "experiments",
        "Straightening by shear",
        "The paper: shear straightens the zones between streams. From t = 12 on shear does not act on "
        "filaments (ε = 0), and the zones still straighten. With ε = 0.4 strong bends disappear sooner, the "
        "last of them later.",
        cell({"seed": 22}),
        (change(12.0, epsilon=0.0),),
    ),
    Preset(
        "equal-stripes",
        "experiments",
        "Equal stripes",
        "The stripes are made unequal, and flow makes them equal: at a rate of 0.014 at this α_u, and of "
        "0.064 after t = 100, where α_u is 0.5. Make them unequal again with the brush.",
        cell(STRIPES, alpha_u=0.1),
        (
            align(5.0, UP, 0.9, 3.1416, 3.9),
            change(100.0, alpha_u=0.5),
            align(100.0, UP, 0.9, 3.1416, 3.9),
        ),
    ),
    Preset(
        "recovery",
        "experiments",
        "Recovery",
        "At t = 20 bundling is stopped and all cables fall apart; at t = 40 the drug is washed out. Two "
        "equal stripes come back, somewhere else: another seed, another place.",
        cell(STRIPES),
        (change(20.0, alpha_p=0.0), fragment(20.0), wash_out(40.0)),
    ),
    Preset(
        "surviving-seeds",
        "experiments",
        "Surviving seeds",
        "As in recovery, but a piece of one cable survives, half a percent of all filaments. It is enough "
        "for the stripes to come back in their old place.",
        cell(STRIPES),
        (
            change(5.0, alpha_p=0.0),
            fragment(
                5.0,
                where={
                    "shape": "box",
                    "theta0": 1.4,
                    "theta1": 1.75,
                    "z0": 2.0,
                    "z1": 2.5,
                    "invert": True,
                },
            ),
            wash_out(25.0),
        ),
    ),
    Preset(
        "cytochalasin",
        "experiments",
        "Cytochalasin",
        "At t = 10 bundling is stopped, and yet the stripes keep streaming, hardly slower. Only at t = 60, "
        "when all cables are fragmented too, does streaming stop. Wash the drug out, or try α_u = 0.2.",
        cell(STRIPES),
        (change(10.0, alpha_p=0.0), fragment(60.0)),
    ),
    Preset(
        "myosin-inhibition",
        "experiments",
        "Myosin inhibition",
        "From disorder without alignment by flow, the stripes are unequal and stay so. The drug is washed "
        "out at t = 80, and they become equal; with seed 0 one direction is left instead.",
        cell({"seed": 1}),
        (change(0.0, alpha_u=0.0), wash_out(80.0)),
    ),
    Preset(
        "coalescence",
        "experiments",
        "Coalescence",
        "The upward stripe is narrow, and without alignment by flow its two borders attract each other and "
        "meet by t = 60. Begin again with α_u = 0.075: now flow drives them apart.",
        cell({"kind": "stripes"}, alpha_p=0.1, alpha_u=0.0),
        (align(0.0, DOWN, 0.9, 2.14, 6.2831),),
    ),
    Preset(
        "circumferential",
        "experiments",
        "A lost cue",
        "At t = 20 filaments lose the cue that keeps them along the cell (κ = 0) and turn around the axis. "
        "At t = 120 it is given back, and two stripes are upright again.",
        cell(STRIPES),
        (change(20.0, kappa=0.0), wash_out(120.0)),
    ),
    Preset(
        "weak-repulsion",
        "experiments",
        "Weak repulsion",
        "At t = 20 repulsion falls to κ = 0.3, where stripes tilt and turn, and at t = 120 to 0.02, where "
        "filaments run around the axis. Find the κ above which stripes are upright: in theory it is 0.4707.",
        cell(STRIPES),
        (change(20.0, kappa=0.3), change(120.0, kappa=0.02)),
    ),
    Preset(
        "force-law",
        "experiments",
        "The force law",
        "Motors here push in proportion to order (n = 0). When bundling stops and all cables are fragmented "
        "at t = 20, streaming comes back; begin again with n = 2 and it does not.",
        cell(STRIPES, force_exponent=0.0),
        (change(20.0, alpha_p=0.0), fragment(20.0)),
    ),
    Preset(
        "wound",
        "experiments",
        "A wound",
        "At t = 10 all filaments in a disc are fragmented; within a few time units the wound has healed to "
        "the old pattern. Make larger ones with the brush.",
        cell(STRIPES),
        (fragment(10.0, where={"shape": "disc", "theta": 3.1416, "z": 2.5, "radius": 1.5}),),
    ),
    Preset(
        "ablation",
        "experiments",
        "One process at a time",
        "Bundling alone makes order, but no lasting stripes. Alignment by flow, from t = 20, turns it around "
        "the axis; repulsion, from t = 80, turns it upright: only together do they make cyclosis.",
        cell(alpha_u=0.0, kappa=0.0),
        (change(20.0, alpha_u=0.5), change(80.0, kappa=0.5)),
    ),
    Preset(
        "timescales",
        "experiments",
        "Times of a motor",
        "Flow aligns filaments only if motors turn them before they let go. From t = 40 to 60 they gradually "
        "stop doing so: stripes last, but once fragmented, at t = 80, one direction takes over.",
        cell(STRIPES),
        (change(40.0, over=20.0, alpha_u=0.0), fragment(80.0)),
    ),
    Preset(
        "cell-shape",
        "experiments",
        "A longer cell",
        "Thirteen radii instead of five. By t = 40 two stripes run along the whole cell, but the longer "
        "their bends are, the longer they take to straighten.",
        cell(grid=LONG | {"length": 13.0}),
    ),
    Preset(
        "twist",
        "experiments",
        "Twist",
        "Filaments avoid a direction tilted by 0.4, and the direction they prefer winds just once about a "
        "cell of this length. So do its stripes; with seed 2 they stay straight and only the filaments tilt.",
        cell({"seed": 0}, LONG | {"length": 14.86}, repulsion_angle=0.4),
    ),
    Preset(
        "closure",
        "experiments",
        "What the equation leaves out",
        "With so little bundling these cells order by t = 35. The density of filament angles, of which the "
        "equation is an approximation, never would: it needs α_p above 0.47.",
        cell(alpha_p=0.25),
    ),
    Preset(
        "ends",
        "experiments",
        "What the ends decide",
        "Filaments run from pole to pole. At t = 20 the point where they meet is pushed aside; in pointed "
        "ends it comes back by t = 40. In a capsule it runs away, until two streams are left.",
        closed_cell(
            {"kind": "unidirectional", "filaments_per_square": 4000.0},
            "spheroid",
            {"aspect": 3.0},
            alpha_p=0.5,
            alpha_u=0.025,
        ),
        (turn_over(20.0, {"shape": "disc", "theta": 1.0, "z": 6.0, "radius": 0.8}),),
    ),
    Preset(
        "droplet",
        "experiments",
        "A droplet circulates",
        "A sphere has no axis, and yet by t = 20 the fluid goes around one, between two vortices. Chance "
        "chooses the axis: another seed gives another one, and the same speed.",
        closed_cell({"seed": 0}, "sphere"),
    ),
)

PRESETS: tuple[Preset, ...] = (*FIGURES, *REGIMES, *EXPERIMENTS)
