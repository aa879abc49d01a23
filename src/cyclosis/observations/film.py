"""Velocities from a film itself: it is read, steadied, and what moves in it is measured."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..model.doors import door
from ..model.errors import InputError, flag, number, whole
from ..model.reporting import Progress, counted, reported
from .films import light as lights
from .films import measuring, moving, reading, steady, trial
from .films.line import line_of
from .films.reading import Film
from .formats.content import KYMOGRAPH
from .observation import Frame, Observation

Array = npt.NDArray[np.float64]

PAIRS = 60
"""Pairs of frames that are measured if nothing is given."""
SAME = 1e-6
"""Relative difference below which a frame is a copy of the one before."""
LEAST, NOISY, FAST = 0.1, 3.0, 75
"""Nothing moves if this percentile is below so many pixels, or so many times the noise of one component."""
SLOW = 0.5
"""Displacement in pixels per pair below which a note says that frames further apart would be better."""
EMPTY = 0.01
"""Share of a picture that must move for a film to be measured."""


@door
def film(
    path: str | os.PathLike[str],
    *,
    frame_s: float | None = None,
    pixel_um: float | None = None,
    frames: tuple[int, int | None] | None = None,
    every: int = 1,
    pairs: int | None = None,
    step_px: int = 8,
    window_px: float | None = None,
    gap: int | None = None,
    average: int | None = None,
    steady_stage: bool = True,
    light: str = "luma",
    line_px: Sequence[Sequence[float]] | None = None,
    progress: Progress = None,
) -> Observation:
    """Return the velocities in a film, an `Observation` on a grid of its pictures.

    Videos (.avi, .mp4, .mov, .gif and others) and stacks of TIFF pictures are read. Each frame is rid of slow
    variations of light and brought to the same contrast; the drift of the stage is taken out as far as
    something in the picture stands still; what stands still is subtracted, from 3 frames on if it can be told
    from what moves slowly. Displacements between two frames are those of scikit-image's iterative
    Lucas-Kanade optical flow, forward and backward. Samples are good where both agree, where the second
    frame, moved back, resembles the first one, and where the standard error, which the scatter of the light
    that is left gives, is below 15 % of the fastest displacements.

    `frame_s` is the time between two frames of the film; without it that of the file is taken, which is the
    rate of playing. A TIFF stack without it gives velocities per frame. `frames` is a span (first, last) and
    `every` takes one frame in so many. At most `pairs` (60) pairs of frames are measured, spread evenly over
    the film. `step_px` is the distance of samples. `window_px` is the diameter of the window, a Gaussian with
    a quarter of that as its standard deviation; `gap` is how many frames lie between the first of a pair and
    the second (1: successive frames); a velocity is the mean of `average` pairs that follow each other. These
    three are chosen on a pair in the middle of the film, as small as its light allows, and a note says them.
    `light` is the colour that is used: luma, red, green or blue. With `line_px`, the ends ((x, y), (x, y)) of
    a line, the result is a kymograph along it, whose speeds `on_surface` measures; nothing is taken out of
    that. `frame_s` of the result is the time from the first frame of a pair to the second, and `noise_px` the
    noise of one component of that displacement, from three successive means, or in short films their standard
    error; its `window_px` is the side of a square that averages as the window does. A bar shows the
    velocities that are done in a terminal or a notebook unless `progress` is False; a function is called as
    `progress(done, total)`. Needs scikit-image
    (`pip install 'cyclosis[film]'`), and tifffile for TIFF (`cyclosis[data]`). Raises `InputError` in one
    sentence for films that cannot be read, that have fewer than two frames, or in which nothing moves.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> run = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0)
        >>> view = cy.observations.View(radius_px=40.0)
        >>> shot = cy.observations.observe(run, view, "film", pixel_um=12.5, frames=4)
        >>> paths = shot.write("shot", "avi")
        >>> seen = cy.observations.film("shot/film.avi", frame_s=0.3)  # doctest: +SKIP
        >>> seen.time_unit, len(seen.frames)  # doctest: +SKIP
        ('s', 3)
    """
    start, stop = _span(frames)
    step = whole("every", every, 1, 100_000, "take one frame in so many")
    most = whole("pairs", PAIRS if pairs is None else pairs, 1, 1_000_000, "give a number of pairs")
    apart = whole("step_px", step_px, 1, 512, "give the distance of samples in pixels")
    between = None if gap is None else whole("gap", gap, 1, 10_000, "give the frames from first to second")
    mean = None if average is None else whole("average", average, 1, 1000, "give a number of pairs")
    window = None if window_px is None else number("window_px", window_px, 5.0, 1001.0, "give pixels")
    flag("steady_stage", steady_stage)
    if line_px is None:
        moving.registration()
    shot = reading.read(Path(path), (start, stop), step, light)
    times, unit, notes = _times(shot, frame_s, step)
    size = shot.pixel_um
    if pixel_um is not None:
        size = number("pixel_um", pixel_um, 1e-6, 1e6, "give the size of a pixel in micrometres")
    if line_px is not None:
        return _kymograph(shot, times, unit, size, line_px, str(path), notes)
    kept = _distinct(shot.pictures)
    if kept.size < len(shot.pictures):
        notes.append(f"{len(shot.pictures) - kept.size} frames are copies of those before, and were left out")
    if kept.size < 2:
        rule = "a film in which something moves: all frames are the same"
        raise InputError("file", str(path), rule, "choose another film")
    if (between or 1) + (mean or 1) > kept.size:
        rule = f"less than the film has together, {kept.size} frames"
        raise InputError("gap and average", (between or 1, mean or 1), rule, "make them smaller")
    prepared = lights.flattened(shot.pictures[kept])
    places = steady.drift(prepared) if steady_stage else np.zeros((kept.size, 2))
    if places.any():
        far = shot.binned * float(np.hypot(*(places.max(axis=0) - places.min(axis=0))))
        notes.append(f"the stage drifted by {far:.1f} pixels, which was taken out")
    picture = steady.steadied(shot.pictures[kept][:40], places[:40]).mean(axis=0)
    radius = None if window is None else max(2, round(0.5 * (window / shot.binned - 1)))
    cell = _cell(steady.steadied(prepared, places), times[kept], radius, shot.binned, str(path))
    plan, fastest = trial.planned(cell.pictures, cell.live, radius, between, mean)
    with reported(progress, "velocities", counted) as told:
        seen, errors = measuring.measured(cell, plan, fastest, most, apart, told)
    if not errors.size:
        rule = "a film whose frames resemble each other, moved by less than about 20 pixels"
        remedy = "record more frames a second, or leave out every"
        raise InputError("file", str(path), rule, remedy)
    took = plan.gap * float(np.median(np.diff(cell.when)))
    scatter = took * (measuring.noise(cell, plan, fastest) or float(np.median(errors)))
    notes += _judged(seen, took, scatter, shot.binned, str(path))
    return Observation(
        tuple(seen),
        time_unit=unit,
        pixel_um=size,
        frame_s=took if unit == "s" else None,
        noise_px=scatter if unit == "s" else scatter / took,
        window_px=moving.even_side(plan.radius) * shot.binned,
        format="film",
        source=str(path),
        notes=(*shot.notes, *notes, _said(plan, shot.binned)),
        image=_full(picture, shot.binned),
    )


def _cell(
    pictures: npt.NDArray[np.float32], when: Array, radius: int | None, binned: int, source: str
) -> measuring.Prepared:
    """Return the frames without what stands still, and where something moves."""
    clear = trial.without_still(pictures, radius)
    live = moving.moves(clear, lights.camera_noise(pictures))
    if live.mean() < EMPTY:
        rule = "a film in which something moves: its light does not change by more than its noise"
        remedy = "take frames further apart, or a sharper film"
        raise InputError("file", source, rule, remedy, "give --every 5, for example")
    return measuring.Prepared(clear, when, live, binned)


def _judged(seen: list[Frame], took: float, scatter: float, binned: int, source: str) -> list[str]:
    """Refuse a film in which nothing moves faster than noise, and return a note if it is slow."""
    ways = took * np.concatenate([_moved(frame)[frame.good] for frame in seen])
    way, fast = float(np.median(ways)), float(np.percentile(ways, FAST))
    least = max(LEAST * binned, NOISY * scatter)
    if fast < least:
        rule = f"a film in which something moves by {least:.2g} pixels from frame to frame, above the noise"
        remedy = "take frames further apart (every)"
        raise InputError("file", source, rule, remedy, "give --every 5, for example")
    if way < SLOW * binned:
        return [
            f"half of the displacements are below {way:.2g} pixels; frames further apart (every) are better"
        ]
    return []


def _said(plan: trial.Plan, binned: int) -> str:
    """Return how pairs were measured, in words."""
    window = f"a window of {(2 * plan.radius + 1) * binned} pixels"
    pairs = "successive frames" if plan.gap == 1 else f"frames {plan.gap} apart"
    return f"{pairs} were compared with {window}" + (
        f"; a velocity is the mean of {plan.average} pairs" if plan.average > 1 else ""
    )


def _kymograph(
    shot: Film,
    times: Array,
    unit: str,
    pixel_um: float | None,
    line_px: Sequence[Sequence[float]],
    source: str,
    notes: list[str],
) -> Observation:
    image, ends = line_of(shot, times, line_px)
    return Observation(
        (),
        KYMOGRAPH,
        unit,
        pixel_um,
        float(np.median(np.diff(times))) if unit == "s" else None,
        format="film",
        source=source,
        notes=(*shot.notes, *notes),
        image=image,
        extra={"line_px": ends},
    )


def _span(frames: tuple[int, int | None] | None) -> tuple[int, int | None]:
    if frames is None:
        return 0, None
    remedy = "give frames=(first, last), counted from 0"
    if not isinstance(frames, list | tuple) or len(frames) != 2:
        raise InputError("frames", frames, "two whole numbers (first, last)", remedy)
    first = whole("frames", frames[0], 0, 10**9, remedy)
    last = None if frames[1] is None else whole("frames", frames[1], first + 2, 10**9, remedy)
    return first, last


def _times(shot: Film, frame_s: float | None, every: int) -> tuple[Array, str, list[str]]:
    """Return the times of the frames, their unit, and where they come from."""
    count = len(shot.pictures)
    if frame_s is not None:
        given = number("frame_s", frame_s, 1e-9, 1e9, "give the seconds between two frames of the film")
        if shot.times is not None and count > 2:
            steps = np.diff(shot.times)
            if np.ptp(steps) > reading.STEADY * float(np.median(steps)):
                # The file tells when each frame was shown; the given time is that of the usual step.
                scaled = shot.times * (given * every / float(np.median(steps)))
                return (
                    scaled - scaled[0],
                    "s",
                    ["frames are not evenly spaced; the times of the file, scaled"],
                )
        return given * every * np.arange(count, dtype=np.float64), "s", []
    if shot.times is None:
        note = "the file does not tell the time between frames: velocities are per frame (give frame_s)"
        return every * np.arange(count, dtype=np.float64), "frame", [note]
    steps = np.diff(shot.times)
    usual = float(np.median(steps))
    notes = [f"{usual / every:.4g} s between frames is what the file says, the rate of playing it (frame_s)"]
    if np.ptp(steps) > reading.STEADY * usual:
        notes.append(f"frames are not evenly spaced: {steps.min():.3g} to {steps.max():.3g} s apart")
    return shot.times - shot.times[0], "s", notes


def _distinct(pictures: npt.NDArray[np.float32]) -> npt.NDArray[np.int64]:
    """Return the frames that are no copies of the one before, as converters of films add them."""
    change = np.array([np.abs(b - a).mean() for a, b in pairwise(pictures)])
    usual = float(np.median(change))
    scale = max(usual, SAME * float(np.abs(pictures[0]).mean()), 1e-12)
    return np.concatenate([[0], 1 + np.flatnonzero(change > 1e-3 * scale)])


def _moved(frame: Frame) -> Array:
    assert frame.vx is not None
    assert frame.vy is not None
    return np.hypot(frame.vx, frame.vy)


def _full(picture: npt.NDArray[np.float32], binned: int) -> npt.NDArray[np.float32]:
    """Return a picture in the pixels of the file."""
    return np.repeat(np.repeat(picture, binned, axis=0), binned, axis=1) if binned > 1 else picture
