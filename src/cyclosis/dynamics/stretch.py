"""Stretches of a run: in one compiled program, or for a large cell in pieces whose transforms use all cores."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import numpy as np

from ..contract.system import System
from ..model.transforms_apart import transforms_apart
from .advance import Control, StepperState, advance, aimed, goes_on, one_step
from .steppers import Method

LARGE = 512 * 512
"""Modes from which a step on a processor is run in pieces: it then takes longer than calling them."""


class Stretch:
    """The steps of one system: the coefficients of a large one are kept from stretch to stretch."""

    def __init__(self, system: System, method: Method) -> None:
        self.system, self.method = system, method
        self.tabulated, self.linear, self.coefficients = np.nan, None, None

    def to(self, control: Control, now: StepperState, target: Any, most: int) -> StepperState:
        """Return the run after at most `most` steps towards a time, see `advance`."""
        if not _is_large(now.spectrum):
            return advance(self.system, control, now, target, np.int64(most), self.method)
        last = int(now.accepted + now.rejected) + most
        if self.linear is None:
            self.linear = _linear(self.system)
        while _goes_on(now, target, last):
            now = _aimed(now, control, target, self.method.adaptive)
            if now.h != self.tabulated:
                self.coefficients = None  # before the new ones, so that there is room for them
                self.coefficients = _tableau(self.linear, now.h, self.method)
                self.tabulated = float(now.h)
            now = _step(self.system, control, now, target, self.linear, self.coefficients, self.method)
        return now


def _is_large(spectrum: Any) -> bool:
    on_processor = not isinstance(spectrum, jax.Array) or spectrum.device.platform == "cpu"
    return spectrum.size >= LARGE and on_processor


_goes_on = jax.jit(goes_on)
_aimed = partial(jax.jit, static_argnums=3)(aimed)
_linear = jax.jit(lambda system: system.linear())
_tableau = partial(jax.jit, static_argnums=2)(lambda linear, h, method: method.tableau(linear, h))
_step = transforms_apart(one_step)
