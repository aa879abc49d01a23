"""Living cells in the site: the explorer's page, a small cell on the front page, links to set-ups.

The page is part of the site where it was built (`make page`). Elsewhere a picture or a sentence is shown
instead.
"""

import html
import shutil
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive

from cyclosis.explorer import setup, static
from cyclosis.explorer.preset import UP, align
from cyclosis.explorer.server import PAGE

FOLDER = "explorer"
SERVER = "http://127.0.0.1:8765/#"
"""What the address of a cell begins with where `cyclosis explore` runs."""
SEED, STRIPES = {"seed": 0}, {"kind": "stripes", "filaments_per_square": 4000.0, "seed": 1}
BESIDE = align(0.0, UP, 0.9, 3.1416, 3.9)
"""Filaments beside one of the zones, aligned with those across it: unequal stripes."""
DISC = {"shape": "disc", "theta": 3.1416, "z": 2.5, "radius": 1.0}


def _cell(initial, points, length=5.0, steps=(), **parameters):
    grid = {"n_theta": points[0], "n_z": points[1], "length": length}
    return setup.from_tables({"initial": initial, "grid": grid, "parameters": parameters}, list(steps))


CELLS = {
    "emergence": _cell(SEED, (48, 48)),
    "growth": _cell({"seed": 1}, (32, 32), alpha_p=0.5),
    "breaking_up": _cell(STRIPES | {"kind": "unidirectional"}, (48, 8), alpha_p=0.1, alpha_u=0.5),
    "two_ends": _cell(SEED, (32, 32), alpha_p=0.3, alpha_u=0.1),
    "unequal_stripes": _cell(STRIPES, (64, 8), steps=[BESIDE], alpha_p=0.1, alpha_u=0.0125),
    "thresholds": _cell(STRIPES, (64, 8), steps=[BESIDE], alpha_p=0.1, alpha_u=0.0025),
    "straightening": _cell({"seed": 22}, (48, 48)),
    "circumferential": _cell(SEED, (32, 32), kappa=0.0),
    "drifting_stripes": _cell(STRIPES | {"magnitude": 0.8}, (48, 8), kappa=0.1),
    "helix": _cell(SEED, (48, 48), 14.86, repulsion_angle=0.4),
    "cytochalasin": _cell(
        *(STRIPES, (64, 16)),
        steps=[{"at": 10.0, "action": "change", "alpha_p": 0.0}, {"at": 60.0, "action": "fragment"}],
    ),
    "wound": _cell(STRIPES, (48, 48), steps=[{"at": 10.0, "action": "fragment", "where": DISC}]),
    "closure": _cell(SEED, (32, 32)),
    "mixing": _cell(STRIPES, (32, 16)),
    "transport": _cell(STRIPES, (32, 16)),
    "own_film": _cell(SEED, (32, 32), d_s=0.05),
}
"""The cells that pages of the gallery offer to try, by page."""
CLOSED = {"ends"}
"""Pages on closed cells, which a page without a server does not compute."""
FRONT = _cell(SEED, (48, 48))
"""The cell of the front page."""

FROM_DISK = (
    "This is a recording: browsers show the living cell only from a web server. Run "
    '<code class="literal">python -m http.server</code> in the folder of this page, and open '
    '<a href="http://127.0.0.1:8000">127.0.0.1:8000</a>.'
)
"""What is said below the picture where the site is opened from the disk."""
SHOW = """(() => {
  const place = document.getElementById('living-cell');
  if (location.protocol === 'file:') place.querySelector('.from-disk').hidden = false;
  else place.replaceChildren(place.querySelector('template').content);
})();"""
"""The script that puts the frame of the cell in place of the picture."""


def built():
    """Say whether the site has the explorer's page."""
    return (PAGE / "index.html").is_file()


def address(document, cell, embedded=False):
    """Return the address of a cell as seen from a page of the site."""
    up = "../" * document.count("/")
    return f"{up}{FOLDER}/index.html{'?embed' if embedded else ''}#{cell.link()}"


class TryIt(Directive):
    """A link that opens the cell of a page of the gallery."""

    required_arguments = 1

    def run(self):
        """Return the link, or a sentence where the site has no explorer."""
        name = self.arguments[0]
        if name not in CELLS.keys() | CLOSED:
            raise self.error(f"no cell is described for {name}: add it to CELLS in docs/living.py")
        if not built() or name in CLOSED:
            command = nodes.literal(text="cyclosis explore")
            return [nodes.paragraph("", "", command, nodes.Text(" shows such cells in the browser."))]
        link = address(self.state.document.settings.env.docname, CELLS[name])
        text = (
            f'<p><a class="try-it" href="{html.escape(link)}">▶ Try it</a>: such a cell in this browser.</p>'
        )
        return [nodes.raw("", text, format="html")]


class LivingCell(Directive):
    """A small living cell; its content, a picture, takes its place where no browser can show the cell.

    That is where the site has no explorer, where there is no JavaScript, and where the site is opened from
    the disk, from which browsers load no workers: there a sentence says how to see the cell.
    """

    has_content = True

    def run(self):
        """Return the content, and the frame of the cell, by which a script replaces it."""
        node = nodes.container()
        self.state.nested_parse(self.content, self.content_offset, node)
        if not built():
            return node.children
        document = self.state.document.settings.env.docname
        frame = (
            '<iframe class="living-cell" loading="lazy" title="A living cell: disordered filaments become two'
            f' opposite streams" src="{html.escape(address(document, FRONT, embedded=True))}"></iframe>'
        )
        before = f'<div id="living-cell"><template>{frame}</template>'
        after = f'<p class="from-disk" hidden>{FROM_DISK}</p></div>\n<script>{SHOW}</script>'
        raw = [nodes.raw("", text, format="html") for text in (before, after)]
        return [raw[0], *node.children, raw[1]]


def lead_here(app, doctree, document):
    """Have links to cells of a running explorer lead to the page in the site, where there is one."""
    if app.builder.format != "html" or not built():
        return
    up = "../" * document.count("/")
    for link in doctree.findall(nodes.reference):
        if link.get("refuri", "").startswith(SERVER):
            link["refuri"] = f"{up}{FOLDER}/index.html#{link['refuri'].removeprefix(SERVER)}"


def _add_page(app, failure):
    """Write the explorer's page into the site."""
    if failure or app.builder.format != "html" or not built():
        return
    folder = Path(app.outdir, FOLDER)
    shutil.rmtree(folder, ignore_errors=True)
    static.write(folder, PAGE)


def add_to(app):
    """Have Sphinx know the directives, and the page written at the end."""
    app.add_directive("try-it", TryIt)
    app.add_directive("living-cell", LivingCell)
    app.connect("doctree-resolved", lead_here)
    app.connect("build-finished", _add_page)
