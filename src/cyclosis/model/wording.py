"""Numbers in sentences that compare them: what is printed must be true as it is printed."""

from __future__ import annotations

from typing import Any


def beside(value: Any, other: Any, digits: int = 6) -> str:
    """Return a number as a text that compares with another, exactly printed, as the two numbers do.

    It has `digits` significant digits, and more if the two would look equal or change their order. Both
    numbers are dimensionless.

    Example:
        >>> from cyclosis.model.wording import beside
        >>> [f"order {beside(order, 0.05, 2)} is below 0.05" for order in (0.031234, 0.049996)]
        ['order 0.031 is below 0.05', 'order 0.049996 is below 0.05']
    """
    for count in range(digits, 17):
        text = f"{value:.{count}g}"
        shown = float(text)
        if (shown < other, shown > other) == (value < other, value > other):
            return text
    return repr(float(value))
