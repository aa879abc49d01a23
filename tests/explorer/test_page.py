"""The page in a real browser: what a visitor does, from the first look to the exported file."""

import io
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request

import av
import numpy as np
import pytest
from PIL import Image

import cyclosis
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
    command = [sys.executable, "-m", "cyclosis", "explore", "--no-browser", "--port", str(port)]
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


def unfold(page):
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")


def export(page, kind, target):
    """Press a button of the exports and return where its file lies."""
    with page.expect_download(timeout=120_000) as found:
        page.locator(f"#export-{kind}").press("Enter")
    found.value.save_as(target)
    return target


def seen(page):
    """The middle of the cylinder as it is drawn: within one stripe."""
    with Image.open(io.BytesIO(page.locator("#cylinder canvas").screenshot())) as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    high, wide, _ = pixels.shape
    return pixels[high * 2 // 5 : high * 3 // 5, wide * 9 // 20 : wide * 11 // 20].sum(axis=-1)


def fingerprint(page):
    """The hash that the page shows of the cell's state."""
    page.evaluate("document.querySelector('#hash').dataset.sha256 = ''")
    page.locator("#ask-hash").press("Enter")
    wait(page, "document.querySelector('#hash').dataset.sha256")
    return page.get_attribute("#hash", "data-sha256")


def test_a_wound_heals_and_all_that_was_done_is_in_the_files(page, tmp_path):
    unfold(page)
    page.locator("#speed").press("End")
    play(page)
    wait(page, "regime.startsWith('cyclosis')", 120)
    play(page, on=False)
    page.locator("#tool-wound").press("Enter")
    page.fill("#at-theta", "1.57")
    page.fill("#at-z", "2.5")
    page.locator("#brush-here").press("Enter")
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
    hurt = latest(page)["t"]
    play(page)
    wait(page, f"cell.t > {hurt + 40}", 120)
    play(page, on=False)
    run = cyclosis.load(export(page, "nc", tmp_path / "run.nc"))
    assert run.times[-1] == pytest.approx(latest(page)["t"])
    lengths = np.hypot(*np.moveaxis(np.asarray(run.frames), 1, 0))
    grid = run.grid
    here = (round(1.57 / (2 * np.pi) * grid.n_theta), round(2.5 / grid.length * grid.n_z))
    wounded = int(np.argmin(np.abs(run.times - hurt)))
    assert lengths[wounded][here] < 0.05
    assert lengths[-1][here] > 0.5
    page.wait_for_timeout(200)
    with av.open(export(page, "movie", tmp_path / "movie.mp4")) as movie:
        assert sum(1 for _ in movie.decode(video=0)) > 10
    with Image.open(export(page, "png", tmp_path / "cell.png")) as picture:
        assert np.asarray(picture.convert("RGB")).std() > 10
    assert "depolymerise" in export(page, "toml", tmp_path / "cell.toml").read_text()


def test_tracers_stream_over_a_cylinder_that_is_steady(page):
    page.locator("#speed").press("End")
    play(page)
    wait(page, "cell.t > 150", 120)
    first = seen(page)
    page.wait_for_timeout(400)
    assert (abs(seen(page) - first) > 40).sum() > 20
    play(page, on=False)
    page.wait_for_timeout(400)
    held = seen(page)
    page.wait_for_timeout(400)
    assert abs(seen(page) - held).max() == 0


def test_what_is_changed_in_the_page_is_the_protocol_of_its_cell(page, tmp_path):
    unfold(page)
    page.fill("#parameter-alpha_p", "0.7")
    page.locator("#parameter-alpha_p").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0.7")
    page.locator("#slider-alpha_u").press("ArrowRight")
    wait(page, "cell.parameters.alpha_u !== 0.5")
    page.locator("#step").press("Enter")
    wait(page, "cell.t > 0")
    page.locator("#drug-cytochalasin").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0")
    page.locator("#drug-wash-out").press("Enter")
    wait(page, "cell.parameters.alpha_p !== 0")
    done = [step["text"] for step in latest(page)["protocol"]]
    assert done[0].startswith("t = 0: alpha_p = 0.7, alpha_u = 0.")
    assert done[1:] == ["t = 0.1: alpha_p = 0", "t = 0.1: wash out"]
    assert "alpha_p = 0.7" in export(page, "toml", tmp_path / "cell.toml").read_text()


def test_a_click_on_the_phase_diagram_goes_there(page):
    unfold(page)
    diagram = page.locator("#diagram")
    diagram.scroll_into_view_if_needed()
    box = diagram.bounding_box()
    diagram.click(position={"x": 0.3 * box["width"], "y": 0.6 * box["height"]})
    wait(page, "cell.protocol.length > 0")
    there = latest(page)["parameters"]
    assert 0 < there["alpha_p"] < 0.5
    assert 0 < there["alpha_u"] < 0.6
    assert "Here" in page.inner_text("#diagram-here")


def test_an_address_opens_the_same_cell(page, address):
    unfold(page)
    page.locator("#slider-alpha_u").press("ArrowRight")
    wait(page, "cell.protocol.length > 0")
    play(page)
    wait(page, "cell.t > 2")
    play(page, on=False)
    cell, print_of = latest(page), fingerprint(page)
    wait(page, "location.hash.slice(1) === cell.link")
    page.goto("about:blank")
    page.goto(address + "#" + cell["link"])
    wait(page, "cell.catching_up === null")
    unfold(page)
    again = latest(page)
    assert again["t"] == cell["t"] > 2
    assert again["link"] == cell["link"]
    assert fingerprint(page) == print_of


def test_with_keys_alone_a_cell_is_wounded_and_the_tour_walked(page):
    unfold(page)
    wait(page, "window.cyclosis.statistics().frame >= 0 && window.cyclosis.statistics().frames > 0")
    page.locator("#tool-wound").press("Enter")
    page.locator("#map canvas[tabindex]").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
    page.keyboard.press("t")
    seen = []
    for _ in range(6):
        page.wait_for_timeout(300)
        seen.append(page.inner_text("#tour-title"))
        page.locator("#tour-next").press("Enter")
    assert len(set(seen)) == 6
    assert page.locator("#tour-card").is_hidden()
