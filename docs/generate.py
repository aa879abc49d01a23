"""Write the tables of settings and quantities from their definitions.

python docs/generate.py            # writes docs/settings.md and docs/quantities.md
"""

from __future__ import annotations

from pathlib import Path

from cyclosis.analysis.diagnostics import QUANTITIES
from cyclosis.model.definitions import TABLES
from cyclosis.model.filaments import TERMS

HERE = Path(__file__).parent
NOTE = "<!-- Written by docs/generate.py from the definitions in the code. -->\n\n"


def settings() -> str:
    """Return the page of every setting."""
    out = NOTE + "# Settings\n\nThe tables of `run.toml` and the options of `cyclosis run`. "
    out += "All values are dimensionless.\n"
    for table, items in TABLES.items():
        out += f"\n## [{table}]\n\n| name | option | symbol | meaning | allowed | default |\n"
        out += "|---|---|---|---|---|---|\n"
        for item in items:
            default = (
                "all" if isinstance(item.default, tuple) else "-" if item.default is None else item.default
            )
            allowed = item.rule + (", or a field (n_theta, n_z)" if item.field else "")
            option = "--" + item.name.replace("_", "-")
            out += (
                f"| `{item.name}` | `{option}` | {item.symbol} | {item.meaning} | {allowed} | {default} |\n"
            )
    out += "\n## Terms\n\n| name | in dP/dt |\n|---|---|\n"
    return out + "".join(f"| `{term.name}` | {_cell(term.formula)} |\n" for term in TERMS)


def quantities() -> str:
    """Return the page of every recorded quantity."""
    out = NOTE + "# Quantities\n\nRecorded along every run, and returned by `cyclosis.diagnose`.\n\n"
    out += "| name | symbol | dimensions | unit | meaning |\n|---|---|---|---|---|\n"
    for item in QUANTITIES:
        dims = ", ".join(("time", *item.dims))
        out += f"| `{item.name}` | {_cell(item.symbol)} | {dims} | {item.unit} | {_cell(item.meaning)} |\n"
    return out


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


PAGES = {"settings.md": settings, "quantities.md": quantities}

if __name__ == "__main__":
    for name, page in PAGES.items():
        (HERE / name).write_text(page())
