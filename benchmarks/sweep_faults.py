"""Kill sweeps at random moments, finish them, and compare every bit with one that was left in peace.

    python benchmarks/sweep_faults.py                   # 100 rounds with made-up blocks
    python benchmarks/sweep_faults.py --rounds 10 --real

In each round one to three blows fall: SIGKILL for a worker, for the client, or for everything at once, half
of them at any moment from the start of the client to the end of the sweep, half of them while blocks are
being written. Afterwards the sweep is finished, all blocks are verified, nothing may be set aside or left
over, and all variables but `seconds` must have the same bits. Exits with 1 if any round went wrong.
"""

from __future__ import annotations

import argparse
import random
import statistics
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cyclosis.sweep.store.store import Store
from measure.faults import KINDS, Blow, Round, disturbed, made_up_command, real_command, start


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--real", action="store_true", help="compute real members by cyclosis sweep run")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        command = real_command(Path(folder)) if arguments.real else made_up_command(0.4)
        rounds = list(strike(Path(folder), command, arguments.rounds, random.Random(arguments.seed)))
    struck = Counter(blow.kind for blows, _ in rounds for blow in blows)
    wrong = [found.wrong for _, found in rounds if found.wrong]
    stood = [count for _, found in rounds for count in found.standing]
    outlived = [found.outlived for _, found in rounds]
    print(f"\n| rounds | blows at {' / '.join(KINDS)} | blocks standing then | orphans, longest | wrong |")
    print("|---:|---:|---:|---:|---:|")
    blows = " / ".join(str(struck[kind]) for kind in KINDS)
    few, median, most = min(stood), statistics.median(stood), max(stood)
    print(
        f"| {len(rounds)} | {blows} | {few} to {most}, median {median:g} | "
        f"{max(outlived):.2f} s | {len(wrong)} |"
    )
    sys.exit(bool(wrong))


def strike(
    folder: Path, command: list[str], count: int, rng: random.Random
) -> list[tuple[list[Blow], Round]]:
    """Compute one sweep in peace, then disturb it `count` times."""
    straight = folder / "straight"
    for store in (straight, folder / "timed"):  # the second finds all programs compiled
        began = time.monotonic()
        process = start(command, store)
        _, said = process.communicate()
        if process.returncode != 0:
            sys.exit(f"the undisturbed sweep fails: {said}")
    longest, blocks = time.monotonic() - began, len(Store(straight).present())
    print(f"undisturbed: {longest:.1f} s")
    out = []
    for number in range(count):
        blows = []
        for _ in range(rng.randint(1, 3)):
            kind, by_time = rng.choice(KINDS), rng.random() < 0.5
            blows.append(
                Blow(kind, seconds=rng.uniform(0.1, 1.0) * longest)
                if by_time
                else Blow(kind, blocks=rng.randrange(1, blocks))
            )
        found = disturbed(command, straight, folder / f"round-{number}", blows, rng)
        told = ", ".join(
            f"{blow.kind} at " + (f"block {blow.blocks}" if blow.blocks else f"{blow.seconds:.1f} s")
            for blow in blows
        )
        stood = ", ".join(map(str, found.standing))
        print(f"{number:3d}  {told:<50} {stood:>10} blocks  {found.wrong or 'the same'}", flush=True)
        out.append((blows, found))
    return out


if __name__ == "__main__":
    main()
