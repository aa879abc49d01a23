"""Closed cells in a real browser: a shape is chosen, seen from all sides, painted over a pole, and kept."""

import io
import time
import tomllib

import numpy as np
import pytest
from PIL import Image

import cyclosis
from measure.pages import opened

pytestmark = [pytest.mark.slow, pytest.mark.browser]
SIZES = {"desktop, light": ((1440, 900), "light"), "phone, dark": ((390, 844), "dark")}


@pytest.fixture(scope="module")
def address(server):
    return f"http://127.0.0.1:{server[0]}/"


@pytest.fixture(params=SIZES, ids=SIZES)
def page(request, browser, address):
    size, scheme = SIZES[request.param]
    with opened(browser, address, size, scheme=scheme) as page:
        wait(page, "true")
        page.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
        yield page


def wait(page, condition, seconds=90):
    told = "const cell = window.cyclosis?.latest(), regime = document.querySelector('#regime')?.innerText"
    end = time.monotonic() + seconds
    while not page.evaluate(f"(() => {{ {told}; return Boolean(cell && ({condition})); }})()"):
        assert time.monotonic() < end, f"{condition} did not come true in {seconds} s"
        time.sleep(0.05)


def latest(page):
    return page.evaluate("window.cyclosis.latest()")


def begin(page, shape, **settings):
    """Begin a cell of a shape by the form for new cells."""
    page.select_option("#setting-shape", shape)
    for name, value in settings.items():
        field = page.locator(f"#setting-{shape}-{name}")
        if field.evaluate("each => each.tagName") == "SELECT":
            field.select_option(value)
        else:
            field.fill(value)
    page.locator("#begin").press("Enter")
    wait(page, f"cell.setup.grid.shape === '{shape}' && window.cyclosis.statistics().lastShown >= 0")
    page.wait_for_timeout(500)


def picture(page, where):
    """What is seen of an element, as (rows, columns, rgb)."""
    with Image.open(io.BytesIO(page.locator(where).screenshot())) as shot:
        return np.asarray(shot.convert("RGB")).astype(int)


def fingerprint(page):
    page.evaluate("document.querySelector('#hash').dataset.sha256 = ''")
    # A page that is opened anew on a phone has its panels closed.
    page.evaluate("document.querySelector('#ask-hash').closest('details').open = true")
    page.locator("#ask-hash").press("Enter")
    wait(page, "document.querySelector('#hash').dataset.sha256")
    return page.get_attribute("#hash", "data-sha256")


def export(page, kind, target):
    with page.expect_download(timeout=120_000) as found:
        page.locator(f"#export-{kind}").press("Enter")
    found.value.save_as(target)
    return target


def test_a_capsule_is_chosen_painted_over_its_pole_and_kept(page, address, tmp_path):
    begin(page, "capsule", length="2", k_max="12")
    grid = latest(page)["setup"]["grid"]
    assert (grid["length"], grid["smoothing"], grid["k_max"]) == (2, 0.4, 12)
    # What has no meaning here is hidden, or says so.
    assert page.locator("#inside").is_hidden()
    assert page.locator("[data-name=zero_theta_flux]").is_hidden()
    assert page.locator("[data-name=repulsion_angle]").is_hidden()
    assert page.locator("[data-name=kappa]").is_visible()
    assert page.locator("#diagram").is_hidden()
    assert "do not hold for a closed cell" in page.inner_text("#panel-diagram")
    assert "profile" not in page.inner_text("#charts")
    page.locator("#step").press("Enter")
    wait(page, "cell.t > 0")
    # From above, a stroke across the picture passes the north pole.
    page.locator("#tool-turn").press("Enter")
    canvas = page.locator("#cylinder canvas").first
    canvas.focus()
    for _ in range(20):
        page.keyboard.press("ArrowDown")
    page.locator("#tool-wound").press("Enter")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x - 40, y)
    page.mouse.down()
    page.mouse.move(x + 40, y, steps=12)
    page.mouse.up()
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
    page.wait_for_timeout(300)
    config = tomllib.loads(export(page, "toml", tmp_path / "cell.toml").read_text())
    assert config["model"] == {"kind": "closed"}
    assert config["grid"] == {"shape": "capsule", "length": 2, "smoothing": 0.4, "k_max": 12}
    discs = [part for step in config["protocol"] for part in step["where"].get("parts", [step["where"]])]
    ends = np.array([disc["z"] for disc in discs])
    length = cyclosis.Capsule(length=2.0).meridian_length
    assert 0.9 * length < ends.max() <= length
    assert ends.min() > 0.5 * length
    angles = [disc["theta"] for disc in discs]
    assert np.ptp(angles) > 1  # on both sides of the pole
    # The same address opens the same cell.
    before, link = fingerprint(page), latest(page)["link"]
    page.goto("about:blank")
    page.goto(address + "#" + link)
    wait(page, "cell.catching_up === null && window.cyclosis.statistics().lastShown >= 0")
    assert latest(page)["setup"]["grid"] == grid
    assert fingerprint(page) == before
    page.locator("#drug-cytochalasin").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0")


def test_files_of_a_closed_cell(page, tmp_path):
    begin(page, "capsule", length="1", k_max="12")
    for _ in range(3):
        page.locator("#step").press("Enter")
    wait(page, "cell.t > 0.25")
    run = cyclosis.load(export(page, "nc", tmp_path / "run.nc"))
    assert isinstance(run.grid, cyclosis.ClosedGrid)
    assert run.times[-1] == pytest.approx(latest(page)["t"])
    assert export(page, "movie", tmp_path / "movie.mp4").stat().st_size > 10_000
    with Image.open(export(page, "png", tmp_path / "cell.png")) as drawn:
        assert np.ptp(np.asarray(drawn.convert("L")).astype(int)) > 60  # the cell, whatever the page's colour


@pytest.mark.parametrize("preset", ["figure4-capsule", "ends", "droplet"])
def test_the_presets_run_and_are_seen_from_all_sides(page, preset):
    page.select_option("#preset", preset)
    wait(page, f"cell.preset === '{preset}' && window.cyclosis.statistics().lastShown >= 0")
    page.locator("#speed").press("End")
    page.locator("#play").press("Enter")
    words = {"figure4-capsule": "t = 1", "ends": "from pole to pole", "droplet": "circulation"}
    if preset == "figure4-capsule":
        wait(page, "cell.t > 15")
    else:
        wait(page, f"regime.startsWith('{words[preset]}')", 180)
    page.locator("#play").press("Enter")
    wait(page, "cell.playing === false")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    canvas = page.locator("#cylinder canvas").first
    canvas.focus()
    seen = []
    for key in ("Home", *["ArrowDown"] * 18):
        page.keyboard.press(key)
    page.wait_for_timeout(400)
    seen.append(picture(page, "#cylinder"))
    for _ in range(40):
        page.keyboard.press("ArrowUp")
    page.wait_for_timeout(400)
    seen.append(picture(page, "#cylinder"))
    # Both poles are whole: nothing of the page is seen through the middle of the cell.
    paper = seen[0][2, 2]
    for each in seen:
        high, wide, _ = each.shape
        middle = each[high // 2 - 20 : high // 2 + 20, wide // 2 - 20 : wide // 2 + 20]
        assert (abs(middle - paper).sum(axis=-1) > 60).mean() > 0.95
    assert (picture(page, "#map").std(axis=(0, 1)) > 10).any()
    axial = preset != "droplet"
    assert page.locator(".key-axial").first.is_visible() is axial
    assert page.locator(".key-ball").first.is_visible() is not axial


def test_a_cylinder_after_a_closed_cell_is_as_before(page):
    page.locator("#inside").press("Enter")
    wait(page, "window.cyclosis.statistics().tracers > 0")
    begin(page, "sphere", k_max="12")
    assert page.locator("#inside").is_hidden()
    assert page.locator(".key-inside").is_hidden()
    page.select_option("#preset", "wound")
    wait(page, "cell.preset === 'wound' && window.cyclosis.statistics().tracers > 0")
    assert page.locator("#inside").is_visible()
    assert page.locator("#diagram").is_visible()
    assert "profile" in page.inner_text("#charts")
    page.locator("#inside").press("Enter")
    wait(page, "window.cyclosis.statistics().tracers === 0")
