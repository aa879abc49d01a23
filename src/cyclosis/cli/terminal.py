"""Characters that a terminal cannot encode are replaced by ones that it can: alpha for α, |- for a branch."""

from __future__ import annotations

import codecs
import io
import re
import sys
import unicodedata

PLAIN = "cyclosis.plain"
"""The name under which `_plain` replaces characters that an encoding lacks."""
_SPOKEN = {
    **{"├": "|", "└": "`", "│": "|", "─": "-", "━": "-", "·": "*", "×": "x", "−": "-", "–": "-", "—": "-"},
    **{"µ": "u", "°": " deg", "±": "+-", "≤": "<=", "≥": ">=", "≈": "~", "≠": "!=", "∞": "inf", "√": "sqrt"},
    **{"→": "->", "∂": "d", "∇": "grad", "…": "...", "“": '"', "”": '"', "‘": "'", "’": "'", "ß": "ss"},
}


def settle() -> None:
    """Make standard output and standard error accept any text."""
    codecs.register_error(PLAIN, _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=PLAIN)


def writable(text: str) -> str:
    """Return a text in a form that standard output can write."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    return text.encode(encoding, PLAIN).decode(encoding, "surrogateescape")


def _plain(error: UnicodeError) -> tuple[str | bytes, int]:
    """Return the replacement of the first character that cannot be encoded, and where to continue."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character, onward = error.object[error.start], error.start + 1
    if "\udc80" <= character <= "\udcff":  # a byte of a file's name that was never text
        return bytes([ord(character) - 0xDC00]), onward
    spoken = _SPOKEN.get(character) or _letters(character)
    return spoken or character.encode("ascii", "backslashreplace").decode(), onward


def _letters(character: str) -> str:
    """Return the name of a Greek letter, or any other without accents or superscripts, or ""."""
    greek = re.match(r"GREEK (SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)", unicodedata.name(character, ""))
    if greek:
        return greek[2].lower() if greek[1] == "SMALL" else greek[2].capitalize()
    plain = unicodedata.normalize("NFKD", character).replace("\u2044", "/")
    return "".join(part for part in plain if part.isascii())
