"""How well films of the model come back: render, measure with `cy.observations.film`, compare.

python benchmarks/films.py    # ten minutes
"""

import tempfile

import numpy as np

import cyclosis as cy
from cyclosis.observations import View, film, observe
from cyclosis.observations.microscope.body import body_of

FILMS = {
    "t = 6, axis 17": (17.0, False, 6.0, "avi", {"frames": 5}),
    "t = 6, axis 90, mirrored": (90.0, True, 6.0, "mp4", {"frames": 24, "chloroplasts": True}),
    "t = 30, axis 17": (17.0, False, 30.0, "mp4", {"frames": 40, "chloroplasts": True}),
    "t = 30, axis -63, mirrored": (-63.0, True, 30.0, "tiff", {"frames": 5}),
    "t = 10, axis 200, 120 um in focus": (200.0, False, 10.0, "avi", {"frames": 5, "depth_um": 120.0}),
}


def errors(body, seen, camera, start):
    """Return the median error, and the rms errors of u_theta and u_z, in shares of the peak; |phi| < 60."""
    found, unit = [], camera.scales.time_s
    for frame in seen.frames:
        xyz, cos_phi = camera.near(body, frame.x, frame.y)
        cap = cos_phi > 0.5
        good = frame.good & cap
        v = np.full((2, frame.x.size), np.nan)
        v[:, cap] = camera.moved(body.velocity(xyz[:, cap], start + frame.time / unit))
        v /= unit
        peak = np.nanmax(np.hypot(*v))
        places = frame.x[good], frame.y[good]
        one = camera.view.velocity_to_surface(*places, frame.vx[good], frame.vy[good])
        other = camera.view.velocity_to_surface(*places, *v[:, good])
        off = camera.view.radius_px * (np.array(one) - np.array(other))
        apart = np.hypot(frame.vx[good] - v[0, good], frame.vy[good] - v[1, good])
        rms = np.sqrt((off**2).mean(axis=1))
        found.append([np.median(apart) / peak, *(rms / peak), good.sum() / cap.sum()])
    return np.mean(found, axis=0)


def main() -> None:
    """Print one line for each film."""
    grid = cy.CylinderGrid(64, 64, 5.0)
    start = cy.initial.disordered(grid, seed=0, noise_grid=(32, 32))
    data = cy.simulate(cy.Parameters(), grid, start, t_end=40.0, save_every=0.25).to_dataset()
    body = body_of(data)
    for name, (axis, mirrored, first, format, options) in FILMS.items():
        made = observe(data, View(100.0, axis, mirrored=mirrored), "film", start=first, **options)
        with tempfile.TemporaryDirectory() as folder:
            seen = film(made.write(folder, format)[0], frame_s=0.3, pairs=4)
        median, around, along, share = errors(body, seen, made.camera, first)
        numbers = f"median {median:.1%}  u_theta {around:.1%}  u_z {along:.1%}  good {share:.0%}"
        print(f"{name}: {numbers}  noise {seen.noise_px:.3f} px")


if __name__ == "__main__":
    main()
