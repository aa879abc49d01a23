"""The page of symbols names all parameters and all that files hold, and the letters with two meanings."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

import cyclosis as cy
from cyclosis.model.definitions import TABLES
from cyclosis.sweep.plan.variables import standard

PAGE = (Path(__file__).parents[1] / "docs" / "symbols.md").read_text()
MODELS = {
    "polar": cy.models.polar,
    "polar with c": cy.models.polar_model(concentration=True),
    "kinetic": cy.models.kinetic_model(8),
    "coupled": cy.models.coupled,
    "closed": cy.models.closed,
}


def rows(text):
    """Return the cells of all tables in a text, without their heads."""
    found = []
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        for line in table.splitlines()[2:]:
            found.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return found


def part(title):
    """Return the text under a heading of the second rank."""
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL).group(1)


STORED = {row[0].strip("`"): row for row in rows(part("In files and sweeps"))}


def test_no_model_is_missing():
    assert {model.name for model in MODELS.values()} == set(cy.models.MODELS)


@pytest.mark.parametrize("name", MODELS)
def test_every_parameter_is_there(name):
    given = {row[1].strip("`") for row in rows(part("Given"))}
    model = MODELS[name]
    own = {item.name for item in fields(model.parameters)} | set(model.options)
    assert own | {item.name for table in TABLES.values() for item in table} <= given


def run_of(name):
    """Return a short run with a protocol that changes the state, recorded apart from its frames."""
    model, params = MODELS[name], cy.Parameters()
    protocol = cy.Protocol(cy.noise(at=0.1, size=0.01))
    if name == "closed":
        grid = cy.ClosedGrid(cy.Sphere(), k_max=4)
        start = cy.closed.swirl(grid, 0.5)
    else:
        grid = cy.CylinderGrid(8, 8)
        start = cy.initial.stripes(grid, magnitude=0.5)
        if name == "kinetic":
            start = cy.kinetic.dressed(start, 8)
        if name == "polar with c":
            start = cy.initial.with_concentration(start, cy.initial.bump(grid, height=0.5))
    times = {"t_end": 0.2, "save_every": 0.2, "record_every": 0.1}
    return cy.simulate(params, grid, start, **times, model=model, protocol=protocol)


SLOW = ("kinetic", "closed")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in MODELS]
)
def test_everything_that_a_file_of_a_run_holds_is_there(name, tmp_path):
    with cy.open_dataset(cy.write(run_of(name), tmp_path / "run.nc")) as data:
        held = set(data.variables)
    assert {"record_time", "intervention_time", "peak_speed"} <= held
    for variable in held | {item.name for item in standard(MODELS[name])}:
        models = STORED[variable][-1]
        where = {"all": set(MODELS), "cylinders": set(MODELS) - {"closed"}}.get(models, models.split(", "))
        assert name in where, variable


def test_a_letter_with_two_meanings_is_said_to_have_them():
    """A symbol in two rows is listed at the end, once; rows with several symbols have a unit for each."""
    several = rows(part("Letters with several meanings"))
    letters = [row[0] for row in several]
    assert len(letters) == len(set(letters))
    meanings = {}
    for row in rows(part("Given")):
        meanings.setdefault(row[0], set()).add(row[2])
    for row in rows(part("In files and sweeps")):
        meanings.setdefault(row[1], set()).add(row[2])
    for row in rows(part("In the theory")):
        units = row[2].split(", ")
        for symbol in row[0].split(", "):
            meanings.setdefault(symbol, set()).add(row[1])
        assert len(units) in (1, len(row[0].split(", "))), row
    twice = {symbol for symbol, found in meanings.items() if len(found) > 1} - {"-"}
    assert {"κ", "w", "c", "n"} <= twice
    assert twice <= set(letters), twice - set(letters)


def test_symbols_of_the_pages_of_theory_are_those_of_the_table():
    """Every Greek letter in a formula of these pages stands somewhere in the tables."""
    letters = {"alpha": "α", "beta": "β", "delta": "δ", "epsilon": "ε", "eta": "η", "kappa": "κ"}
    letters |= {"lambda": "λ", "mu": "μ", "nu": "ν", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ"}
    letters |= {"chi": "χ", "psi": "ψ", "omega": "ω", "Lambda": "Λ", "Omega": "Ω", "Psi": "Ψ", "Pi": "Π"}
    symbols = " ".join(row[0] + row[1] for row in rows(PAGE))
    for name in (
        "theory_kinetic",
        "theory_vacuole",
        "theory_closed",
        "kinetic",
        "vacuole",
        "closed",
        "model",
    ):
        text = (Path(__file__).parents[1] / "docs" / f"{name}.md").read_text()
        for word in set(re.findall(r"\\([A-Za-z]+)", text)) & set(letters):
            assert letters[word] in symbols, (name, word)
