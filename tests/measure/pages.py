"""The explorer's page in a browser, and the processes of its server."""

import io
import time
from contextlib import contextmanager, suppress

import numpy as np
import psutil
from PIL import Image

TOLD = """const cell = window.cyclosis?.latest(), other = window.cyclosis?.other(),
  find = (name) => document.querySelector(name), regime = find('#regime')?.innerText;"""


@contextmanager
def opened(browser, address, size, console=True, scheme=None):
    """Open the page in a window of a size; it must cause no errors, nor print any if `console`."""
    width, height = size
    context = browser.new_context(
        viewport={"width": width, "height": height}, accept_downloads=True, color_scheme=scheme
    )
    page, troubles = context.new_page(), []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    if console:
        page.on("console", lambda said: troubles.append(said.text) if said.type == "error" else None)
    page.goto(address)
    yield page
    context.close()
    assert not troubles, troubles


def latest(page):
    """Return what the page was told last of its cell."""
    return page.evaluate("window.cyclosis.latest()")


def wait(page, condition, seconds=90):
    """Wait for a condition on `cell`, told last, `other`, the second of two, `regime`, its name.

    `find` finds elements.
    """
    end = time.monotonic() + seconds
    while not page.evaluate(f"(() => {{ {TOLD} return Boolean(cell && ({condition})); }})()"):
        assert time.monotonic() < end, f"{condition} did not come true in {seconds} s: {latest(page)}"
        time.sleep(0.05)


def unfold(page):
    """Open all that is folded."""
    page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")


def makers(server):
    """The processes of a server that make files, less those that have just ended."""
    found = []
    for child in server.children():
        with suppress(psutil.NoSuchProcess):  # a zombie is one, too
            found += [child] if "cyclosis.explorer.maker" in child.cmdline() else []
    return found


def export(page, kind, target):
    """Press a button of the exports and return where its file lies."""
    with page.expect_download(timeout=120_000) as found:
        page.locator(f"#export-{kind}").press("Enter")
    found.value.save_as(target)
    return target


def picture(page, where):
    """What is seen of an element, as (rows, columns, rgb)."""
    with Image.open(io.BytesIO(page.locator(where).screenshot())) as shot:
        return np.asarray(shot.convert("RGB")).astype(int)
