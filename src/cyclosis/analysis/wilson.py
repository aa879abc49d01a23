"""How well a share is known from a number of trials: Wilson's score interval."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError, number
from ..model.grid import Array


def wilson(successes: npt.ArrayLike, trials: npt.ArrayLike, confidence: float = 0.95) -> tuple[Array, Array]:
    """Return the lower and upper end (...) of Wilson's interval of a share, both between 0 and 1.

    Of `trials` (...) independent trials `successes` (...) succeeded, with the share p = successes/trials.
    The ends are the two shares s that are z standard deviations of a binomial share from p,
    (p - s)² = z² s (1 - s)/n, with n = trials and z the normal quantile of (1 + confidence)/2:

        s = [p + z²/2n ± z (p (1 - p)/n + z²/4n²)^½] / (1 + z²/n) .

    It never leaves [0, 1] and has a width even where p = 0 or 1. NaN where there are no trials. The
    arguments broadcast; `successes` need not be whole. Raises `InputError` for counts that are negative
    or not finite, for more successes than trials, and for a confidence outside
    [10⁻⁶, 1 - 10⁻⁶]. Source: Wilson,
    J. Am. Stat. Assoc. 22 (1927) 209.
    """
    level = number("confidence", confidence, 1e-6, 1 - 1e-6, "the default is 0.95")
    hits, n = np.broadcast_arrays(
        np.asarray(successes, dtype=np.float64), np.asarray(trials, dtype=np.float64)
    )
    if not (np.all(np.isfinite(hits)) and np.all(np.isfinite(n)) and np.all(hits >= 0) and np.all(n >= hits)):
        raise InputError(
            "successes and trials", (successes, trials), "counts with 0 <= successes <= trials", "count again"
        )
    z = NormalDist().inv_cdf(0.5 * (1 + level))
    some = np.where(n > 0, n, 1.0)
    p = hits / some
    middle = p + z**2 / (2 * some)
    half = z * np.sqrt(p * (1 - p) / some + z**2 / (4 * some**2))
    scale = np.where(n > 0, 1 + z**2 / some, np.nan)
    # At p = 0 and 1 one end equals p exactly, which rounding would miss.
    low = np.where(hits == 0, 0.0, np.maximum(middle - half, 0.0)) / scale
    high = np.where(hits == n, scale, np.minimum(middle + half, scale)) / scale
    return low, high
