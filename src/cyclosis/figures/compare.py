"""Two runs side by side at one time, and their difference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import InputError, number
from ..model.grid import Array, interpolate
from ..model.units import scales_in
from .clock import time_text
from .edges import name_axes
from .frames import frame, grid_of, in_memory, indices_at, is_closed, peak_speed
from .looks import setting
from .portraits import Look, Portrait, portrait
from .skin import Skin
from .style import SMALL, TYPE, WIDE, WIDTH, blank, place

__all__ = [
    "compare",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Places in millimetres.
_MARGIN, _TITLE, _AXIS, _LABEL, _APART, _KEY = 3.0, 12.0, 7.0, 7.0, 5.0, 11.0
_LEAST_KEY = 11.0
_HOW: dict[str, Any] = {"cmap": "berlin", "origin": "lower", "interpolation": "bilinear"}
"""The difference has other colours than P_z, dark at zero too, and safe for all colour vision."""

_Drawn = tuple[Any, float, str, float]
"""The image of a difference, its largest value, its size in words, and the lower end of its key."""
_Pair = tuple[Portrait, tuple[Callable[[Array, Array], Look], ...], Callable[[Any, Sequence[Look]], _Drawn]]


@door
def compare(
    first: Any,
    second: Any,
    time: float | None = None,
    names: tuple[str, str] = ("A", "B"),
    width: float = WIDTH,
) -> Figure:
    """Return the maps of two runs of cells of one shape at one time, and the difference in P_z.

    `first` and `second` are datasets of runs; of each the saved frame nearest to `time` (dimensionless) is
    drawn, by default the last time that both have reached. A state on another grid is interpolated to that
    of the first. The third map is P_z of the first minus that of the second, on a scale of its own, and its
    title is <|ΔP|²>^½, the root mean square of the whole difference of P. On closed cells the maps are of
    equal area and show P_s; on a sphere they show |P| and |ΔP|, and both runs are turned alike. `names` are
    those above the maps; `width` is in millimetres, at least 89. Raises `InputError` for cells of different
    shape or length, and for times that one of the two does not have.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.compare import compare
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.stripes(grid, magnitude=0.5)
        >>> one, other = (
        ...     cy.simulate(cy.Parameters(alpha_u=value), grid, state, t_end=2.0).to_dataset()
        ...     for value in (0.5, 0.6)
        ... )
        >>> len(compare(one, other).axes)  # three maps and two keys
        5
    """
    width = number("width", width, 89.0, 1000.0, "choose a width in millimetres")
    datasets = in_memory(first), in_memory(second)
    cell, states, difference = (_closed if is_closed(first) else _cylinders)(*datasets)
    if time is None:
        time = min(float(data["time"].values[-1]) for data in datasets)
    indices = [indices_at(data, [time], "time")[0] for data in datasets]
    looks = [state(*frame(data, index)) for state, data, index in zip(states, datasets, indices, strict=True)]
    peak = max(peak_speed(data) for data in datasets)
    scales, box = scales_in(first), cell.map_extent()
    room = (width - 2 * _MARGIN - _LABEL - 2 * _APART - 2 * _KEY) / 3
    high = room * (box[3] - box[2]) / (box[1] - box[0])
    with setting(TYPE | (SMALL if width < WIDE else {})):
        size = matplotlib.rcParams["font.size"]
        figure = blank(width, _AXIS + high + _TITLE)
        left = _MARGIN + _LABEL
        for k, look in enumerate(looks):
            ax = place(figure, left, _AXIS, room, high)
            cell.flat(ax, look, peak_speed=peak)
            cell.edges(ax, scales)
            when = time_text(scales, float(datasets[k]["time"].values[indices[k]]))
            ax.set_title(f"{names[k]}, {when}", fontsize=size, pad=4.0)
            name_axes(ax, cell.across)
            if k:
                ax.set_yticklabels([])
            left += room + _APART
        cell.key(place(figure, left - _APART + 3.0, _AXIS, 3.0, max(high - 5.0, _LEAST_KEY)))
        left += _KEY
        ax = place(figure, left, _AXIS, room, high)
        image, most, text, low = difference(ax, looks)
        cell.edges(ax)
        ax.set_yticklabels([])
        name_axes(ax, cell.across)
        ax.set_title(r"$\langle|\Delta\mathbf{P}|^2\rangle^{1/2}$" + f" = {text}", fontsize=size, pad=4.0)
        _key(figure, image, (left + room + 2.5, _AXIS, 3.0, max(high - 5.0, _LEAST_KEY)), (low, most), cell)
        return figure


def _key(
    figure: Figure, image: Any, box: tuple[float, float, float, float], ends: tuple[float, float], cell: Any
) -> None:
    """Draw the key of a difference in a place in millimetres."""
    key = place(figure, *box)
    figure.colorbar(image, cax=key, ticks=sorted({ends[0], 0.0, ends[1]}), format="%.2g")
    key.tick_params(labelsize=7.5 if figure.get_figwidth() * 25.4 >= WIDE else 6.5)
    name = r"|\Delta\mathbf{P}|" if ends[0] == 0.0 else rf"\Delta P_{cell.along.strip('$')}"
    key.set_title(f"${name}$", pad=5.0, fontsize=matplotlib.rcParams["font.size"])


def _cylinders(first: xarray.Dataset, second: xarray.Dataset) -> _Pair:
    """Return how two cylinders are drawn, their states as drawings take them, and their difference."""
    grids = grid_of(first), grid_of(second)
    if grids[0].length != grids[1].length:
        rule = f"{grids[0].length:g}, as in the first"
        raise InputError("length of the second cell", grids[1].length, rule, "compare cells of one length")
    grid = grids[0]

    def alike(P: Array, u: Array) -> Look:
        same = P.shape[1:] == grid.shape
        return Look(P, u) if same else Look(interpolate(P, grid.shape), interpolate(u, grid.shape))

    def draw(ax: Any, looks: Sequence[Look]) -> _Drawn:
        difference = looks[0].P - looks[1].P
        fine = interpolate(difference, (4 * grid.n_theta, 4 * grid.n_z))[1]
        most = max(float(np.abs(fine).max()), 1e-12)
        edges = (0.0, 2 * np.pi, 0.0, grid.length)
        image = ax.imshow(fine.T, extent=edges, vmin=-most, vmax=most, **_HOW)
        size = float(np.sqrt(np.mean(np.sum(difference**2, axis=0))))
        return image, most, f"{size:.2g}", -most

    return portrait(grid), (alike, alike), draw


def _closed(first: xarray.Dataset, second: xarray.Dataset) -> _Pair:
    """Return the same of two closed cells."""
    from .closed_cells import closed_grid, closed_subject  # loads JAX, by way of `cyclosis.closed`
    from .closed_map import paint_values

    if not is_closed(second):
        rule = "a run of a closed cell, as the first"
        raise InputError("the second run", "that of a cylinder", rule, "compare cells of one shape")
    grids = closed_grid(first), closed_grid(second)
    if grids[0].surface != grids[1].surface:
        rule = f"{grids[0].surface!r}, as in the first"
        raise InputError("surface of the second cell", grids[1].surface, rule, "compare cells of one shape")
    subjects = [closed_subject(data, upright_in=first) for data in (first, second)]
    skin = subjects[0].surface
    assert isinstance(skin, Skin)

    def draw(ax: Any, looks: Sequence[Look]) -> _Drawn:
        difference = looks[0].P - looks[1].P
        square = np.sum(difference**2, axis=0).mean(axis=0)
        size = float(np.sqrt(np.trapezoid(square * skin.r, skin.s) / np.trapezoid(skin.r, skin.s)))
        values = difference[1] if skin.axial else np.hypot(*difference)
        most = max(float(np.abs(values).max()), 1e-12)
        low = -most if skin.axial else 0.0
        how = _HOW if skin.axial else _HOW | {"cmap": "magma"}
        return paint_values(ax, skin, values, vmin=low, vmax=most, **how), most, f"{size:.2g}", low

    return portrait(skin), (subjects[0].look, subjects[1].look), draw
