"""What must stay bit for bit the same when code is rearranged: runs, files, blocks, members and links.

Each case returns arrays by name, computed through public names, or through the narrowest inner one.
"""

import hashlib
import itertools
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, follow
from cyclosis.explorer import setup
from cyclosis.sweep.plan.sweep import Sweep
from cyclosis.sweep.store import block
from cyclosis.sweep.store import block_file as packed

GRID = cy.CylinderGrid(24, 20, 3.0)
PARAMS = cy.Parameters(alpha_p=1.0, alpha_u=0.5, d_s=0.06)


def kept(run):
    """Return what a run has found."""
    records = {f"record {name}": values for name, values in run.records.items()}
    events = {f"event {k}": event.after for k, event in enumerate(run.interventions)}
    steps = np.array([run.effort.evaluations, run.effort.accepted, run.effort.rejected])
    return {"state": run.final_state, "times": run.times, "steps": steps, **records, **events}


def simulated(t_end=6.0, **settings):
    settings = {"save_every": 2.0} | settings
    return kept(cy.simulate(PARAMS, GRID, cy.initial.disordered(GRID, seed=3), t_end=t_end, **settings))


def protocol():
    return cy.Protocol(
        cy.change(at=1.0, over=1.5, alpha_u=0.2, mu=0.1),
        cy.fragment(at=2.0, where=cy.regions.disc(theta=3.1, z=1.5, radius=0.6)),
        cy.change(at=3.0, kappa=0.1, where=cy.regions.band("z", 0.0, 1.0)),
        cy.wash_out(at=4.0, over=1.0),
        seed=5,
    )


def steady():
    params, grid = cy.Parameters(alpha_p=1.0, d_r=0.025), cy.CylinderGrid(16, 16)
    start = cy.initial.unidirectional(grid, 0.5)
    return kept(cy.simulate(params, grid, start, t_end=200.0, save_every=20.0, steady_rate=1e-6))


def file():
    """Return the bytes of a run's file, written at a fixed date by a clock that ticks evenly."""
    ticks = (1e-3 * k for k in itertools.count())
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch("cyclosis.dynamics.run.clock.perf_counter", side_effect=ticks),
        mock.patch("cyclosis.dataset.provenance.datetime") as dates,
        mock.patch("cyclosis.dataset.provenance.platform.python_version", return_value="3"),
    ):
        dates.now().isoformat.return_value = "2000-01-01T00:00:00+00:00"
        run = cy.simulate(
            PARAMS,
            GRID,
            cy.initial.disordered(GRID, seed=3),
            t_end=3.0,
            record_every=0.5,
            protocol=protocol(),
        )
        path = cy.write(run, Path(folder) / "run.nc")
        return {"sha256": hashed(path.read_bytes())}


def hashed(data):
    return np.frombuffer(hashlib.sha256(data).digest(), np.uint8)


def plane(**tables):
    return Sweep.from_tables(
        {
            "grid": {"n_theta": 32, "n_z": 16, "length": 3.0},
            "parameters": {"d_s": 0.1},
            "initial": {"filaments_per_square": 100.0},
            "axes": {"alpha_p": {"values": [0.02, 0.6, 1.0]}, "alpha_u": {"values": [0.1, 0.5]}},
            "ensemble": {"seeds": 2, "block": 3},
            "run": {"t_end": 300.0, "rtol": 1e-3},
        }
        | tables
    )


def stored_block():
    """Return a block's checksum; what it cost is left out, and so is the version of the program."""
    sweep = plane()
    arrays = block.compute(sweep, 1)
    arrays["seconds"] = np.zeros_like(arrays["seconds"])
    return {"sha256": hashed(packed.pack(sweep, 1, arrays)), **arrays}


def figure_5():
    """Return the regimes over a small plane of parameters, as Figure 5 counts them."""
    sweep = plane()
    found = [block.compute(sweep, index) for index in range(sweep.blocks)]
    return {
        name: np.concatenate([each[name] for each in found])
        for name in ("regime", "status", "t_final", "t_order", "eigenvalue", "zone_count")
    }


def members():
    grid = cy.CylinderGrid(32, 24, 3.0)
    params = cy.Parameters(alpha_p=1.0, d_s=0.1)
    starts = [cy.initial.disordered(grid, 100.0, seed) for seed in (1, 2)]
    found = follow([Member(params, grid, lambda P=P: P) for P in starts], EnsembleSettings(t_end=500.0))
    out = {}
    for number, outcome in enumerate(found):
        assert outcome.status == "certified"
        out |= {
            f"{number} state": outcome.state,
            f"{number} numbers": np.array([outcome.t_final, outcome.t_order, outcome.eigenvalue]),
            f"{number} regime": np.frombuffer(outcome.regime.encode(), np.uint8),
        }
    return out


def link():
    """Return a link of the explorer, and what opening it gives."""
    tables = {
        "parameters": {"alpha_p": 1.0, "kappa": 0.3},
        "grid": {"n_theta": 24, "n_z": 20, "length": 3.0},
        "initial": {"kind": "disordered", "seed": 3},
        "run": {"save_every": 0.5},
    }
    cell = setup.from_tables(tables, protocol().as_tables(), 5.0)
    again = setup.from_link(cell.link())
    texts = {"link": cell.link(), "opened": again.link(), "toml": again.toml()}
    return {name: np.frombuffer(text.encode(), np.uint8) for name, text in texts.items()}


CASES = {
    "adaptive": simulated,
    "rk4": lambda: simulated(stepper="rk4", dt=0.02, t_end=2.0, save_every=1.0),
    "float32": lambda: simulated(precision="float32", rtol=1e-5),
    "protocol": lambda: simulated(protocol=protocol(), dealias="quadratic"),
    "steady": steady,
    "file": file,
    "block": stored_block,
    "figure 5": figure_5,
    "members": members,
    "link": link,
}
