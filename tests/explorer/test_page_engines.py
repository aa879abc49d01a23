"""The page on both engines, by keys alone: all that it offers works, or one sentence says what it needs."""

import importlib
import itertools
import time
import tomllib
from pathlib import Path

import av
import pytest
from PIL import Image

from cyclosis.explorer import setup
from measure.pages import export, opened, picture, wait

pytestmark = [pytest.mark.slow, pytest.mark.browser]
proxies = importlib.import_module("proxy")
SIZES = {"desktop": (1280, 800), "phone": (390, 844)}
AXE = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
RAMP = {"at": 0.5, "action": "change", "over": 1.0, "d_r": 0.03, "alpha_u": 0.3}
COARSE = {"grid": {"n_theta": 16, "n_z": 16}, "parameters": {"d_s": 0.2}}
SMALL = setup.from_tables(COARSE, [RAMP], 1.0).link()
"""A small cell, in the middle of a ramp."""
WAYS = [
    *(("server", "desktop", "dark"), ("server", "phone", "light")),
    *(("browser", "desktop", "light"), ("browser", "phone", "dark")),
]
HIDDEN = """hidden => {
  Object.defineProperty(document, 'hidden', { configurable: true, get: () => hidden });
  document.dispatchEvent(new Event('visibilitychange'));
}"""


@pytest.fixture(params=WAYS, ids=["-".join(way) for way in WAYS])
def way(request, browser, server):
    """Yield whether the browser computes, the page at a size in light or dark, and its address."""
    engine, size, scheme = request.param
    root = f"http://127.0.0.1:{server[0]}/"
    address = root + ("?engine=browser" if engine == "browser" else "")
    with opened(browser, f"{address}#{SMALL}", SIZES[size], scheme=scheme) as page:
        wait(page, "cell.catching_up === null && window.cyclosis.statistics().lastShown >= 0")
        page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
        yield engine == "browser", page, root


def press(page, name, key="Enter"):
    page.locator(name).press(key)


def begin(page, preset):
    page.select_option("#preset", preset)
    wait(page, f"cell.preset === '{preset}' && cell.t === 0 && window.cyclosis.statistics().lastShown >= 0")


def test_every_feature_by_keys_alone(way, tmp_path):
    here, page, root = way
    accessible(page)
    # A ramp of the protocol; presets; the pace; parameters.
    wait(page, "cell.special.alpha_u === 'ramp'")
    begin(page, "disordered")
    press(page, "#speed", "End")
    press(page, "#slider-alpha_p", "ArrowRight")
    wait(page, "cell.protocol.length === 1")
    press(page, "#play")
    wait(page, "cell.playing && window.cyclosis.statistics().t > 2")
    # A page that nobody sees rests.
    page.evaluate(HIDDEN, True)
    wait(page, "!cell.playing")
    page.evaluate(HIDDEN, False)
    wait(page, "cell.playing")
    press(page, "#play")
    wait(page, "!cell.playing")
    # The brush, and drugs.
    press(page, "#tool-wound")
    page.locator("#map canvas[tabindex]").focus()
    page.keyboard.press("Enter")
    wait(page, "cell.protocol.some(({ text }) => text.includes('depolymerise'))")
    press(page, "#drug-inhibit-myosin")
    wait(page, "cell.parameters.alpha_u === 0")
    press(page, "#drug-wash-out")
    wait(page, "cell.parameters.alpha_u !== 0")
    # The diagram, and what it is drawn with.
    press(page, "#diagram", "ArrowLeft")
    press(page, "#diagram", "Enter")
    wait(page, "find('#diagram-here').innerText.startsWith('Here')")
    if here:  # the server computes them in seconds; test_server.py tests that
        wait(page, "document.querySelectorAll('.legend li').length === 5")
    assert page.evaluate("document.querySelectorAll('#charts .chart').length") == 5
    # The address, files, and movies.
    press(page, "#ask-hash")
    wait(page, "find('#hash').dataset.sha256?.length === 64")
    wait(page, "location.hash.slice(1) === cell.link")
    cell = page.evaluate("window.cyclosis.latest()")
    table = tomllib.loads(export(page, "toml", tmp_path / "cell.toml").read_text())
    link = setup.from_link(cell["link"])
    assert table["protocol"] == list(link.steps)
    assert table["run"]["t_end"] == link.t == cell["t"]
    with Image.open(export(page, "png", tmp_path / "cell.png")) as image:
        assert image.convert("L").getextrema()[1] > 100
    press(page, "#record")
    wait(page, "find('#record').ariaPressed === 'true' && /1 s$/.test(find('#record + span').innerText)")
    with page.expect_download() as found:
        press(page, "#record")
    with av.open(found.value.path()) as movie:
        frames = [frame.to_ndarray(format="gray") for frame in movie.decode(video=0)]
    assert len(frames) > 3
    assert frames[-1].std() > 4  # a plain one has 0
    if here:
        for kind in ("nc", "movie"):
            press(page, f"#export-{kind}")
            wait(page, f"find('#making-{kind} .warn')?.innerText.includes('Python')")
            press(page, f"#making-{kind} button")
        press(page, "#inside")
        wait(page, "find('#toast').innerText.includes('Python')")
        press(page, "#inside")
    # The same cell in the other engine.
    page.goto("about:blank")
    page.goto(f"{root}{'' if here else '?engine=browser'}#{cell['link']}")
    wait(page, f"cell.catching_up === null && cell.t === {cell['t']}")
    again = page.evaluate("window.cyclosis.latest()")
    assert (again["parameters"], again["protocol"]) == (cell["parameters"], cell["protocol"])
    assert setup.from_link(again["link"]).tables == link.tables


def accessible(page):
    """Nothing that axe-core finds, with every panel open and an explanation shown."""
    if not AXE.is_file():
        pytest.skip("axe-core is not installed: run `npm ci` in web/")
    page.evaluate(AXE.read_text())
    found = page.evaluate("axe.run().then(({ violations }) => violations)")
    assert not found, "\n".join(
        f"{each['id']}: {node['html'][:200]}" for each in found for node in each["nodes"]
    )


@pytest.mark.parametrize("way", WAYS[1:3], indirect=True, ids=["-".join(way) for way in WAYS[1:3]])
def test_two_cells_differ_in_one_parameter_only(way):
    _, page, _ = way
    press(page, "#play")
    wait(page, "window.cyclosis.statistics().t > 1.5")
    page.select_option("#compare-parameter", "alpha_p")
    page.fill("#compare-value", "0.2")
    press(page, "#compare")
    wait(page, "other && other.t > 2")
    press(page, "#drug-inhibit-myosin")
    wait(page, "cell.parameters.alpha_u === 0")
    press(page, "#slider-alpha_p", "ArrowLeft")
    wait(page, "cell.parameters.alpha_p !== 1 && cell.parameters.alpha_p !== 0.2")
    press(page, "#play")
    wait(
        page,
        "!cell.playing && other.t === window.cyclosis.statistics().t && location.hash.includes(other.link)",
    )
    wait(page, "cell.t === other.t && location.hash.slice(1).startsWith(cell.link)")
    t = page.evaluate("window.cyclosis.latest().t")
    links = [
        setup.from_link(page.evaluate(of))
        for of in ("window.cyclosis.latest().link", "window.cyclosis.other().link")
    ]
    first, second = (link.tables | {"steps": [dict(step) for step in link.steps]} for link in links)
    assert second["parameters"].pop("alpha_p") == 0.2
    first["parameters"].pop("alpha_p", None)
    by_hand = [step.pop("alpha_p", None) for step in itertools.chain(first["steps"], second["steps"])]
    assert first == second
    assert len(first["steps"]) == 3
    assert 0.2 in by_hand
    assert t > 2
    for name in ("#cylinder", "#second-cylinder", "#both-charts"):
        assert picture(page, name).std() > 10
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    accessible(page)
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    wait(page, f"other && other.t === {t} && cell.catching_up === null && cell.t === {t}")
    page.evaluate("document.querySelector('#compare').click()")
    wait(page, "!other && !location.hash.includes('~')")


def test_a_cell_whose_server_is_lost_goes_on_in_the_browser(browser, server):
    """Noticed within 5 s; the protocol, also what nobody heard, and the time are kept."""
    proxy = proxies.Proxy(server[0])
    with opened(browser, f"http://127.0.0.1:{proxy.port}/#{SMALL}", SIZES["phone"], console=False) as page:
        wait(page, "window.cyclosis.statistics().lastShown >= 0")
        press(page, "#play")
        wait(page, "window.cyclosis.statistics().t > 2")
        press(page, "#play")
        wait(page, "!cell.playing && window.cyclosis.statistics().t === cell.t")
        page.wait_for_timeout(500)  # the engine in the browser is loaded as a precaution
        before = page.evaluate("window.cyclosis.latest()")
        order = page.evaluate("window.cyclosis.order()")
        proxy.swallowing.set()
        press(page, "#drug-inhibit-myosin")
        lost = time.monotonic()
        wait(page, "!find('#lost').hidden")
        assert time.monotonic() - lost < 5.0
        press(page, "#move")
        wait(page, f"find('#lost').hidden && cell.catching_up === null && cell.t === {before['t']}")
        wait(page, "cell.parameters.alpha_u === 0 && window.cyclosis.statistics().t === cell.t")
        assert page.evaluate("window.cyclosis.order()") == pytest.approx(order, rel=1e-6)
        after = page.evaluate("window.cyclosis.latest()")
        assert after["speed"] == before["speed"]
        assert setup.from_link(after["link"]).tables == setup.from_link(before["link"]).tables
        assert "engine=browser" in page.url
        press(page, "#play")
        wait(page, f"window.cyclosis.statistics().t > {before['t'] + 1}")
    proxy.close()


def test_two_fingers_enlarge_and_one_paints(browser, server):
    address = f"http://127.0.0.1:{server[0]}/?engine=browser#{SMALL}"
    with opened(browser, address, SIZES["phone"]) as page:
        wait(page, "cell.catching_up === null && window.cyclosis.statistics().lastShown >= 0")
        touch = page.context.new_cdp_session(page)
        touch.send("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
        press(page, "#tool-wound")
        page.evaluate("scrollTo(0, 0)")
        box = page.locator("#cylinder").bounding_box()
        x, y = (box[side] + box[length] / 2 for side, length in (("x", "width"), ("y", "height")))

        def put(kind, *heights):
            points = [{"x": x, "y": y + up, "id": k} for k, up in enumerate(heights)]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

        small = picture(page, "#cylinder")
        put("touchStart", -20)
        put("touchStart", -20, 20)
        for k in range(1, 6):
            put("touchMove", -20 - 10 * k, 20 + 10 * k)
        put("touchEnd")
        page.wait_for_timeout(800)
        assert (abs(picture(page, "#cylinder") - small).sum(axis=-1) > 60).mean() > 0.1
        assert page.evaluate("window.cyclosis.latest().protocol.length") == 1
        put("touchStart", -20)
        put("touchMove", 10)
        put("touchEnd")
        wait(page, "cell.protocol.some(({ text }) => text.includes('depolymerise'))")
