"""A process forked from one in which JAX has run cannot compute: it would wait forever.

A fork copies the memory of a process but none of its threads. JAX's runtime hands its work to threads,
which the copy lacks. A process that was forked before JAX has run can compute.
"""

from __future__ import annotations

import os
import sys

_forked = False


class ForkedError(RuntimeError):
    """A process that was forked from one in which JAX had run was asked to compute.

    Example:
        >>> from cyclosis.model.forks import ForkedError
        >>> issubclass(ForkedError, RuntimeError)
        True
    """


def refuse_fork() -> None:
    """Raise `ForkedError`, with the remedy, in a process in which computing would never end."""
    if _forked:
        raise ForkedError(
            "this process was forked from one in which JAX had already run, and would wait forever: start "
            'processes afresh, by multiprocessing.get_context("spawn").Pool(...), by '
            'ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn")), or by joblib; many cells '
            "at once are faster still in one process, by cyclosis.ensemble.follow or cyclosis.run_sweep."
        )


def _after_fork() -> None:
    global _forked
    bridge = sys.modules.get("jax._src.xla_bridge")  # JAX has no public function for this
    begun = getattr(bridge, "backends_are_initialized", None)
    if begun is not None:
        _forked = _forked or bool(begun())


if hasattr(os, "register_at_fork"):  # not on Windows, which cannot fork
    os.register_at_fork(after_in_child=_after_fork)
