"""Cells to begin with: the paper's figure, the regimes, and the cells of the experiments."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Preset:
    """A cell: `tables` as in `run.toml`, the steps of its protocol as tables, and what there is to see."""

    name: str
    group: Literal["figures", "regimes", "experiments"]
    title: str
    text: str
    tables: dict[str, dict[str, Any]] = field(default_factory=dict)
    protocol: tuple[dict[str, Any], ...] = ()


_STRIPES = {"kind": "stripes", "filaments_per_square": 1000.0}


def _regime(name: str, text: str, **tables: dict[str, Any]) -> Preset:
    return Preset(name, "regimes", name.replace("-", " "), text, tables)


def _experiment(name: str, text: str, *protocol: dict[str, Any], **tables: dict[str, Any]) -> Preset:
    return Preset(name, "experiments", name.replace("-", " "), text, tables, protocol)


def _change(at: float, **more: Any) -> dict[str, Any]:
    return {"at": at, "action": "change"} | more


def _fragment(at: float, **more: Any) -> dict[str, Any]:
    return {"at": at, "action": "fragment"} | more


_DISC = {"shape": "disc", "theta": 3.14, "z": 2.5, "radius": 1.5}
_WASH = {"action": "wash_out"}

PRESETS = (
    Preset(
        "figure4",
        "figures",
        "Figure 4: cyclosis emerges",
        "Disorder becomes patches, patches become streams, and two stripes remain.",
        {"parameters": {"alpha_p": 1.0, "alpha_u": 0.5}, "grid": {"n_theta": 64, "n_z": 64, "length": 5.0}},
    ),
    _regime(
        "disordered",
        "Bundling is too weak against random turning: no order lasts.",
        parameters={"alpha_p": 0.01, "alpha_u": 0.02},
    ),
    _regime(
        "unidirectional",
        "Bundling alone can make all filaments agree; with no way back, nothing flows.",
        parameters={"alpha_p": 0.5, "alpha_u": 0.025},
        initial={"kind": "unidirectional"},
    ),
    _regime("cyclosis", "Two stripes, up one half and down the other.", initial=dict(_STRIPES)),
    _regime(
        "multistripe",
        "Four stripes last for a while, but fewer are more stable: watch two of them go.",
        initial=_STRIPES | {"stripes": 4},
    ),
    _regime(
        "circumferential",
        "Without the wall's resistance filaments may run around the cell.",
        parameters={"kappa": 0.0},
        initial={"kind": "circumferential"},
    ),
    _experiment("emergence", "From disorder: order grows in patches, which merge."),
    _experiment(
        "shear-straightening",
        "Strong shear and advection; do the stripes straighten sooner?",
        parameters={"epsilon": 0.5},
    ),
    _experiment(
        "equal-stripes",
        "Whatever patches there are at first, the two stripes end equally wide.",
        initial={"seed": 5},
    ),
    _experiment(
        "recovery",
        "Everything is fragmented at t = 20 with bundling arrested, and washed out at t = 40.",
        _change(20.0, alpha_p=0.0),
        _fragment(20.0),
        _WASH | {"at": 40.0},
        initial=dict(_STRIPES),
    ),
    _experiment(
        "surviving-seeds",
        "All but one cable is fragmented at t = 10: what survives decides where the stripes come back.",
        _fragment(10.0, where={"shape": "band", "axis": "theta", "start": 1.2, "stop": 1.6, "invert": True}),
        initial=dict(_STRIPES),
    ),
    _experiment(
        "cytochalasin",
        "Bundling is poisoned from the beginning: flow alone must align. Wash it out and see.",
        parameters={"alpha_p": 0.0, "alpha_u": 0.2},
    ),
    _experiment(
        "myosin-inhibition",
        "Without flow alignment order still grows, but two stripes need not.",
        parameters={"alpha_u": 0.0},
    ),
    _experiment(
        "coalescence",
        "A long cell: many domains meet and join into two stripes.",
        grid={"n_theta": 48, "n_z": 96, "length": 15.0},
    ),
    _experiment(
        "circumferential-cell",
        "Stripes that lose the wall's resistance at t = 10: do they turn?",
        _change(10.0, kappa=0.0),
        initial=dict(_STRIPES),
    ),
    _experiment(
        "weak-repulsion", "A wall that resists little: stripes tilt and turn.", parameters={"kappa": 0.1}
    ),
    _experiment(
        "force-law", "Another force law, F = P: does the pattern care?", parameters={"force_exponent": 0.0}
    ),
    _experiment(
        "wound",
        "A wound at t = 10 heals from its edges.",
        _fragment(10.0, where=_DISC),
        initial=dict(_STRIPES),
    ),
    _experiment(
        "ablation",
        "From t = 10 a patch of the wall carries no bundling at all.",
        _fragment(10.0, where=_DISC),
        _change(10.0, where=_DISC, alpha_p=0.0),
        initial=dict(_STRIPES),
    ),
    _experiment(
        "timescales", "Locally fast, then across, then along: compare the times.", initial={"seed": 3}
    ),
    _experiment("cell-shape", "A long, slender cell.", grid={"n_theta": 48, "n_z": 128, "length": 20.0}),
    _experiment(
        "twist", "A wall whose resistance is oblique twists the stripes.", parameters={"repulsion_angle": 0.2}
    ),
)
