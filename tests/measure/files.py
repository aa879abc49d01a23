"""Every data variable of two files, bit by bit; and runs that are killed at random moments."""

from __future__ import annotations

import random
import subprocess
import sys
import time
from pathlib import Path

import h5netcdf
import numpy as np

from cyclosis.dataset import parts

COMMAND = [sys.executable, "-m", "cyclosis"]
TEXT = (
    "--n-theta 32 --n-z 24 --d-s 0.1 --t-end 30 --save-every 2 --stepper etdrk4 --dt 0.02 "
    "--filaments-per-square 100 --quiet"
)
SETTINGS = TEXT.split()


def everything(path: Path) -> dict[str, np.ndarray]:
    """Return all variables of a file, those of the restart included."""
    with h5netcdf.File(path, "r") as file:
        out = {name: np.asarray(v[...]) for name, v in file.variables.items()}
        return out | {f"restart/{n}": np.asarray(v[...]) for n, v in file.groups["restart"].variables.items()}


def differences(a: Path, b: Path) -> list[str]:
    """Return the names of variables that are not bitwise the same in two files."""
    first, second = everything(a), everything(b)
    out = sorted(set(first) ^ set(second))
    for name in sorted(set(first) & set(second)):
        x, y = first[name], second[name]
        same = x.shape == y.shape and x.dtype == y.dtype
        if not same or (x.tolist() != y.tolist() if x.dtype == object else x.tobytes() != y.tobytes()):
            out.append(name)
    return out


def started(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """Start a command of cyclosis."""
    command, pipe = [*COMMAND, *arguments], subprocess.PIPE
    return subprocess.Popen(command, cwd=folder, stdout=pipe, stderr=pipe, text=True)


def wait_for_parts(process: subprocess.Popen[str], target: Path, count: int = 3) -> None:
    """Wait until a run that has been started has saved some parts."""
    while len(parts.stored(target)) < count:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)


def call(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command of cyclosis to its end."""
    return subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
    )


def killed_round(folder: Path, number: int, seconds: float) -> str:
    """Kill a run after some time, and the resumed run once more; return what is wrong in the end, or nothing.

    `folder` holds `straight.nc`, the same run undisturbed.
    """
    target = folder / f"killed-{number}.nc"
    start = ["run", *SETTINGS, "--out", target.name, "--checkpoint-seconds", "0"]
    for arguments in (start, ["resume", target.name, "--quiet", "--checkpoint-seconds", "0"]):
        if arguments is not start and not _stands(target):
            break  # killed before anything was written: there is nothing to resume
        process = started(folder, *arguments)
        time.sleep(seconds)
        process.kill()
        process.communicate()
        if _stands(target):
            info = call(folder, "info", target.name)
            if info.returncode != 0:
                return f"after {seconds:.2f} s the file does not open: {info.stderr}"
    if _stands(target):
        finish = call(folder, "resume", target.name, "--quiet")
        complete = "later than the time reached" in finish.stderr
    else:
        finish = call(folder, "run", *SETTINGS, "--out", target.name)
        complete = False
    if finish.returncode != 0 and not complete:
        return f"after {seconds:.2f} s the run does not go on: {finish.stderr}"
    wrong = differences(folder / "straight.nc", target)
    target.unlink()
    return f"after {seconds:.2f} s these differ: {wrong}" if wrong else ""


def _stands(target: Path) -> bool:
    return target.exists() or bool(parts.stored(target))


def killing(folder: Path, rounds: int, seed: int = 0) -> list[str]:
    """Kill and resume a run `rounds` times at random moments; return what went wrong."""
    straight = call(folder, "run", *SETTINGS, "--out", "straight.nc")
    if straight.returncode != 0:
        return [straight.stderr]
    began = time.perf_counter()
    call(folder, "run", *SETTINGS, "--out", "timed.nc", "--checkpoint-seconds", "0")
    longest = time.perf_counter() - began
    rng = random.Random(seed)
    wrong = (killed_round(folder, number, rng.uniform(0.2, 1.0) * longest) for number in range(rounds))
    return [text for text in wrong if text]
