"""The documentation in a browser: no page is wider than its screen, and all that it leads to is there.

The site is built without running its code, which `make docs` does.
"""

import functools
import http.server
import subprocess
import sys
import threading
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pytest

pytest.importorskip("myst_nb", reason="the documentation's tools are not installed")
DOCS = Path(__file__).parents[2] / "docs"
if not (DOCS / "conf.py").is_file():
    pytest.skip("not in a checkout", allow_module_level=True)

pytestmark = [pytest.mark.slow, pytest.mark.browser]
SCREENS = {"desktop": (1280, 800), "phone": (390, 844)}
SEEN = """() => {
  const all = (what) => [...document.querySelectorAll(what)];
  const scrolls = (each) => each.matches('html') || getComputedStyle(each).overflowX !== 'visible';
  const named = ({ src, alt }) => alt && !src.endsWith(alt);
  return {
    beyond: all('html, .content').filter(scrolls).map((each) => each.scrollWidth - each.clientWidth),
    missing: all('img').filter((each) => each.complete && !each.naturalWidth).map((each) => each.src),
    unnamed: all('article img').filter((each) => !named(each)).map((each) => each.src),
    links: all('a[href]').map((each) => each.href),
    ids: all('[id]').map((each) => each.id),
  };
}"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Build the site and return its folder."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-D", "nb_execution_mode=off"]
    subprocess.run([*command, "-d", folder / "trees", DOCS, folder / "html"], check=True, timeout=900)
    return folder / "html"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *args):
        pass


@pytest.fixture(scope="module")
def address(site):
    handler = functools.partial(Quiet, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def visit(browser, site, address, size):
    """Yield the address of each page, and what is seen there; formulas come from elsewhere and stay text."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]})
    context.route(lambda url: not url.startswith(address), lambda route: route.abort())
    page, troubles = context.new_page(), []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    for path in sorted(site.rglob("*.html")):
        name = path.relative_to(site).as_posix()
        if not name.startswith(("explorer/", "_static/")):
            page.goto(address + name)
            yield address + name, page.evaluate(SEEN)
    context.close()
    assert not troubles, troubles


@pytest.mark.parametrize("size", SCREENS)
def test_no_page_is_wider_than_its_screen(browser, site, address, size):
    """Tables and code scroll within the page."""
    seen = dict(visit(browser, site, address, SCREENS[size]))
    assert len(seen) > 80
    assert {page: found["beyond"] for page, found in seen.items() if max(found["beyond"]) > 0} == {}


def test_pictures_are_there_and_named_and_links_lead_to_places_that_are_there(browser, site, address):
    seen = dict(visit(browser, site, address, SCREENS["desktop"]))
    places = {page: set(found["ids"]) for page, found in seen.items()}
    for page, found in seen.items():
        assert not found["missing"], page
        assert not found["unnamed"], page
        for link in found["links"]:
            there, place = urldefrag(link)
            if there in places:
                assert not place or unquote(place) in places[there], f"{page} leads to {link}"
            elif there.startswith(address):
                assert (site / there.removeprefix(address).partition("?")[0]).exists(), (
                    f"{page} leads to {link}"
                )
