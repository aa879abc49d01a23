"""The living cells of the site: each page of the gallery has one, and the front page; or words, without."""

import re
import sys
from pathlib import Path

import pytest

pytest.importorskip("docutils", reason="the documentation's tools are not installed")
DOCS = Path(__file__).parents[1] / "docs"
if not (DOCS / "living.py").is_file():
    pytest.skip("not in a checkout", allow_module_level=True)
sys.path.insert(0, str(DOCS))
import living  # noqa: E402

from cyclosis.explorer import setup  # noqa: E402

PAGES = sorted(path.stem for path in (DOCS / "gallery").glob("*.md") if path.stem != "index")


def test_every_page_of_the_gallery_opens_a_cell_that_a_browser_computes():
    assert sorted(living.CELLS.keys() | living.CLOSED) == PAGES
    for name, cell in living.CELLS.items():
        assert f"```{{try-it}} {name}\n" in (DOCS / "gallery" / f"{name}.md").read_text()
        ready = cell.ready()
        assert ready.model.name == "polar"
        address = living.address(f"gallery/{name}", cell)
        assert address.startswith("../explorer/index.html#")
        assert setup.from_link(address.split("#")[1]).tables == cell.tables


@pytest.mark.slow
@pytest.mark.parametrize("built", [True, False])
def test_a_site_has_the_page_or_says_how_to_see_cells(tmp_path, monkeypatch, built):
    application = pytest.importorskip("sphinx.application")
    page = tmp_path / "page"
    if built:
        (page / "assets").mkdir(parents=True)
        (page / "index.html").write_text('<head><meta charset="utf-8" /></head>')
        (page / "offline.js").write_text("const VERSION = '';\nconst FILES = [];\n")
    monkeypatch.setattr(living, "PAGE", page)
    source, site = tmp_path / "source", tmp_path / "site"
    source.mkdir()
    (source / "index.rst").write_text(
        "Cells\n=====\n\n.. living-cell::\n\n   In place of it.\n\n.. try-it:: wound\n\n"
        "`Open the cell <http://127.0.0.1:8765/#eNod>`_\n"
    )
    (source / "conf.py").write_text("import living\n\n\ndef setup(app):\n    living.add_to(app)\n")
    app = application.Sphinx(source, source, site, tmp_path / "trees", "html", status=None, freshenv=True)
    app.build()
    text = (site / "index.html").read_text()
    assert ("<iframe" in text, 'class="try-it"' in text) == (built, built)
    there = "explorer/index.html#eNod" if built else "http://127.0.0.1:8765/#eNod"
    assert f'href="{there}"' in text
    words = re.sub("<[^>]+>", "", text)
    assert "In place of it." in words  # where there is a page, until a script replaces it
    assert ("cyclosis explore" in words, "python -m http.server" in words) == (not built, built)
    assert (site / "explorer" / "api" / "engine").is_file() == built
