"""The page in front of a class, in a real browser: languages, full screen, colours, units, words, undo."""

import io

import numpy as np
import pytest
from PIL import Image

from cyclosis.explorer import setup
from measure.pages import latest, opened, unfold, wait

pytestmark = [pytest.mark.slow, pytest.mark.browser]
SMALL = {"grid": {"n_theta": 32, "n_z": 32}}
AROUND = SMALL | {"initial": {"kind": "circumferential"}, "parameters": {"kappa": 0.0}}
NAMELESS = """() => [...document.querySelectorAll('button, select, input')].filter(each => {
    const labels = [...(each.labels ?? [])].map(label => label.textContent).join('');
    return !(each.getAttribute('aria-label') || each.textContent.trim() || labels.trim());
}).map(each => each.outerHTML)"""
BEYOND = """() => {
    const { right } = document.querySelector('#panels').getBoundingClientRect();
    return [...document.querySelectorAll('#panels button, #panels input, #panels select, #panels output')]
        .filter(each => each.getBoundingClientRect().right > right && !each.closest('.explained'))
        .map(each => each.outerHTML);
}"""


def link(tables):
    return setup.from_tables(tables).link()


@pytest.fixture(scope="module")
def page(server, browser):
    address = f"http://127.0.0.1:{server[0]}/"
    with opened(browser, f"{address}#{link(SMALL)}", (1280, 800)) as page:
        wait(page, "window.cyclosis.statistics().lastShown >= 0")
        yield page


def brightness(page, where):
    """The mean brightness of the middle of a picture, from 0 to 255."""
    with Image.open(io.BytesIO(page.locator(where).screenshot())) as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(float)
    high, wide, _ = pixels.shape
    return pixels[high * 2 // 5 : high * 3 // 5, wide * 9 // 20 : wide * 11 // 20].max(axis=-1).mean()


def test_what_was_done_is_undone_and_the_cell_begins_again_with_the_same_seed(page):
    unfold(page)
    assert page.locator("#undo").is_disabled()
    page.fill("#parameter-alpha_p", "0.7")
    page.locator("#parameter-alpha_p").press("Enter")
    wait(page, "cell.parameters.alpha_p === 0.7 && cell.undo === 1")
    page.locator("#step").press("Enter")
    wait(page, "cell.t > 0")
    page.locator("#drug-cytochalasin").press("Enter")
    wait(page, "cell.undo === 2")
    for _ in range(3):
        page.locator("#step").press("Enter")
    wait(page, "cell.t > 0.35")
    page.locator("#step").focus()
    page.keyboard.press("z")
    wait(page, "cell.t < 0.15 && cell.parameters.alpha_p === 0.7")
    assert len(latest(page)["protocol"]) == 1
    page.keyboard.press("b")
    wait(page, "cell.t === 0 && cell.parameters.alpha_p === 0.7 && cell.protocol.length === 0")
    assert page.locator("#undo").is_disabled()


def test_a_word_opens_its_explanation_by_key(page):
    page.select_option("#preset", "disordered")
    wait(page, "cell.preset === 'disordered'")
    word = page.locator("#preset-text button.word").first
    word.focus()
    page.keyboard.press("Enter")
    box = page.locator("#glossary-box")
    box.wait_for(state="visible")
    assert word.inner_text() in box.inner_text()
    assert len(box.inner_text()) > 60
    page.keyboard.press("Escape")
    box.wait_for(state="hidden")
    assert page.evaluate("document.activeElement.className") == "word"
    assert page.locator("#preset-text .math sub").first.inner_text() == "r"


def test_full_screen_shows_the_cell_the_legend_and_the_time_in_large_print(page):
    before = page.evaluate("parseFloat(getComputedStyle(document.querySelector('#clock')).fontSize)")
    page.locator("#step").focus()
    page.keyboard.press("f")
    wait(page, "document.documentElement.classList.contains('projected')")
    for shown in ("#cylinder", "#map", ".key-colours", "#clock", "#regime-name", "#play"):
        place = page.locator(shown).bounding_box()
        assert 0 <= place["y"] < place["y"] + place["height"] <= 800.5, shown
    after = page.evaluate("parseFloat(getComputedStyle(document.querySelector('#clock')).fontSize)")
    assert after > 1.4 * before
    page.keyboard.press("f")
    wait(page, "!document.documentElement.classList.contains('projected')")
    assert page.locator("#panels").is_visible()


def test_the_worksheet_opens_a_cell_in_units_that_its_address_keeps(page):
    unfold(page)
    page.select_option("#units", "some")
    wait(page, "cell.setup.scales.radius_um === 500")
    assert page.inner_text("#clock") == "0.0 s"
    assert page.locator(".scale-bar").inner_text().endswith("µm")
    assert "µm" in page.inner_text("#charts")
    page.locator("#questions").press("Enter")
    assert page.locator("#worksheet li").count() == 10
    page.locator("#worksheet .open-cell").nth(3).press("Enter")
    wait(page, "cell.parameters.alpha_u === 0.025 && cell.setup.grid.n_z === 32")
    scales = setup.from_link(latest(page)["link"]).tables["scales"]
    assert scales == {"radius_um": 500, "speed_um_s": 75}
    page.select_option("#units", "none")
    wait(page, "cell.setup.scales.radius_um === undefined")
    assert page.inner_text("#clock") == "t = 0.0"


def test_order_around_the_cell_is_dark_in_one_palette_and_shown_in_another(page):
    page.evaluate(f"location.hash = '{link(AROUND)}'")
    wait(page, "cell.setup.initial.kind === 'circumferential'")
    unfold(page)
    found = {}
    for palette in ("polarity", "direction"):
        page.select_option("#palette", palette)
        page.wait_for_timeout(1200)
        found[palette] = [brightness(page, where) for where in ("#cylinder", "#map")]
    assert max(found["polarity"]) < 90 < 130 < min(found["direction"])
    assert page.locator(".wheel").is_visible()
    page.select_option("#palette", "polarity")
    assert page.locator(".wheel").is_hidden()


def test_the_page_speaks_german_and_keeps_its_cell(page):
    assert page.evaluate(NAMELESS) == []
    unfold(page)
    before = latest(page)["link"]
    with page.expect_navigation(url=lambda address: "lang=de" in address):  # not the hash of the old page
        page.select_option("#language", "de")
    wait(page, "window.cyclosis.statistics().lastShown >= 0")
    assert "lang=de" in page.url
    assert latest(page)["link"] == before
    assert page.evaluate("document.documentElement.lang") == "de"
    assert page.inner_text("#play") == "▶ Start"
    assert page.inner_text("#clock") == "t = 0,0"
    assert page.evaluate(NAMELESS) == []
    unfold(page)
    wait(page, f"({BEYOND})().length === 0", 10)
    page.keyboard.press("t")
    assert "Zelle" in page.inner_text("#tour-title")
