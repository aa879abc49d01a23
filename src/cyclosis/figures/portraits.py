"""How a cell is drawn in figures and movies: as a solid and as a map, on one scale, whatever its shape.

Movies draw in processes that load only this: nothing here may load JAX.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..model.grid import Array, CylinderGrid
from ..model.scales import Scales
from . import closed_map, closed_solid, cylinder, unwrapped
from .marks import Mark
from .skin import Skin
from .streamlines import Unrolled, Wall
from .style import colour_key

Box = tuple[float, float, float, float]
"""Left, right, bottom and top, in radii."""
Links = tuple[tuple[tuple[float, float], tuple[float, float]], ...]
"""Lines of unrolling: from a place in the solid's picture, in radii, to one of the map, in shares of it."""


@dataclass(frozen=True, eq=False)
class Look:
    """A state P and its flow u as drawings take them, (2, ...) each, and the defects of P to mark."""

    P: Array
    u: Array
    marks: Sequence[Mark] = ()


class Portrait(Protocol):
    """The drawings of cells of one shape."""

    @property
    def across(self) -> str:
        """The name of the map's horizontal axis."""
        ...

    @property
    def along(self) -> str:
        """The name of its vertical axis."""
        ...

    @property
    def wall(self) -> Wall:
        """The surface on which streamlines are drawn."""
        ...

    @property
    def tilt(self) -> float:
        """The angle, in radians, by which the viewer looks down unless another is given."""
        ...

    def extent(self, tilt: float) -> Box:
        """Return the edges of the solid's picture."""
        ...

    def map_extent(self) -> Box:
        """Return the edges of the map."""
        ...

    def links(self) -> Links:
        """Return the lines of unrolling."""
        ...

    def solid(self, ax: Any, look: Look, **options: Any) -> None:
        """Draw the solid: `view_angle`, `tilt`, `peak_speed`, `ribbons` and `pixels` as for a cylinder."""
        ...

    def flat(self, ax: Any, look: Look, **options: Any) -> None:
        """Paint the map: `peak_speed`, `ribbons` and `scale` as for a cylinder."""
        ...

    def edges(self, ax: Any, scales: Scales | None = None) -> None:
        """Put ticks at the edges of the map, in units with `scales`."""
        ...

    def key(self, ax: Any) -> None:
        """Draw the key of colours."""
        ...


@dataclass(frozen=True)
class OfCylinder:
    """The drawings of a periodic cylinder."""

    grid: CylinderGrid
    across: str = "$θ$"
    along: str = "$z$"

    @property
    def wall(self) -> Wall:
        """The unrolled wall."""
        return Unrolled(self.grid)

    @property
    def tilt(self) -> float:
        """The default tilt."""
        return cylinder.TILT

    def extent(self, tilt: float) -> Box:
        """Return the edges of the cylinder's picture."""
        return cylinder.extent(self.grid.length, tilt)

    def map_extent(self) -> Box:
        """Return the edges of the map."""
        return 0.0, 2 * np.pi, 0.0, self.grid.length

    def links(self) -> Links:
        """Return two lines, from the lower rim of the cylinder to the upper edge of its map."""
        return ((-1.0, 0.0), (0.0, 1.0)), ((1.0, 0.0), (1.0, 1.0))

    def solid(self, ax: Any, look: Look, **options: Any) -> None:
        """Draw the cylinder."""
        cylinder.draw(ax, self.grid, look.P, look.u, **options)

    def flat(self, ax: Any, look: Look, **options: Any) -> None:
        """Paint its map."""
        unwrapped.paint_map(ax, self.grid, look.P, look.u, **options)

    def edges(self, ax: Any, scales: Scales | None = None) -> None:
        """Put ticks at the edges of the map, in units with `scales`."""
        unwrapped.mark_edges(ax, self.grid, scales)

    def key(self, ax: Any) -> None:
        """Draw the colours of P_z."""
        colour_key(ax)


@dataclass(frozen=True)
class OfClosed:
    """The drawings of a closed cell."""

    skin: Skin
    across: str = "$θ$"
    along: str = "$s$"

    @property
    def wall(self) -> Wall:
        """The surface in space."""
        return self.skin

    @property
    def tilt(self) -> float:
        """The default tilt."""
        return closed_solid.TILT

    def extent(self, tilt: float) -> Box:
        """Return the edges of the solid's picture."""
        return closed_solid.extent(self.skin, tilt)

    def map_extent(self) -> Box:
        """Return the edges of the map."""
        return closed_map.frame_of(self.skin)

    def links(self) -> Links:
        """Return one line, from the lowest place of the picture to the north pole on the map."""
        return (((0.0, self.extent(self.tilt)[2]), (0.5, 1.0)),)

    def solid(self, ax: Any, look: Look, **options: Any) -> None:
        """Draw the solid."""
        closed_solid.draw_closed(ax, self.skin, look.P, look.u, marks=look.marks, **options)

    def flat(self, ax: Any, look: Look, **options: Any) -> None:
        """Paint its map."""
        closed_map.paint_closed(ax, self.skin, look.P, look.u, marks=look.marks, **options)

    def edges(self, ax: Any, scales: Scales | None = None) -> None:
        """Put ticks at the edges of the map, in units with `scales`."""
        closed_map.mark_edges(ax, self.skin, scales)

    def key(self, ax: Any) -> None:
        """Draw the colours of P_s, or of |P| on a sphere."""
        colour_key(ax, "$P_s$" if self.skin.axial else r"$|\mathbf{P}|$", signed=self.skin.axial)


def portrait(surface: CylinderGrid | Skin) -> Portrait:
    """Return how cells with this surface are drawn."""
    return OfCylinder(surface) if isinstance(surface, CylinderGrid) else OfClosed(surface)
