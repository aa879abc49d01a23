"""Running an ensemble: members that may share lanes are integrated together, all others one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any

import jax
import numpy as np

from ..model.devices import require_devices
from ..model.doors import door
from ..model.errors import InputError
from ..model.precision import double
from ..model.reporting import Progress, counted, reported
from .members import UNCERTIFIED, EnsembleSettings, Member, Outcome, refuse_adaptive
from .pool import Pool
from .scheduled import follow_scheduled
from .scheduled_lanes import ScheduledLanes

CPU_LANES = 1
"""Lanes on a CPU: with more, the working set does not fit into the fast cache."""
ACCELERATOR_BYTES = 8 * 2**30
"""Memory that lanes may use on an accelerator, by default."""
FIELDS_PER_LANE = 64
"""Approximate number of complex fields that a lane needs."""


@door
def follow(
    members: Sequence[Member], how: EnsembleSettings | None = None, *, progress: Progress = None
) -> list[Outcome]:
    """Integrate every member until its final regime is certain, or to t_end, and return outcomes in order.

    With `finish = "certified"` a member ends as soon as its final regime is certain (see
    `cyclosis.ensemble.certainty`); with "t_end" all are integrated to t_end. Each member has its own adaptive
    step from the ladder 2^{j/2}; its outcome does not depend on the other members. Members may differ in
    everything; those with the same grid, diffusion and flow operator share lanes. `lanes` sets how many run
    at once, by default one on a CPU and as many as fit into 8 GiB on an accelerator. Members with a protocol
    share lanes too, whatever the times and values of its steps. `progress` shows a bar in a terminal or a
    notebook unless it is False; a function is called with the numbers of members done and in all.

    Raises `InputError` for states that do not fit their grid, for a protocol if `finish` is "certified" or
    `axial_resolution` "adaptive", and for models that do not allow these; problems that occur later are
    outcomes.

    Example:
        >>> import cyclosis as cy
        >>> grid, params = cy.CylinderGrid(16, 16), cy.Parameters(alpha_p=0.5, d_s=0.1)
        >>> starts = [cy.initial.stripes(grid, magnitude=0.9), cy.initial.unidirectional(grid, 0.9)]
        >>> members = [cy.ensemble.Member(params, grid, lambda P=P: P) for P in starts]
        >>> [(found.regime, found.status) for found in cy.ensemble.follow(members)]  # both are stable
        [('cyclosis', 'certified'), ('unidirectional', 'certified')]
    """
    how = how or EnsembleSettings()
    outcomes: list[Outcome | None] = [None] * len(members)
    alone: list[int] = []
    pools: dict[Any, list[int]] = {}
    scheduled: dict[tuple[Any, int], list[int]] = {}
    for index, member in enumerate(members):
        lanes = member.model.lanes
        if how.finish == "certified" and member.protocol:
            raise InputError("finish", how.finish, "t_end where there is a protocol", UNCERTIFIED)
        if how.axial_resolution == "adaptive":
            refuse_adaptive(member.model, bool(member.protocol))
        if how.finish == "certified" and not member.model.certifies:
            rule = f"t_end with the model {member.model.wording}, whose final regimes cannot be certified"
            raise InputError("finish", how.finish, rule, "set it so")
        if lanes is not None and member.protocol:
            width = how.lanes or default_lanes(member.grid, how.precision)
            scheduled.setdefault((member.model, width), []).append(index)
        elif lanes is None:
            alone.append(index)
        else:
            pools.setdefault((member.model, lanes.shared(member.params, member.grid)), []).append(index)

    def singly(indices: Sequence[int]) -> Iterator[tuple[int, Outcome]]:
        return ((index, follow_scheduled(members[index], how)) for index in indices)

    with double(), reported(progress, "follow", counted) as report:
        parts = [singly(alone)]
        for (_, width), indices in scheduled.items():
            # One lane needs no stacking: its member is integrated like a single run.
            lanes_of = ScheduledLanes(members, indices, how, width)
            parts.append(singly(indices) if width == 1 else lanes_of.run())
        for indices in pools.values():
            # A power of two if there are few members, so that few programs are compiled.
            most = default_lanes(members[indices[0]].grid, how.precision)
            width = how.lanes or min(most, 2 ** (len(indices) - 1).bit_length())
            parts.append(Pool(members, indices, how, width).run())
        for done, (index, outcome) in enumerate(chain.from_iterable(parts), 1):
            outcomes[index] = outcome
            if report is not None:
                report(done, len(members))
    return [outcome for outcome in outcomes if outcome is not None]


@door
def default_lanes(grid: Any, precision: str) -> int:
    """Return how many lanes suit the device that JAX uses: one on a CPU, else as many as fit into 8 GiB.

    Example:
        >>> import cyclosis as cy
        >>> cy.ensemble.default_lanes(cy.CylinderGrid(48, 48), "float64") >= 1
        True
    """
    require_devices()
    if jax.default_backend() == "cpu":
        return CPU_LANES
    each = FIELDS_PER_LANE * int(np.prod(grid.shape)) * (16 if precision == "float64" else 8)
    return int(max(1, ACCELERATOR_BYTES // each))
