"""Labels along the edges of a map of a cell, which leave room for each other."""

from __future__ import annotations

from typing import Any


def mark_height(ax: Any, text: str, height: float) -> None:
    """Put ticks at the bottom and the top of a map; a unit stands below its number, beside the map."""
    ax.set_yticks([0, height], ["0", text])
    if "\n" in text:
        ax.get_yticklabels()[1].set_verticalalignment("top")


def name_axes(ax: Any, across: str, along: str | None = None, pad: float = -6.0) -> None:
    """Write the names of a map's axes between the labels of their ends."""
    ax.set_xlabel(across, labelpad=pad)
    if along is not None:
        top = "\n" in ax.get_yticklabels()[-1].get_text()
        size = ax.yaxis.label.get_size() / (72 * ax.get_position().height * ax.figure.get_figheight())
        # Halfway up, or halfway between the labels of the ends where the upper one has two lines.
        free = 0.6 * size, 1.0 - (2.6 if top else 0.6) * size
        ax.set_ylabel(along, rotation=0, labelpad=-1.0, va="center", y=min(0.5, 0.5 * sum(free)))
