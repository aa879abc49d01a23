"""Take the pictures of the explorer's page: images/explorer.png and images/explorer-inside.png.

python docs/explorer_pictures.py    # a minute, with playwright, Chromium, and the built page

The cell is that of Figure 4, computed by a server of its own.
"""

import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

IMAGES = Path(__file__).parent / "images"
# The browser draws in software, as in tests/explorer/conftest.py.
ARGUMENTS = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]
SIZE = {"width": 1440, "height": 900}
EMERGED, EMERGING = 41.0, 12.0
"""Times of the pictures: two streams whose zones are still bent, and patches that merge."""


@contextmanager
def served() -> Iterator[str]:
    """Start the explorer on a free port and yield its address."""
    command = [sys.executable, "-u", "-m", "cyclosis", "explore", "--no-browser", "--no-ahead", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as started:
        assert started.stdout is not None
        try:
            for line in started.stdout:
                if found := re.search(r"http://\S+", line):
                    yield found[0].rstrip(".")
                    break
        finally:
            started.terminate()


def wait(page: Page, condition: str, seconds: float = 240.0) -> None:
    """Wait for a condition on `cell`, what the page was told last."""
    end = time.monotonic() + seconds
    told = f"(() => {{ const cell = window.cyclosis?.latest(); return cell && ({condition}); }})()"
    while not page.evaluate(told):
        if time.monotonic() > end:
            raise TimeoutError(condition)
        page.clock.run_for(40)


def played(page: Page, address: str, until: float) -> None:
    """Open a new cell and play it until a time.

    The page's clock stands still while it draws, or else it would leave out particles and pixels on a machine
    that draws slowly.
    """
    page.clock.install(time=0)
    page.goto(address)
    page.clock.pause_at(60_000)
    wait(page, "cell.playing === false")
    page.locator("#play").press("Enter")
    wait(page, f"window.cyclosis.statistics().t >= {until}")


def keep(shot: bytes, name: str) -> None:
    """Store a picture with few colours, which is small."""
    with Image.open(BytesIO(shot)) as picture:
        drawn = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    drawn.save(IMAGES / name, optimize=True)


def main() -> None:
    """Take both pictures."""
    with served() as address, sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)
        page = browser.new_context(viewport=SIZE, color_scheme="light").new_page()
        played(page, address, EMERGED)
        page.evaluate("document.activeElement.blur()")
        keep(page.screenshot(), "explorer.png")
        page = browser.new_context(viewport=SIZE, color_scheme="light").new_page()
        played(page, address, EMERGING)
        page.locator("#inside").press("Enter")
        wait(page, "window.cyclosis.statistics().inside > 20")
        page.evaluate("document.activeElement.blur()")
        stage = page.locator("#stage").bounding_box()
        keep(page.screenshot(clip=stage), "explorer-inside.png")
        browser.close()


if __name__ == "__main__":
    main()
