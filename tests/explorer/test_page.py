"""The page in a real browser: what a visitor does, from the first look to the exported file."""

import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from cyclosis.explorer.server import PAGE

pytestmark = pytest.mark.slow
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
# The browser draws in software and asks nothing of any network.
ARGUMENTS = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
]
SIZES = {"desktop": (1440, 900), "phone": (390, 844)}


@pytest.fixture(scope="module")
def address():
    if not (PAGE / "index.html").exists():
        pytest.skip("the explorer's page is not built: install Node.js 20.19 or newer and run `make page`")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    code = "from cyclosis.cli import main; main()"
    command = [sys.executable, "-c", code, "explore", "--no-browser", "--port", str(port)]
    server = subprocess.Popen(command, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
    found = f"http://127.0.0.1:{port}/"
    for _ in range(200):
        try:
            urllib.request.urlopen(found, timeout=5).close()
            break
        except OSError:
            time.sleep(0.2)
    yield found
    server.terminate()
    server.wait(10)


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("there is no Chromium on this machine: install it to test the page")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield started
        started.close()


@pytest.fixture(params=SIZES, ids=SIZES)
def page(request, browser, address):
    width, height = SIZES[request.param]
    context = browser.new_context(viewport={"width": width, "height": height}, accept_downloads=True)
    page = context.new_page()
    troubles = []
    page.on("console", lambda said: troubles.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.goto(address)
    wait(page, "true")
    yield page
    context.close()
    assert not troubles


def latest(page):
    return page.evaluate("window.cyclosis.latest()")


def wait(page, condition, seconds=60):
    """Wait for a condition on `cell`, the latest that the server told, and `regime`, what the page says."""
    told = "const cell = window.cyclosis?.latest(), regime = document.querySelector('#regime')?.innerText"
    end = time.monotonic() + seconds
    while not page.evaluate(f"(() => {{ {told}; return Boolean(cell && ({condition})); }})()"):
        assert time.monotonic() < end, f"{condition} did not come true in {seconds} s: {latest(page)}"
        time.sleep(0.05)


def play(page, on=True):
    if (page.get_attribute("#play", "aria-pressed") == "true") != on:
        page.locator("#play").press("Enter")
    wait(page, f"cell.playing === {str(on).lower()}")


@pytest.mark.parametrize("page", ["desktop"], indirect=True)
def test_a_cell_comes_to_cyclosis_and_what_is_done_to_it_is_its_protocol(page, tmp_path):
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    page.locator("#speed").press("End")
    play(page)
    wait(page, "regime.startsWith('cyclosis')", 90)
    page.fill("#parameter-alpha_p", "0.7")
    page.locator("#parameter-alpha_p").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0.7")
    page.locator("#slider-alpha_u").press("ArrowRight")
    wait(page, "cell.parameters.alpha_u !== 0.5")
    page.locator("#drug-cytochalasin").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0")
    play(page, on=False)
    cell = latest(page)
    assert len(cell["protocol"]) >= 3
    with page.expect_download(timeout=60_000) as found:
        page.locator("#export-toml").press("Enter")
    target = Path(tmp_path) / "cell.toml"
    found.value.save_as(target)
    assert "alpha_p = 0.7" in target.read_text()


def test_an_address_opens_the_same_cell(page, address):
    play(page)
    time.sleep(2)
    play(page, on=False)
    cell = latest(page)
    assert page.url.endswith(cell["link"])
    page.goto("about:blank")
    page.goto(address + "#" + cell["link"])
    wait(page, "true")
    wait(page, "cell.catching_up === null")
    again = latest(page)
    assert again["t"] == cell["t"] > 0
    assert again["link"] == cell["link"]


@pytest.mark.parametrize("page", ["phone"], indirect=True)
def test_a_wound_is_painted_with_keys_alone(page):
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    wait(page, "window.cyclosis.statistics().frames > 0")
    page.locator("#tool-wound").press("Enter")
    page.locator("#map canvas[tabindex]").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
