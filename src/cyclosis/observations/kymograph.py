"""Speeds along a line from a kymograph, by correlation of its rows, refused where they could be aliased."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.arrays import numbers
from ..model.doors import door
from ..model.errors import InputError, whole

Array = npt.NDArray[np.float64]
LEAST_PEAK = 0.15
"""Correlation of shifted rows below which nothing was recognised again."""
DISTINCT = 1.25
"""How much higher the highest peak must be than the next one: otherwise streaks could be mistaken."""


@shown
@dataclass(frozen=True)
class LineSpeeds:
    """Speeds along the line of a kymograph, in windows of its columns and rows.

    `speed` (rows, columns) is in pixels per row of the kymograph, positive to the right, NaN where nothing
    was recognised; `times` (rows,) and `places` (columns,) are the middles of the windows, in rows and
    pixels. `correlation` (rows, columns) is the height of the peak, 1 for rows that are alike.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> pattern = np.random.default_rng(0).normal(size=400)
        >>> picture = np.stack([np.roll(pattern, 4 * row) for row in range(40)])
        >>> round(cy.observations.line_speeds(picture).mean, 2)
        4.0
    """

    speed: Array
    times: Array
    places: Array
    correlation: Array

    @property
    def mean(self) -> float:
        """The mean of all speeds, in pixels per row.

        Example:
            >>> import numpy as np
            >>> import cyclosis as cy
            >>> speed = np.array([[1.0, 3.0]])
            >>> cy.observations.LineSpeeds(speed, np.zeros(1), np.zeros(2), np.ones((1, 2))).mean
            2.0
        """
        return float(np.nanmean(self.speed))


@door
def line_speeds(image: npt.ArrayLike, columns: int = 1, rows: int = 1) -> LineSpeeds:
    """Return the speeds in a kymograph (times, places) in `columns` x `rows` windows.

    Every row is correlated with the next one, and the mean correlation over the window has its peak at the
    shift per row, found to a fraction of a pixel by a parabola. Unlike the slope of streaks in the picture,
    this is right for streaks that move by more than their width in a row. Where two shifts fit almost
    equally well, as for a periodic pattern, the speed is ambiguous. Raises `InputError` for that, for a
    picture in which nothing is recognised from row to row, and for one that is too small.

    Example: streaks that move by three of their widths in every row.
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> pattern = np.random.default_rng(1).normal(size=300)
        >>> picture = np.stack([np.roll(pattern, -9 * row) for row in range(60)])
        >>> cy.observations.line_speeds(picture, columns=2).speed.round(1)
        array([[-9., -9.]])
    """
    picture = numbers("image", image, "numbers (times, places)", "give one kymograph")
    parts = whole("columns", columns, 1, 1000, "give a number of windows")
    spans = whole("rows", rows, 1, 100000, "give a number of windows")
    if picture.ndim != 2 or picture.shape[0] < 2 * spans or picture.shape[1] < 16 * parts:
        rule = f"an image of at least {2 * spans} rows and {16 * parts} columns for so many windows"
        raise InputError("image", picture, rule, "use fewer windows, or a longer kymograph")
    if not np.isfinite(picture).all():
        raise InputError("image", picture, "finite everywhere", "cut off what was not recorded")
    clean = picture - picture.mean(axis=0)
    across = np.array_split(np.arange(picture.shape[1]), parts)
    along = np.array_split(np.arange(picture.shape[0]), spans)
    found = [[_shift(clean[np.ix_(span, part)]) for part in across] for span in along]
    speed = np.array([[shift for shift, _ in row] for row in found])
    height = np.array([[peak for _, peak in row] for row in found])
    if not np.isfinite(speed).any():
        rule = "a kymograph in which rows resemble the rows before, shifted by one distance"
        remedy = "record lines more often, or a finer pattern: the speed would be ambiguous"
        raise InputError("image", picture, rule, remedy)
    return LineSpeeds(
        speed, np.array([s.mean() for s in along]), np.array([p.mean() for p in across]), height
    )


def _shift(window: Array) -> tuple[float, float]:
    """Return the shift per row in pixels and the correlation there, NaN if no shift stands out."""
    count = window.shape[1]
    rows = window - window.mean(axis=1, keepdims=True)
    spectrum = np.fft.rfft(rows, 2 * count, axis=1)
    product = (spectrum[1:] * spectrum[:-1].conj()).mean(axis=0)
    raw = np.fft.irfft(product, 2 * count)
    power = np.fft.irfft((np.abs(spectrum) ** 2).mean(axis=0), 2 * count)[0]
    most = count // 2
    lags = np.arange(-most, most + 1)
    if power <= 0:
        return np.nan, 0.0
    # Divided by the overlap, so that large shifts are not at a disadvantage.
    curve = raw[lags % (2 * count)] / power * count / (count - np.abs(lags))
    best = int(curve.argmax())
    peak = float(curve[best])
    if best in (0, lags.size - 1) or peak < LEAST_PEAK:
        return np.nan, peak
    if _next_peak(curve, best) * DISTINCT > peak:
        return np.nan, peak
    left, middle, right = curve[best - 1 : best + 2]
    bend = left - 2 * middle + right
    return float(lags[best] + (0.5 * (left - right) / bend if bend < 0 else 0.0)), peak


def _next_peak(curve: Array, best: int) -> float:
    """Return the height of the highest peak that is not part of the highest one."""
    low, high = best, best
    while low > 0 and curve[low - 1] < curve[low]:
        low -= 1
    while high < curve.size - 1 and curve[high + 1] < curve[high]:
        high += 1
    rest = np.concatenate([curve[:low], curve[high + 1 :]])
    return float(rest.max()) if rest.size else 0.0
