"""What hostile clients cost the other visitors of the explorer, and its server's memory.

    python benchmarks/hostile.py              # every attack
    python benchmarks/hostile.py pings crowd  # some

A real server is started, and each attack runs against it from a process of its own for --seconds. Meanwhile
one visitor plays a 64 x 64 cell and moves a slider; its longest wait is that for an answer to its own action
or from one picture to the next: for ever, if it is cut off. Memory is that of the server's process, at its
most, above that before. The exit status is 1 if a wait was longer than a second.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import multiprocessing
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import psutil
from attacks import ATTACKS
from clients import BEGIN, GONE, PLAY, ask, get, visit

LONGEST = 1.0
"""What another visitor may wait, in seconds."""


@contextlib.contextmanager
def server() -> Iterator[tuple[int, psutil.Process]]:
    """Start the explorer on a free port; yield the port and the process."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "cyclosis", "explore", "--no-browser", "--no-ahead", "--port", str(port)]
    one_thread = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    started = subprocess.Popen(command, env=one_thread, stdout=subprocess.DEVNULL)
    try:
        while get(port, "/api/about")[0] != 200:
            time.sleep(0.2)
        yield port, psutil.Process(started.pid)
    finally:
        started.terminate()
        started.wait(20)


class Visitor(threading.Thread):
    """One who plays a cell and moves a slider, and notes its longest wait in seconds."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self.port, self.longest, self.actions, self.pictures = port, 0.0, 0, 0
        self.playing, self.enough = threading.Event(), threading.Event()

    def run(self) -> None:
        """Play until it is enough."""
        try:
            while not self.playing.is_set() and not self.enough.wait(0.1):
                with contextlib.suppress(*GONE):  # all places are taken as yet
                    self.play()
        finally:
            if not self.enough.is_set():
                self.longest = math.inf

    def play(self) -> None:
        """Play for one visit."""
        with visit(self.port) as wire:
            for words in (BEGIN, PLAY, {"do": "change", "values": {"alpha_u": 0.3}}):
                ask(wire, **words)
            acted, seen = 0.0, time.monotonic()
            while not self.enough.is_set():
                now = time.monotonic()
                if not acted and now - seen < 0.1:
                    self.actions, acted = self.actions + 1, now
                    ask(wire, do="change", values={"alpha_u": 0.3 + 0.4 * (self.actions % 2)})
                    if self.actions % 500 == 0:  # a protocol has an end
                        ask(wire, **BEGIN)
                        ask(wire, **PLAY)
                message = wire.recv(30)
                now = time.monotonic()
                if isinstance(message, bytes):
                    self.longest, seen = max(self.longest, now - seen), now
                    self.pictures += 1
                    ask(wire, do="seen", frame=0)
                elif (kind := json.loads(message)["type"]) == "alive":
                    ask(wire, do="alive")
                elif kind == "cell" and acted:
                    self.longest, acted = max(self.longest, now - acted), 0.0
                if self.pictures > 20 and not self.playing.is_set():
                    self.longest = 0.0
                    self.playing.set()


def attacked(name: str, port: int, seconds: float, answers: multiprocessing.Queue[str]) -> None:
    """Put what an attack was answered into a queue; "none" attacks nothing."""
    if name == "none":
        time.sleep(seconds)
    answers.put(ATTACKS[name](port, seconds) if name in ATTACKS else "")


def under(name: str, port: int, process: psutil.Process, seconds: float) -> tuple[str, float, float]:
    """Let an attack run; return its answers, the good visitor's longest wait, and memory's growth, MiB."""
    good = Visitor(port)
    good.start()
    if not good.playing.wait(60):
        good.enough.set()
        raise SystemExit(f"nobody can play before {name}")
    before = most = process.memory_info().rss
    processes = multiprocessing.get_context("spawn")  # a copy of this process would hold its threads' locks
    answers: multiprocessing.Queue[str] = processes.Queue()
    attacker = processes.Process(target=attacked, args=(name, port, seconds, answers))
    attacker.start()
    while attacker.is_alive():
        most = max(most, process.memory_info().rss)
        time.sleep(0.05)
    good.enough.set()
    good.join(60)
    return answers.get(timeout=10), good.longest, (most - before) / 2**20


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("attacks", nargs="*", metavar="attack", help=f"any of {', '.join(ATTACKS)}")
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    if unknown := set(given.attacks) - set(ATTACKS):
        parser.error(f"no attack {', '.join(sorted(unknown))}: choose from {', '.join(ATTACKS)}")
    slow = []
    print("| attack | answers | longest wait, s | memory, MiB |\n|---|---|---:|---:|", flush=True)
    with server() as (port, process):
        for name in ["none", *(given.attacks or ATTACKS)]:
            answer, wait, growth = under(name, port, process, given.seconds)
            print(f"| {name} | {answer} | {wait:.2f} | {growth:.0f} |", flush=True)
            if wait > LONGEST:
                slow.append(name)
    if slow:
        raise SystemExit(f"another visitor waited for more than {LONGEST:g} s under {', '.join(slow)}")


if __name__ == "__main__":
    main()
