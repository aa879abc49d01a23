"""Write the numbers that hold the engine in the browser to the library: `python web/tests/golden/make.py`.

Fields are the base64 text of little-endian float64 numbers, exact to the last bit.
`tests/explorer/test_engine.py` computes them again and compares; `web/tests/engine.*.test.ts` compare the
engine with the same files.
"""

from __future__ import annotations

import base64
import hashlib
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import jax
import numpy as np

import cyclosis as cy
from cyclosis.config import initial_state
from cyclosis.dynamics.advance import Control, advance, start
from cyclosis.dynamics.live import Live
from cyclosis.dynamics.steppers import METHODS
from cyclosis.explorer.catalogue import catalogue
from cyclosis.explorer.palettes import PALETTES
from cyclosis.explorer.setup import from_tables
from cyclosis.figures.looks import direction_rgb
from cyclosis.model.precision import double
from cyclosis.model.system import ramped, rate_spectrum, state_of, system

HERE = Path(__file__).parent
GENERAL = {
    "alpha_p": 0.8,
    "alpha_u": 0.45,
    "epsilon": 0.3,
    "d_s": 0.03,
    "d_r": 0.04,
    "kappa": 0.35,
    "mu": 0.08,
    "repulsion_angle": 0.4,
}
NONE = dict.fromkeys(GENERAL, 0.0)


def packed(values: Any) -> str:
    """Return numbers as text."""
    return base64.b64encode(np.ascontiguousarray(values, "<f8").tobytes()).decode()


def unpacked(text: str) -> np.ndarray:
    """Return the numbers of a text."""
    return np.frombuffer(base64.b64decode(text), "<f8")


def field(grid: cy.CylinderGrid, low: float, high: float) -> np.ndarray:
    """Return a smooth field of parameters."""
    wave = np.cos(grid.theta)[:, None] * np.sin(2 * np.pi * grid.z / grid.length + 0.3)[None, :]
    return 0.5 * (low + high) + 0.5 * (high - low) * wave


def cases() -> list[dict[str, Any]]:
    """Return the right-hand sides to compute: a grid, parameters, and a ramp where there is one."""
    usual = (16, 12, 5.0)
    out: list[dict[str, Any]] = [
        {"name": "diffusion", "parameters": {"d_s": 0.7, "d_r": 0.2}},
        {"name": "bundling", "parameters": {"alpha_p": 1.3}},
        {"name": "flow alignment", "parameters": {"alpha_u": 1.1, "mu": 0.07}},
        {"name": "flow alignment without mean flow", "parameters": {"alpha_u": 1.1, "zero_theta_flux": True}},
        {"name": "repulsion", "parameters": {"kappa": 0.9}},
        {"name": "oblique repulsion", "parameters": {"kappa": 0.9, "repulsion_angle": 0.7}},
        {"name": "advection and shear", "parameters": {"epsilon": 1.0, "mu": 0.05}},
        {"name": "all terms", "parameters": GENERAL},
        {"name": "linear force", "parameters": GENERAL | {"force_exponent": 0.0}},
        {"name": "force of another power", "parameters": GENERAL | {"force_exponent": 1.5}},
        {
            "name": "fields",
            "parameters": GENERAL,
            "fields": ["alpha_p", "alpha_u", "kappa", "repulsion_angle"],
        },
        {
            "name": "ramps",
            "parameters": GENERAL,
            "last": {
                "mu": 0.3,
                "d_s": 0.01,
                "d_r": 0.09,
                "kappa": 0.1,
                "repulsion_angle": 1.0,
                "alpha_u": 0.9,
            },
            "ramps": {"mu": [1.0, 3.0], "d_s": [1.0, 4.0], "d_r": [0.0, 2.0]}
            | {"kappa": [1.0, 2.0], "repulsion_angle": [1.0, 2.0], "alpha_u": [0.5, 2.5]},
            "t": 1.3,
        },
    ]
    for item in out:
        item["grid"], item["parameters"] = usual, NONE | item["parameters"]
    for n_theta, n_z in ((15, 10), (14, 9), (64, 1), (24, 22)):
        item = {"name": f"all terms, {n_theta} x {n_z}", "parameters": GENERAL, "grid": (n_theta, n_z, 3.0)}
        out.append(item)
    return out


def given_state(n_theta: int, n_z: int) -> np.ndarray:
    """Return the state of which right-hand sides are computed."""
    return cy.initial.noise(cy.CylinderGrid(n_theta, n_z), 6, seed=3)


def right_hand_side(case: dict[str, Any]) -> dict[str, Any]:
    """Return a case with the fields of its parameters, and its rate of change."""
    grid = cy.CylinderGrid(*case["grid"])
    given = case["parameters"] | {name: field(grid, 0.1, 0.9) for name in case.get("fields", ())}
    params = cy.Parameters(**given)
    state = given_state(*grid.shape)
    equation = system(params, grid)
    if "ramps" in case:
        times = {name: tuple(span) for name, span in case["ramps"].items()}
        equation = ramped(equation, system(params.replace(**case["last"]), grid), times)
    with double():
        rate = state_of(rate_spectrum(equation, equation.spectrum(state), case.get("t", 0.0)))
    values = {name: packed(given[name]) for name in case.get("fields", ())}
    return case | {"fields": values, "rate": packed(rate)}


def rates() -> dict[str, Any]:
    """Return all right-hand sides, and the states of the grids that they are of."""
    found = cases()
    sizes = {case["grid"] for case in found}
    states = {f"{n_theta} x {n_z}": packed(given_state(n_theta, n_z)) for n_theta, n_z, _ in sorted(sizes)}
    return {"states": states, "cases": [right_hand_side(case) for case in found]}


SEEDS = (0, 1, 42, 2**32 + 5, 2**53 - 1)


def noise() -> dict[str, Any]:
    """Return random numbers: the first of each seed, and the checksum of as many as the finest grid needs."""
    streams = [(seed, ()) for seed in SEEDS] + [(7, (1,)), (7, (2,)), (0, (2**31 - 1,)), (2**40, (3,))]
    out = []
    for seed, key in streams:
        sequence = np.random.SeedSequence(seed, spawn_key=key)
        generator = np.random.Generator(np.random.PCG64(sequence))
        drawn = generator.normal(size=2 * 128 * 128)
        digest = hashlib.sha256(drawn.astype("<f8").tobytes()).hexdigest()
        words = [int(word) for word in sequence.generate_state(4)]
        out.append(
            {"seed": seed, "key": list(key), "words": words, "first": packed(drawn[:32]), "sha256": digest}
        )
    return {"streams": out}


def initial_states() -> list[dict[str, Any]]:
    """Return initial states by their tables."""
    tables = [
        {"kind": "disordered", "seed": 5},
        {"kind": "disordered", "seed": 5, "filaments_per_square": 50.0, "noise_grid": [32, 24]},
        {"kind": "disordered", "seed": 6, "noise_grid": [8, 8]},
        {"kind": "unidirectional", "magnitude": 0.7},
        {"kind": "circumferential", "filaments_per_square": 4000.0, "seed": 2},
        {"kind": "stripes", "stripes": 4, "filaments_per_square": 4000.0},
    ]
    grid = cy.CylinderGrid(16, 12, 5.0)
    return [{"table": table, "state": packed(initial_state(table, grid))} for table in tables]


def steps() -> list[dict[str, Any]]:
    """Return runs by every stepper to a time: state and counts."""
    grid, state = (
        cy.CylinderGrid(16, 12, 5.0),
        cy.initial.disordered(cy.CylinderGrid(16, 12, 5.0), 100, seed=4),
    )
    out = []
    plans = [
        ("etdrk4", {"dt": 0.3}, 0.3, 1),
        ("rk4", {"dt": 0.02}, 0.02, 1),
        ("etdrk4", {"dt": 0.25}, 2.1, 1000),
        ("rk4", {"dt": 0.05}, 1.0, 1000),
        ("adaptive", {}, 0.1, 1),
        ("adaptive", {"rtol": 1e-6}, 7.3, 1000),
        ("adaptive", {"steady_rate": 1e-3}, 4000.0, 100_000),
        ("adaptive", {"bound": 0.5}, 50.0, 1000),
    ]
    for name, how, target, most in plans:
        method = METHODS[name]
        kept = {"rtol": 1e-4, "atol": 1e-10, "bound": 1.01, "dt": 0.1, "steady_rate": -1.0} | how
        equation = system(cy.Parameters(), grid, split=method.exact)
        with double():
            begun = start(equation, equation.spectrum(state), np.float64(0.0))
            end = advance(equation, Control.of(**kept), begun, np.float64(target), np.int64(most), method)
            end = jax.device_get(end)
        out.append(
            {"method": name, "control": kept, "target": target, "most": most, "t": float(end.t)}
            | {key: int(getattr(end, key)) for key in ("accepted", "rejected", "evaluations", "rung")}
            | {"failed": bool(end.failed), "rate": float(end.rate), "peak": float(end.peak)}
            | {"state": packed(state_of(end.spectrum))}
        )
    return [{"grid": [16, 12, 5.0], "state": packed(state), "runs": out}]


def run() -> dict[str, Any]:
    """Return an adaptive run to t = 20 on 32 x 32 points: numbers on the way, and the last state."""
    grid = cy.CylinderGrid(32, 32, 5.0)
    live = Live(cy.Parameters(), grid, cy.initial.disordered(grid, seed=0), 0.5)
    rows = []
    while live.t < 20.0:
        if live.forward() and live.frame % 4 == 0:
            rows.append({name: np.asarray(value).tolist() for name, value in live.record().items()})
            rows[-1] |= {"t": live.t}
            del rows[-1]["budget"]
    now = live._follower.now
    counts = {key: int(getattr(now, key)) for key in ("accepted", "rejected", "evaluations")}
    return {"rows": rows, "state": packed(live.state), "flow": packed(live.flow())} | counts


def ends() -> list[dict[str, Any]]:
    """Return what cells from ten seeds are at t = 200, with and almost without alignment by flow."""
    grid, out = cy.CylinderGrid(32, 32, 5.0), []
    for alpha_u in (0.5, 0.025):
        params = cy.Parameters(alpha_u=alpha_u)
        for seed in range(10):
            live = Live(params, grid, cy.initial.disordered(grid, seed=seed), 1.0)
            while live.t < 200.0:
                live.forward()
            found = cy.regime(params, grid, live.state)
            out.append({"alpha_u": alpha_u, "seed": seed, "name": found.name, "zones": found.zones.tolist()})
    return out


DISCS = [
    {"shape": "disc", "theta": 0.1, "z": 4.9, "radius": 0.6},
    {"shape": "disc", "theta": 3.0, "z": 2.0, "radius": 0.5},
]
PROTOCOLS: list[dict[str, Any]] = [
    {
        "name": "drugs, brush and ramps",
        "initial": {"kind": "stripes", "filaments_per_square": 4000.0, "seed": 3},
        "end": 9.0,
        "protocol": [
            {"at": 1.0, "action": "fragment", "where": DISCS[0]},
            {
                "at": 1.0,
                "action": "align",
                "angle": 1.5707963267948966,
                "where": {"shape": "union", "parts": DISCS},
            },
            {"at": 2.05, "action": "change", "alpha_p": 0.2, "over": 1.5},
            {"at": 3.0, "action": "depolymerise", "keep": 0.25, "where": DISCS[1] | {"invert": True}},
            {"at": 4.0, "action": "change", "mu": 0.2, "d_s": 0.05, "force_exponent": 1.0, "over": 2.0},
            {"at": 5.0, "action": "noise", "size": 0.1, "noise_grid": [8, 8]},
            {"at": 6.0, "action": "wash_out", "over": 1.0},
            {"at": 8.0, "action": "change", "zero_theta_flux": True, "kappa": 0.1, "repulsion_angle": 0.3},
        ],
    },
    {
        "name": "parameters that differ from place to place",
        "initial": {"kind": "disordered", "seed": 8},
        "end": 8.0,
        "protocol": [
            {
                "at": 0.0,
                "action": "change",
                "alpha_u": 0.9,
                "where": {"shape": "band", "axis": "z", "start": 4.0, "stop": 1.0},
            },
            {"at": 2.0, "action": "change", "kappa": 0.1, "repulsion_angle": 0.5, "over": 2.0}
            | {"where": {"shape": "strips", "count": 3, "share": 0.4, "axis": "theta", "offset": 0.1}},
            {"at": 3.0, "action": "change", "alpha_p": 0.4, "over": 3.0}
            | {"where": {"shape": "box", "theta0": 5.5, "theta1": 1.0, "z0": 1.0, "z1": 3.0}},
            {"at": 7.0, "action": "wash_out", "over": 0.5},
        ],
    },
]


def protocols() -> list[dict[str, Any]]:
    """Return cells under protocols: the texts of their steps, parameters on the way, and states."""
    out = []
    for item in PROTOCOLS:
        grid, seed = cy.CylinderGrid(24, 16, 5.0), item["initial"]["seed"]
        protocol = cy.Protocol.from_tables(item["protocol"], seed)
        live = Live(cy.Parameters(), grid, initial_state(item["initial"], grid), 0.5, protocol)
        params, states = [], []
        while live.t < item["end"]:
            if live.forward():
                params.append({k: float(np.mean(v)) for k, v in live.params_now.items()} | {"t": live.t})
                if live.frame % 6 == 0 or live.t == item["end"]:
                    states.append({"t": live.t, "state": packed(live.state)})
        texts = {"texts": [str(step) for step in protocol], "tables": protocol.as_tables()}
        out.append(item | texts | {"parameters": params, "states": states})
    return out


def regimes() -> list[dict[str, Any]]:
    """Return what states are, one of every regime."""
    grid = cy.CylinderGrid(16, 12, 5.0)
    angle = grid.theta[:, None]
    wave = 2 * np.pi / grid.length * grid.z[None, :]
    noise, one = cy.initial.noise(grid, 1e5, seed=1), np.ones(grid.shape)
    given = {
        "disordered": cy.initial.disordered(grid, seed=1),
        "unidirectional": cy.initial.unidirectional(grid, 0.9) + noise,
        "circumferential": cy.initial.circumferential(grid, 0.9) + noise,
        "stripes": cy.initial.stripes(grid) + noise,
        "unequal": np.stack([0 * one, 0.8 * np.tanh(3 * (np.cos(angle) - 0.3 + 0.1 * np.cos(wave)))]),
        "four stripes": cy.initial.stripes(grid, 4) + noise,
        "helix": np.stack(
            [0.3 * np.cos(angle + wave), 0.6 * np.sin(angle + wave) + 0.1 * np.sin(angle - 0.3)]
        ),
        "rings": np.stack([0 * one, 0.6 * np.sin(wave + 0.1) * one + 0.01 * np.sin(angle)]),
        "patches": np.stack(
            [0.2 * one, 0.6 * np.sin(wave + 0.1) * np.sin(angle + 0.1) + 0.2 * np.sin(2 * angle + 0.2)]
        ),
    }
    out = []
    for name, state in given.items():
        found = cy.regime(cy.Parameters(kappa=0.1), grid, state)
        kept = {
            key: np.asarray(getattr(found, key)).tolist()
            for key in ("zones", "widths", "mean_P", "drift", "order", "rate")
        }
        crossed = cy.zones.crossings(state)
        kept |= {
            "name": found.name,
            "reason": found.reason,
            "boundaries": [int(crossed.min()), int(crossed.max())],
        }
        out.append({"of": name, "state": packed(state), "found": kept})
    return out


def links() -> list[dict[str, Any]]:
    """Return links of the explorer, and what they contain."""
    cell = PROTOCOLS[0]
    tables = {"parameters": {"alpha_p": 0.25}, "grid": {"n_theta": 24, "n_z": 16}, "initial": cell["initial"]}
    given = [from_tables(tables, cell["protocol"], 3.3), from_tables({}, ())]
    return [
        {"link": item.link(), "tables": item.tables, "steps": list(item.steps), "t": item.t} for item in given
    ]


def colours() -> dict[str, Any]:
    """Return the colours of the page, and those of order vectors by the figures: [P_theta, P_z, r, g, b]."""
    angle, size = np.meshgrid(np.linspace(-3.0, 3.1, 23), [0.0, 0.2, 0.6, 1.0, 1.3])
    P = np.stack([size * np.cos(angle), size * np.sin(angle)])
    rows = np.concatenate([P, np.moveaxis(direction_rgb(P), -1, 0)]).reshape(5, -1).T
    return {"palettes": [asdict(item) for item in PALETTES], "directions": np.round(rows, 6).tolist()}


def write(name: str, found: Any) -> None:
    """Write one file."""
    (HERE / name).write_text(json.dumps(found, indent=1) + "\n")
    print(f"{name}: {(HERE / name).stat().st_size / 1000:.0f} kB")


FILES = {
    "catalogue.json": catalogue,
    "rates.json": rates,
    "noise.json": noise,
    "initial.json": initial_states,
    "steps.json": steps,
    "run.json": run,
    "protocols.json": protocols,
    "regimes.json": regimes,
    "links.json": links,
    "ends.json": ends,
    "colours.json": colours,
}


def main() -> None:
    """Write the files named on the command line, or all."""
    for name in sys.argv[1:] or FILES:
        write(name, FILES[name]())


if __name__ == "__main__":
    main()
