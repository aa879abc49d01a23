"""The error for input that cannot be used: what was found, what is allowed, what to do."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Iterable
from typing import Any

from .carried import NOT_TRACED as NOT_TRACED
from .carried import bare, objection, traced


class InputError(ValueError):
    """Input that cannot be used.

    The message is one sentence naming the field, the value found, the rule and the remedy; the four
    parts are also attributes. If the remedy differs on the command line, `command` is that remedy,
    and `at_terminal` the sentence with it.

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

    def __init__(self, field: str, value: Any, rule: str, remedy: str, command: str = "") -> None:
        self.field, self.value, self.rule, self.remedy = field, value, rule, remedy
        self.command = command or remedy
        super().__init__(self._sentence(remedy))

    @property
    def at_terminal(self) -> str:
        """The sentence for a user of the command line.

        Example:
            >>> import cyclosis as cy
            >>> error = cy.InputError("out", "run.nc", "a new file", "give force=True", "give --force")
            >>> error.at_terminal
            "out = 'run.nc' cannot be used: it must be a new file; give --force."
        """
        return self._sentence(self.command)

    def _sentence(self, remedy: str) -> str:
        return f"{self.field} = {shown(self.value)} cannot be used: it must be {self.rule}; {remedy}."

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.field, self.value, self.rule, self.remedy, self.command)


def shown(value: Any, width: int = 60) -> str:
    """Return `value` as a short one-line text for a message."""
    if traced(value):
        return "a value that JAX traces"
    if getattr(value, "ndim", 0) and hasattr(value, "shape"):
        return f"an array of shape {value.shape}"
    text = " ".join(repr(value).split())
    return text if len(text) <= width else text[: width - 3] + "..."


def span(minimum: float, maximum: float) -> str:
    """Return a range of numbers in words."""
    return f"from {_exactly(minimum)} to {_exactly(maximum)}"


def _exactly(value: float) -> str:
    text = f"{value:g}"
    return text if float(text) == value else repr(value)


def plain(field: str, value: Any) -> Any:
    """Return one value without the array around it, or raise `InputError` if it carries more than that."""
    refused = objection(value)
    if refused:
        raise InputError(field, value, *refused)
    return bare(value)


def number(field: str, value: Any, minimum: float, maximum: float, remedy: str) -> float:
    """Return `value` as a finite float within [minimum, maximum], or raise `InputError`."""
    found = plain(field, value)
    usable = isinstance(found, numbers.Real) and not isinstance(found, bool)
    try:
        result = float(found) if usable else float("nan")
    except OverflowError:
        result = float("inf")
    if not usable or not math.isfinite(result) or not minimum <= result <= maximum:
        raise InputError(field, value, f"one number {span(minimum, maximum)}", remedy)
    return result


def whole(field: str, value: Any, minimum: int, maximum: int, remedy: str, also: int | None = None) -> int:
    """Return `value` as an int within [minimum, maximum], or `also`; otherwise raise `InputError`."""
    found = plain(field, value)
    usable = isinstance(found, numbers.Integral) and not isinstance(found, bool)
    if not usable or not (minimum <= int(found) <= maximum or found == also):
        rule = f"a whole number from {minimum} to {maximum}"
        raise InputError(field, value, rule if also is None else f"{rule}, or {also}", remedy)
    return int(found)


def flag(field: str, value: Any) -> bool:
    """Return `value` as a bool, or raise `InputError`."""
    found = plain(field, value)
    if not isinstance(found, bool):
        raise InputError(field, value, "true or false", "write one of the two")
    return found


def choice(field: str, value: Any, allowed: tuple[str, ...]) -> str:
    """Return `value` if it is one of `allowed`, or raise `InputError`."""
    if not isinstance(value, str) or value not in allowed:
        raise InputError(field, value, "one of " + ", ".join(allowed), guess(value, allowed))
    return value


def closest(name: str, known: Iterable[str]) -> str:
    """Return the remedy for a misspelt name."""
    match = difflib.get_close_matches(str(name), list(known), 1)
    return f"did you mean {match[0]}" if match else "check the spelling"


def guess(name: Any, allowed: Iterable[str]) -> str:
    """Return the remedy for a name that is not one of those listed; case does not matter."""
    known = {each.lower(): each for each in allowed}
    match = difflib.get_close_matches(str(name).lower(), known, 1)
    return f"did you mean {known[match[0]]}" if match else "choose one of these names"
