"""The rooms of the package import only what lies below them."""

import ast
import graphlib
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "cyclosis"
ORDER = [
    "version",
    "display",
    "model",
    "contract",
    "closed",
    "analysis",
    "models",
    "dynamics",
    "traced",
    "stability",
    "kinetic",
    "dataset",
    "vacuole",
    "config",
    "ensemble",
    "fitting",
    "sweep",
    "figures",
    "observations",
    "experiments",
    "explorer",
    "report",
    "progress",
    "cli",
    "__main__",
]
LAZY = {
    ("dynamics/trajectory.py", "dataset"),
    ("dynamics/trajectory.py", "figures"),
    ("models/polar_cylinder.py", "ensemble"),
}
"""The upward imports that are allowed: `to_dataset` and `plot` of a run, and the theory of final regimes."""
HEAVY = (
    *("jax", "scipy", "xarray", "matplotlib", "h5netcdf", "h5py", "contourpy"),
    *("rich.progress", "fastapi", "uvicorn"),
)


def room(path):
    parts = path.relative_to(ROOT).parts
    return parts[0].removesuffix(".py")


def imports(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.parent
            for _ in range(node.level - 1):
                base = base.parent
            targets = [node.module] if node.module else [alias.name for alias in node.names]
            for target in targets:
                yield (base / target.replace(".", "/")).relative_to(ROOT).parts[0]


FILES = [path for path in sorted(ROOT.rglob("*.py")) if path != ROOT / "__init__.py"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_run_down(path):
    own = ORDER.index(room(path))
    for target in imports(path):
        if (str(path.relative_to(ROOT)), target) not in LAZY:
            assert ORDER.index(target) <= own, f"{path.name} imports {target}, which lies above it"


def at_once(tree):
    """Yield what a module does when it is loaded: not what its functions do, nor what types alone need."""
    waiting = list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.If | ast.Try | ast.With | ast.ClassDef):
            waiting += node.body
        yield node


def files_needed(path, nodes=at_once):
    """Yield the files of the package that a file loads: at once, or ever, with `nodes=ast.walk`."""
    for node in nodes(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            place = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for alias in node.names:
                found = (place / f"{alias.name}.py", place / alias.name / "__init__.py")
                yield next((file for file in (*found, place.with_suffix(".py")) if file in FILES), None)


GENERIC = (
    "contract",
    "dynamics",
    "dataset",
    "sweep",
    *(f"ensemble/{n}.py" for n in ("members", "lanes", "axial_lanes", "packing", "run", "scheduled")),
)
"""Rooms and files that serve every model."""
OF_ONE_MODEL = ("analysis", *(f"model/{n}" for n in ("system", "filaments", "spectral", "initial", "moment")))
"""What belongs to the polar model, and is reached through `cyclosis.models` alone."""
SERVE_ALL = [path for path in FILES if str(path.relative_to(ROOT)).startswith(GENERIC)]


@pytest.mark.parametrize("path", SERVE_ALL, ids=lambda path: str(path.relative_to(ROOT)))
def test_rooms_for_every_model_know_none_by_heart(path):
    for file in files_needed(path, ast.walk):
        if file is not None:
            name = str(file.relative_to(ROOT))
            assert not name.startswith(OF_ONE_MODEL), f"{path.name} imports {name}"


def test_no_file_needs_itself_by_way_of_others():
    needs = {path: {file for file in files_needed(path) if file} - {path} for path in FILES}
    assert sum(map(len, needs.values())) > 1000
    graphlib.TopologicalSorter(needs).prepare()  # raises CycleError with the files of a circle


def loaded_by(code):
    out = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(out.stdout.split())


@pytest.mark.parametrize(
    "code", ["import cyclosis", "import cyclosis.cli", "import cyclosis; cyclosis.Parameters()"]
)
def test_heavy_libraries_load_only_when_used(code):
    assert not loaded_by(code) & set(HEAVY)


RUN = """
import sys
from cyclosis.cli import main
sys.argv = "cyclosis run --kind stripes --n-theta 16 --n-z 16 --t-end 0.5 --out run.nc --quiet".split()
try:
    main()
except SystemExit as ended:
    assert not ended.code
"""
FOR_A_RUN = {"jax", "scipy", "h5py", "h5netcdf", "rich.progress"}
UNUSED = (set(HEAVY) - FOR_A_RUN) | {
    "scipy.optimize.elementwise",
    "pandas",
    "dask",
    "distributed",
    "zarr",
    "av",
    "PIL",
    "pyevtk",
}


def test_a_run_loads_nothing_that_it_does_not_use(tmp_path, monkeypatch):
    """One whose frames have indifferent zones, which are looked for in every frame that is stored."""
    monkeypatch.chdir(tmp_path)
    assert not loaded_by(RUN) & UNUSED
    assert (tmp_path / "run.nc").exists()


def test_every_public_name_loads_and_none_is_missing():
    import cyclosis

    for name in cyclosis.__all__:
        assert getattr(cyclosis, name) is not None, name
    with pytest.raises(AttributeError, match="nonsense"):
        cyclosis.nonsense  # noqa: B018
