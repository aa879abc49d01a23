"""The rooms of the package import only what lies below them."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "cyclosis"
ORDER = [
    "version",
    "display",
    "model",
    "analysis",
    "dynamics",
    "stability",
    "dataset",
    "config",
    "ensemble",
    "sweep",
    "figures",
    "experiments",
    "explorer",
    "traced",
    "report",
    "progress",
    "cli",
    "__main__",
]
LAZY = {("dynamics/trajectory.py", "dataset")}
"""The one upward import that is allowed: `Trajectory.to_dataset`."""
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


def test_every_public_name_loads_and_none_is_missing():
    import cyclosis

    for name in cyclosis.__all__:
        assert getattr(cyclosis, name) is not None, name
    with pytest.raises(AttributeError, match="nonsense"):
        cyclosis.nonsense  # noqa: B018
