"""Languages of the page: every text that the package gives it has a translation that still fits."""

import re
from pathlib import Path

import pytest

from cyclosis.explorer.about import about

ROOT = Path(__file__).parents[2]
WORDS = ROOT / "web" / "src" / "words"
LANGUAGES = sorted(
    path for path in WORDS.glob("??*.ts") if re.fullmatch("(?!en)[a-z]{2}(-[a-z]+)?", path.stem)
)
NUMBER = r"\d+(?:[.,]\d+)?"


def texts():
    """Return every text of the package that the page shows, by its place."""
    told = about()
    found = {"diagram": told["diagram"]["caption"]}
    found |= {f"palette.{item['name']}": item["title"] for item in told["palettes"]}
    for item in told["presets"]:
        found |= {f"preset.{item['name']}": item["title"], f"preset.{item['name']}.text": item["text"]}
    for item in told["terms"]:
        name = item["name"]
        found |= {f"term.{name}": name.replace("_", " "), f"term.{name}.caption": item["caption"]}
    for item in (*told["parameters"], *told["initial"], told["interval"]):
        found[f"setting.{item['name']}"] = item["meaning"]
    for shape in told["shapes"]:
        found |= {f"setting.{shape['name']}.{each['name']}": each["meaning"] for each in shape["settings"]}
    for model in told["models"].values():
        found |= {f"trace.{item['name']}": item["meaning"] for item in model["traces"]}
    for k, item in enumerate(told["worksheet"], 1):
        found[f"worksheet.{k}"] = item["question"]
        found |= {f"worksheet.{k}.try": item["attempt"], f"worksheet.{k}.answer": item["answer"]}
    return found


def translations(path, section):
    """Return the entries of a section of a language file."""
    body = re.search(rf"^  {section}: \{{\n(.*?)^  \}},", path.read_text(), re.M | re.S)[1]
    entries = re.findall(r"^\s+(?:'((?:[^'\\]|\\.)*)'|(\w+)): '((?:[^'\\]|\\.)*)',$", body, re.M)
    return {quoted or bare: text for quoted, bare, text in entries}


@pytest.mark.skipif(not WORDS.exists(), reason="the page's source is not here")
@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_each_text_of_the_package_is_translated_with_its_numbers(path):
    english, here = texts(), translations(path, "package")
    assert here.keys() == english.keys()
    for place, text in english.items():
        there = sorted(number.replace(",", ".") for number in re.findall(NUMBER, here[place]))
        assert there == sorted(re.findall(NUMBER, text)), place


@pytest.mark.skipif(not WORDS.exists(), reason="the page's source is not here")
@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_each_translated_sentence_is_one_that_the_package_says(path):
    sources = [
        *(ROOT / "src/cyclosis").glob("explorer/*.py"),
        *(ROOT / "src/cyclosis/dynamics").rglob("*.py"),
    ]
    sources += [*(ROOT / "web/src/engine").glob("*.ts")]
    said = "".join(source.read_text() for source in sources)
    for sentence in translations(path, "sentences"):
        pieces = re.split(r"(?:\ba )?\{\w+\}|\. |^Preparing (?=what|a )", sentence)
        assert max(pieces, key=len) in said, sentence
