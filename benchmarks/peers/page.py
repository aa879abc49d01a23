"""The page docs/peers.md, from the data that compare.py leaves. It needs no other code to be installed."""

from __future__ import annotations

import ast
import json
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from statistics import median

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DATA = ROOT / "docs" / "data" / "peers.json"
TITLES = {
    "cyclosis": "cyclosis",
    "numba": "Numba + FFTW",
    "dedalus": "Dedalus",
    "exponax": "Exponax",
    "py-pde": "py-pde",
}
MODELS = {
    "numba": "numba_model.py",
    "dedalus": "dedalus_model.py",
    "exponax": "exponax_model.py",
    "py-pde": "pypde_model.py",
}
TOLERANT = ("adaptive", "multistep")
"""Variants that choose their steps by a tolerance."""
BY_HAND = (
    "The program in Numba and FFTW was compared later, on another machine: see\n"
    "[larger grids](#larger-grids) and [a thousand members](#a-thousand-members).\n"
)
"""What the page says while the first table is without it."""
LEVEL = 1.1
"""Ratios below it are within what a busy machine may change."""


def page() -> str:
    """Return the page."""
    data = json.loads(DATA.read_text())
    about, ours_ahead = data["about"], ratios(data)["dedalus"].values()
    cases = list(data["cost"].values())
    return (HERE / "template.md").read_text().format(
        costs=_costs(data),
        settings=_settings(cases, data["cost"]),
        differences=_differences(data),
        convergence=_convergence(data["agreement"]["codes"]),
        lines=_lines(),
        behind=_behind(data),
        tolerance=f"{about['tolerance']:.0e}",
        cores=about["cores"],
        processor=about["processor"],
        python=about["python"],
        date=about["date"],
        seconds=about.get("seconds", "on the clock"),
        turns=len(cases[0]["best"]["cyclosis"]["timings"]),
        versions=", ".join(f"{TITLES[name]} {number}" for name, number in about["versions"].items()),
        installing="\n".join(f"* {TITLES[name]}: `{how}`" for name, how in about["install"].items()),
        reference=f"{max(case['error of the reference'] for case in cases):.0e}",
        dedalus_low=_times(min(ours_ahead)),
        dedalus_high=_times(max(ours_ahead)),
        ensemble_length=data["ensemble"]["length"],
        ensemble_t=f"{data['ensemble']['t']:g}",
        agreement_t=f"{data['agreement']['t']:g}",
        agreement_length=data["agreement"]["length"],
        agreement_n=data["agreement"]["n"],
        agreement_dt=data["agreement"]["dt"],
        right_hand_sides=_grids(data, right_hand_sides, "cyclosis, ms", 1e3),
        runs=_grids(data, runs, "cyclosis, s per R/U", 1.0),
        grid_settings=_grid_settings(data["grids"]["sizes"]),
        grids_behind=_grids_behind(data),
        grids_measured=_measured(data["grids"]["about"]),
        by_hand="" if "numba" in ratios(data) else BY_HAND,
        grids_t=_final_times(data["grids"]["sizes"]),
        multistep=_times(multistep_beside_adaptive(data)),
        members=_members(data["members"]),
        members_errors=f"{max(max(way['errors']) for way in data['members']['ways'].values()):.1e}",
        members_count=data["members"]["members"],
        members_t=f"{data['members']['t']:g}",
        members_length=data["members"]["length"],
        members_turns=len(data["members"]["ways"]["cyclosis"]["timings"]),
        members_measured=_measured(data["members"]["about"]),
    )  # fmt: skip


def seconds(item: dict) -> float:
    """Return the best of a setting's timings: what else the machine did can only lengthen one."""
    return min(item["timings"])


def ratios(data: dict) -> dict[str, dict[str, float]]:
    """Return for every code and case how many times as long as ours it takes at equal error."""
    found: dict[str, dict[str, float]] = {}
    for case, item in data["cost"].items():
        ours = seconds(item["best"]["cyclosis"])
        for name, best in item["best"].items():
            found.setdefault(name, {})[case] = seconds(best) / ours
    return found


def throughput(data: dict) -> dict[str, float]:
    """Return for every code how many times its throughput of members ours is."""
    rates = {name: max(item["rates"]) for name, item in data["ensemble"]["codes"].items()}
    return {name: rates["cyclosis"] / rate for name, rate in rates.items()}


def right_hand_sides(size: dict, name: str) -> list[float]:
    """Return the seconds of a right-hand side of a code on one grid, turn by turn."""
    return size["codes"].get(name, {}).get("seconds a right-hand side", [])


def runs(size: dict, name: str) -> list[float]:
    """Return the seconds per unit of time of a code's cheapest setting on one grid, turn by turn."""
    found = size["codes"].get(name, {}).get("runs", [])
    return [seconds / size["t"] for seconds in cheapest(found)["timings"]] if found else []


def cheapest(found: list[dict]) -> dict:
    """Return the setting whose median is least."""
    return min(found, key=lambda one: median(one["timings"]))


def grid_ratios(data: dict, measure: Callable[[dict, str], list[float]]) -> dict[str, dict[int, float]]:
    """Return for every code and grid how many times as long as ours it takes: the median over turns."""
    found: dict[str, dict[int, float]] = {}
    for size in data["grids"]["sizes"].values():
        ours = measure(size, "cyclosis")
        for name in size["codes"]:
            theirs = measure(size, name)
            if theirs:  # a long run is made in the first turn only, and compared with ours of that turn
                found.setdefault(name, {})[size["n"]] = median(
                    a / b for a, b in zip(theirs, ours, strict=False)
                )
    return found


def projected(series: list[dict], tolerance: float) -> tuple[float, float] | None:
    """Return order and seconds at the tolerance of a series whose cost grows with the grid to the fourth."""
    a, b = series[-2:]
    if a["error"] is None or b["error"] is None or a["error"] > 0.3 or b["error"] > 0.5 * a["error"]:
        return None
    order = math.log(a["error"] / b["error"]) / math.log(b["n"] / a["n"])
    if order > 3:
        return None
    return order, b["seconds"] * (b["error"] / tolerance) ** (4 / order)


def setting_up(cases: list[dict], name: str, best: dict) -> float:
    """Return seconds that a setting takes before its first step: the longest seen, with nothing compiled."""
    same = [one for case in cases for one in case["tried"].get(name, []) if one["n"] == best["n"]]
    return max(one["setup"] for one in same if one["variant"] == best["variant"])


def lines_of_code(source: str) -> int:
    """Return how many lines hold code: no blank ones, no comments, no docstrings."""
    told: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            told |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    lines = enumerate(source.splitlines(), 1)
    return sum(1 for n, line in lines if n not in told and line.strip() and not line.strip().startswith("#"))


def _times(value: float) -> str:
    return f"{value:.0f}" if value >= 20 else f"{value:.2g}" if value >= 1.05 else f"{value:.2f}"


def _table(head: list[str], rows: list[list[str]]) -> str:
    out = "| " + " | ".join(head) + " |\n|---|" + "---:|" * (len(head) - 1) + "\n"
    return out + "".join("| " + " | ".join(row) + " |\n" for row in rows)


def _costs(data: dict) -> str:
    cases, found, members = data["cost"], ratios(data), throughput(data)
    rows = []
    for name in (name for name in TITLES if name in found):
        cells = [_times(found[name][case]) if case in found.get(name, {}) else "-" for case in cases]
        rows.append([TITLES[name], *cells, _times(members[name]) if name in members else "-"])
    return _table(["times as long as ours", *cases, "many members"], rows)


def _settings(cases: list[dict], names: dict) -> str:
    rows = []
    for case, item in zip(names, cases, strict=True):
        for name, best in item["best"].items():
            setting = f"{best['n']} x {best['n']}, {_variant(best)}"
            setup = setting_up(cases, name, best)
            cells = [setting, f"{best['error']:.1e}", f"{seconds(best):.3g}", f"{setup:.2g}"]
            rows.append([case, TITLES[name], *cells])
    return _table(["case", "code", "cheapest setting", "error", "stepping, s", "setting up, s"], rows)


def _convergence(codes: dict) -> str:
    rows = []
    for name, items in codes.items():
        for item in items:
            first, last = item["errors"][0], item["errors"][-1]
            order = math.log(first / last) / math.log(item["steps"][0] / item["steps"][-1])
            shown = ", ".join(f"{error:.1e}" for error in item["errors"])
            steps = ", ".join(f"{step:.2g}" for step in item["steps"])
            adaptive = item["variant"] in TOLERANT
            knob = "rtol" if adaptive else "dt"
            rows.append(
                [
                    TITLES[name],
                    item["variant"],
                    f"{knob} = {steps}",
                    shown,
                    "-" if adaptive else f"{order:.1f}",
                ]
            )
    return _table(["code", "scheme", "steps", "difference", "order"], rows)


def _differences(data: dict) -> str:
    out = ""
    for case, item in data["cost"].items():
        series = item.get("differences", [])
        known = [one for one in series if one["error"] is not None]
        if not known:
            continue
        out += f"* {case}: " + ", ".join(
            f"{one['error']:.1e} on {one['n']} x {one['n']} in {one['seconds']:.2g} s" for one in known
        )
        if guess := projected(series, data["about"]["tolerance"]):
            ratio = guess[1] / seconds(item["best"]["cyclosis"])
            out += f"; order {guess[0]:.1f}, hence about {guess[1]:.0e} s, {ratio:.0e} times ours"
        else:
            out += "; too inaccurate to extrapolate"
        out += ".\n"
    return out


def _lines() -> str:
    start = (ROOT / "README.md").read_text().split("```python\n")[1].split("```")[0]
    rows = [["cyclosis", str(lines_of_code(start)), "the README's start, run included"]]
    for name, file in MODELS.items():
        rows.append(
            [TITLES[name], str(lines_of_code((HERE / file).read_text())), f"`benchmarks/peers/{file}`"]
        )
    return _table(["code", "lines", "file"], rows)


def _variant(one: dict) -> str:
    knob = "rtol" if one["variant"] in TOLERANT else "dt"
    return f"{one['variant']}, {knob} = {one['step']:.2g}"


def _grids(data: dict, measure: Callable[[dict, str], list[float]], head: str, factor: float) -> str:
    found = grid_ratios(data, measure)
    others = [name for name in TITLES if name in found and name != "cyclosis"]
    rows = []
    for size in sorted(data["grids"]["sizes"].values(), key=lambda size: size["n"]):
        n, ours = size["n"], factor * median(measure(size, "cyclosis"))
        ratios_here = [_times(found[name][n]) if n in found[name] else "-" for name in others]
        rows.append([f"{n} x {n}", f"{ours:.3g}", *ratios_here])
    return _table(["points", head, *(TITLES[name] for name in others)], rows)


def _grid_settings(sizes: dict) -> str:
    out = ""
    for name in TITLES:
        groups: dict[str, list[int]] = {}
        errors = []
        for size in sorted(sizes.values(), key=lambda size: size["n"]):
            if found := size["codes"].get(name, {}).get("runs"):
                groups.setdefault(_variant(cheapest(found)), []).append(size["n"])
                errors.append(cheapest(found)["error"])
        if groups:
            parts = [f"{how} ({_listed(points)})" for how, points in groups.items()]
            out += f"* {TITLES[name]}: {'; '.join(parts)}; errors {min(errors):.1e} to {max(errors):.1e}.\n"
    return out


def _grids_behind(data: dict) -> str:
    """Say where others are ahead by the size of the grid."""
    out = ""
    for what, measure in (("one right-hand side", right_hand_sides), ("a run", runs)):
        found = grid_ratios(data, measure)
        ahead = [
            f"{TITLES[name]} on {_listed(n for n in ratio if ratio[n] < 1)} points"
            for name, ratio in found.items()
            if name != "cyclosis" and min(ratio.values()) < 1
        ]
        out += f"For {what} **ours is behind** {'; '.join(ahead)}.\n" if ahead else ""
    return out or "No code was faster than ours.\n"


def _listed(numbers: Iterable[int]) -> str:
    return ", ".join(str(n) for n in sorted(numbers))


def _final_times(sizes: dict) -> str:
    times: dict[float, list[int]] = {}
    for size in sorted(sizes.values(), key=lambda size: size["n"]):
        times.setdefault(size["t"], []).append(size["n"])
    return ", ".join(f"{t:g} (on {_listed(points)})" for t, points in times.items())


def multistep_beside_adaptive(data: dict) -> float:
    """Return how many times as long as our default stepper `multistep` takes on the smallest grid."""
    size = min(data["grids"]["sizes"].values(), key=lambda size: size["n"])
    taken = {one["variant"]: one["seconds"] for one in size["codes"]["cyclosis"]["tried"]}
    return taken["multistep"] / taken["adaptive"]


def _members(found: dict) -> str:
    ours, rows = found["ways"]["cyclosis"]["timings"], []
    for label, way in found["ways"].items():
        rate = found["members"] / median(way["timings"])
        ratio = median(a / b for a, b in zip(way["timings"], ours, strict=True))
        title = label.replace(way["code"], TITLES[way["code"]], 1)
        setting = f"{way['n']} x {way['n']}, {_variant(way)}"
        rows.append([title, setting, f"{rate:.3g}", _times(ratio)])
    return _table(["code", "setting", "members a second", "time, in ours"], rows)


def _measured(about: dict) -> str:
    versions = ", ".join(f"{TITLES[name]} {number}" for name, number in about["versions"].items())
    machine = f"one core of an {about['processor']}, Python {about['python']}"
    return f"Measured {about['date']} on {machine}: {versions}."


def _behind(data: dict) -> str:
    """Say where others are ahead or level: one cell, many members, or a first run with its setting up."""
    cases = data["cost"]
    places = {"many members": throughput(data)}
    for case in cases:
        places[case] = {name: found[case] for name, found in ratios(data).items() if case in found}
    ahead, level, sooner = [], [], []
    for place, found in places.items():
        for name, ratio in found.items():
            if name != "cyclosis" and ratio < LEVEL:
                (ahead if ratio < 1 else level).append(f"{TITLES[name]} at {place} ({ratio:.2f})")
    for name, by_size in grid_ratios(data, runs).items():
        slow = {n: ratio for n, ratio in by_size.items() if ratio < 1}
        if slow and name != "cyclosis":
            least, most = _times(min(slow.values())), _times(max(slow.values()))
            how = least if least == most else f"{least} to {most}"
            ahead.append(f"{TITLES[name]} on [grids](#larger-grids) of {_listed(slow)} points a side ({how})")
    for case, item in cases.items():
        first = {
            name: setting_up(list(cases.values()), name, best) + seconds(best)
            for name, best in item["best"].items()
        }
        ours = first.pop("cyclosis")
        for name, total in first.items():
            if total < ours:
                sooner.append(f"{TITLES[name]} at {case} ({total:.1f} s against {ours:.1f} s)")
    out = f"**Ours is behind** {'; '.join(ahead)}.\n" if ahead else "No code was faster than ours.\n"
    out += f"**About level**: {'; '.join(level)}.\n" if level else ""
    if sooner:
        out += f"**A first run, which has to compile, takes less time with** {'; '.join(sooner)}.\n"
    return out


if __name__ == "__main__":
    print(page())
