"""How the pages become a site: `make docs`."""

import logging
import os
import sys
from pathlib import Path

from docutils import nodes

import cyclosis

sys.path.insert(0, str(Path(__file__).parent))
import docstrings
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
html_js_files = [("site.js", {"defer": "defer"})]
highlight_language = "none"

myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath", "html_image"]
myst_heading_anchors = 4
# A formula that is wider than the page is broken: this needs MathJax 4. An older one lets it scroll.
mathjax3_config = {"output": {"displayOverflow": "linebreak"}}

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


def widen(app, doctree, name):
    """Mark the cells of tables by the length of their text, for which static/site.css leaves room."""
    for cell in doctree.findall(nodes.entry):
        length = len(cell.astext())
        for least, mark in ((49, "sentence"), (22, "phrase"), (13, None), (0, "short")):
            if length >= least:
                cell["classes"] += [mark] if mark else []
                break


def name_pictures(app, doctree, name):
    """Name pictures that code has drawn by the heading above them, for those who do not see them."""
    for picture in doctree.findall(nodes.image):
        if not picture.get("alt"):
            section = picture.parent
            while section and not isinstance(section, nodes.section):
                section = section.parent
            picture["alt"] = f"Drawn by the code: {section[0].astext()}" if section else "Drawn by the code"


def setup(app):
    """Have docstrings, signatures and pages passed through the functions above."""
    app.connect("doctree-resolved", widen)
    app.connect("doctree-resolved", name_pictures)
    app.connect("autodoc-skip-member", docstrings.foreign)
    app.connect("autodoc-process-docstring", docstrings.as_rst)
    app.connect("autodoc-process-signature", docstrings.in_short)
    living.add_to(app)
