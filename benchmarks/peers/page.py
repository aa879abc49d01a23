"""The page docs/peers.md, from the data that compare.py leaves. It needs no other code to be installed."""

from __future__ import annotations

import ast
import json
import math
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DATA = ROOT / "docs" / "data" / "peers.json"
MODELS = {"dedalus": "dedalus_model.py", "exponax": "exponax_model.py", "py-pde": "pypde_model.py"}
TITLES = {"cyclosis": "cyclosis", "dedalus": "Dedalus", "exponax": "Exponax", "py-pde": "py-pde"}


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
    for name, title in TITLES.items():
        cells = [_times(found[name][case]) if case in found.get(name, {}) else "-" for case in cases]
        rows.append([title, *cells, _times(members[name]) if name in members else "-"])
    return _table(["times as long as ours", *cases, "many members"], rows)


def _settings(cases: list[dict], names: dict) -> str:
    rows = []
    for case, item in zip(names, cases, strict=True):
        for name, best in item["best"].items():
            knob = "rtol" if best["variant"] == "adaptive" else "dt"
            setting = f"{best['n']} x {best['n']}, {best['variant']}, {knob} = {best['step']:.2g}"
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
            adaptive = item["variant"] == "adaptive"
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
