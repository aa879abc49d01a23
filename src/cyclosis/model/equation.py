"""The terms of the filament equation, each once: its name, formula, kind, and what it does in plain words.

`filaments` has their functions, of the same names. Nothing heavy is imported here.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

TermKind = Literal["torque", "rate", "linear", "custom"]


class Entry(NamedTuple):
    """One line of `EQUATION`; a `caption` is for a person who has never heard of the model."""

    name: str
    formula: str
    kind: TermKind
    caption: str


EQUATION = (
    Entry(
        "advection",
        "-ε (u·∇)P",
        "rate",
        "The streaming fluid carries filaments along, as far as they are free to go.",
    ),
    Entry(
        "shear",
        "(I - PP)·ε (P·∇)u",
        "torque",
        "Where layers of fluid slide past each other, they turn the filaments between them.",
    ),
    Entry(
        "bundling",
        "(I - PP)·α_p P",
        "torque",
        "Neighbouring filaments stick together and point the same way, so that cables form.",
    ),
    Entry(
        "flow_alignment",
        "(I - PP)·α_u u",
        "torque",
        "Filaments turn to point along the flow, and their motors then drive the flow further.",
    ),
    Entry(
        "repulsion",
        "-(I - PP)·κ (P·d) d",
        "torque",
        "Filaments avoid one direction, around the cell, and so align along the cell.",
    ),
    Entry(
        "diffusion",
        "d_s ∇²P",
        "linear",
        "Filaments wander, which smooths out differences between one place and the next.",
    ),
    Entry(
        "rotational_diffusion",
        "-d_r P",
        "linear",
        "Filaments turn at random, which reduces order everywhere.",
    ),
)

TERM_NAMES = tuple(entry.name for entry in EQUATION)
