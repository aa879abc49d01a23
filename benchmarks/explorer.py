"""Pictures per second, computed time per second, and latency from slider to picture, in a real browser.

python benchmarks/explorer.py        # with `cyclosis explore --no-browser` running

The browser is the system's Chromium, which draws in software unless --gpu names how it reaches a GPU.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import time

from playwright.sync_api import sync_playwright

ARGUMENTS = ["--headless", "--no-sandbox", "--disable-background-networking", "--no-first-run"]
SOFTWARE = ["--disable-gpu", "--enable-unsafe-swiftshader"]
GPU = ["--enable-gpu", "--ignore-gpu-blocklist", "--enable-features=Vulkan", "--use-gl=angle"]
RENDERER = """(() => {
  const gl = document.createElement('canvas').getContext('webgl2');
  const named = gl?.getExtension('WEBGL_debug_renderer_info');
  return named ? gl.getParameter(named.UNMASKED_RENDERER_WEBGL) : 'unknown';
})()"""
# From the moment a slider is moved to the first picture that was drawn of a cell with its new value.
LATENCY = """value => new Promise(done => {
  const slider = document.querySelector('#slider-alpha_u'), began = performance.now();
  const old = window.cyclosis.latest().parameters.alpha_u;
  slider.value = value;
  slider.dispatchEvent(new Event('input', { bubbles: true }));
  let frame = null;
  const look = () => {
    if (frame === null && window.cyclosis.latest().parameters.alpha_u !== old)
      frame = window.cyclosis.statistics().frames;
    if (frame !== null && window.cyclosis.statistics().frames > frame) done(performance.now() - began);
    else setTimeout(look, 2);
  };
  look();
})"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--address", default="http://127.0.0.1:8765/")
    parser.add_argument("--gpu", choices=("vulkan", "gl-egl"), help="let the browser draw on a GPU")
    parser.add_argument("--inside", action="store_true", help="open the cell and show the flow inside")
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    with sync_playwright() as driver:
        args = [*ARGUMENTS, *([*GPU, f"--use-angle={given.gpu}"] if given.gpu else SOFTWARE)]
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=args)
        page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
        page.goto(given.address)
        while not page.evaluate("Boolean(window.cyclosis && window.cyclosis.latest())"):
            time.sleep(0.1)
        print(f"drawn by              {page.evaluate(RENDERER)}")
        if page.get_attribute("#play", "aria-pressed") != "true":
            page.locator("#play").press("Enter")
        if given.inside:
            page.locator("#inside").press("Enter")
        time.sleep(4.0)
        first, began = page.evaluate("window.cyclosis.statistics()"), time.perf_counter()
        time.sleep(given.seconds)
        last, spent = page.evaluate("window.cyclosis.statistics()"), time.perf_counter() - began
        print(f"pictures per second   {(last['frames'] - first['frames']) / spent:.1f}")
        print(f"time units per second {(last['t'] - first['t']) / spent:.2f}")
        if given.inside:
            told = (last["inside"] - first["inside"]) / spent
            print(f"tracers               {last['tracers']}, told {told:.1f} times a second")
        slider = "document.querySelector('#slider-alpha_u')"
        low, high = (float(page.evaluate(f"{slider}.{end}")) for end in ("min", "max"))
        waits = []
        for k in range(20):
            share = 0.3 + 0.4 * (k % 2)
            waits.append(page.evaluate(LATENCY, low + share * (high - low)))
            time.sleep(0.3)
        print(f"slider to picture     median {statistics.median(waits):.0f} ms, longest {max(waits):.0f} ms")
        browser.close()


if __name__ == "__main__":
    main()
