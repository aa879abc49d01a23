"""Stretches of a run: in one compiled program, or for a large cell in pieces that use all cores."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import numpy as np

from ..contract.system import System
from ..model.room import Room
from ..model.transforms_apart import transforms_apart
from .advance import Control, StepperState, advance, aimed, goes_on, one_step
from .steppers import Method

LARGE = 16 * 512 * 512
"""Bytes of a state from which its steps are run in pieces: calling these takes less time than they gain."""


class Stretch:
    """The steps of one system. Coefficients and the room of fields are kept until a target is reached."""

    def __init__(self, system: System, method: Method) -> None:
        self.system, self.method, self.room = system, method, Room()
        self.linear, self.coefficients, self.tabulated = None, None, np.nan

    def to(self, control: Control, now: StepperState, target: Any, most: int) -> StepperState:
        """Return the run after at most `most` steps towards a time, see `advance`."""
        if now.spectrum.nbytes < LARGE or _platform(now.spectrum) != "cpu":
            return advance(self.system, control, now, target, np.int64(most), self.method)
        if self.linear is None:
            self.linear = _linear(self.system)
        last = int(now.accepted + now.rejected) + most
        own: Any = ()  # fields that nobody but this loop has seen
        while _goes_on(now, target, last):
            h, left = _aimed(now, control, target, self.method.adaptive)
            if h != self.tabulated:
                self.coefficients = None  # before the new ones, so that there is room for them
                self.coefficients = _tableau(self.linear, h, self.method)
                self.tabulated = float(h)
            arguments = self.system, control, now._replace(h=h, left=left), target, self.linear
            now = _step(self.room, *arguments, self.coefficients, self.method, given_up=own)
            own = now.spectrum, now.nonlinear, now.past
        if now.t >= target:
            # What is measured there needs memory too.
            self.linear, self.coefficients, self.tabulated = None, None, np.nan
            self.room.clear()
        return now


def _platform(spectrum: Any) -> str:
    devices = spectrum.devices() if isinstance(spectrum, jax.Array) else jax.devices()
    return str(next(iter(devices)).platform)


@partial(jax.jit, static_argnums=3)
def _aimed(now: StepperState, control: Control, target: Any, adaptive: bool) -> tuple[Any, Any]:
    found = aimed(now, control, target, adaptive)
    return found.h, found.left


_goes_on = jax.jit(goes_on)
_linear = jax.jit(lambda system: system.linear())
_tableau = partial(jax.jit, static_argnums=2)(lambda linear, h, method: method.tableau(linear, h))
_step = transforms_apart(one_step)
