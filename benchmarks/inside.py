"""What the flow inside the cell costs the explorer's server: the visitor who asked for it, and another.

    python benchmarks/inside.py              # 64 x 64 points
    python benchmarks/inside.py --points 128

One visitor plays at the usual pace, then at full speed, each without and with the switch, while another plays
a 64 x 64 cell at the usual pace. Processor time is that of the whole server, per picture that
either visitor received. Before, one message is made by itself.
"""

from __future__ import annotations

import argparse
import json
import struct
import threading
import time

import numpy as np
import psutil
from clients import PLAY, ask, visit
from hostile import server

import cyclosis as cy
from cyclosis.explorer.inside import Seen, Tracers


class Watcher(threading.Thread):
    """A visitor who plays a cell; counts pictures and messages of the inside, and the time reached."""

    def __init__(self, port: int, points: int, speed: float, inside: bool) -> None:
        super().__init__(daemon=True)
        self.port, self.points, self.speed, self.inside = port, points, speed, inside
        self.pictures, self.told, self.t, self.gaps = 0, 0, 0.0, [0.0]
        self.begun, self.enough = threading.Event(), threading.Event()

    def run(self) -> None:
        """Play until it is enough."""
        with visit(self.port) as wire:
            ask(wire, do="begin", setup={"grid": {"n_theta": self.points, "n_z": self.points}})
            ask(wire, do="speed", value=self.speed)
            ask(wire, **PLAY)
            if self.inside:
                ask(wire, do="vacuole", on=True)
            seen = time.monotonic()
            while not self.enough.is_set():
                message = wire.recv(60)
                if isinstance(message, str):
                    if json.loads(message)["type"] == "alive":
                        ask(wire, do="alive")
                    continue
                size, kind = struct.unpack("<II", message[:8])
                if kind:
                    self.told += 1
                    continue
                self.t = json.loads(message[8 : 8 + size])["t"]
                self.pictures += 1
                now = time.monotonic()
                self.gaps.append(now - seen)
                seen = now
                ask(wire, do="seen", frame=0)
                if self.pictures > 20:
                    self.begun.set()


def alone(points: int) -> str:
    """Return what one message takes of the processor, and its size."""
    grid = cy.CylinderGrid(points, points)
    u = np.asarray(cy.flow(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0)))
    tracers, spent = Tracers(grid, 600, 0.6), []
    for _ in range(8):
        began = time.process_time()
        data = tracers.message(Seen(u, grid, 0.0, 1, True), 0.12)
        spent.append(time.process_time() - began)
    first, others = 1e3 * spent[0], 1e3 * min(spent[1:])
    size = f"{len(data) / 1e3:.1f} kB on {points} x {points} points"
    return f"a message of 600 tracers: {size}, {others:.1f} ms, the first {first:.0f} ms"


def measured(
    port: int, process: psutil.Process, points: int, speed: float, inside: bool, seconds: float
) -> str:
    """Return a row of the table."""
    one, other = Watcher(port, points, speed, inside), Watcher(port, 64, 5.0, False)
    for each in (one, other):
        each.start()
    for each in (one, other):
        each.begun.wait(120)
    before = one.pictures, other.pictures, one.told, one.t, len(other.gaps)
    busy, began = sum(process.cpu_times()[:2]), time.monotonic()
    time.sleep(seconds)
    busy, spent = sum(process.cpu_times()[:2]) - busy, time.monotonic() - began
    pictures, others, told, t = (
        one.pictures - before[0],
        other.pictures - before[1],
        one.told - before[2],
        one.t - before[3],
    )
    longest = max(other.gaps[before[4] :], default=float("inf"))
    for each in (one, other):
        each.enough.set()
        each.join(30)
    figures = (pictures / spent, told / spent, t / spent, 1e3 * busy / max(1, pictures + others))
    row = " | ".join(f"{figure:.1f}" for figure in figures)
    return f"| {speed:g} | {'on' if inside else 'off'} | {row} | {others / spent:.1f} | {1e3 * longest:.0f} |"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    print(alone(given.points) + "\n")
    print(
        "| speed | switch | pictures/s | tracers/s | time units/s | processor, ms a picture"
        " | other's pictures/s | other's longest wait, ms |"
    )
    print("|---:|---|---:|---:|---:|---:|---:|---:|", flush=True)
    with server() as (port, process):
        for speed in (5.0, 100.0):
            for inside in (False, True):
                print(measured(port, process, given.points, speed, inside, given.seconds), flush=True)


if __name__ == "__main__":
    main()
