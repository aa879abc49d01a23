"""The explorer's server, started as a user starts it, and a browser."""

import importlib
import shutil

import pytest

from cyclosis.explorer.server import PAGE

hostile = importlib.import_module("hostile")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
# The browser draws in software and asks nothing of any network.
ARGUMENTS = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
]


@pytest.fixture(scope="module")
def server():
    """Yield the port and the process of a server; skip where there is no page."""
    if not (PAGE / "index.html").exists():
        pytest.skip("the explorer's page is not built: install Node.js 20.19 or newer and run `make page`")
    with hostile.server() as (port, process):
        yield port, process


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("there is no Chromium on this machine: install it to test the page")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield started
        started.close()
