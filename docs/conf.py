"""How the pages become a site: `make docs`."""

import logging
import os
import re
import sys
from pathlib import Path

from docutils import nodes

import cyclosis

sys.path.insert(0, str(Path(__file__).parent))
import living

project = "cyclosis"
author = "The cyclosis developers"
copyright = author
version = release = cyclosis.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx_design"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "cyclosis"
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["site.css"]
highlight_language = "none"

myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath", "html_image"]
myst_heading_anchors = 4

# Every page with cells is run again, in a separate folder, with the commands of this environment.
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
logging.getLogger("traitlets").setLevel(logging.WARNING)
# Kernels have a separate profile, in which only errors are logged.
os.environ["IPYTHONDIR"] = str(Path(__file__).parent / "_build" / "ipython")
_profile = Path(os.environ["IPYTHONDIR"]) / "profile_default"
_profile.mkdir(parents=True, exist_ok=True)
(_profile / "ipython_kernel_config.py").write_text('get_config().IPKernelApp.log_level = "ERROR"\n')
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
default_role = "py:obj"


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


def widen(app, doctree, name):
    """Mark the cells of tables that hold a sentence, which static/site.css keeps wide enough to read."""
    for cell in doctree.findall(nodes.entry):
        if len(cell.astext()) > 48:
            cell["classes"].append("sentence")


def foreign(app, what, name, obj, skip, options):
    """Leave out members that are functions of NumPy: their text is not ours."""
    home = getattr(getattr(obj, "__self__", None), "__class__", type(None)).__module__
    return True if home.split(".")[0] == "numpy" else None


def setup(app):
    """Have docstrings, signatures and pages passed through the functions above."""
    app.connect("doctree-resolved", widen)
    app.connect("autodoc-skip-member", foreign)
    app.connect("autodoc-process-docstring", as_rst)
    app.connect("autodoc-process-signature", in_short)
    living.add_to(app)
