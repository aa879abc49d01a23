"""The page in a real browser: its connection fails, its cell is compiled, its files are made; on tour."""

import importlib
import itertools
import time
from contextlib import ExitStack, contextmanager

import pytest

from cyclosis.explorer import setup
from cyclosis.explorer.session import Session
from measure.pages import makers, opened

pytestmark = [pytest.mark.slow, pytest.mark.browser]
hostile, proxies = map(importlib.import_module, ("hostile", "proxy"))
# When the banner appeared, by the page's own clock.
WATCH = """() => {
  const lost = document.querySelector('#lost');
  window.lostAt = null;
  const note = () => { if (!lost.hidden) window.lostAt ??= Date.now(); };
  new MutationObserver(note).observe(lost, { attributes: true });
}"""
# For every mark: its name, the share of it under the card, and the share of it that the window shows.
MARKS = """() => {
  const card = document.querySelector('#tour-card').getBoundingClientRect();
  return [...document.querySelectorAll('.marked')].map(each => {
    const box = each.getBoundingClientRect();
    const meet = (a, b, low, high) => Math.max(0, Math.min(a[high], b[high]) - Math.max(a[low], b[low]));
    const covered = meet(box, card, 'left', 'right') * meet(box, card, 'top', 'bottom');
    const seen = meet(box, { top: 0, bottom: innerHeight }, 'top', 'bottom');
    return [each.id || each.dataset.name, covered / (box.width * box.height), seen / box.height];
  });
}"""
SIZES = {"desktop": (1440, 900), "phone": (390, 844), "small phone": (360, 640), "tablet": (768, 1024)}
fresh = itertools.count(9)
"""Sizes of grids that nobody has used yet."""


@pytest.fixture
def proxy(server):
    proxy = proxies.Proxy(server[0])
    yield proxy
    proxy.close()


@pytest.fixture
def page(browser, proxy):
    with watched(browser, proxy.port) as page:
        yield page


@contextmanager
def watched(browser, port, size="phone"):
    """Open the page, whose lost connections the browser prints as errors, and keep watch over it."""
    with opened(browser, f"http://127.0.0.1:{port}/", SIZES[size], console=False) as page:
        wait(page, "cell && window.cyclosis.statistics().lastShown >= 0")
        page.evaluate(WATCH)
        yield page


def latest(page):
    return page.evaluate("window.cyclosis.latest()")


def wait(page, condition, seconds=90):
    told = "const cell = window.cyclosis?.latest(), find = (name) => document.querySelector(name)"
    end = time.monotonic() + seconds
    while not page.evaluate(f"(() => {{ {told}; return Boolean({condition}); }})()"):
        assert time.monotonic() < end, f"{condition} did not come true in {seconds} s"
        time.sleep(0.05)


def play(page, on=True):
    wait(page, "find('#waits').hidden")  # until then the page refuses
    page.locator("#play").press("Enter")
    wait(page, f"cell.playing === {str(on).lower()}")


def fingerprint(page):
    page.evaluate("document.querySelector('#hash').dataset.sha256 = ''")
    page.evaluate("document.querySelector('#ask-hash').click()")
    wait(page, "find('#hash').dataset.sha256")
    return page.get_attribute("#hash", "data-sha256")


def begin(page, points):
    """Begin a cell on a grid of that many points each way, as a visitor does."""
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    for name in ("n_theta", "n_z"):
        page.fill(f"#setting-{name}", str(points))
    page.evaluate("document.querySelector('#begin').click()")


def stands_still(page):
    """Whether the page says that nothing can be asked, and lets nothing be."""
    assert "connection is lost" in page.inner_text("#waits")
    assert page.evaluate("document.querySelector('#play').closest('[inert]') !== null")
    assert page.evaluate("document.querySelector('#panel-parameters .body').inert")


def test_a_swallowed_connection_is_noticed_in_5_s_and_the_session_goes_on(page, proxy):
    play(page)
    wait(page, "cell.t > 3")
    begun = latest(page)["begun"]
    swallowed = time.time()
    proxy.swallowing.set()
    wait(page, "!find('#lost').hidden")
    assert page.evaluate("window.lostAt") / 1000 - swallowed < 5.0
    assert "lost" in page.inner_text("#lost")
    assert "Reconnecting" in page.inner_text("#lost")
    stands_still(page)
    proxy.swallowing.clear()
    page.locator("#reconnect").press("Enter")
    wait(page, "find('#lost').hidden && find('#waits').hidden")
    seen = latest(page)["t"]
    wait(page, f"cell.t > {seen + 1}")
    assert latest(page)["begun"] == begun
    play(page, on=False)
    found, cell = fingerprint(page), latest(page)
    other = Session(setup.from_link(cell["link"]))
    while other.live.t < cell["t"]:
        other.forward()
    assert other.digest() == found


def test_what_was_asked_while_nobody_heard_is_done_once(page, proxy):
    proxy.swallowing.set()
    page.locator("#step").press("Enter")
    page.locator("#step").press("Enter")
    wait(page, "!find('#lost').hidden")
    proxy.swallowing.clear()
    wait(page, "find('#lost').hidden")
    wait(page, "cell.t > 0.15")
    page.wait_for_timeout(500)
    assert latest(page)["t"] == pytest.approx(0.2)


def test_a_question_whose_answer_is_lost_is_asked_again(page, proxy):
    play(page)
    wait(page, "cell.t > 1")
    play(page, on=False)
    found = fingerprint(page)
    proxy.swallowing.set()
    page.evaluate("document.querySelector('#hash').dataset.sha256 = ''")
    page.evaluate("document.querySelector('#ask-hash').click()")
    wait(page, "!find('#lost').hidden")
    proxy.swallowing.clear()
    wait(page, "find('#hash').dataset.sha256")
    assert page.get_attribute("#hash", "data-sha256") == found


def test_a_server_that_ends_is_noticed_and_another_goes_on_from_the_address(browser):
    pages = ExitStack()
    with hostile.server() as (port, process):
        proxy = proxies.Proxy(port)
        page = pages.enter_context(watched(browser, proxy.port))
        play(page)
        wait(page, "cell.t > 2")
        play(page, on=False)
        found, cell = fingerprint(page), latest(page)
        process.kill()
        wait(page, "!find('#lost').hidden", 20)
        stands_still(page)
    with hostile.server() as (port, _):
        proxy.target = port
        wait(page, "find('#lost').hidden")
        assert "no longer had this cell" in page.inner_text("#toast")
        wait(page, f"cell.catching_up === null && cell.t === {cell['t']} && find('#waits').hidden")
        again = latest(page)
        assert not again["playing"]
        assert (again["link"], again["speed"]) == (cell["link"], cell["speed"])
        assert fingerprint(page) == found
        pages.close()
    proxy.close()


def test_a_page_that_slept_goes_on_with_its_session(page):
    play(page)
    wait(page, "cell.t > 1")
    begun = latest(page)["begun"]
    browser = page.context.new_cdp_session(page)
    browser.send("Page.setWebLifecycleState", {"state": "frozen"})
    time.sleep(14)  # the server gives up who answers nothing for 10 s
    browser.send("Page.setWebLifecycleState", {"state": "active"})
    wait(page, "find('#lost').hidden && find('#waits').hidden")
    seen = latest(page)["t"]
    wait(page, f"cell.t > {seen + 1}")
    assert latest(page)["begun"] == begun


def test_a_page_that_is_looked_at_again_asks_at_once(page, proxy):
    proxy.swallowing.set()
    page.evaluate("dispatchEvent(new Event('online'))")
    began = page.evaluate("Date.now()")
    wait(page, "!find('#lost').hidden")
    assert page.evaluate("window.lostAt") - began < 3000
    proxy.swallowing.clear()
    page.evaluate("document.dispatchEvent(new Event('visibilitychange'))")
    wait(page, "find('#lost').hidden")


def test_a_cell_that_is_compiled_is_never_an_empty_stage_without_a_word(page):
    points = 2 * next(fresh)
    begin(page, points)
    wait(page, f"find('#waits').innerText.includes('Preparing a cell of {points} x {points} points')")
    assert page.is_visible("#waits-over")
    assert page.evaluate("document.querySelector('#panel-parameters .body').inert")
    assert not page.evaluate("document.querySelector('#panel-presets .body').inert")
    page.keyboard.press("n")
    assert "Preparing" in page.inner_text("#toast")
    page.evaluate(
        """() => {
          window.bare = 0;
          const look = () => {
            const empty = window.cyclosis.statistics().lastShown < 0;
            if (empty && document.querySelector('#waits').hidden) window.bare += 1;
            requestAnimationFrame(look);
          };
          look();
        }"""
    )
    wait(page, f"cell.setup.grid.n_theta === {points} && find('#waits').hidden")
    wait(page, "window.cyclosis.statistics().lastShown >= 0")
    assert page.evaluate("window.bare") <= 2  # a picture that has come is drawn in the next moment
    assert not page.evaluate("document.querySelector('[inert]')")
    begin(page, points)
    wait(page, "find('#waits').hidden")


def test_a_page_that_opens_says_so(browser, proxy):
    context = browser.new_context()
    page = context.new_page()
    page.add_init_script("window.WebSocket = class { static OPEN = 1; readyState = 0; close() {} send() {} }")
    page.goto(f"http://127.0.0.1:{proxy.port}/")
    page.wait_for_selector("#waits:has-text('Opening the cell')")
    assert page.is_visible("#waits-over")
    context.close()


def test_a_file_shows_how_far_it_is_and_can_be_given_up(page, server):
    _, process = server
    page.locator("#speed").press("End")
    play(page)
    wait(page, "cell.t > 30", 120)
    play(page, on=False)
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    page.locator("#export-movie").press("Enter")
    wait(page, "find('#making-movie progress')?.value > 0")
    assert "%" in page.inner_text("#making-movie")
    page.locator("#cancel-movie").press("Enter")
    wait(page, "!find('#making-movie')")
    end = time.monotonic() + 20
    while makers(process):
        assert time.monotonic() < end
        time.sleep(0.1)
    assert page.get_attribute("#export-movie", "aria-busy") is None
    with page.expect_download(timeout=120_000) as found:
        page.locator("#export-nc").press("Enter")
    assert found.value.suggested_filename == "cyclosis-run.nc"
    wait(page, "find('#making').hidden")


def test_a_file_that_cannot_be_made_says_why(page):
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    page.locator("#export-nc").press("Enter")
    wait(page, "find('#making-nc .warn')")
    assert "let the cell run, then export it" in page.inner_text("#making-nc")
    page.locator("#making-nc button").press("Enter")
    wait(page, "find('#making').hidden")


@pytest.mark.parametrize("size", SIZES)
def test_the_tour_covers_nothing_that_it_speaks_of(browser, proxy, size):
    with watched(browser, proxy.port, size) as page:
        page.locator("#tour").press("Enter")
        for number in range(1, 7):
            wait(page, f"find('#tour-card').innerText.includes('{number} of 6')")
            before, marks = None, page.evaluate(MARKS)
            while marks != before:  # the page scrolls
                page.wait_for_timeout(700)
                before, marks = marks, page.evaluate(MARKS)
            for name, covered, _ in marks:
                assert covered < 0.05, (number, name)
            assert max(seen for *_, seen in marks) > 0.6, (number, marks)
            assert page.evaluate(
                "(() => { const b = document.querySelector('#tour-next').getBoundingClientRect();"
                " return b.top >= 0 && b.bottom <= innerHeight; })()"
            )
            page.locator("#tour-next").press("Enter")
        assert page.locator("#tour-card").is_hidden()
