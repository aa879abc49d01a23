"""How well films of other people come back: drawn by a renderer that shares no code with the package.

python benchmarks/strangers.py                # half an hour on one core: each line is one film
python benchmarks/strangers.py sparse drift   # some of them
"""

import sys
import tempfile
from pathlib import Path

import av
import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates, shift

import cyclosis as cy
from cyclosis.observations import film

FRAME_S, RADIUS, AXIS, SIZE = 0.3, 100.0, 17.0, (300, 440)
LENGTH = 5.0
FILMS = {
    "plain": {},
    "12 pixels a frame": {"speed": 12.0},
    "20 pixels a frame": {"speed": 20.0},
    "0.8 pixels a frame": {"speed": 0.8, "frames": 8},
    "a seventh of the spots": {"density": 1 / 400},
    "five times the spots": {"density": 1 / 12, "bright": 25.0},
    "spots of 4 pixels": {"size": 4.0, "density": 1 / 250},
    "dark on bright": {"inverted": True},
    "noise as strong as spots": {"bright": 20.0, "read": 6.0, "photons": 0.5},
    "lamp flickers, dark corners": {"flicker": 0.15, "vignette": 0.7},
    "bleaching, 12 frames": {"bleach": 0.1, "frames": 12},
    "spots last 5 frames": {"life": 5.0},
    "Brownian motion of a pixel": {"jitter": 1.0},
    "strong light at rest, 40 frames": {"still": 25.0, "frames": 40},
    "strong light at rest, 12 frames": {"still": 25.0, "frames": 12},
    "stage drifts 0.7 pixels a frame": {"still": 12.0, "frames": 40, "drift": (0.6, -0.4)},
    "two streams": {"start": 30.0},
    "two streams, 12 pixels a frame": {"start": 30.0, "speed": 12.0},
    "two streams, light at rest": {"start": 30.0, "still": 25.0, "frames": 40},
}


class Surface:
    """The flow of a run at any place and time: splines over the grid, linear in time."""

    def __init__(self, run):
        self.times, self.u = run["time"].values, run["u"].values

    def __call__(self, theta, z, time):
        """Return u (2, n) at places and a time."""
        k = int(np.clip(np.searchsorted(self.times, time) - 1, 0, self.times.size - 2))
        w = (time - self.times[k]) / (self.times[k + 1] - self.times[k])
        u = (1 - w) * self.u[k] + w * self.u[k + 1]
        n, m = u.shape[1:]
        at = np.mod(theta, 2 * np.pi) * n / (2 * np.pi), np.mod(z, LENGTH) * m / LENGTH
        return np.array([map_coordinates(part, at, order=3, mode="grid-wrap") for part in u])


def directions():
    """Return the directions of z and of theta in the picture (y down); no mirror."""
    a = np.deg2rad(AXIS)
    along = np.array([np.cos(a), -np.sin(a)])
    return along, np.array([-along[1], along[0]])


def rendered(
    flow,
    start=6.0,
    frames=5,
    speed=6.0,
    density=1 / 60,
    size=1.5,
    bright=60.0,
    back=20.0,
    read=2.0,
    photons=2.0,
    inverted=False,
    still=0.0,
    drift=(0.0, 0.0),
    vignette=0.0,
    flicker=0.0,
    bleach=0.0,
    life=0.0,
    jitter=0.0,
    shape=SIZE,
    radius=RADIUS,
    seed=0,
):
    """Return the frames of a film (frames, rows, columns), 8 bits, and the model's time between two of them.

    `speed` is what U is in pixels a frame; `density` is spots per square pixel of the surface, of standard
    deviation `size`; `still` is the contrast of light at rest; `life` is in frames, `jitter` in pixels.
    """
    rng = np.random.default_rng(seed)
    rows, columns = shape
    along, across = directions()
    half = 0.5 * np.hypot(rows, columns) / radius + 1
    count = int(density * np.pi * radius**2 * 2 * half)
    phi, z = rng.uniform(-np.pi / 2, np.pi / 2, count), rng.uniform(-half, half, count)
    strength = rng.uniform(0.5, 1.5, count)
    rest = gaussian_filter(rng.normal(size=(rows + 80, columns + 80)), 3.0)
    rest /= rest.std()
    y, x = np.mgrid[:rows, :columns]
    corner = ((y - rows / 2) / (rows / 2)) ** 2 + ((x - columns / 2) / (columns / 2)) ** 2
    step, time, out = speed / radius, start, []
    for k in range(frames):
        at = radius * (np.outer(across, np.sin(phi)) + np.outer(along, z)) + np.array(drift)[:, None] * k
        light = np.zeros(shape)
        reach = np.arange(-int(4 * size) - 1, int(4 * size) + 2)
        for px, py, each in zip(at[0] + columns / 2, at[1] + rows / 2, strength, strict=True):
            i, j = round(py) + reach, round(px) + reach
            i, j = i[(i >= 0) & (i < rows)], j[(j >= 0) & (j < columns)]
            if i.size and j.size:
                spot = np.exp(-((i[:, None] - py) ** 2 + (j - px) ** 2) / (2 * size**2))
                light[np.ix_(i, j)] += each * spot
        moved = shift(rest, (drift[1] * k, drift[0] * k), order=3, mode="nearest")[40:-40, 40:-40]
        light = (back + bright * light + still * moved) * (1 - 0.5 * vignette * corner)
        light = np.maximum(light * (1 + flicker * rng.normal()) * (1 - bleach) ** k, 0.0)
        seen = rng.poisson(light * photons) / photons + read * rng.normal(size=shape)
        out.append(np.clip(200 - seen if inverted else seen, 0, 255).astype(np.uint8))
        for _ in range(4):
            first = flow(phi, z, time)
            middle = flow(phi + step / 8 * first[0], z + step / 8 * first[1], time + step / 8)
            phi, z, time = phi + step / 4 * middle[0], z + step / 4 * middle[1], time + step / 4
        phi, z = (part + jitter / radius * rng.normal(size=count) for part in (phi, z))
        phi, z = np.mod(phi + np.pi / 2, np.pi) - np.pi / 2, np.mod(z + half, 2 * half) - half
        new = rng.random(count) < (1 / life if life else 0.0)
        phi[new], z[new] = rng.uniform(-np.pi / 2, np.pi / 2, new.sum()), rng.uniform(-half, half, new.sum())
    return np.stack(out), step


def written(path, frames):
    """Write frames as a video that is compressed as cameras and phones do."""
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=10)
        stream.height, stream.width = frames.shape[1:]
        stream.pix_fmt, stream.options = "yuv420p", {"crf": "18"}
        for frame in frames:
            picture = av.VideoFrame.from_ndarray(np.repeat(frame[..., None], 3, axis=2), format="rgb24")
            for packet in stream.encode(picture):
                file.mux(packet)
        for packet in stream.encode():
            file.mux(packet)
    return path


def errors(flow, seen, start, step, speed=6.0, shape=SIZE, radius=RADIUS):
    """Return errors within 60 degrees of the facing line, as shares of the peak, and the share of samples.

    They are the median of the displacement's error, and the rms of the surface's u_theta and u_z.
    """
    along, across = directions()
    found = []
    for frame in seen.frames:
        place = np.stack([frame.x - shape[1] / 2, frame.y - shape[0] / 2]) / radius
        s, z = across @ place, along @ place
        cap = np.abs(s) < np.sin(np.pi / 3)
        phi = np.arcsin(np.clip(s, -1, 1))
        u = speed * flow(phi, z, start + step * frame.time / FRAME_S)
        true = np.outer(across, u[0] * np.cos(phi)) + np.outer(along, u[1])
        off = FRAME_S * np.stack([frame.vx, frame.vy]) - true
        peak, good = np.hypot(*true)[cap].max(), frame.good & cap
        parts = (across @ off / np.cos(phi))[good], (along @ off)[good]
        rms = [np.sqrt((part**2).mean()) / peak for part in parts]
        found.append([np.median(np.hypot(*off)[good]) / peak, *rms, good.sum() / cap.sum()])
    return np.mean(found, axis=0)


def main() -> None:
    """Print one line for each film."""
    grid = cy.CylinderGrid(64, 64, LENGTH)
    start = cy.initial.disordered(grid, seed=0, noise_grid=(32, 32))
    flow = Surface(cy.simulate(cy.Parameters(), grid, start, t_end=45.0, save_every=0.25).to_dataset())
    for name in FILMS if len(sys.argv) < 2 else [n for n in FILMS if any(w in n for w in sys.argv[1:])]:
        options = FILMS[name]
        frames, step = rendered(flow, **options)
        with tempfile.TemporaryDirectory() as folder:
            path = written(Path(folder) / "film.mp4", frames)
            seen = film(path, frame_s=FRAME_S, pairs=8)
        place = options.get("start", 6.0), step, options.get("speed", 6.0)
        median, around, axial, share = errors(flow, seen, *place)
        numbers = f"median {median:.1%}  u_theta {around:.1%}  u_z {axial:.1%}  good {share:.0%}"
        print(f"{name}: {numbers}; {seen.notes[-1]}", flush=True)


if __name__ == "__main__":
    main()
