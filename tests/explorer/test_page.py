"""The page in a real browser: what a visitor does, from the first look to the exported file."""

import io

import av
import numpy as np
import pytest
from PIL import Image

import cyclosis
from measure.pages import export, latest, opened, picture, unfold, wait

pytestmark = [pytest.mark.slow, pytest.mark.browser]
SIZES = {"desktop": (1440, 900), "phone": (390, 844)}


@pytest.fixture(scope="module")
def address(server):
    return f"http://127.0.0.1:{server[0]}/"


@pytest.fixture(params=SIZES, ids=SIZES)
def page(request, browser, address):
    with opened(browser, address, SIZES[request.param]) as page:
        wait(page, "true")
        yield page


def play(page, on=True):
    if (page.get_attribute("#play", "aria-pressed") == "true") != on:
        page.locator("#play").press("Enter")
    wait(page, f"cell.playing === {str(on).lower()}")


def seen(page):
    """The middle of the cylinder as it is drawn: within one stripe."""
    place = page.locator("#cylinder")
    place.evaluate("cylinder => cylinder.scrollIntoView({ block: 'nearest' })")
    # A screenshot of the element itself would wait for it to rest.
    shot = page.screenshot(clip=place.bounding_box())
    with Image.open(io.BytesIO(shot)) as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    high, wide, _ = pixels.shape
    return pixels[high * 2 // 5 : high * 3 // 5, wide * 9 // 20 : wide * 11 // 20].sum(axis=-1)


def fingerprint(page):
    """The hash that the page shows of the cell's state."""
    page.evaluate("document.querySelector('#hash').dataset.sha256 = ''")
    page.locator("#ask-hash").press("Enter")
    wait(page, "document.querySelector('#hash').dataset.sha256")
    return page.get_attribute("#hash", "data-sha256")


def test_a_wound_heals_and_all_that_was_done_is_in_the_files(page, tmp_path):
    unfold(page)
    page.locator("#speed").press("End")
    play(page)
    wait(page, "regime.startsWith('cyclosis')", 120)
    play(page, on=False)
    page.locator("#tool-wound").press("Enter")
    page.fill("#at-theta", "1.57")
    page.fill("#at-z", "2.5")
    page.locator("#brush-here").press("Enter")
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
    hurt = latest(page)["t"]
    play(page)
    wait(page, f"cell.t > {hurt + 40}", 120)
    play(page, on=False)
    run = cyclosis.load(export(page, "nc", tmp_path / "run.nc"))
    assert run.times[-1] == pytest.approx(latest(page)["t"])
    lengths = np.hypot(*np.moveaxis(np.asarray(run.frames), 1, 0))
    grid = run.grid
    here = (round(1.57 / (2 * np.pi) * grid.n_theta), round(2.5 / grid.length * grid.n_z))
    wounded = int(np.argmin(np.abs(run.times - hurt)))
    assert lengths[wounded][here] < 0.05
    assert lengths[-1][here] > 0.5
    page.wait_for_timeout(200)
    with av.open(export(page, "movie", tmp_path / "movie.mp4")) as movie:
        assert sum(1 for _ in movie.decode(video=0)) == 144
        assert movie.duration / av.time_base == pytest.approx(12.0)
    with Image.open(export(page, "png", tmp_path / "cell.png")) as picture:
        assert np.asarray(picture.convert("RGB")).std() > 10
    assert "depolymerise" in export(page, "toml", tmp_path / "cell.toml").read_text()


def test_tracers_stream_over_a_cylinder_that_is_steady(page):
    page.locator("#speed").press("End")
    play(page)
    wait(page, "cell.t > 150", 120)
    first, moved = seen(page), 0
    for _ in range(20):  # a machine that draws in software besides other work may need more than one look
        page.wait_for_timeout(400)
        moved = (abs(seen(page) - first) > 40).sum()
        if moved > 20:
            break
    assert moved > 20
    play(page, on=False)
    page.wait_for_timeout(400)
    held = seen(page)
    page.wait_for_timeout(400)
    assert abs(seen(page) - held).max() == 0


def test_what_is_changed_in_the_page_is_the_protocol_of_its_cell(page, tmp_path):
    unfold(page)
    page.fill("#parameter-alpha_p", "0.7")
    page.locator("#parameter-alpha_p").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0.7")
    page.locator("#slider-alpha_u").press("ArrowRight")
    wait(page, "cell.parameters.alpha_u !== 0.5")
    page.locator("#step").press("Enter")
    wait(page, "cell.t > 0")
    page.locator("#drug-cytochalasin").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0")
    page.locator("#drug-wash-out").press("Enter")
    wait(page, "cell.parameters.alpha_p !== 0")
    done = [step["text"] for step in latest(page)["protocol"]]
    assert done[0].startswith("t = 0: alpha_p = 0.7, alpha_u = 0.")
    assert done[1:] == ["t = 0.1: alpha_p = 0", "t = 0.1: wash out"]
    assert "alpha_p = 0.7" in export(page, "toml", tmp_path / "cell.toml").read_text()


def test_a_click_on_the_phase_diagram_goes_there(page):
    unfold(page)
    diagram = page.locator("#diagram")
    diagram.scroll_into_view_if_needed()
    box = diagram.bounding_box()
    diagram.click(position={"x": 0.3 * box["width"], "y": 0.6 * box["height"]})
    wait(page, "cell.protocol.length > 0")
    there = latest(page)["parameters"]
    assert 0 < there["alpha_p"] < 0.5
    assert 0 < there["alpha_u"] < 0.6
    assert "Here" in page.inner_text("#diagram-here")


def test_an_address_opens_the_same_cell(page, address):
    unfold(page)
    page.locator("#slider-alpha_u").press("ArrowRight")
    wait(page, "cell.protocol.length > 0")
    play(page)
    wait(page, "cell.t > 2")
    play(page, on=False)
    cell, print_of = latest(page), fingerprint(page)
    wait(page, "location.hash.slice(1) === cell.link")
    page.goto("about:blank")
    page.goto(address + "#" + cell["link"])
    wait(page, "cell.catching_up === null")
    unfold(page)
    again = latest(page)
    assert again["t"] == cell["t"] > 2
    assert again["link"] == cell["link"]
    assert fingerprint(page) == print_of


def test_with_keys_alone_a_cell_is_wounded_and_the_tour_walked(page):
    unfold(page)
    wait(page, "window.cyclosis.statistics().frame >= 0 && window.cyclosis.statistics().frames > 0")
    page.locator("#tool-wound").press("Enter")
    page.locator("#map canvas[tabindex]").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    wait(page, "cell.protocol.some(step => step.text.includes('depolymerise'))")
    page.keyboard.press("t")
    seen = []
    for _ in range(6):
        page.wait_for_timeout(300)
        seen.append(page.inner_text("#tour-title"))
        page.locator("#tour-next").press("Enter")
    assert len(set(seen)) == 6
    assert page.locator("#tour-card").is_hidden()


def begin(page, preset):
    page.select_option("#preset", preset)
    wait(page, f"cell.preset === '{preset}' && cell.t === 0")
    page.wait_for_timeout(1500)  # software draws the new cell, passing over from the old one


def test_zones_are_drawn_between_steady_streams_and_not_in_disorder(page):
    """On the line between two straight streams |P| is zero: what lies around it says that it is one."""
    shares = []
    for preset in ("wound", "disordered"):
        begin(page, preset)
        seen = picture(page, "#map").min(axis=-1) > 225
        # The map lies between margins of 30 and 12; the two streams of the wound's cell part at its middle.
        middle = 30 + (seen.shape[1] - 42) // 2
        rows = seen[seen.shape[0] * 2 // 5 : seen.shape[0] * 3 // 5, middle - 12 : middle + 13]
        shares.append(rows.any(axis=1).mean())
    assert shares[0] > 0.95
    assert shares[1] == 0


def test_numbers_beside_the_traces_are_whole_however_small(page):
    """In disorder speed and power are of the order of 1e-5 and 1e-10."""
    inked = """() => [...document.querySelectorAll('#charts .plot canvas')].map(canvas => {
        const pen = canvas.getContext('2d');
        const opaque = (value, k) => k % 4 === 3 && value > 0;
        const ink = (x, wide) => pen.getImageData(x, 0, wide, canvas.height).data.filter(opaque);
        return [ink(0, 1).length, ink(0, 60).length];
    })"""
    begin(page, "disordered")
    page.locator("#charts").scroll_into_view_if_needed()
    page.wait_for_timeout(1000)  # what is out of sight is drawn when it is seen
    found = page.evaluate(inked)
    assert len(found) == 5
    for edge, labels in found:
        assert edge == 0
        assert labels > 100


def test_every_explanation_opens_and_closes_by_tap_and_key(page):
    unfold(page)
    buttons = page.locator("button.explain")
    own = page.locator(".parameter:not(.compared)")
    assert page.locator(".parameter button.explain").count() == own.count()
    assert page.locator("#charts button.explain").count() == page.locator("#charts .chart").count()
    width, height = (page.viewport_size[side] for side in ("width", "height"))
    for k in range(buttons.count()):
        button, box = buttons.nth(k), page.locator(".explained").nth(k)
        button.scroll_into_view_if_needed()
        if k % 2:
            button.click()
        else:
            button.press("Enter")
        box.wait_for(state="visible")
        page.wait_for_timeout(100)  # it is put beside its button once it stands
        assert button.get_attribute("aria-expanded") == "true"
        assert len(box.inner_text()) > 30
        place = box.bounding_box()
        assert place["x"] >= 0
        assert place["x"] + place["width"] <= width
        assert place["y"] >= 0
        assert place["y"] + place["height"] <= height
        page.keyboard.press("Escape")
        box.wait_for(state="hidden")


def test_what_the_cell_does_is_said_without_numbers_that_need_a_manual(page):
    begin(page, "cyclosis")
    page.locator("#speed").press("End")
    play(page)
    wait(page, "regime.includes('R/U')", 120)
    play(page, on=False)
    said = page.inner_text("#regime")
    assert "halve in about" in said or "double in about" in said
    assert not any(word in said for word in ("relaxing", "undecided", "widths", " at -", "zone"))
    page.locator("#now button.explain").press("Enter")
    assert "U/R" in page.locator("#now .explained").inner_text()


def test_the_cell_opens_and_shows_the_flow_inside(page, address):
    """By a click and by a key; the browser remembers it, and the cell stays the same."""
    unfold(page)
    wait(page, "window.cyclosis.statistics().lastShown >= 0")
    print_of = fingerprint(page)
    button = page.locator("#inside")
    assert button.get_attribute("aria-pressed") == "false"
    closed = picture(page, "#cylinder")
    button.click()
    wait(page, "window.cyclosis.statistics().tracers > 0 && cell.vacuole > 0")
    assert button.get_attribute("aria-pressed") == "true"
    assert page.locator(".key-inside").is_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.locator(".key-bar button.explain").press("Enter")
    assert "vacuole" in page.inner_text(".key-bar .explained")
    page.keyboard.press("Escape")
    assert fingerprint(page) == print_of
    assert (abs(picture(page, "#cylinder") - closed).sum(axis=-1) > 60).mean() > 0.05
    begin(page, "wound")
    page.locator("#speed").press("End")
    play(page)
    came = page.evaluate("window.cyclosis.statistics().inside")
    wait(page, f"window.cyclosis.statistics().inside > {came + 5}")
    first = picture(page, "#cylinder")
    page.wait_for_timeout(500)
    assert (abs(picture(page, "#cylinder") - first).sum(axis=-1) > 60).sum() > 50
    page.reload()
    wait(page, "window.cyclosis.statistics().tracers > 0")
    button.focus()
    page.keyboard.press("v")
    wait(page, "cell.vacuole === undefined")
    assert button.get_attribute("aria-pressed") == "false"
    assert page.locator(".key-inside").is_hidden()
    wait(page, "window.cyclosis.statistics().tracers === 0")
