"""The pages are up to date and lead somewhere, none is left out, and all code in them works."""

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import NAMES, experiment
from measure.commandline import WHOLE, said

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
SITE = sorted(page for page in DOCS.rglob("*.md") if "_build" not in page.parts)
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *SITE]


def named(page):
    return str(page.relative_to(ROOT))


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_generated_pages_match_the_code():
    generate = loaded("generate")
    for name, page in generate.PAGES.items():
        assert (DOCS / name).read_text() == page(), f"run python docs/generate.py: {name} is out of date"


@pytest.mark.parametrize("name", NAMES)
def test_the_decisive_number_of_a_claim_is_one_of_those_measured(name):
    with xarray.open_dataset(DOCS / "data" / "experiments" / f"{name}.nc", engine="h5netcdf") as data:
        told = experiment(name).decisive(data)
        number = re.match(r"[\d.]+( % \([\d.]+ to [\d.]+ %\))?", told).group()
        assert number in data.attrs["measured"], told


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text()):
        if not target.startswith(("http://", "https://", "mailto:")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


def listed(page):
    """The pages that a page's tables of contents name."""
    for block in re.findall(r"```\{toctree\}\n(.*?)```", page.read_text(), re.DOTALL):
        for line in block.splitlines():
            if line and not line.startswith(":"):
                yield (page.parent / f"{line.strip()}.md").resolve()


def test_every_page_is_in_one_table_of_contents():
    entries = [entry for page in SITE for entry in listed(page)]
    assert sorted(entries) == sorted(page for page in SITE if page != DOCS / "index.md")


def test_no_page_holds_two_versions_of_a_text():
    """As a merge leaves them where both sides have changed it."""
    for page in (*DOCS.rglob("*.md"), *ROOT.glob("*.md")):
        assert not re.search(r"^(<{7}|>{7}|={7}$)", page.read_text(), re.MULTILINE), page


def test_the_site_is_built_from_pages_that_run():
    conf = (DOCS / "conf.py").read_text()
    for line in ('nb_execution_mode = "force"', "nb_execution_raise_on_error = True", '"myst_nb"'):
        assert line in conf
    assert "sphinx-build -W" in (ROOT / "Makefile").read_text()
    for page in SITE:
        text = page.read_text()
        assert text.startswith("---\nfile_format: mystnb\n") == ("```{code-cell}" in text), page.name


def test_every_public_name_is_in_the_reference():
    told = "".join(page.read_text() for page in (DOCS / "api").glob("*.md"))
    for name in cy.__all__:
        marks = (f":: cyclosis.{name}\n", f"## cyclosis.{name}\n")
        assert any(mark in told for mark in marks), name


def test_formulas_in_docstrings_survive():
    lines = ["Return |P| * 2, `a | b`.", "", "    |P| * x", "", "See P_ too.", ">>> a | b", "[1 * 2]", ""]
    loaded("docstrings").as_rst(None, "function", "", None, None, lines)
    assert lines == [
        *("Return \\|P\\| \\* 2, `a | b`.", "", "::", "", "    |P| * x", ""),
        *("See P\\_ too.", "", ">>> a | b", "[1 * 2]", ""),
    ]


def resolved(path):
    """What a dotted name of the package stands for; raises where there is no such thing."""
    found = cy
    for name in path:
        if not hasattr(found, name):
            importlib.import_module(f"{found.__name__}.{name}")
        found = getattr(found, name)
    return found


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_names_in_the_pages_exist(page):
    for told in re.findall(r"\b(?:cy|cyclosis)((?:\.[A-Za-z_]\w*)+)(?!\w*\.)", page.read_text()):
        resolved(told[1:].split("."))
    if page.name in ("stability.md", "stripes.md"):
        for told in re.findall(r"\bs\.([a-z_]\w*)\(", page.read_text()):
            resolved(["stability", told])


def blocks(page):
    return re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)


def timed(pages):
    """The pages as parameters; those that take longest are slow, and run when the site is built, too."""
    return [
        pytest.param(page, id=named(page), marks=[pytest.mark.slow] if page.name in LONG else [])
        for page in pages
    ]


LONG = (
    "biologist.md",
    "student.md",
    "teacher.md",
    "scan.md",
    "gpu.md",
    "diagnostic.md",
    "kinetic.md",
    "closed.md",
    "theory_closed.md",
    "protocols.md",
    "numerics.md",
)
"""Pages with code that takes long."""


@pytest.mark.parametrize("page", timed(page for page in PAGES if blocks(page)))
def test_the_python_of_the_pages_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in blocks(page):
        exec(compile(block.replace("t_end=200.0", "t_end=2.0"), page.name, "exec"), {})


def cells(page):
    return re.findall(r"```\{code-cell\}\n(?::.*\n|\n)*(.*?)```", page.read_text(), re.DOTALL)


# The gallery's cells only call scripts, which tests/test_gallery.py does.
EXECUTED = [page for page in SITE if cells(page) and page.parent.name != "gallery"]
SMALLER = {
    "n_theta=64, n_z=64": "n_theta=32, n_z=32",
    '"n_theta": 48, "n_z": 48': '"n_theta": 16, "n_z": 16',
    "t_end=60.0": "t_end=2.0",
    "--t-end 60": "--t-end 2",
}
"""What makes the cells of pages quick; as they are, `make docs` runs them."""


@pytest.mark.filterwarnings("ignore:the mean line of the flow:UserWarning")  # which a page is about
@pytest.mark.parametrize("page", timed(EXECUTED))
@pytest.mark.slow
def test_the_cells_of_the_pages_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    names = {}
    for cell in cells(page):
        for large, small in SMALLER.items():
            cell = cell.replace(large, small)
        if cell.startswith("%%bash\n"):
            shell(cell.removeprefix("%%bash\n"))
        else:
            exec(compile(cell, page.name, "exec"), names)


def shell(text):
    """Do what a cell tells the shell; commands of cyclosis alone are called in this process."""
    lines = text.splitlines()
    if all(line.startswith("cyclosis ") for line in lines):
        for line in lines:
            code, _, errors = said(*shlex.split(line)[1:])
            assert code == 0, errors
    else:
        subprocess.run(["bash", "-e", "-c", text], check=True, capture_output=True)


def commands(page):
    """The lines of the command line that stand in a page, alone or in running text."""
    text = page.read_text().replace("\\\n", " ")
    alone = re.findall(r"^ *(cyclosis (?!is\b|as\b)[a-z].*)$", text, re.MULTILINE)
    running = [re.sub(r"\s+", " ", told) for told in re.findall(r"`(cyclosis [^`]*)`", text)]
    for line in alone + running:
        line = re.split(r" {2,}#| # ", line)[0].strip()
        if not re.search(r"\.\.\.| \| ", line):
            yield line


def parsed(line):
    """Parse a command as the shell would have it parsed, without doing anything."""
    words = shlex.split(line)[1:]
    command, context = WHOLE, None
    while hasattr(command, "commands") and words and not words[0].startswith("-"):
        assert words[0] in command.commands, f"{line}: there is no {words[0]}"
        context = command.make_context(words[0], [], parent=context, resilient_parsing=True)
        command = command.commands[words.pop(0)]
    if not words or words == ["--help"]:
        return
    parser = command.make_parser(command.context_class(command, parent=context))
    _, rest, _ = parser.parse_args(args=list(words))
    assert not rest or command.allow_extra_args, f"{line}: {rest} is left over"


LINES = sorted({(named(page), line) for page in PAGES for line in commands(page)})


@pytest.mark.parametrize(("page", "line"), LINES, ids=[f"{page}: {line}" for page, line in LINES])
def test_the_commands_of_the_pages_parse(page, line):
    parsed(line)


def test_a_wrong_command_does_not_parse():
    for line in ("cyclosis walk", "cyclosis run --alpha-q 1", "cyclosis info a.nc b.nc"):
        with pytest.raises(Exception, match=r"walk|alpha-q|b\.nc"):
            parsed(line)
