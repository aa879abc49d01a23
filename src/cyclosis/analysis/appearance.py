"""What a state looks like, in a few numbers, and since when it has looked like that."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..model.grid import Array, resolved, sign_changes
from .regimes import DISORDER, DOMINANT


class Look(NamedTuple):
    """Whether a state is ordered, the fewest and most zones on circles z = const, whether it circles."""

    ordered: bool
    low: int
    high: int
    circling: bool

    @classmethod
    def of_signs(cls, signs: Any) -> Look:
        """Return the look of a member in a lane."""
        order, around = float(signs.order), float(signs.around)
        return cls(order >= DISORDER, int(signs.low), int(signs.high), around**2 >= DOMINANT * order**2)

    @classmethod
    def of_state(cls, P: Array) -> Look:
        """Return the look of a state (2, n_theta, n_z)."""
        return cls.of_field(resolved(P))

    @classmethod
    def of_field(cls, P: Array) -> Look:
        """Return the look of a vector field, with sign changes around the first of its two directions."""
        changes = sign_changes(P[1])
        order2, around2 = float(np.mean(np.sum(P**2, axis=0))), float(np.mean(P[0] ** 2))
        circling = around2 >= DOMINANT * order2
        return cls(order2 >= DISORDER**2, int(changes.min()), int(changes.max()), circling)

    def like(self, other: Look) -> bool:
        """Return whether two states look the same; zones of P_z count only if P is not circumferential."""
        if self.ordered != other.ordered or self.circling != other.circling:
            return False
        return self.circling or (self.low, self.high) == (other.low, other.high)

    def since(self, looks: Sequence[tuple[float, Look]], otherwise: float) -> float:
        """Return the first of the times from which on all looks are like this one."""
        first = otherwise
        for time, seen in reversed(looks):
            if not self.like(seen):
                break
            first = time
        return first
