"""What a time stepper needs to know about an equation."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import jax


class System(Protocol):
    """dy/dt = L y + N(t, y) for the complex modes y of a state, in which L is diagonal.

    A system is a pytree: its numbers are arrays, so that changing one recompiles nothing. All methods are
    traceable; everything is dimensionless, times are in R/U.
    """

    def linear(self) -> jax.Array:
        """Return the diagonal of L: real, at most 0, of a shape that broadcasts to that of the modes."""
        ...

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> Any:
        """Return the moment: what is computed once from the modes at a time and shared by all terms."""
        ...

    def nonlinear(self, now: Any) -> jax.Array:
        """Return N at a moment, an array of the shape of the modes."""
        ...

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return the norm of a state, a rate or an error in modes, by which steps and rates are judged.

        A large part that never changes is left out, so that it does not hide the rest.
        """
        ...

    def peak(self, now: Any) -> jax.Array:
        """Return the largest |P|² at a moment, or its equivalent; a run must stay below the bound squared."""
        ...


@runtime_checkable
class LocalSystem(System, Protocol):
    """A system that knows which part of N decays fast, place by place: what stepper multistep needs.

    At every place D, a matrix without growth, acts on the state there; it is near the Jacobian of N.
    """

    def local(self, now: Any) -> jax.Array:
        """Return D at a moment, as one array."""
        ...

    def relaxed(self, spectrum: jax.Array, local: jax.Array, tau: Any) -> jax.Array:
        """Return (1 - τ L)⁻¹ (1 - τ D)⁻¹ of modes."""
        ...
