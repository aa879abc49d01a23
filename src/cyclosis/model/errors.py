"""What is said when input cannot be used: what was found, what is allowed, what to do."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Iterable
from typing import Any


class InputError(ValueError):
    """Input that cannot be used.

    The message is one sentence naming the field, the value found, the rule and the remedy; the four
    parts are also attributes.

    Example:
        >>> import cyclosis as cy
        >>> cy.Parameters(alpha_p=-1.0)
        Traceback (most recent call last):
            ...
        cyclosis.model.errors.InputError: alpha_p = -1.0 cannot be used: ...
        >>> try:
        ...     cy.CylinderGrid(n_theta=4)
        ... except cy.InputError as error:
        ...     print(error.field, error.value, error.rule)
        n_theta 4 a whole number from 8 to 8192
    """

    def __init__(self, field: str, value: Any, rule: str, remedy: str) -> None:
        self.field, self.value, self.rule, self.remedy = field, value, rule, remedy
        super().__init__(f"{field} = {shown(value)} cannot be used: it must be {rule}; {remedy}.")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.field, self.value, self.rule, self.remedy)


def shown(value: Any, width: int = 60) -> str:
    """Return `value` as a short one-line text for a message."""
    if getattr(value, "ndim", 0):
        return f"an array of shape {value.shape}"
    text = " ".join(repr(value).split())
    return text if len(text) <= width else text[: width - 3] + "..."


def span(minimum: float, maximum: float) -> str:
    """Return a range of numbers in words."""
    return f"from {minimum:g} to {maximum:g}"


def number(field: str, value: Any, minimum: float, maximum: float, remedy: str) -> float:
    """Return `value` as a finite float within [minimum, maximum], or raise `InputError`."""
    usable = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if getattr(value, "shape", None) == () and getattr(value.dtype, "kind", "") in "iuf":
        usable, value = True, value.item()
    rule = f"one number {span(minimum, maximum)}"
    try:
        result = float(value) if usable else float("nan")
    except OverflowError:
        result = float("inf")
    if not usable or not math.isfinite(result) or not minimum <= result <= maximum:
        raise InputError(field, value, rule, remedy)
    return result


def whole(field: str, value: Any, minimum: int, maximum: int, remedy: str) -> int:
    """Return `value` as an int within [minimum, maximum], or raise `InputError`."""
    usable = isinstance(value, numbers.Integral) and not isinstance(value, bool)
    if not usable or not minimum <= int(value) <= maximum:
        raise InputError(field, value, f"a whole number from {minimum} to {maximum}", remedy)
    return int(value)


def flag(field: str, value: Any) -> bool:
    """Return `value` as a bool, or raise `InputError`."""
    plain = value.item() if getattr(value, "shape", None) == () else value
    if not isinstance(plain, bool):
        raise InputError(field, value, "true or false", "write one of the two")
    return plain


def choice(field: str, value: Any, allowed: tuple[str, ...]) -> str:
    """Return `value` if it is one of `allowed`, or raise `InputError`."""
    if not isinstance(value, str) or value not in allowed:
        raise InputError(field, value, "one of " + ", ".join(allowed), "choose one of these names")
    return value


def closest(name: str, known: Iterable[str]) -> str:
    """Return the remedy for a misspelt name."""
    match = difflib.get_close_matches(str(name), list(known), 1)
    return f"did you mean {match[0]}" if match else "check the spelling"
