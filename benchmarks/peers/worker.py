"""A process of its own for each code, kept on one core: what codes do to their process stays there."""

from __future__ import annotations

import multiprocessing
import os
import time


def _serve(pipe, name: str, core: int) -> None:
    """Answer one request after another: compute, and say how long it took."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    import logging

    from case import CODES, start

    if name == "dedalus":
        import dedalus.public  # noqa: F401  it sets up the logging that is silenced next

    logging.disable(logging.WARNING)
    code, known = CODES[name], {}
    while True:
        kind, n, length, step, how, t_end, seeds = pipe.recv()
        key = (kind, n, length, step, str(how))
        began = time.perf_counter()
        if key not in known:
            known = {key: getattr(code, kind)(n, length, step, how)}
        prepared = time.perf_counter()
        states = [start(n, length, seed) for seed in seeds]
        # Seconds of the processor, which other work on the machine does not lengthen: each code has one core.
        begun = time.process_time()
        try:
            given = states[0] if kind == "prepare" else states
            state = known[key](given, t_end)
        except (ArithmeticError, RuntimeError, ValueError) as problem:
            state = problem
        pipe.send((state, prepared - began, time.process_time() - begun))


class Worker:
    """One code on one core."""

    def __init__(self, name: str, core: int = 0) -> None:
        for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
            os.environ[variable] = "1"
        os.environ["JAX_PLATFORMS"] = "cpu"
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, name, core), daemon=True)
        self.process.start()

    def ask(self, n, length, step, how, t_end, kind="prepare", seeds=(0,)) -> None:
        """Begin a computation."""
        self.pipe.send((kind, n, length, step, how, t_end, seeds))

    def answer(self):
        """Return the state, seconds of setting up, and seconds of the processor for stepping."""
        return self.pipe.recv()

    def run(self, *setting, **more):
        """Compute and wait."""
        self.ask(*setting, **more)
        return self.answer()

    def close(self) -> None:
        """End the process."""
        self.process.terminate()
        self.process.join()
