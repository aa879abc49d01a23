"""How values of this package show themselves: a short text, and a tree in a notebook, without arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from html import escape
from typing import Any, TypeVar

import numpy as np

from .notebook import tree

MOST = 60
"""Characters of one part of a text."""
WHOLE = 500
"""Characters of a whole text."""

Class = TypeVar("Class", bound=type)


def shown(cls: Class) -> Class:
    """Give a class a short text in place of the one that dataclasses and named tuples make, and a tree.

    A text that a class writes itself is kept, and is shown in notebooks as well.
    """
    made = hasattr(cls, "_fields") or hasattr(cls.__dict__.get("__repr__", cls.__repr__), "__wrapped__")
    kind: Any = cls
    if made:
        kind.__repr__ = _text
    if "_repr_html_" not in cls.__dict__:
        kind._repr_html_ = _branches if made else _written
    return cls


def brief(value: Any) -> str:
    """Return a value in a few characters: arrays by their shape, and what is long by its kind."""
    if isinstance(value, str):
        return repr(value if len(value) <= MOST else f"{value[: MOST - 3]}...")
    if _is_array(value):
        return f"<array {tuple(value.shape)}>"
    if isinstance(value, np.generic):
        return repr(value.item())
    if callable(value) and hasattr(value, "__name__"):
        return f"<function {value.__name__}>"
    if isinstance(value, Mapping):
        return _few((f"{key!r}: {brief(one)}" for key, one in value.items()), len(value), "{}")
    if isinstance(value, tuple | list) and not hasattr(value, "_fields"):
        return _few(map(brief, value), len(value), "()" if isinstance(value, tuple) else "[]")
    if hasattr(value, "dims") and hasattr(value, "attrs"):
        return f"<{type(value).__name__}>"  # of xarray, whose text may be long
    text = repr(value)
    return text if len(text) <= MOST and "\n" not in text else f"<{type(value).__name__}>"


def _is_array(value: Any) -> bool:
    """Return whether a value is an array of NumPy or JAX; those of xarray show themselves."""
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    jax_like = hasattr(value, "__array__") and hasattr(value, "dtype") and not hasattr(value, "dims")
    return jax_like and bool(value.shape)


def _few(parts: Iterable[str], count: int, ends: str) -> str:
    if count > MOST:
        return f"<{count} items>"
    listed = ", ".join(parts) + ("," if ends == "()" and count == 1 else "")
    return f"{ends[0]}{listed}{ends[1]}" if len(listed) <= MOST else f"<{count} items>"


def _parts(value: Any) -> list[tuple[str, Any]]:
    """Return the names and values of the fields that a value shows."""
    named = getattr(value, "_fields", None) or [item.name for item in fields(value) if item.repr]
    return [(name, getattr(value, name)) for name in named]


def _text(self: Any) -> str:
    words = f"{type(self).__name__}({', '.join(f'{name}={brief(one)}' for name, one in _parts(self))})"
    return words if len(words) <= WHOLE else f"{words[: WHOLE - 4]}...)"


def _branches(self: Any) -> str:
    return tree(type(self).__name__, [(name, _said(one)) for name, one in _parts(self)])


def _said(value: Any) -> str:
    """Return a value for a tree: an array with its size and its range."""
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if not _is_array(value):
        return brief(value)
    array = np.asarray(value)
    size = " x ".join(map(str, array.shape)) + " values"
    if array.dtype.kind not in "iuf" or not np.isfinite(array).any():
        return f"{size}, {array.dtype}"
    return f"{size}, {np.nanmin(array):.4g} to {np.nanmax(array):.4g}"


def _written(self: Any) -> str:
    return f'<pre style="margin:0;background:none">{escape(repr(self))}</pre>'
