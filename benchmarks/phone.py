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
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from cyclosis.explorer import static
from explorer import ARGUMENTS, GPU, RENDERER, SOFTWARE

SIZE = {"width": 390, "height": 844}
FIRST = """() => new Promise(done => {
  const shown = () => window.cyclosis?.statistics().lastShown >= 0;
  const look = () => shown() ? done(performance.now()) : requestAnimationFrame(look);
  look();
})"""


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


def measured(browser: Browser, address: str, slower: float, megabits: float, latency: float, seconds: float):
    """Return milliseconds to the first picture, pictures per second, and time units per second."""
    context = browser.new_context(viewport=SIZE, device_scale_factor=2)
    page = context.new_page()
    tools = context.new_cdp_session(page)
    bytes_per_second = megabits * 1e6 / 8
    tools.send("Network.enable")
    conditions = {"offline": False, "latency": latency, "downloadThroughput": bytes_per_second}
    tools.send("Network.emulateNetworkConditions", conditions | {"uploadThroughput": bytes_per_second})
    tools.send("Emulation.setCPUThrottlingRate", {"rate": slower})
    page.goto(address, wait_until="commit")
    first = page.evaluate(FIRST)
    page.locator("#play").press("Enter")
    time.sleep(3.0)
    before, began = page.evaluate("window.cyclosis.statistics()"), time.perf_counter()
    time.sleep(seconds)
    after, spent = page.evaluate("window.cyclosis.statistics()"), time.perf_counter() - began
    context.close()
    return first, (after["frames"] - before["frames"]) / spent, (after["t"] - before["t"]) / spent


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
        conditions = (given.slower, given.megabits, given.latency, given.seconds)
        found = [measured(browser, address, *conditions) for _ in range(given.rounds)]
        first, pictures, units = (statistics.median(column) for column in zip(*found, strict=True))
        print(f"first picture         {first:.0f} ms")
        print(f"pictures per second   {pictures:.1f}")
        print(f"time units per second {units:.2f}")
        browser.close()
        server.shutdown()


if __name__ == "__main__":
    main()
