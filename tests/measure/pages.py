"""The explorer's page in a browser, and the processes of its server."""

import time
from contextlib import contextmanager, suppress

import psutil


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


def wait(page, condition, seconds=60):
    """Wait for a condition on `cell`, the latest that the server told, and `regime`, what the page says."""
    told = "const cell = window.cyclosis?.latest(), regime = document.querySelector('#regime')?.innerText"
    end = time.monotonic() + seconds
    while not page.evaluate(f"(() => {{ {told}; return Boolean(cell && ({condition})); }})()"):
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
