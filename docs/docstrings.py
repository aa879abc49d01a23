"""How docstrings, which are plain text with formulas, become reStructuredText: a part of conf.py."""

import re


def as_rst(app, what, name, obj, options, lines):
    """Make docstrings, which are plain text with formulas, safe for Sphinx.

    What is indented after a blank line is a formula or code and stays as it is; elsewhere bars and stars
    outside backquotes are themselves.
    """
    out, literal, listed = [], False, False
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if line.strip() and (indent == 0 or listed):
            literal = False
        if line.startswith(("* ", "- ")):
            listed = True
        elif line.strip() and indent == 0:
            listed = False
        opens = indent >= 4 and not listed and not literal and out and not out[-1].strip()
        if opens and not _opened(out) and not line.lstrip().startswith(">>>"):
            out += ["::", ""]
            literal = True
        elif opens:
            literal = True
        example = line.lstrip().startswith(">>>")
        if example and out and out[-1].strip() and not _tested(out) and not literal:
            out.append("")
        if not literal and not example and not _tested(out):
            line = _escaped(line)
        out.append(line)
    lines[:] = out


def _opened(out):
    """Say whether the last line before a blank one already opens a literal block."""
    told = [line for line in out if line.strip()]
    return bool(told) and told[-1].rstrip().endswith("::")


def _tested(out):
    """Say whether the next line is the output of an example."""
    before = []
    for line in reversed(out):
        if not line.strip():
            break
        before.append(line)
    return any(line.lstrip().startswith(">>>") for line in before)


def _escaped(line):
    head = re.match(r"\s*(\* )?", line).group()
    parts = line[len(head) :].split("`")
    parts[::2] = [re.sub(r"[|*]|(?<=\w)_(?=\W|$)", r"\\\g<0>", part) for part in parts[::2]]
    return head + "`".join(parts)


def in_short(app, what, name, obj, options, signature, returned):
    """Write types in a signature by their last names, and arrays as such."""
    return tuple(text and _plain(text) for text in (signature, returned))


def _plain(text):
    text = re.sub(r"~?\b(?:[A-Za-z_]\w*\.)+([A-Za-z_]\w*)", r"\1", text)
    text = re.sub(r"_Buffer \| .*?bytes \| str\]", "ArrayLike", text)
    return re.sub(r"ndarray\[tuple\[Any, \.\.\.\], dtype\[\w+\]\]", "Array", text)


def foreign(app, what, name, obj, skip, options):
    """Leave out members that are functions of NumPy: their text is not ours."""
    home = getattr(getattr(obj, "__self__", None), "__class__", type(None)).__module__
    return True if home.split(".")[0] == "numpy" else None
