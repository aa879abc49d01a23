"""CONTRIBUTING.md is followed to the letter, in a copy of the tree, and everything follows as it says."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
IGNORED = shutil.ignore_patterns("__pycache__", "page", "_build", "images", "reference")


def steps(title):
    """The numbered steps of a section of CONTRIBUTING.md: at most five, one line each."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    section = text.split(f"## {title}\n")[1].split("\n## ")[0]
    found = re.findall(r"^\d\. (.*)$", section, re.MULTILINE)
    assert len(found) == len(section.strip().splitlines()) <= 5
    return found


class Tree:
    """A copy in which changes are made that a step asks for."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("src", "tests", "docs", "examples"):
            shutil.copytree(ROOT / name, folder / name, ignore=IGNORED)
        shutil.copy(ROOT / "pyproject.toml", folder)
        paths = os.pathsep.join(str(folder / name) for name in ("src", "tests"))
        self.environment = os.environ | {"PYTHONPATH": paths, "COLUMNS": "200"}

    def change(self, step, file, *changes):
        """Put the new in place of the old, each once, in a file that the step names."""
        assert Path(file).name in step or file in step, f"{file} is not in: {step}"
        path = self.folder / ("src" if file.startswith("cyclosis") else "") / file
        text = path.read_text()
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        path.write_text(text)

    def run(self, *arguments):
        out = subprocess.run(
            [sys.executable, *arguments],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert out.returncode == 0, out.stdout + out.stderr
        return out.stdout

    def python(self, code):
        """Run code on the copy."""
        check = "import cyclosis as cy, numpy as np\nassert 'FOLDER' in cy.__file__, cy.__file__\n"
        return self.run("-c", check.replace("FOLDER", str(self.folder)) + code)

    def cyclosis(self, *arguments):
        return self.run("-m", "cyclosis", *arguments)

    def page(self, name):
        """A page of the documentation as docs/generate.py writes it now."""
        code = f"import runpy; print(runpy.run_path('docs/generate.py')['PAGES'][{name!r}]())"
        return self.run("-c", code)


@pytest.fixture
def tree(tmp_path):
    return Tree(tmp_path)


TERM_WORKS = """
import oracle
from measure import check, right_hand_side
from cyclosis.stability import growth_rates

check(right_hand_side.single_terms())
check(right_hand_side.alias_free("numbers, tilted d"))
assert right_hand_side.NUMBERS["damping"] and "damping" in oracle.TERMS
grid, params = cy.CylinderGrid(16, 12, 5.0), cy.Parameters(damping=0.3)
state = cy.initial.unidirectional(grid, 0.5)
run = cy.simulate(params, grid, state, 4.0, 1.0, terms=["damping"], rtol=1e-8)
exact = 0.5 / np.sqrt(1 + 2 * 0.3 * 0.25 * run.times)
assert np.allclose([frame[1, 0, 0] for frame in run.frames], exact, atol=1e-7)
assert np.isclose(cy.diagnose(params, grid, state)["budget"]["damping"], -0.3 * 0.5**4)
assert "damping" in cy.simulate(params, grid, state, 1.0, 1.0).to_dataset()["term"].values
scales = cy.Scales()
assert np.isclose(scales.from_physical(scales.to_physical(params)).damping, 0.3)
try:
    growth_rates(params, "disorder", 1, 0)
except cy.InputError as error:
    assert "closed form" in str(error)
else:
    raise AssertionError("a closed form leaves the term out without a word")
"""


def test_a_term(tree):
    one, two, three, four, five = steps("Add a term")
    function = 'def damping(now: Moment) -> jax.Array:\n    """Return -γ |P|² P."""\n'
    function += "    return -now.values.damping * dot(now.p, now.p) * now.p\n\n\n"
    tree.change(
        one,
        "cyclosis/model/filaments.py",
        ("def bundling(", function + "def bundling("),
        ('    "bundling": bundling,\n', '    "damping": damping,\n    "bundling": bundling,\n'),
    )
    entry = '    Entry("damping", "-γ |P|² P", "rate", "Order undoes itself."),\n'
    tree.change(two, "cyclosis/model/equation.py", ("EQUATION = (\n", "EQUATION = (\n" + entry))
    coupling = '    Definition("damping", "γ", "damping of order by order", 0.0, field=True),\n'
    tree.change(three, "cyclosis/model/definitions.py", ("PARAMETERS = (\n", "PARAMETERS = (\n" + coupling))
    field = '    force_exponent: float = _DEFAULT["force_exponent"]\n'
    parameters = tree.folder / "src" / "cyclosis" / "model" / "parameters.py"
    assert "`Parameters`" in three
    new = parameters.read_text().replace(field, field + '    damping: Coupling = _DEFAULT["damping"]\n')
    parameters.write_text(new)
    tree.change(
        three,
        "cyclosis/model/moment.py",
        ("    alpha_p: Any\n", "    damping: Any\n    alpha_p: Any\n"),
    )
    tree.change(
        three,
        "cyclosis/model/scales.py",
        ("    force_exponent: float\n", "    force_exponent: float\n    damping_per_s: Coupling = 0.0\n"),
        (
            "            force_exponent=params.force_exponent,\n",
            "            force_exponent=params.force_exponent,\n"
            "            damping_per_s=params.damping / self.time_s,\n",
        ),
        (
            "            force_exponent=physical.force_exponent,\n",
            "            force_exponent=physical.force_exponent,\n"
            "            damping=physical.damping_per_s * self.time_s,\n",
        ),
    )
    formula = 'if name == "damping":\n            square = P[0] ** 2 + P[1] ** 2\n'
    formula += "            return [-p.damping * square * P[i] for i in (0, 1)]\n        "
    tree.change(
        four,
        "tests/oracle.py",
        ('TERMS = (\n    "advection"', 'TERMS = (\n    "damping", "advection"'),
        ('if name == "bundling":', formula + 'if name == "bundling":'),
    )
    tree.change(
        four, "tests/measure/right_hand_side.py", ('"alpha_p": 0.7,', '"alpha_p": 0.7, "damping": 0.2,')
    )
    tree.python(TERM_WORKS)
    assert "--damping" in tree.cyclosis("run", "--help")
    assert "generate.py" in five
    assert tree.page("settings.md").count("`damping`") == 3, "a coupling, an axis of sweeps, a term"


QUANTITY = """    Quantity(
        "following", "<P·u>", (), "1", "how far filaments point along the flow",
        lambda system, now: jnp.mean(dot(now.p, now.u)),
    ),
"""
LAW = '''

def test_linear_forces_do_work_where_filaments_follow():
    """For n = 0 the force is P itself, so that <P·u> is the power."""
    found = cy.diagnose(cy.Parameters(force_exponent=0.0), laws.GRID, laws.state(1))
    assert found["following"] == pytest.approx(found["power_input"], rel=1e-13)
'''


def test_a_diagnostic(tree):
    one, two, three = steps("Add a diagnostic")
    start = "QUANTITIES = (\n"
    tree.change(one, "cyclosis/analysis/diagnostics.py", (start, start + QUANTITY))
    laws = (tree.folder / "tests" / "physics" / "test_laws.py").read_text()
    tree.change(two, "tests/physics/test_laws.py", (laws, laws + LAW))
    assert "1 passed" in tree.run(
        "-m", "pytest", "-v", "-k", "filaments_follow", "tests/physics/test_laws.py"
    )
    tree.python(
        "grid = cy.CylinderGrid(16, 12, 5.0)\n"
        "run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 2.0, 1.0)\n"
        "last = cy.diagnose(run.params, grid, run.final_state)['following']\n"
        "data = cy.open_dataset(cy.write(run, 'run.nc'))\n"
        "assert np.isclose(data['following'][-1], last, rtol=1e-12)\n"
        "assert 'along the flow' in str(data['following'].attrs)\n"
    )
    assert "generate.py" in three
    assert "| `following` | \\<P·u> |" in tree.page("quantities.md").replace("| <P·u>", "| \\<P·u>")


STEPPER = '''def heun_step(system: System, h: Any, t: Any, _: Any, Z: jax.Array, N1: jax.Array) -> Stepped:
    """Advance by Heun's method of second order (Z. Math. Phys. 45 (1900) 23)."""
    N2 = system.nonlinear(system.at(Z + h * N1, t + h))
    new = Z + 0.5 * h * (N1 + N2)
    end = system.at(new, t + h)
    return Stepped(new, system.nonlinear(end), 0.5 * h * (N2 - N1), system.peak(end))


METHODS = {
'''
METHOD = (
    '    "heun": Method(lambda linear, h: jnp.asarray(h), heun_step, order=2, evaluations=2, exact=False, '
    "stability=2.0),\n"
)


def test_a_stepper(tree):
    one, two, three, four, five = steps("Add a stepper")
    tree.change(one, "cyclosis/dynamics/steppers.py", ("METHODS = {\n", STEPPER))
    assert "`METHODS` there" in two
    path = tree.folder / "src" / "cyclosis" / "dynamics" / "steppers.py"
    path.write_text(path.read_text().replace("METHODS = {\n", "METHODS = {\n" + METHOD))
    tree.change(three, "cyclosis/model/definitions.py", ('"etdrk4", "rk4")', '"etdrk4", "rk4", "heun")'))
    place = "tests/physics/test_manufactured.py"
    assert f"pytest {place}" in four
    assert "1 passed" in tree.run("-m", "pytest", "-v", "-k", "heun", place)
    tree.python(
        "grid = cy.CylinderGrid(16, 12, 5.0)\n"
        "ends = [cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 2.0, stepper=name, **how)\n"
        "        for name, how in (('heun', {}), ('adaptive', {'rtol': 1e-8}))]\n"
        "assert np.allclose(ends[0].final_state, ends[1].final_state, atol=1e-3)\n"
        "assert ends[0].effort.evaluations == 2 * ends[0].effort.accepted + 1\n"
    )
    assert "generate.py" in five
    assert "rk4, heun" in tree.page("settings.md")


MODEL_WORKS = """
from scipy.special import iv

ring = cy.models.ring
grid, params = ring.grid(48), ring.parameters(alpha_p=1.0, d_r=0.2)
state = (1 + 0.2 * np.cos(grid.phi)) / (2 * np.pi)
run = cy.simulate(params, grid, state, 60.0, model=ring, rtol=1e-8)
P = run.records["order"][-1]
assert abs(P - iv(1, 5 * P) / iv(0, 5 * P)) < 1e-6 and P > 0.5
half = cy.write(cy.simulate(params, grid, state, 30.0, model=ring, rtol=1e-8), "ring.nc")
assert np.array_equal(cy.resume_file(half, 60.0).final_state, run.final_state)
assert cy.load("ring.nc").model is ring
"""


def test_a_model(tree):
    one, two, three, four, five = steps("Add a model")
    assert "tests/models/ring.py" in one
    source = (tree.folder / "tests" / "models" / "ring.py").read_text()
    assert "cyclosis/models/NAME.py" in two
    (tree.folder / "src" / "cyclosis" / "models" / "ring.py").write_text(source)
    tree.change(
        three,
        "cyclosis/models/__init__.py",
        (
            "from .polar_cylinder import polar as polar\n",
            "from .polar_cylinder import polar as polar\nfrom .ring import ring as ring\n",
        ),
        (
            "for item in (polar, kinetic, coupled, closed)",
            "for item in (polar, kinetic, coupled, closed, ring)",
        ),
    )
    tree.change(
        three,
        "cyclosis/model/definitions.py",
        (
            'allowed=("polar", "kinetic", "coupled", "closed")',
            'allowed=("polar", "kinetic", "coupled", "closed", "ring")',
        ),
    )
    tree.python(MODEL_WORKS)
    assert "polar, kinetic, coupled, closed, ring" in " ".join(tree.cyclosis("run", "--help").split())
    tree.cyclosis("figure", "history", "ring.nc", "--out", "ring.png")
    contract = tree.folder / "tests" / "models" / "test_contract.py"
    assert "tests/models/test_contract.py" in four
    contract.write_text(contract.read_text().replace("from models.ring", "from cyclosis.models.ring"))
    told = tree.run("-m", "pytest", "-v", "-k", "von_mises or bit_for_bit", str(contract))
    assert "4 passed" in told
    assert "generate.py" in five
    assert "polar, kinetic, coupled, closed, ring" in tree.page("settings.md")


EXPERIMENT = '''"""Whether disorder orders."""

import matplotlib.pyplot as plt
import xarray

from ..model import initial
from ..model.grid import CylinderGrid
from ..model.parameters import Parameters
from .experiment import AGREES, DOES_NOT, Experiment, Verdict


def measure(lab):
    grid, orders = CylinderGrid(16, 16, 5.0), []
    for seed in range(lab.seeds):
        run = lab.story(Parameters(), grid, initial.disordered(grid, 100, seed), 20.0)
        orders.append(float(run.records["order"][-1]))
    return xarray.Dataset({"order": ("seed", orders)})


def verdict(data):
    least = float(data["order"].min())
    return Verdict(AGREES if least > 0.5 else DOES_NOT, f"least order {least:.2f}")


def decisive(data):
    return f"{float(data['order'].min()):.2f} is the least order"


def draw(data):
    figure, ax = plt.subplots()
    ax.plot(data["order"])
    return figure


'''
TABLE = """EXPERIMENT = Experiment(
    name="ordering",
    headline="Disorder orders.",
    claim="Disorder orders in every cell.",
    source="Abstract",
    method="Cells are integrated.",
    seeds=10,
    quick_seeds=2,
    measure=measure,
    verdict=verdict,
    decisive=decisive,
    draw=draw,
)
"""


def test_an_experiment(tree):
    one, two, three, four, five = steps("Add an experiment")
    assert "measure(lab)" in one
    assert "verdict(data)" in two
    assert "decisive(data)" in two
    assert "draw(data)" in two
    assert "EXPERIMENT = Experiment" in three
    folder = tree.folder / "src" / "cyclosis" / "experiments"
    (folder / "ordering.py").write_text(EXPERIMENT + TABLE)
    tree.change(four, "cyclosis/experiments/catalogue.py", ("NAMES = (\n", 'NAMES = (\n    "ordering",\n'))
    assert "cyclosis experiment NAME" in five
    assert "Disorder orders in every cell." in tree.cyclosis("experiment", "list")
    told = tree.cyclosis("experiment", "ordering", "--quick", "--quiet", "--out", "out")
    assert re.search(r"AGREES.*least order 0\.\d\d", told, re.DOTALL)
    assert sorted(path.name for path in (tree.folder / "out").glob("ordering.*")) == [
        "ordering.nc",
        "ordering.png",
    ]
