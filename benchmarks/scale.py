"""What large tasks would cost, from small ones: kinetic sweeps, transport at high Pe, fits of films.

    python benchmarks/scale.py kinetic      # processor time and memory of a member; a minute
    python benchmarks/scale.py transport    # which Péclet numbers the vacuole's solvers resolve; some minutes
    python benchmarks/scale.py fits         # processor time and memory of a fit by `equation`; a minute

One core: OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1. Seconds are of the processor. The first call of a kind
compiles, the second does not; both are printed, since each worker of a sweep has a first one.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from typing import Any

import numpy as np

import cyclosis as cy

CELLS = {"ring": (36, 1, 40), "whole cell": (32, 32, 48)}
"""Points around and along, and modes, of the kinetic members of the experiment closure."""
T_END = 20.0


def spent(call: Any) -> tuple[float, Any]:
    """Return the processor time of a call, and what it returned."""
    began = time.process_time()
    found = call()
    return time.process_time() - began, found


def peak() -> float:
    """Return the largest memory of this process so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10


def members(cell: str, lanes: int) -> None:
    """Print as JSON what kinetic members of one kind cost, in a process of their own."""
    from functools import partial

    from cyclosis.ensemble import EnsembleSettings, Member, follow

    n_theta, n_z, modes = CELLS[cell]
    grid, params, loaded = cy.CylinderGrid(n_theta, n_z), cy.Parameters(), peak()
    model = cy.models.kinetic_model(modes=modes)

    def batch(first: int) -> list[Any]:
        start = [partial(cy.kinetic.disordered, grid, seed=first + k, modes=modes) for k in range(lanes)]
        how = EnsembleSettings(t_end=T_END, finish="t_end", rtol=1e-3, lanes=lanes)
        return list(follow([Member(params, grid, each, model=model) for each in start], how))

    first, _ = spent(lambda: batch(0))
    again, found = spent(lambda: batch(lanes))
    work = sum(one.evaluations for one in found)
    print(json.dumps([first, again / lanes, 1e3 * again / work, peak() - loaded]))


def kinetic() -> None:
    print("| member | lanes | first batch, s | a member, s | a right-hand side, ms | memory above, MiB |")
    print("|---|---:|---:|---:|---:|---:|")
    for cell, lanes in (("ring", 1), ("ring", 10), ("whole cell", 1)):
        command = [sys.executable, __file__, "members", "--cell", cell, "--lanes", str(lanes)]
        out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        first, each, evaluation, memory = json.loads(out.splitlines()[-1])
        told = f"{first:.1f} | {each:.2f} | {evaluation:.2f} | {memory:.0f}"
        print(f"| {cell}, to t = {T_END:g} | {lanes} | {told} |", flush=True)


def refused(call: Any) -> tuple[str, float]:
    """Return the result of a call in words, and its processor time."""

    def told() -> str:
        try:
            return f"{call():.6g}"
        except cy.InputError as error:
            return "refused: " + str(error).split(" must be ")[-1].split(";")[0]

    seconds, words = spent(told)
    return words, seconds


def transport() -> None:
    grid = cy.CylinderGrid(32, 32, 5.0)
    profile = np.asarray(cy.stability.cyclosis(cy.Parameters()).u)
    straight, twisted = (
        cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, profile, pitch)) for pitch in (np.inf, 5.0)
    )
    q = 2 * np.pi / 5
    kinds = {
        "exchange, straight": lambda pe: cy.vacuole.band_exchange(straight, pe, q),
        "uptake, pitch 5 R": lambda pe: cy.vacuole.uptake(twisted, pe),
        "mixing, pitch 5 R": lambda pe: cy.vacuole.mixing_rate(twisted, pe),
        "dispersion, pitch 5 R": lambda pe: cy.vacuole.dispersion(twisted, pe).coefficient,
    }
    print(
        "| by modes | " + " | ".join(f"Pe = {pe:g}" for pe in PECLETS) + " |\n|---|" + "---:|" * len(PECLETS)
    )
    for name, call in kinds.items():
        cells = [refused(lambda pe=pe, call=call: call(pe)) for pe in PECLETS]
        print(f"| {name} | " + " | ".join(f"{told} ({s:.1f} s)" for told, s in cells) + " |", flush=True)
    print(
        "\n| in time, points | Pe | an R/U, s | shortest waves' share of <c²> at t = 5 | memory so far, MiB |"
    )
    print("|---|---:|---:|---:|---:|")
    for n, n_r in SIZES:

        def carried(pe: float, t_end: float, n: int = n, n_r: int = n_r) -> Any:
            wall = cy.vacuole.Absorbing()
            times = [0.0, t_end]
            return cy.vacuole.transport(twisted, pe, wall, t_end=t_end, n_r=n_r, shape=(n, n), times=times)

        carried(PECLETS[0], 0.2)  # compiles
        for pe in PECLETS:
            seconds, run = spent(lambda pe=pe, carried=carried: carried(pe, 5.0))
            told = f"{seconds / 5:.2f} | {run.unresolved[-1]:.1e} | {peak():.0f}"
            print(f"| {n} x {n} x {n_r} | {pe:g} | {told} |", flush=True)


PECLETS = (1e3, 1e4, 1e5)
SIZES = ((24, 16), (32, 24), (48, 32), (96, 64))


def fits() -> None:
    grid = cy.CylinderGrid(64, 64)
    films = []
    for seed in range(3):
        start = cy.initial.disordered(grid, seed=seed)
        times = [round(1 + 0.25 * k, 9) for k in range(117)]
        run = cy.simulate(cy.Parameters(), grid, start, t_end=times[-1], save_at=times)
        data = run.to_dataset()[["P", "u"]]
        data = data.isel(theta=np.abs(data["theta"].values - np.pi) <= np.radians(70))
        rng = np.random.default_rng(seed)
        films.append(data.map(lambda f, rng=rng: f + 0.03 * rng.normal(size=f.shape), keep_attrs=True))
    size = sum(films[0][name].nbytes for name in ("P", "u"))
    before = peak()
    for k, film in enumerate(films):
        seconds, fit = spent(lambda film=film: cy.fit(film, method="equation"))
        told = fit.refused or f"alpha_p = {fit.estimate['alpha_p']:.3f}"
        print(f"film {k + 1} of 117 frames, {size / 1e6:.1f} MB: {seconds:.1f} s, {told}", flush=True)
    print(f"memory of the fits above that of making the films: {peak() - before:.0f} MiB")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=["kinetic", "members", "transport", "fits"])
    parser.add_argument("--cell", choices=list(CELLS), default="ring")
    parser.add_argument("--lanes", type=int, default=1)
    given = parser.parse_args()
    if given.what == "members":
        members(given.cell, given.lanes)
    else:
        {"kinetic": kinetic, "transport": transport, "fits": fits}[given.what]()


if __name__ == "__main__":
    main()
