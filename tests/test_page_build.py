"""The build hook makes the explorer's page where it can, and never fails where it cannot."""

import importlib.util
import os
from pathlib import Path

import pytest

pytest.importorskip("hatchling")
if not (FILE := Path(__file__).parents[1] / "hatch_build.py").is_file():
    pytest.skip("not in a checkout", allow_module_level=True)
SPEC = importlib.util.spec_from_file_location("hatch_build", FILE)
hook = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(hook)

BUILDS = 'echo "$*" >> calls; case "$1" in run) mkdir -p ../{page}; echo new > ../{page}/index.html;; esac'


class App:
    def __init__(self):
        self.warnings = []

    def display_warning(self, text):
        self.warnings.append(text)


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project with sources of a page, where no command is found and nothing is fetched."""
    (tmp_path / "web" / "src").mkdir(parents=True)
    for name in ("package-lock.json", "src/main.ts"):
        (tmp_path / "web" / name).write_text("{}")
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.delenv("CYCLOSIS_PAGE", raising=False)
    monkeypatch.setattr(hook, "packaged_npm", lambda folder: [])
    return tmp_path


def command(project, name, script):
    file = project / "bin" / name
    file.write_text(f"#!/bin/sh\nPATH=/usr/bin:/bin\n{script}\n")
    file.chmod(0o755)


def node(project, version="v22.12.0", npm=BUILDS):
    command(project, "node", f"echo {version}")
    command(project, "npm", npm.replace("{page}", hook.PAGE.as_posix()))


def page(project, age=0.0):
    file = project / hook.PAGE / "index.html"
    file.parent.mkdir(parents=True)
    file.write_text("old")
    when = (project / "web" / "src" / "main.ts").stat().st_mtime - age
    os.utime(file, (when, when))
    return file


def warned(project):
    app = App()
    hook.CustomBuildHook(str(project), {}, None, None, str(project), "wheel", app).initialize("standard", {})
    for text in app.warnings:
        assert text.count("The explorer's page") == 1
        assert "install Node.js 20.19 or newer, then run `make page`" in text
    return app.warnings


def calls(project):
    file = project / "web" / "calls"
    return file.read_text().splitlines() if file.exists() else []


def test_a_missing_page_is_built(project):
    node(project)
    assert not warned(project)
    assert (project / hook.PAGE / "index.html").read_text() == "new\n"
    assert [line.split()[0] for line in calls(project)] == ["ci", "run"]


@pytest.mark.parametrize("age", [0.0, -5.0])
def test_a_fresh_page_is_left_alone(project, age):
    node(project)
    file = page(project, age)
    assert not warned(project)
    assert (file.read_text(), calls(project)) == ("old", [])


def test_a_page_older_than_its_sources_is_built_anew(project):
    node(project)
    file = page(project, age=5.0)
    assert not warned(project)
    assert file.read_text() == "new\n"


def test_tests_and_installed_packages_are_no_sources(project):
    page(project)
    for folder in ("tests", "node_modules"):
        (project / "web" / folder).mkdir()
        (project / "web" / folder / "new.ts").write_text("")
        later = (project / "web" / "src" / "main.ts").stat().st_mtime + 9
        os.utime(project / "web" / folder / "new.ts", (later, later))
    assert hook.fresh(project)


def test_the_page_of_a_source_distribution_is_used_whatever_its_time(project):
    page(project, age=5.0)
    (project / "PKG-INFO").write_text("Name: cyclosis")
    assert not warned(project)


def test_without_node_it_warns_and_goes_on(project):
    (text,) = warned(project)
    assert "there is no Node.js" in text
    assert "is not there" in text


def test_a_stale_page_stays_where_it_cannot_be_built(project):
    file = page(project, age=5.0)
    (text,) = warned(project)
    assert "is older than its sources" in text
    assert file.read_text() == "old"


@pytest.mark.parametrize("version", ["v20.18.3", "v18.0.0", "nonsense"])
def test_a_node_that_is_too_old_is_not_used(project, version):
    node(project, version)
    (text,) = warned(project)
    assert "too old" in text
    assert not calls(project)


@pytest.mark.parametrize("version", ["v20.19.0", "v24.1.0"])
def test_a_node_that_is_new_enough_is_used(project, version):
    node(project, version)
    assert not warned(project)


@pytest.mark.parametrize(
    ("npm", "words"),
    [
        ("echo before; echo Error: no registry >&2; exit 1", "npm ci failed: Error: no registry"),
        ('case "$1" in run) echo "x.ts(1,1): error TS1005";  exit 2;; esac', "npm run build failed: x.ts"),
        ("exit 0", "npm run build left no page"),
    ],
)
def test_a_failing_npm_is_told_and_survived(project, npm, words):
    node(project, npm=npm)
    (text,) = warned(project)
    assert words in text


def test_an_npm_without_end_is_stopped(project, monkeypatch):
    monkeypatch.setattr(hook, "NPM_SECONDS", 0.2)
    node(project, npm="exec sleep 20")
    (text,) = warned(project)
    assert "no end after 0.2 s" in text


def test_any_other_mistake_is_survived(project, monkeypatch):
    monkeypatch.setattr(hook, "make_page", lambda root: 1 / 0)
    (text,) = warned(project)
    assert "ZeroDivisionError" in text


def test_skip_leaves_the_page_alone(project, monkeypatch):
    node(project)
    monkeypatch.setenv("CYCLOSIS_PAGE", "skip")
    assert not warned(project)
    assert not calls(project)


def test_the_lock_file_names_no_registry_but_the_public_one():
    lock = FILE.parent / "web" / "package-lock.json"
    if not lock.is_file():
        pytest.skip("no sources of the page here")
    addresses = [line.split('"')[3] for line in lock.read_text().splitlines() if '"resolved":' in line]
    assert all(each.startswith("https://registry.npmjs.org/") for each in addresses)
