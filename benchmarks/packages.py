"""Whether the packages that are given out install and work, on every Python that is here.

python benchmarks/packages.py [--pythons python3.11 python3.12 ...] [--lowest]

An sdist is built, a wheel from that sdist, and the wheel goes into a clean environment of each Python, where
no compiler and no Node.js can be found and nothing may be built. There the six lines of the README are run,
then `cyclosis run`, and the explorer is asked for its page. With --lowest the lowest versions of all
that the project names are installed, on the first Python.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).parents[1]
PYTHONS = ("python3.11", "python3.12", "python3.13", "python3.14")


def run(command: list[str | Path], **options: object) -> str:
    """Run a command; return what it prints, or end with what it complained of."""
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done.stdout


def environment(python: str | Path, folder: Path) -> Path:
    """Make a clean environment; return its folder of commands."""
    run([python, "-m", "venv", folder])
    return folder / "bin"


def packages(folder: Path, python: str) -> Path:
    """Build the sdist from the tree and the wheel from the sdist; return the wheel."""
    tools = environment(python, folder / "tools")
    run([tools / "python", "-m", "pip", "install", "-q", "build"])
    run([tools / "python", "-m", "build", "-o", folder, ROOT])  # the wheel is built from the sdist
    wheel = next(folder.glob("*.whl"))
    sdist = next(folder.glob("*.tar.gz"))
    for file in (sdist, wheel):
        print(f"{file.name}: {file.stat().st_size / 2**20:.1f} MiB", flush=True)
    return wheel


def lowest(wheel: Path, python: str, folder: Path) -> list[str]:
    """Return the lowest versions that the project allows of what it names itself."""
    tools = environment(python, folder / "resolver")
    run([tools / "python", "-m", "pip", "install", "-q", "uv"])
    version = run([python, "-c", "import sys; print('.'.join(map(str, sys.version_info[:2])))"]).strip()
    command = [
        tools / "uv",
        "pip",
        "compile",
        "-q",
        "--no-header",
        "--no-annotate",
        "--python-version",
        version,
    ]
    pins = run([*command, "--resolution", "lowest-direct", ROOT / "pyproject.toml"])
    return [line for line in pins.splitlines() if line and not line.startswith("#")]


def seconds(command: list[str | Path], env: dict[str, str]) -> float:
    """Return the quickest of five runs: what the machine does beside them does not count."""
    times = []
    for _ in range(5):
        began = time.perf_counter()
        run(command, env=env)
        times.append(time.perf_counter() - began)
    return min(times)


def smoke(tools: Path, folder: Path) -> str:
    """Use an installed package as a new user does; return what was measured."""
    env = {"PATH": str(tools), "HOME": str(folder), "OPENBLAS_NUM_THREADS": "1"}
    folder = Path(tempfile.mkdtemp(dir=folder))
    for tool in ("cc", "gcc", "node", "npm"):
        assert shutil.which(tool, path=str(tools)) is None
    start = re.search(r"```python\n(import cyclosis.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    code = start.group(1).replace("t_end=200.0", "t_end=20.0")
    said = run([tools / "python", "-c", code], cwd=folder, env=env)
    assert said.strip(), "the six lines print a regime"
    file = folder / "run.nc"
    settings = ["--n-theta", "16", "--n-z", "16", "--t-end", "1", "--quiet"]
    run([tools / "cyclosis", "run", *settings, "--out", file], cwd=folder, env=env)
    assert file.stat().st_size > 1000
    about = explorer(tools, folder, env)
    bare = seconds([tools / "python", "-c", "pass"], env)
    quick = seconds([tools / "python", "-c", "import cyclosis"], env) - bare
    helps = seconds([tools / "cyclosis", "--help"], env)
    return f"import {quick:.2f} s, --help {helps:.2f} s, page {about}"


def explorer(tools: Path, folder: Path, env: dict[str, str]) -> str:
    """Start the explorer and return how large its page is."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [tools / "cyclosis", "explore", "--no-browser", "--port", str(port)]
    server = subprocess.Popen(command, cwd=folder, env=env, stdout=subprocess.DEVNULL)
    try:
        for _ in range(300):
            if server.poll() is not None:
                sys.exit("the explorer did not start")
            try:
                page = urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=5).read().decode()
                break
            except OSError:
                time.sleep(0.1)
        script = re.search(r'src="\.?/?(assets/[^"]+\.js)"', page).group(1)
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/{script}", timeout=5) as answer:
            return f"{len(answer.read()) / 1000:.0f} kB"
    finally:
        server.terminate()
        server.wait(20)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pythons", nargs="+", default=PYTHONS)
    parser.add_argument("--lowest", action="store_true", help="with the lowest versions allowed")
    given = parser.parse_args()
    here = []
    for python in given.pythons:
        found = shutil.which(python)
        works = found and subprocess.run([found, "-c", ""], capture_output=True).returncode == 0
        if works:
            here.append(found)
        else:
            print(f"{python}: not here, not tried", flush=True)
    if not here:
        parser.error("none of these Pythons is here")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        wheel = packages(folder, here[0])
        for python in here[:1] if given.lowest else here:
            tools = environment(python, folder / Path(python).name)
            pins = lowest(wheel, python, folder) if given.lowest else []
            pip = [tools / "python", "-m", "pip", "install", "-q", "--only-binary", ":all:"]
            run([*pip, wheel, *pins], env=os.environ | {"PATH": str(tools)})
            version = run([tools / "python", "-V"]).strip()
            print(
                f"{version}{' with the lowest versions' * given.lowest}: {smoke(tools, folder)}", flush=True
            )
            shutil.rmtree(folder / Path(python).name)


if __name__ == "__main__":
    main()
