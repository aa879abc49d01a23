"""A run as a movie: the slowly turning cell and the unwrapped map, with the flow streaming over both."""

from __future__ import annotations

import multiprocessing
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from ..model.doors import door
from ..model.errors import InputError, number, whole
from ..model.grid import Array
from ..model.units import scales_in
from . import looks, style
from .clock import movie_times
from .encode import Output
from .frames import area_shares, frame, in_memory, mean_square, peak_speed, travelled
from .scene import Pixels, Scene, SceneLayout, Shot, draw_shot, open_stage
from .subjects import Subject, subject_of
from .tracers import Tracers

__all__ = [
    "FADE",
    "FINEST",
    "HEIGHT",
    "PACE",
    "movie",
]


def __dir__() -> list[str]:
    return sorted(__all__)


PACE = 0.6
"""Radii that the fastest flow moves a line in a second of the movie."""
FADE = 0.5
"""Seconds in which a line appears or disappears."""
FINEST = 192
"""States on finer grids are reduced to this many points in each direction: no picture shows more."""
HEIGHT = 540
"""Default height of a frame in pixels."""


@door
def movie(
    dataset: Any,
    paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    frames: int = 144,
    seconds: float = 12.0,
    turns: float | None = None,
    height: int = HEIGHT,
    progress: Callable[[int, int], object] | None = None,
    workers: int | None = None,
) -> list[Path]:
    """Write the movie of a run as MP4 or GIF, by suffix, and return the paths.

    `dataset` is a run's `xarray.Dataset`. Frames are drawn once for all `paths`. `frames` are spread over
    `seconds` so that fast changes are shown slowly (see `cyclosis.figures.clock.movie_times`), from the
    first to the last saved time; between saved times P and u are interpolated linearly. The cell makes
    `turns`, by default half a turn and a closed one a whole turn, and ends with an indifferent zone in front.
    The lines stream at a pace set by the flow's speed, but per second of the movie, not per unit of time.
    `height` is in pixels, a multiple of 18; frames are 16:9, GIFs at most 324 pixels high. A GIF has a
    resolution of a hundredth of a second and shows at most 50 frames per second: its frames differ in
    duration by one hundredth, and surplus frames are left out, so that it lasts `seconds` too.
    `progress(done, total)` is called after every frame.
    `workers` processes draw, by default one per core; in a script that is not guarded by
    `if __name__ == "__main__":` give 1. Raises `InputError` for bad arguments, fewer than 2 saved
    frames, and places that cannot be written to.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.movie import movie
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid, magnitude=0.5), t_end=2.0)
        >>> paths = movie(run.to_dataset(), "cell.gif", frames=2, seconds=1.0, height=180, workers=1)
        >>> [path.name for path in paths]
        ['cell.gif']
    """
    subject = subject_of(dataset, FINEST)
    if dataset.sizes["time"] < 2:
        raise InputError("the number of saved frames", dataset.sizes["time"], "at least 2", "save more often")
    frames = whole("frames", frames, 2, 100_000, "choose a number of frames")
    seconds = number("seconds", seconds, 0.1, 3600.0, "choose a duration")
    turns = subject.turns if turns is None else turns
    turns = number("turns", turns, -100.0, 100.0, "choose a number of turns")
    height = whole("height", height, 90, 4320, "choose a number of pixels")
    if height % 18:
        raise InputError("height", height, "a multiple of 18, so that frames are 16:9", "choose 540 or 720")
    processes = _processes(workers)
    listed = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    if not listed:
        raise InputError("paths", listed, "at least one file name", "give the movie a name")
    about = style.marks(dataset)
    with ExitStack() as stack:
        outputs = [stack.enter_context(Output(path, frames, seconds, about)) for path in listed]
        dataset = in_memory(dataset)
        shots = _shots(dataset, subject, frames, seconds, turns)
        scene = Scene(subject.surface, *_order(dataset), height, scales_in(dataset), looks.colours())
        for done, pixels in enumerate(_drawn(scene, shots, processes), 1):
            for output in outputs:
                output.add(pixels)
            if progress is not None:
                progress(done, frames)
    return [output.path for output in outputs]


def _processes(workers: int | None) -> int:
    most = min(8, os.cpu_count() or 1) if workers is None else workers
    processes = whole("workers", most, 1, 256, "choose a number of processes")
    # A script that is not guarded is run again by every process it starts: refuse that here, before a file is
    # opened. At that moment such a process has no parent yet; multiprocessing itself checks this attribute.
    beginning = getattr(multiprocessing.current_process(), "_inheriting", False)
    if processes > 1 and (beginning or multiprocessing.parent_process() is not None):
        raise _unguarded(processes)
    return processes


def _unguarded(processes: int) -> InputError:
    rule = "1 where no other processes can be started, as in a script without `if __name__ == '__main__':`"
    return InputError("workers", processes, rule, "give 1, or guard the script")


def _order(dataset: xarray.Dataset) -> tuple[Array, Array]:
    """Return the order over time, from the first to the last saved time."""
    if "order" in dataset:
        values = dataset["order"]
        return values[values.dims[0]].values, values.values
    states = (frame(dataset, index)[0] for index in range(dataset.sizes["time"]))
    order = [mean_square(P, area_shares(dataset)) for P in states]
    return dataset["time"].values, np.array(order)


def _shots(
    dataset: xarray.Dataset, subject: Subject, count: int, seconds: float, turns: float
) -> Iterator[Shot]:
    """Yield what the frames show, in order."""
    saved = dataset["time"].values
    recorded, order = _order(dataset)
    peak = peak_speed(dataset)
    tracers = Tracers(subject.portrait.wall, FADE * count / seconds)
    last = subject.facing(frame(dataset, -1)[0])
    views = last - 2 * np.pi * turns * np.linspace(1.0, 0.0, count)
    fields = _Between(dataset)
    times = movie_times(saved, travelled(dataset), count)
    for view, time in zip(views.tolist(), times.tolist(), strict=True):
        look = subject.look(*fields.at(time))
        ribbons = tracers.advance(look.u, peak, PACE * seconds / count)
        now = float(np.interp(time, recorded, order))
        yield Shot(look.P, look.u, ribbons, view, time, now, look.marks)


class _Between:
    """The fields of a run between its saved times; caches the two frames in use."""

    def __init__(self, dataset: xarray.Dataset) -> None:
        self.dataset, self.times = dataset, dataset["time"].values
        self.before = -1
        self.pair: list[tuple[Array, Array]] = []

    def at(self, time: float) -> tuple[Array, Array]:
        """Return P and u, both (2, ...), at a time."""
        before = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, self.times.size - 2))
        if before != self.before:
            self.before, self.pair = before, [frame(self.dataset, before), frame(self.dataset, before + 1)]
        start, stop = self.times[before : before + 2]
        share = (time - start) / (stop - start)
        (P, u), (next_P, next_u) = self.pair
        return P + share * (next_P - P), u + share * (next_u - u)


def _drawn(scene: Scene, shots: Iterator[Shot], processes: int) -> Iterator[Pixels]:
    """Yield the frames' pictures in order, drawn in this process or in several others."""
    if processes == 1:
        stage = SceneLayout(scene)
        yield from map(stage.drawn, shots)
        return
    # Fresh processes, because a copy of one that has used JAX may hang.
    fresh = multiprocessing.get_context("spawn")
    try:
        with ProcessPoolExecutor(processes, fresh, open_stage, (scene,)) as pool:
            waiting: deque[Future[Pixels]] = deque()
            for shot in shots:
                waiting.append(pool.submit(draw_shot, shot))
                if len(waiting) > 3 * processes:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
    except BrokenProcessPool as error:
        raise _unguarded(processes) from error
