"""The page as a folder of files, served from a path by Python's own web server."""

import functools
import http.server
import json
import re
import shutil
import threading
import time
from contextlib import contextmanager, suppress

import pytest
from typer.testing import CliRunner

from cyclosis.cli import app
from cyclosis.explorer import static
from cyclosis.explorer.server import PAGE
from cyclosis.model.errors import InputError
from measure.pages import opened

HEAD = '<html><head>\n    <meta charset="utf-8" />\n    <title>cyclosis</title></head></html>'
SIZES = {"desktop": (1440, 900), "phone": (390, 844)}


@pytest.fixture
def page(tmp_path):
    """Return a folder like that of the built page."""
    folder = tmp_path / "page"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text(HEAD)
    (folder / "assets" / "index.js").write_text("1;")
    (folder / "offline.js").write_text("const VERSION = '';\nconst FILES = [];\n")
    return folder


@pytest.fixture
def untheoretical(monkeypatch):
    """Leave out the curves of theory, which take seconds."""
    monkeypatch.setattr(static, "whole", lambda: {"theory": True})


def test_files(page, tmp_path, untheoretical):
    size = static.write(tmp_path / "site" / "cell", page)
    files = {
        path.relative_to(tmp_path / "site" / "cell").as_posix(): path
        for path in (tmp_path / "site").rglob("*")
    }
    assert {"index.html", "assets/index.js", "api/about", "api/engine"} <= files.keys()
    assert size == sum(path.stat().st_size for path in files.values() if path.is_file())
    text = files["index.html"].read_text()
    assert text.index("charset") < text.index("Content-Security-Policy") < text.index("<title>")
    assert 'name="cyclosis-engine" content="browser"' in text
    assert not any(word in text for word in ("unsafe-eval", "http:", "https:"))
    assert json.loads(files["api/engine"].read_text()) == {"theory": True}
    assert json.loads(files["api/about"].read_text())["presets"]


def test_the_service_worker_keeps_all_files_under_a_name_of_their_own(page, tmp_path, untheoretical):
    """The name, and so the script that a browser compares, changes with any file."""
    first, again, other = (tmp_path / name for name in ("first", "again", "other"))
    static.write(first, page)
    static.write(again, page)
    (page / "assets" / "index.js").write_text("2;")
    static.write(other, page)
    script = (first / "offline.js").read_text()
    assert json.loads(re.search(r"FILES = (\[.+\]);", script)[1]) == [
        *("./", "api/about", "api/engine", "assets/index.js", "index.html")
    ]
    assert re.search(r"VERSION = '[0-9a-f]{16}';", script)
    assert script == (again / "offline.js").read_text()
    assert script != (other / "offline.js").read_text()


@pytest.mark.parametrize("there", ["file", "full"])
def test_another_folder_is_refused(page, tmp_path, untheoretical, there):
    target = tmp_path / "target"
    if there == "file":
        target.write_text("mine")
    else:
        target.mkdir()
        (target / "mine").write_text("mine")
    with pytest.raises(InputError, match="new or empty"):
        static.write(target, page)
    assert [path.name for path in tmp_path.rglob("mine")] == ([] if there == "file" else ["mine"])


def test_a_page_that_is_not_built_is_refused(tmp_path, untheoretical):
    with pytest.raises(InputError, match="built with its page"):
        static.write(tmp_path / "site", tmp_path / "nothing")
    assert not (tmp_path / "site").exists()


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """Return a folder in which the files lie under some/path, written as a user writes them."""
    if not (PAGE / "index.html").exists():
        pytest.skip("the explorer's page is not built: install Node.js 20.19 or newer and run `make page`")
    root = tmp_path_factory.mktemp("site")
    told = CliRunner().invoke(app, ["explore", "--static", str(root / "some" / "path")])
    assert told.exit_code == 0, told.output
    return root


@contextmanager
def served(root, port=0):
    """Serve a folder as `python -m http.server` does; yield the address of the page."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(root))
    with http.server.ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/some/path/"
        server.shutdown()


def wait(page, expression, seconds=60):
    """Wait until an expression over `cell`, what the engine told last, is true, and return its value."""
    script = f"(() => {{ const cell = window.cyclosis?.latest(); return cell && ({expression}); }})()"
    end = time.monotonic() + seconds
    while not (found := page.evaluate(script)):  # the page's policy forbids what playwright waits by
        assert time.monotonic() < end, expression
        time.sleep(0.05)
    return found


def fingerprint(page):
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    page.locator("#ask-hash").press("Enter")
    return wait(page, "document.querySelector('#hash').dataset.sha256")


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("size", SIZES)
def test_a_cell_lives_without_a_server(browser, root, size):
    with served(root) as address, opened(browser, address, SIZES[size]) as page:
        asked, errors = [], []
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
        page.reload()
        wait(page, "cell.preset === 'figure4' && document.querySelector('#regime').innerText")
        page.locator("#play").press("Enter")
        wait(page, "cell.playing && window.cyclosis.statistics().t >= 3")
        page.locator("#play").press("Enter")
        t = wait(page, "!cell.playing && cell.t")
        digest, link = fingerprint(page), wait(page, f"cell.t === {t} && cell.link")
        page.goto(f"{address}?again#{link}")
        wait(page, f"cell.t === {t}")
        assert fingerprint(page) == digest
        assert all(url.startswith((address, "data:", "blob:")) for url in asked), asked
        assert not errors, errors


@pytest.mark.slow
@pytest.mark.browser
def test_opened_from_the_disk_it_says_how_to_serve_it(browser, root):
    page = browser.new_page()
    page.goto((root / "some" / "path" / "index.html").as_uri())
    assert "python -m http.server" in page.inner_text("body")
    assert "Opening" not in page.inner_text("body")
    page.close()


@pytest.mark.slow
@pytest.mark.browser
def test_it_lives_without_a_network_and_a_new_release_replaces_it(browser, root, tmp_path):
    site = tmp_path / "site"
    shutil.copytree(root, site)
    here = site / "some" / "path"
    driver = pytest.importorskip("playwright.sync_api")
    begun = "cell.preset === 'figure4' && window.cyclosis.statistics().lastShown >= 0"
    context = browser.new_context(viewport={"width": 390, "height": 844})
    page, errors = context.new_page(), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    with served(site) as address:
        page.goto(address)
        wait(page, begun)
        page.evaluate("navigator.serviceWorker.ready.then(() => true)")
    port = int(address.split(":")[2].split("/")[0])
    page.goto("about:blank")
    page.goto(address)  # nobody answers there any more
    wait(page, begun)
    page.locator("#play").press("Enter")
    wait(page, "cell.playing && window.cyclosis.statistics().t >= 1")
    about = json.loads((here / "api" / "about").read_text())
    (here / "api" / "about").write_text(json.dumps(about | {"version": "another"}))
    old = (here / "offline.js").read_text()
    (here / "offline.js").write_text(re.sub(r"VERSION = '\w+'", "VERSION = 'another'", old))
    version = "document.querySelector('.foot').innerText.includes('another')"
    with served(site, port):
        page.goto(address)
        wait(page, begun)
        assert not page.evaluate(version)  # files of one release go together
        waits = "navigator.serviceWorker.getRegistration().then((each) => Boolean(each.waiting))"
        end = time.monotonic() + 20
        while not page.evaluate(waits):
            assert time.monotonic() < end
            time.sleep(0.1)
        page.goto(address)
        end = time.monotonic() + 20
        while True:
            with suppress(driver.Error):  # the page loads again when the release takes over
                if page.evaluate(f"document.querySelector('.foot') && {version}"):
                    break
            assert time.monotonic() < end
            time.sleep(0.1)
        wait(page, begun)
        assert page.evaluate("caches.keys()") == ["cyclosis-another"]
    context.close()
    assert not errors, errors
