"""Lines that stream: short streamlines whose heads move with the flow from one frame of a movie to the next.

Drawing new streamlines for each frame would make them jump. Here every line persists: its head moves with
the flow, and the line is the part of the streamline upstream of it. Lines that come too close to older ones
fade out, new ones fade in where there is room, so that the surface stays evenly filled.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import numpy.typing as npt

from ..model.grid import Array, CylinderGrid
from .ribbons import NEGLIGIBLE, Ribbon, outline, tapered
from .streamlines import STEP, Taken, Unrolled, Wall, even_fractions, traced

SEPARATION = 0.11
"""Lines begin at least this far from others, in radii."""
CLOSEST = 0.04
"""Lines that come this close to older ones are cut there or fade."""
LENGTH = 0.9
"""Arc length of a line, in radii."""
SHORTEST = 0.35
"""Lines cut to less than this fraction of that length fade."""
CANDIDATES = 60
"""Places tried for new lines in every frame."""
GROWTH = 2
"""Points by which a line may become longer or shorter from one frame to the next."""
CURL = 1.5 * np.pi
"""Angle, in radians, by which a line may turn."""


class Tracers:
    """The lines of a movie; `advance` moves them by one frame.

    They are drawn on a wall, which is that of the cylinder if a grid is given. `fade` is the number of frames
    in which a line appears or disappears.
    """

    def __init__(self, wall: CylinderGrid | Wall, fade: float) -> None:
        self.wall: Wall = Unrolled(wall) if isinstance(wall, CylinderGrid) else wall
        period = self.wall.period
        self.step = 1.0 / max(fade, 1.0)
        self.heads = np.empty((period.size, 0))  # oldest first
        self.points = np.empty(0, dtype=np.int64)  # how many points long each line is
        self.shown = np.empty(0)  # 0 to 1: how far each line has faded in
        self.dying = np.empty(0, dtype=bool)
        self.seeds = self.wall.places(even_fractions(self.wall.area, SEPARATION))
        self.tried = 0
        self.crowded, self.roomy = (Taken(period, distance, 3) for distance in (CLOSEST, SEPARATION))

    def advance(self, flow: Array, peak_speed: float, distance: float) -> list[Ribbon]:
        """Return the lines of the next frame as ribbons, with their strengths.

        `flow` (2, n_theta, n_z) moves the heads by `distance`, in radii, where its speed is `peak_speed`,
        and by less where it is slower. On a closed surface it is (2, n_theta, n_s).
        """
        if peak_speed <= 0:
            return []
        wall = self.wall
        velocity = wall.velocity(flow)
        speed = np.hypot.reduce(velocity(self.heads))
        moved = wall.onto(traced(velocity, self.heads, 1, distance * speed / peak_speed)[:, -1])
        self.heads = np.concatenate([moved, self._candidates()], axis=1)
        paths = wall.onto(traced(velocity, self.heads, round(LENGTH / STEP), -STEP))
        speeds = np.hypot.reduce(velocity(paths))
        self._update(paths, _open(wall.headings(paths), speeds > NEGLIGIBLE * peak_speed))
        kept = np.flatnonzero((self.shown > 0) & (self.points > 1))
        self.heads, self.points = self.heads[:, kept], self.points[kept]
        self.shown, self.dying = self.shown[kept], self.dying[kept]
        ribbons = []
        for k, points, share in zip(kept, self.points.tolist(), self.shown.tolist(), strict=True):
            line = paths[:, points - 1 :: -1, k]
            shown = share**2 * (3 - 2 * share)
            width, strength = tapered(speeds[points - 1 :: -1, k], peak_speed, shown=shown)
            ribbons.append((outline(line, width, partial(wall.across, line)), strength))
        return ribbons

    def _candidates(self) -> Array:
        """Return the places (d, n) to try for new lines: all of them while there are no lines."""
        total = self.seeds.shape[1]
        count = min(CANDIDATES, total) if self.shown.size else total
        chosen = (self.tried + np.arange(count)) % total
        self.tried = (self.tried + count) % total
        return self.seeds[:, chosen]

    def _update(self, paths: Array, free: npt.NDArray[np.int64]) -> None:
        """Update all lines from their paths (d, points, n), which run upstream from the heads.

        The first are those of the present lines, the others of candidates; `free` (n,) is how many of
        their points the flow allows. Lines grow, shrink, fade and disappear smoothly.
        """
        self.crowded.clear()
        self.roomy.clear()
        cells, room = self.crowded.cells(paths), self.roomy.cells(paths)
        living, new = self.shown.size, paths.shape[2] - self.shown.size
        least = 1 + round(SHORTEST * LENGTH / STEP)
        self.points = np.append(self.points, np.zeros(new, dtype=np.int64))
        self.shown = np.append(self.shown, np.zeros(new))
        self.dying = np.append(self.dying, np.zeros(new, dtype=bool))

        def take(k: int) -> None:
            self.crowded.add(cells[: self.points[k], k])
            self.roomy.add(room[: self.points[k], k])

        for k in range(living):
            if not self.dying[k]:
                apart = min(free[k], _first(self.crowded.taken[cells[:, k]]))
                self.dying[k] = apart < least
                self.points[k] = min(max(apart, self.points[k] - GROWTH), self.points[k] + GROWTH)
            self.points[k] = min(self.points[k], free[k])
            self.shown[k] = min(1.0, self.shown[k] + (-self.step if self.dying[k] else self.step))
            if not self.dying[k]:
                take(k)
        # Most candidates have no room among the present lines; the others may still overlap.
        roomy = (free >= least) & ~self.roomy.taken[room].any(axis=0)
        for k in (living + np.flatnonzero(roomy[living:])).tolist():
            if not self.roomy.taken[room[:, k]].any():
                self.points[k], self.shown[k] = free[k], self.step if living else 1.0
                take(k)


def _first(blocked: npt.NDArray[np.bool_]) -> int:
    """Return how many points (n,) come before the first that is blocked."""
    return int(np.argmax(blocked)) if blocked.any() else blocked.size


def _open(headings: Array, fast: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Return how many points of each path (n,) come before it is too slow or curls up, as in a vortex."""
    fast[1:] &= np.abs(headings) < CURL
    return np.where(fast.all(axis=0), fast.shape[0], np.argmin(fast, axis=0))
