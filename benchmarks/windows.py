"""What averages over interrogation windows do to a fit, with the window unknown and known.

    python benchmarks/windows.py --method equation
    python benchmarks/windows.py --method film --windows 16 --noise-px 0.1

* equation: the exact P and u of a film at 64 x 64 points from t = 1 to 30, every 0.25 R/U; u is averaged over
  windows, and taken up to 58 degrees from the middle
* film: vectors of the synthetic microscope from t = 4 to 10, every 0.5 R/U, R = 100 px, steps of 8 px, axis
  at 17 degrees; epsilon, d_r and kappa are given
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from typing import Any

import numpy as np

import cyclosis as cy
from cyclosis.fitting.windows import Window, averaging

TRUTH = {**{name: float(value) for name, value in cy.Parameters().items()}, "U": 1.0}
TILT = 0.3


def averaged(side: float) -> Any:
    """Return a film of P and of u through windows of a side in radii."""
    grid, times = cy.CylinderGrid(64, 64), np.arange(1.0, 30.01, 0.25)
    start = cy.initial.disordered(grid, seed=0)
    run = cy.simulate(cy.Parameters(), grid, start, t_end=30.0, save_at=times, rtol=1e-7)
    data = run.to_dataset()[["P", "u"]].drop_attrs()
    seen = data.isel(theta=np.abs(data["theta"].values - np.pi) < np.radians(70))
    operator = averaging(Window(side, TILT), seen["theta"].values, np.pi, grid.m, grid.q)
    along = np.exp(1j * np.outer(grid.z, grid.q))
    waves = np.fft.fft2(data["u"].values, norm="forward")
    u = np.stack([np.einsum("camn,cmn,bn->cab", operator, wave, along, optimize=True).real for wave in waves])
    return seen.assign(u=(seen["u"].dims, u)).assign_attrs(facing=np.pi)


def measured(window: int, noise: float) -> Any:
    """Return vectors of the microscope on the surface, with and without the window."""
    grid, axis = cy.CylinderGrid(64, 64), 17.0
    start = cy.initial.disordered(grid, seed=0, noise_grid=(32, 32))
    run = cy.simulate(cy.Parameters(), grid, start, t_end=10.0, save_every=0.25)
    times, camera = np.arange(4.0, 10.01, 0.5), cy.observations.View(100.0, axis)
    options = {"window_px": window, "step_px": 8, "noise_px": noise, "times": times}
    shot = cy.observations.observe(run, camera, "piv", **options)
    x, y, vx, vy = (shot.data[name].values for name in ("x", "y", "vx", "vy"))
    unit = shot.camera.scales.time_s
    frames = [
        cy.observations.gridded(x, y, a / 0.3, b / 0.3, time=float(t) * unit)
        for a, b, t in zip(vx, vy, times, strict=True)
    ]
    seen = cy.observations.Observation(tuple(frames), pixel_um=5.0, frame_s=0.3, noise_px=noise)
    seen = seen.view(100.0, axis, shot.camera.view.centre_px, mirrored=False)
    for each in (None, float(window)):
        surface = replace(seen, window_px=each).on_surface(scales=shot.camera.scales, max_angle_deg=60.0)
        yield surface.sel(z=slice(0.0, 4.99)).assign_attrs(length=5.0)


def show(window: float, known: str, fit: Any) -> None:
    """Print a row of errors, with half widths of intervals in brackets."""
    cells = [
        f"{name} {100 * (value / TRUTH[name] - 1):+.1f} [{50 * np.ptp(fit.interval[name]) / TRUTH[name]:.1f}]"
        for name, value in fit.estimate.items()
    ]
    print(f"{window:g} {known}:", *cells, f"residual {fit.residual:.3f}", fit.refused or "", flush=True)


def main() -> None:
    """Print errors in per cent."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--method", choices=["equation", "film"], default="equation")
    parser.add_argument("--windows", type=int, nargs="+", default=[16, 24, 32], help="hundredths of a radius")
    parser.add_argument("--noise-px", type=float, default=0.1)
    given = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)
    for window in given.windows:
        if given.method == "equation":
            data = averaged(window / 100)
            inner = data.isel(theta=np.abs(data["theta"].values - np.pi) < np.radians(58))
            show(window, "unknown", cy.fit(inner))
            show(window, "known", cy.fit(data, window=window / 100))
            continue
        fixed = {name: TRUTH[name] for name in ("epsilon", "d_r", "kappa")}
        for known, data in zip(("unknown", "known"), measured(window, given.noise_px), strict=True):
            show(window, known, cy.fit(data[["u"]], method="film", fix=fixed))


if __name__ == "__main__":
    main()
