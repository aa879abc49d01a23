"""The whole cell of a grid, whatever its geometry."""

from __future__ import annotations

from collections.abc import Iterable

from ...closed.grid import ClosedGrid
from ...closed.system import PRINCIPAL
from ...model.errors import InputError
from ...model.filaments import TermLike
from ...model.grid import CylinderGrid
from ...model.parameters import Parameters
from ...models import closed_model, polar
from .closed_surface import closed_surface
from .linearised import WholeCell
from .plane import plane


def whole_cell(
    params: Parameters,
    grid: CylinderGrid | ClosedGrid,
    terms: Iterable[TermLike] | None,
    dealias: str,
    repulsion: str,
) -> WholeCell:
    """Return the `WholeCell` of a grid; `dealias` is for the cylinder, `repulsion` for closed surfaces.

    Raises `InputError` for custom terms, and for an option of the other geometry.
    """
    if isinstance(grid, ClosedGrid):
        return closed_surface(closed_model(repulsion).problem(params, grid, terms, dealias))
    if repulsion != PRINCIPAL:
        rule = f"{PRINCIPAL} on a cylinder, where all forms of repulsion are the same"
        raise InputError("repulsion", repulsion, rule, "leave it out, or use a closed grid")
    return plane(polar.problem(params, grid, terms, dealias))
