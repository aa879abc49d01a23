"""The page without a server as a telephone has it: the first picture, and pictures per second, in Chromium.

    python benchmarks/phone.py           # a few minutes

The folder of `cyclosis explore --static` is served from a sub-path, compressed as web servers do, over a
connection and to a processor that Chromium makes slower: the page's thread, but not that of the engine.
"""

from __future__ import annotations

import argparse
import gzip
import http.server
import shutil
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from cyclosis.explorer import static
from explorer import ARGUMENTS, GPU, RENDERER, SOFTWARE

SIZE = {"width": 390, "height": 844}
PAINTED = "performance.getEntriesByName('first picture')[0]?.startTime ?? null"
SEEN = """() => new Promise(done => {
  const look = () => performance.getEntriesByName('first picture').length ||
    window.cyclosis?.statistics().lastShown >= 0 ? done() : setTimeout(look, 30);
  look();
})"""
FIRST = """() => new Promise(done => {
  const shown = () => window.cyclosis?.statistics().lastShown >= 0;
  const look = () => shown() ? done(performance.now()) : requestAnimationFrame(look);
  look();
})"""


COSTS = ("before", "ScriptDuration", "TaskDuration")
PRINTED = {
    "first": ("first picture", "ms"),
    "solid": ("drawn with WebGL", "ms"),
    "pictures": ("pictures per second", ""),
    "units": ("time units per second", ""),
    "before": ("thread before it", "ms"),
    "ScriptDuration": ("scripts for a picture", "ms"),
    "TaskDuration": ("thread for a picture", "ms"),
}
BEST = {"ms": min, "": max}


def served(root: Path) -> http.server.ThreadingHTTPServer:
    """Serve a folder, compressed."""

    class Compressed(http.server.SimpleHTTPRequestHandler):
        def do_GET(self) -> None:
            path = root / self.path.split("?")[0].strip("/")
            path = path / "index.html" if path.is_dir() else path
            if not path.is_file():
                self.send_error(404)
                return
            data = gzip.compress(path.read_bytes())
            self.send_response(200)
            self.send_header("Content-Type", self.guess_type(str(path)))
            self.send_header("Content-Encoding", "gzip")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *_: object) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Compressed)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


@contextmanager
def opened(browser: Browser, address: str) -> Iterator[tuple[Page, CDPSession]]:
    """Open the page as on a telephone, with tools that are to prepare it first."""
    context = browser.new_context(viewport=SIZE, device_scale_factor=2)
    page = context.new_page()
    yield page, context.new_cdp_session(page)
    context.close()


def told(page: Page, tools: CDPSession | None) -> dict[str, float]:
    """Return what the page counts, and what the browser does."""
    found = dict(page.evaluate("window.cyclosis?.statistics() ?? {}"))
    if tools:
        found |= {each["name"]: each["value"] for each in tools.send("Performance.getMetrics")["metrics"]}
    return found


def played(page: Page, seconds: float, tools: CDPSession | None = None) -> dict[str, float]:
    """Play the cell; return pictures and time units a second, and what the page's thread did for each."""
    page.locator("#play").press("Enter")
    time.sleep(3.0)
    before, began = told(page, tools), time.perf_counter()
    time.sleep(seconds)
    after, spent = told(page, tools), time.perf_counter() - began
    pictures = max(1, after["frames"] - before["frames"])
    costs = {name: (after[name] - before[name]) / pictures for name in COSTS[1:] if tools}
    return costs | {"pictures": pictures / spent, "units": (after["t"] - before["t"]) / spent}


def slowed(browser: Browser, address: str, given: argparse.Namespace) -> dict[str, float]:
    """Return milliseconds to the first picture, and to WebGL's, and how the cell plays, made slower."""
    with opened(browser, address) as (page, tools):
        bytes_per_second = given.megabits * 1e6 / 8
        tools.send("Network.enable")
        conditions = {"offline": False, "latency": given.latency, "downloadThroughput": bytes_per_second}
        tools.send("Network.emulateNetworkConditions", conditions | {"uploadThroughput": bytes_per_second})
        tools.send("Emulation.setCPUThrottlingRate", {"rate": given.slower})
        page.goto(address, wait_until="commit")
        solid = page.evaluate(FIRST)
        return {"first": page.evaluate(PAINTED) or solid, "solid": solid} | played(page, given.seconds)


def cost(browser: Browser, address: str, given: argparse.Namespace) -> dict[str, float]:
    """Return the processor time of the page's thread up to the first picture and for each, times slowness.

    Neither contains what draws, so they are what limits a telephone whose GPU draws.
    """
    with opened(browser, address) as (page, tools):
        tools.send("Performance.enable", {"timeDomain": "threadTicks"})
        page.goto(address, wait_until="commit")
        page.evaluate(SEEN)
        before = told(page, tools)["TaskDuration"]
        page.evaluate(FIRST)
        found = {"before": before} | played(page, given.seconds, tools)
        return {name: 1e3 * given.slower * found[name] for name in COSTS}


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--slower", type=float, default=4.0, help="how many times slower the page is")
    parser.add_argument("--megabits", type=float, default=9.0, help="of the connection, per second")
    parser.add_argument("--latency", type=float, default=60.0, help="of the connection, in milliseconds")
    parser.add_argument("--gpu", choices=("vulkan", "gl-egl"), help="let the browser draw on a GPU")
    parser.add_argument("--seconds", type=float, default=8.0)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        root = Path(folder)
        static.write(root / "some" / "path")
        files = [path for path in root.rglob("*") if path.is_file()]
        packed = sum(len(gzip.compress(path.read_bytes())) for path in files)
        print(f"files                 {sum(path.stat().st_size for path in files) / 1e6:.2f} MB")
        print(f"compressed            {packed / 1e6:.2f} MB")
        server = served(root)
        args = [*ARGUMENTS, *([*GPU, f"--use-angle={given.gpu}"] if given.gpu else SOFTWARE)]
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=args)
        blank = browser.new_page()
        print(f"drawn by              {blank.evaluate(RENDERER)}")
        blank.close()
        address = f"http://127.0.0.1:{server.server_port}/some/path/"
        found = [slowed(browser, address, given) | cost(browser, address, given) for _ in range(given.rounds)]
        for name, (words, unit) in PRINTED.items():
            values = [each[name] for each in found]
            print(f"{words:<22}{statistics.median(values):.1f} {unit} (best {BEST[unit](values):.1f})")
        browser.close()
        server.shutdown()


if __name__ == "__main__":
    main()
