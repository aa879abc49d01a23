"""What all codes compute, how each is called, and what counts as an error."""

from __future__ import annotations

import importlib
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version

import numpy as np

import cyclosis as cy
from cyclosis.model.grid import interpolate

PARAMS = cy.Parameters(alpha_p=1.0, alpha_u=0.5)
NOISE_GRID = (32, 32)
LENGTHS = {"2 pi": 2 * np.pi, "5": 5.0}
TIMES = (10.0, 100.0)
TOLERANCE = 1e-4
FINE = {"n": 128, "dt": 0.0125}
STEPS = tuple(1 / k for k in (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 128))
"""Time steps that a scan tries, all of which divide both times."""
SIZES = (54, 56, 60, 64, 72)
GRID_RUNS = {64: (10.0, 9), 128: (10.0, 7), 256: (10.0, 5), 512: (5.0, 3), 1024: (2.0, 3)}
"""Final time and number of turns on each grid of `grids`."""
PROBE_DT = 1 / 64
"""Step of the short runs that time a right-hand side."""


@dataclass(frozen=True)
class Code:
    """A code that computes the case: its module here, its packages, and what a scan tries.

    `probe` names the variant that times a right-hand side, and how many its steps have. Members are computed
    one after another by `module`, or as a whole by the function `ensemble` of the module `together`; if
    `batched`, that function takes `batch`, the number of members that are computed at once.
    """

    name: str
    module: str
    packages: tuple[str, ...]
    install: str
    variants: dict[str, dict] = field(default_factory=lambda: {"": {}})
    square_only: bool = False
    rtols: tuple[float, ...] = ()
    probe: tuple[str, int] | None = None
    together: str = ""
    batched: bool = False

    def steps(self, how: dict) -> tuple[float, ...]:
        """Return the steps that a scan tries, or tolerances where the code chooses its steps by one."""
        return self.rtols if self.rtols and how.get("stepper") != "etdrk4" else STEPS

    def lengths(self) -> dict[str, float]:
        """Return the lengths that the code can compute."""
        return {"2 pi": LENGTHS["2 pi"]} if self.square_only else LENGTHS

    def installed(self) -> str:
        """Return the versions of the packages, or nothing if one is missing."""
        try:
            return " + ".join(version(package) for package in self.packages)
        except PackageNotFoundError:
            return ""

    def prepare(self, n: int, length: float, step: float, how: dict):
        """Return the function that takes a state to a time."""
        return importlib.import_module(self.module).prepare(PARAMS, n, length, step, **how)

    def ensemble(self, n: int, length: float, step: float, how: dict):
        """Return the function that takes many states to a time."""
        if self.together:
            return importlib.import_module(self.together).ensemble(PARAMS, n, length, step, **how)
        advance = self.prepare(n, length, step, how)
        return lambda states, t_end: [advance(state, t_end) for state in states]


CODES = {
    code.name: code
    for code in (
        Code(
            "cyclosis",
            "cyclosis_model",
            ("cyclosis",),
            "pip install .",
            {"adaptive": {}, "multistep": {"stepper": "multistep"}, "etdrk4": {"stepper": "etdrk4"}},
            rtols=(3e-3, 1e-3, 5e-4, 2e-4, 1e-4, 3e-5, 1e-5),
            probe=("etdrk4", 4),
            together="cyclosis_model",
        ),
        Code(
            "dedalus",
            "dedalus_model",
            ("dedalus",),
            "apt-get install libopenmpi-dev libfftw3-dev libfftw3-mpi-dev && "
            "CC=mpicc MPI_PATH=/usr FFTW_PATH=/usr pip install dedalus",
            {
                "SBDF3": {"scheme": "SBDF3"},
                "SBDF4": {"scheme": "SBDF4"},
                "RK443": {"scheme": "RK443"},
                "SBDF4, dealiased by 3/2": {"scheme": "SBDF4", "dealias": 1.5},
            },
            probe=("RK443", 4),
        ),
        Code(
            "exponax",
            "exponax_model",
            ("exponax",),
            "pip install exponax",
            {"ETDRK4": {}},
            square_only=True,
            probe=("ETDRK4", 4),
            together="exponax_ensemble",
            batched=True,
        ),
        Code(
            "numba",
            "numba_model",
            ("numba", "pyfftw"),
            "pip install numba pyfftw",
            {"ETDRK4": {}},
            probe=("ETDRK4", 4),
        ),
        Code(
            "py-pde",
            "pypde_model",
            ("py-pde",),
            "pip install py-pde",
            {"derivatives by Fourier transforms": {"derivatives": "fourier"}},
        ),
    )
}
DIFFERENCES = {"derivatives": "differences"}
"""How py-pde computes with its own operators; see `differences` in scan.py."""


def start(n: int, length: float, seed: int = 0) -> np.ndarray:
    """Return disorder, the same on every grid."""
    return cy.initial.disordered(cy.CylinderGrid(n, n, length), seed=seed, noise_grid=NOISE_GRID)


def reference(length, times=TIMES, n: int = FINE["n"], dt: float = FINE["dt"], seed: int = 0) -> dict:
    """Return the states of a fine run at the given times."""
    grid, state = cy.CylinderGrid(n, n, length), start(n, length, seed)
    run = cy.simulate(PARAMS, grid, state, times[-1], save_at=list(times), stepper="etdrk4", dt=dt)
    return dict(zip(times, run.frames, strict=True))


def error(state: np.ndarray, fine: np.ndarray) -> float:
    """Return the relative L2 error of a state, after spectral interpolation to the fine grid."""
    if not np.all(np.isfinite(state)):
        return float("inf")
    found = interpolate(state, fine.shape[1:])
    return float(np.linalg.norm(found - fine) / np.linalg.norm(fine))
