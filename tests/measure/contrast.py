"""Write the numbers by which the page's tests see that its lines are judged as those of the figures.

python tests/measure/contrast.py     # writes web/tests/contrast.json
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import cyclosis as cy
from cyclosis.model.grid import resolved

TARGET = Path(__file__).parents[2] / "web" / "tests" / "contrast.json"


def states() -> dict[str, tuple[cy.CylinderGrid, np.ndarray]]:
    """Return what is compared: steady cyclosis, its cell at the start, and a patch in a long cell."""
    square, long = cy.CylinderGrid(32, 16, 5.0), cy.CylinderGrid(14, 17, 9.0)
    stripes = np.zeros((2, *square.shape))
    stripes[1] = cy.stability.cyclosis(cy.Parameters()).at(square.theta, zone=1.03)[0][:, None]
    patch = np.zeros((2, *long.shape))
    patch[1] = 0.6 * np.sin(long.theta)[:, None] * np.cos(2 * np.pi * long.z / long.length) + 0.05
    return {
        "steady cyclosis": (square, stripes),
        "disorder": (square, cy.initial.disordered(square, seed=3)),
        "patches": (long, patch),
    }


def numbers() -> dict[str, Any]:
    """Return the constants, and grid, P_z and contrast of every state, rounded to six digits."""
    cells = []
    for name, (grid, state) in states().items():
        state[1] = np.round(resolved(state[1]), 6)  # what the page gets has no Nyquist modes
        cell = {"name": name, "n_theta": grid.n_theta, "n_z": grid.n_z, "length": grid.length}
        found = cy.zones.contrast(grid, state)
        cells.append(cell | {"P_z": state[1].ravel().tolist(), "contrast": found.ravel().round(6).tolist()})
    zones = cy.zones
    bounds = {"reach": zones.REACH, "grain": zones.GRAIN, "faint": zones.FAINT, "plain": zones.PLAIN}
    return bounds | {"cells": cells}


if __name__ == "__main__":
    TARGET.write_text(json.dumps(numbers()) + "\n")
