"""The same model in other codes: agreement, cost at equal error and by grids, throughput of many members.

    python benchmarks/peers/compare.py [--quick] [--stages agreement cost ensemble grids members]
                                       [--lengths "2 pi" 5] [--times 10 100] [--sizes 64 128 256 512 1024]

Every code that is installed takes part; the others are named, with how to install them. Writes
docs/data/peers.json, from which docs/generate.py makes docs/peers.md; --quick computes less, to see that
all works, and writes nothing. The other options renew parts of the data and keep the rest: lengths and
times of `cost`, sizes of `grids`, whose smallest gives `members` its settings. Each size is written when it
is done.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import sys
from pathlib import Path

from case import (
    CODES,
    GRID_RUNS,
    LENGTHS,
    NOISE_GRID,
    PARAMS,
    SIZES,
    TIMES,
    TOLERANCE,
    Code,
    error,
    reference,
)
from grids import grids, on_grids
from members import TAKE_PART, members
from scan import cheapest, convergence, differences
from worker import Worker

DATA = Path(__file__).parents[2] / "docs" / "data" / "peers.json"
STAGES = ("agreement", "cost", "ensemble", "grids", "members")
FINALISTS = 3
"""Settings of each code that are timed again."""
SOON, SOON_DT = 5.0, 0.0025
"""Time at which convergence is measured, and the reference's step: far below all steps measured, since two
codes with one scheme and one step share its error, which would then look like a higher order."""


def installed() -> dict[str, Code]:
    """Return the codes that are there, and name the others."""
    there = {name: code for name, code in CODES.items() if code.installed()}
    for name in CODES.keys() - there.keys():
        print(f"{name} is not installed and takes no part: {CODES[name].install}.")
    return there


def agreement(codes: dict[str, Code], workers: dict[str, Worker], quick: bool) -> dict:
    """Return how far other codes are from cyclosis, and how the difference falls with the step."""
    found, n, length = {}, 32 if quick else 96, LENGTHS["2 pi"]
    fine = reference(length, (SOON,), n, SOON_DT)[SOON]
    for name, code in codes.items():
        found[name] = convergence(workers[name], code, length, SOON, fine, n)
        print(f"{name}: {found[name]}", flush=True)
    return {"t": SOON, "length": "2 pi", "n": n, "dt": SOON_DT, "codes": found}


def cost(codes: dict[str, Code], workers: dict[str, Worker], lengths, times, quick: bool) -> dict:
    """Return the cheapest accurate setting of each code, timed in turns, and all that was tried."""
    found, rounds = {}, 1 if quick else 5
    for label in lengths:
        length = LENGTHS[label]
        fine = reference(length, times, 96, 0.05) if quick else reference(length)
        coarser = None if quick else reference(length, times, 96, 0.025)
        for t_end in times:
            able = {name: code for name, code in codes.items() if label in code.lengths()}
            sizes = (64,) if quick else SIZES
            tried = {}
            for name, code in able.items():
                tried[name] = cheapest(workers[name], code, length, t_end, fine[t_end], sizes)
            best = timed(able, workers, tried, length, t_end, rounds)
            case = {"length": label, "t": t_end, "best": best, "tried": tried}
            if coarser:
                case["error of the reference"] = error(coarser[t_end], fine[t_end])
            if "py-pde" in able:
                grids = (32, 64) if quick else (64, 128, 256) if t_end == TIMES[0] else (64, 128)
                case["differences"] = differences(workers["py-pde"], length, t_end, fine[t_end], grids)
            found[f"l = {label}, t = {t_end:g}"] = case
            print(f"l = {label}, t = {t_end:g}: {summary(best)}", flush=True)
    return found


def timed(codes: dict[str, Code], workers: dict[str, Worker], tried: dict, length, t_end, rounds) -> dict:
    """Return the cheapest setting of every code: those that seem cheapest are timed, all codes in turns."""
    finalists = {}
    for name, settings in tried.items():
        accurate = [one for one in settings if one["error"] <= TOLERANCE]
        finalists[name] = [one | {"timings": []} for one in accurate[:FINALISTS]]
    for _ in range(rounds):
        for name, settings in finalists.items():
            for one in settings:
                setting = (one["n"], length, one["step"], codes[name].variants[one["variant"]], t_end)
                workers[name].run(*setting)  # compiles, where that has not been done, and warms up
                one["timings"].append(workers[name].run(*setting)[2])
    return {name: min(those, key=seconds) for name, those in finalists.items() if those}


def seconds(one: dict) -> float:
    """Return the best of a setting's timings: what else the machine did can only lengthen one."""
    return min(one["timings"])


def summary(best: dict) -> dict[str, str]:
    """Return for a person to read how long each code took."""
    ours = seconds(best["cyclosis"])
    return {name: f"{seconds(one):.3f} s, {seconds(one) / ours:.2f} times ours" for name, one in best.items()}


def ensemble(codes: dict[str, Code], cases: dict, quick: bool) -> dict:
    """Return members x time a second, one worker on each core, at the settings that cost least."""
    case = cases[list(cases)[0 if quick else 1]]
    length, t_end, cores = LENGTHS[case["length"]], case["t"], os.cpu_count() or 1
    found = {}
    crews = {name: [Worker(name, core) for core in range(cores)] for name in codes if name in case["best"]}
    for turn in range(1 if quick else 3):
        for name, crew in crews.items():
            item = chosen(case, name)
            how = codes[name].variants[item["variant"]]
            setting = (item["n"], length, item["step"], how, t_end)
            if turn == 0:
                for worker in crew:
                    worker.ask(*setting, kind="ensemble")
                for worker in crew:
                    worker.answer()
            each = max(1, min(64, round(4 / item["seconds"])))
            for core, worker in enumerate(crew):
                worker.ask(*setting, kind="ensemble", seeds=range(core * each, (core + 1) * each))
            rate = cores * each * t_end / max(worker.answer()[2] for worker in crew)
            kept = found.setdefault(name, {**item, "members": cores * each, "rates": []})
            kept["rates"].append(rate)
            print(f"{name}: {cores * each} members, {rate:.1f} members x time a second", flush=True)
    for crew in crews.values():
        for worker in crew:
            worker.close()
    return {"length": case["length"], "t": t_end, "cores": cores, "codes": found}


def chosen(case: dict, name: str) -> dict:
    """Return the setting that a code's ensemble uses: for ours the adaptive stepper, which sweeps use."""
    right = [item for item in case["tried"][name] if name != "cyclosis" or item["variant"] == "adaptive"]
    return {key: value for key, value in right[0].items() if key != "timings"}


def about(codes: dict[str, Code]) -> dict:
    """Return on what and with what all this is measured."""
    model = platform.processor()
    if Path("/proc/cpuinfo").exists():
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), model)
    versions = {name: code.installed() for name, code in codes.items()}
    return {
        "date": datetime.date.today().isoformat(),
        "processor": model,
        "cores": os.cpu_count(),
        "python": sys.version.split()[0],
        "versions": versions,
        "seconds": "of the processor",
        "parameters": dict(PARAMS.items()),
        "seed": 0,
        "noise_grid": NOISE_GRID,
        "tolerance": TOLERANCE,
    }


def how_to_install() -> dict[str, str]:
    """Return for every other code the commands that install it."""
    return {name: code.install for name, code in CODES.items() if name != "cyclosis"}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--stages", nargs="+", choices=STAGES, default=STAGES)
    parser.add_argument("--lengths", nargs="+", choices=LENGTHS, default=list(LENGTHS))
    parser.add_argument("--times", nargs="+", type=float, choices=TIMES, default=list(TIMES))
    parser.add_argument("--sizes", nargs="+", type=int, choices=GRID_RUNS, default=list(GRID_RUNS))
    asked = parser.parse_args()
    codes, lengths, times, sizes = installed(), asked.lengths, sorted(asked.times), sorted(asked.sizes)
    if asked.quick:
        lengths, times, sizes = ["2 pi"], list(TIMES[:1]), list(GRID_RUNS)[:1]
    partly = set(asked.stages) != set(STAGES) or lengths != list(LENGTHS) or times != list(TIMES)
    partly = partly or sizes != list(GRID_RUNS)
    data = json.loads(DATA.read_text()) if partly and DATA.exists() else {}
    if {"cost", "ensemble"} & set(asked.stages) or not data:
        data["about"] = about(codes)
    data["about"]["install"] = how_to_install()
    workers = {name: Worker(name) for name in codes}
    if "agreement" in asked.stages:
        data["agreement"] = agreement(codes, workers, asked.quick)
    if "cost" in asked.stages:
        data["cost"] = data.get("cost", {}) | cost(codes, workers, lengths, times, asked.quick)
        write(data, asked.quick)
    if "grids" in asked.stages:
        known = data.get("grids", {}).get("sizes", {})
        for _, found in grids(codes, workers, sizes, known, asked.quick):
            data["grids"] = {"about": about(on_grids(codes)), "sizes": found}
            write(data, asked.quick)
    if "members" in asked.stages:
        size = min(data["grids"]["sizes"].values(), key=lambda size: size["n"])
        crew = {name: code for name, code in codes.items() if name in TAKE_PART}
        data["members"] = {"about": about(crew)} | members(crew, workers, size, asked.quick)
    for worker in workers.values():
        worker.close()
    if "ensemble" in asked.stages:
        data["ensemble"] = ensemble(codes, data["cost"], asked.quick)
    if write(data, asked.quick):
        print(f"wrote {DATA}; python docs/generate.py makes the page")


def write(data: dict, quick: bool) -> bool:
    """Write the data unless all was quick, and say whether it was written."""
    if not quick:
        DATA.write_text(json.dumps(finite(data), indent=1) + "\n")
    return not quick


def finite(item):
    """Return data fit for JSON, which has no infinity: null stands for it."""
    if isinstance(item, dict):
        return {key: finite(value) for key, value in item.items()}
    if isinstance(item, (list, tuple)):
        return [finite(value) for value in item]
    return None if item == float("inf") else item


if __name__ == "__main__":
    main()
