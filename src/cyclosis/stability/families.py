"""The symmetry of equal stripes, and the four families of perturbations of P_z that it keeps apart.

A profile P of `count` equal stripes is odd about every zone and turns into -P one stripe further on. The
linearised equation contains P² and P u only, so that it commutes with the reflection about a zone and
with a shift by one stripe. Of the perturbations that a shift by one stripe leaves alone or reverses,

* `own`, odd about zones, reversed: what P is made of, whose growth ends the branch in a fold;
* `widths`, even, left alone: neighbouring zones move apart, with a mean, so that widths become unequal;
* `rotation`, even, reversed: all zones move alike; it contains P', the neutral rotation;
* `shapes`, odd, left alone.

With two stripes these are all. The neutral rotation and the growth of unequal widths, between which lies
next to nothing where zones are narrow, are in two families and cannot mix.
"""

from __future__ import annotations

import numpy as np

from ..model.grid import Array

OWN, WIDTHS, ROTATION, SHAPES = FAMILIES = ("own", "widths", "rotation", "shapes")


def bases(n: int, count: int = 2) -> dict[str, Array]:
    """Return an orthonormal basis (n, size) of each family on n points, without the Nyquist mode."""
    theta = 2 * np.pi / n * np.arange(n)
    per_stripe = np.arange(0, (n + 1) // 2, count // 2)
    even, odd = per_stripe[::2], per_stripe[1::2]
    waves = {
        OWN: np.sin(np.outer(theta, odd)),
        WIDTHS: np.cos(np.outer(theta, even)),
        ROTATION: np.cos(np.outer(theta, odd)),
        SHAPES: np.sin(np.outer(theta, even[1:])),
    }
    return {name: wave / np.linalg.norm(wave, axis=0) for name, wave in waves.items()}
