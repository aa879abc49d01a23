"""What one setting is, and how its values are checked and read. Nothing heavy is imported here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

from . import errors

Kind = Literal["number", "whole", "flag", "choice", "text", "names", "numbers", "shape"]


@dataclass(frozen=True)
class Definition:
    """One setting: what it is called, what it means and what it may be.

    `optional` settings may also be None, `needed` ones have no default; `field` marks a parameter that may
    be given as an array of shape (n_theta, n_z). `usual` is the range of a slider: the paper's values and
    their surroundings. `also` is one more value of a whole number, outside the range.
    """

    name: str
    symbol: str
    meaning: str
    default: Any
    kind: Kind = "number"
    minimum: float = 0.0
    maximum: float = 1e3
    allowed: tuple[str, ...] = ()
    optional: bool = False
    field: bool = False
    needed: bool = False
    usual: tuple[float, float] | None = None
    also: int | None = None

    @property
    def remedy(self) -> str:
        """What to do about a refused value."""
        if self.needed:
            return "give one: there is no default"
        if self.default is None:
            return "leave it out for the default"
        return f"the default is {str(self.default).lower() if self.kind == 'flag' else self.default}"

    @property
    def rule(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return "one of " + ", ".join(self.allowed)
        if self.kind == "flag":
            return "true or false"
        if self.kind in ("number", "whole"):
            span = errors.span(self.minimum, self.maximum)
            return span if self.also is None else f"{span}, or {self.also}"
        return {
            "text": "a text",
            "names": "a list of names",
            "numbers": "a list of numbers in increasing order",
            "shape": "two whole numbers [n_theta, n_z]",
        }[self.kind]

    @property
    def written(self) -> str:
        """The allowed values in words, and how a list of them is written on the command line."""
        if self.kind == "names" and self.allowed:
            return f"{self.rule} among {', '.join(self.allowed)}, as {','.join(self.allowed[:2])}"
        form = {"numbers": "0,10,25", "shape": "32,32"}.get(self.kind)
        return f"{self.rule}, as {form}" if form else self.rule

    def check(self, value: Any) -> Any:
        """Return `value` in its proper type, or raise `InputError` with one sentence."""
        if value is None and self.optional:
            return None
        if self.kind == "number":
            return errors.number(self.name, value, self.minimum, self.maximum, self.remedy)
        if self.kind == "whole":
            least, most = int(self.minimum), int(self.maximum)
            return errors.whole(self.name, value, least, most, self.remedy, self.also)
        if self.kind == "flag":
            return errors.flag(self.name, value)
        if self.kind == "choice":
            return errors.choice(self.name, value, self.allowed)
        if self.kind == "text":
            if not isinstance(value, str) or not value or "\0" in value:
                raise errors.InputError(self.name, value, self.rule, self.remedy)
            return value
        return self._check_list(value)

    def parse(self, text: str) -> Any:
        """Return the checked value that a text on the command line describes.

        Lists are separated by commas or spaces, with brackets or without; a shape also by an x.
        """
        if self.kind in ("names", "numbers", "shape"):
            between = r"\s*[,x]\s*|\s+" if self.kind == "shape" else r"\s*,\s*|\s+"
            inner = re.fullmatch(r"\s*\[(.*)\]\s*", text, re.DOTALL)
            parts = re.split(between, (inner[1] if inner else text).strip())
            if self.kind == "names":
                return self.check([part.strip("\"'") for part in parts])
            values = [_plain(part) for part in parts]
            if not all(isinstance(value, int | float) for value in values):
                raise errors.InputError(self.name, text, self.written, self.remedy)
            return self.check(values)
        if self.kind in ("text", "choice"):
            return self.check(text)
        return self.check(_plain(text))

    def _check_list(self, value: Any) -> tuple[Any, ...]:
        if self.kind == "numbers" and hasattr(value, "shape") and hasattr(value, "dtype"):
            from .arrays import series  # loads NumPy, which lists do not need

            value = series(self.name, value, self.remedy).tolist()
        listed = isinstance(value, list | tuple)
        if self.kind == "names":
            if not listed or not value or not all(isinstance(item, str) for item in value):
                raise errors.InputError(self.name, value, "a list of at least one name", self.remedy)
            return tuple(errors.choice(self.name, item, self.allowed or (item,)) for item in value)
        if self.kind == "shape":
            if not listed or len(value) != 2:
                raise errors.InputError(self.name, value, self.rule, self.remedy)
            low, high = int(self.minimum), int(self.maximum)
            return tuple(errors.whole(self.name, item, low, high, self.remedy, self.also) for item in value)
        if not listed or not value:
            raise errors.InputError(self.name, value, self.rule, self.remedy)
        times = tuple(
            errors.number(self.name, item, self.minimum, self.maximum, self.remedy) for item in value
        )
        for before, after in pairwise(times):
            if after <= before:
                rule = f"later than the one before it, {before!r}"
                raise errors.InputError(self.name, after, rule, "sort them and leave out repeats")
        return times


def _plain(text: str) -> Any:
    """Return a text as a bool, int or float if it can be read as one, otherwise unchanged."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
