"""What films of u tell at best: the Fisher information at the truth, the initial state integrated out.

    python benchmarks/bounds.py

The paper's cell at 32 x 32 points, seed 0, 70 degrees either way, 2 % noise. The prior is that of
`cyclosis.fit`: a factor e for the parameters, P smooth over 2.5 waves per radian. Standard deviations in %.
"""

from __future__ import annotations

import argparse

import numpy as np
import xarray

import cyclosis as cy
from cyclosis.fitting.film import film_of
from cyclosis.fitting.prepared import prepared
from cyclosis.model.precision import double

NAMES = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu")
NOISE, POINTS, WAVES = 0.02, 32, 2.5
FILMS = {
    "13 frames, t = 4 to 10": (4.0, 10.0, 0.5, ("u",)),
    "25 frames, t = 4 to 10": (4.0, 10.0, 0.25, ("u",)),
    "25 frames, t = 4 to 16": (4.0, 16.0, 0.5, ("u",)),
    "49 frames, t = 4 to 16": (4.0, 16.0, 0.25, ("u",)),
    "97 frames, t = 4 to 28": (4.0, 28.0, 0.25, ("u",)),
    "13 frames, t = 4 to 10, and angles to 6 degrees": (4.0, 10.0, 0.5, ("u", "angle")),
}


def bound(begin: float, end: float, every: float, fields: tuple[str, ...]) -> np.ndarray:
    """Return standard deviations of the logarithms of the parameters."""
    grid, times = cy.CylinderGrid(POINTS, POINTS), np.arange(begin, end + 1e-9, every)
    start = cy.initial.disordered(grid, seed=0)
    run = cy.simulate(cy.Parameters(), grid, start, t_end=times[-1], save_at=times, rtol=1e-7)
    data = run.to_dataset()[["P", "u"]].drop_attrs().assign_attrs(length=grid.length)
    P = data["P"]
    data["angle"] = np.arctan2(P.sel(component="theta"), P.sel(component="z"))
    seen = data.isel(theta=np.abs(data["theta"].values - np.pi) <= np.radians(70))[list(fields)]
    noise = {"u": NOISE, "angle": 0.1}
    rng = np.random.default_rng(0)
    noisy = xarray.Dataset(
        {k: f + noise[k] * rng.normal(size=f.shape) for k, f in seen.items()}, attrs=seen.attrs
    )
    with double():
        match = prepared(film_of(noisy, None), NAMES, {"U": 1.0}, None, None)
        sigma = {k: np.full_like(each, noise[k]) for k, each in match.arrays.sigma.items()}
        problem = type(match)(**{**vars(match), "arrays": match.arrays._replace(sigma=sigma)}).problem()
        around, along = (wave[:, k] for wave, k in zip(match.arrays.waves, match.arrays.kept, strict=True))
        design = np.einsum("ak,bk->abk", around, along).reshape(grid.n_theta * grid.n_z, -1)
        first = P.values[0].reshape(2, -1)
        waves = np.linalg.lstsq(design, first.T, rcond=None)[0].T.ravel()
        x = np.concatenate([np.log([TRUTH[name] for name in NAMES]), waves])
        size = float(np.sqrt(np.mean(np.sum(P.values[0] ** 2, axis=0)) / 2))
        white = problem.scale(size, WAVES)[:, None] * problem.jacobian(x)
    inverse = np.linalg.inv(white @ white.T + np.eye(x.size))
    return np.sqrt(np.diag(inverse)[: len(NAMES)])


TRUTH = dict(cy.Parameters().items())


def main() -> None:
    """Print a row for each film."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="films whose name contains this")
    given = parser.parse_args()
    print("| film |", " | ".join(NAMES), "|")
    for name, film in FILMS.items():
        if given.only not in name:
            continue
        print(f"| {name} |", " | ".join(f"{100 * each:.1f}" for each in bound(*film)), "|", flush=True)


if __name__ == "__main__":
    main()
