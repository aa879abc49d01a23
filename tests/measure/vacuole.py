"""The flow in the vacuole against an independent solver, fifty-digit solutions, and closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq

import cyclosis as cy
from cyclosis.vacuole.helix import radial_stream
from vacuole_oracle import wave

from . import Row, band_limited

REFERENCE = Path(__file__).parents[1] / "reference" / "vacuole.npz"
NAMES = ("random", "compressible", "helix", "emerging")
RADII = (1e-9, 0.01, 0.3, 0.8, 0.99, 0.9999)
WAVES = (
    *((0, 1), (0, 60), (1, 0), (1, 1), (1, 60), (-2, 3)),
    *((3, 1), (12, 40), (30, 0), (30, 2), (30, 60), (-60, 1)),
)
LENGTHS = (0.2, 5.0, 1000.0)
Q = 2 * np.pi / 5


def flow_of(name):
    """Return the flow of a wall in the reference file, and what the file says about it."""
    with np.load(REFERENCE) as file:
        about = json.loads(str(file["meta"]))
        known = {key.removeprefix(f"{name}_"): file[key] for key in file if key.startswith(f"{name}_")}
    grid = cy.CylinderGrid(*known["u"].shape[1:], about[name]["length"])
    return cy.vacuole.flow(grid, known["u"]), known


def reference():
    """Four walls against a solver without Bessel functions, at points that include the axis and the wall."""
    rows = []
    for name in NAMES:
        flow, known = flow_of(name)
        points = known["points"].copy()
        points[:, 0] = np.maximum(points[:, 0], 1e-9)  # where the file has the axis
        work, volume = known["dissipation"]
        law = f"vacuole reference, {name}"
        for what, value, bound in (
            ("velocity", np.abs(flow.at(points) - known["velocity"]).max(), 2e-12),
            ("Cartesian velocity", np.abs(flow.cartesian_at(points) - known["cartesian"]).max(), 2e-12),
            ("pressure", np.abs(flow.pressure_at(points) - known["pressure"]).max(), 5e-11),
            ("traction", np.abs(flow.wall_traction - known["traction"]).max(), 1e-10),
        ):
            rows.append(Row(law, f"max error of {what}", float(value), bound))
        rows.append(Row(law, "dissipation / work of the wall - 1", abs(flow.dissipation / work - 1), 1e-11))
        rows.append(Row(law, "dissipation / ∫ 2 e:e dV - 1", abs(flow.dissipation / volume - 1), 1e-9))
    return rows


def oracle():
    """Single waves against fifty digits: in short and long cells, on the axis, at the wall."""
    rows = []
    for length in LENGTHS:
        worst = dict.fromkeys(("velocity", "pressure", "traction"), 0.0)
        for m, j in WAVES:
            for a, b in ((1.0, 0.0), (0.0, 1.0)):
                q = 2 * np.pi * j / length
                found = cy.vacuole.wave(m, q, a, b, RADII)
                size = max(1.0, abs(wave(m, q, a, b, 1.0)[1]))
                for k, r in enumerate(RADII):
                    v, p, stress = wave(m, q, a, b, r)
                    worst["velocity"] = max(worst["velocity"], np.abs(found.velocity[:, k] - v).max())
                    worst["pressure"] = max(worst["pressure"], abs(found.pressure[k] - p) / size)
                large = max(1.0, *map(abs, stress))
                worst["traction"] = max(worst["traction"], np.abs(found.traction - stress).max() / large)
        law = f"vacuole waves to (30, 60) and (60, 1), length {length:g}"
        rows.append(Row(law, "max error of the velocity", float(worst["velocity"]), 1e-12))
        rows.append(Row(law, "max error of the pressure, relative", float(worst["pressure"]), 1e-12))
        rows.append(Row(law, "max error of the traction, relative", float(worst["traction"]), 1e-12))
    return rows


def bands():
    """Two bands, +1 and -1 at half of the wall each: the arctangent."""
    grid = cy.CylinderGrid(1024, 8)
    n = np.arange(1, 512, 2)
    wall = np.zeros((2, *grid.shape))
    wall[1] = (4 / (np.pi * n) * np.sin(np.outer(grid.theta, n))).sum(axis=1)[:, None]
    flow = cy.vacuole.flow(grid, wall)
    r, theta = (part.ravel() for part in np.meshgrid([0.0, 0.25, 0.5, 0.75, 0.9], np.arange(0.1, 6.2, 0.3)))
    exact = 2 / np.pi * np.arctan2(2 * r * np.sin(theta), 1 - r**2)
    found = flow.at(np.stack([r, theta, np.zeros(r.size)], axis=1))
    shear = flow.at([[1e-3, np.pi / 2, 0.0]])[0, 2] / np.arctan(1e-3)
    middle = flow.at([[r, np.pi / 2, 0.0] for r in (0.25, 0.5, 0.75, 0.9)])[:, 2]
    law = "vacuole, two bands"
    known = np.array([0.3119165215, 0.5903344706, 0.8193310588, 0.9330491666])
    return [
        Row(law, "max error of v_z against (2/π) atan2", float(np.abs(found[:, 2] - exact).max()), 1e-12),
        Row(law, "max |v_r|, |v_θ|", float(np.abs(found[:, :2]).max()), 1e-14),
        Row(law, "shear on the axis - 4/π", abs(shear - 4 / np.pi), 1e-12),
        Row(law, "error of ten known digits", float(np.abs(middle - known).max()), 6e-11),
    ]


def profile_of_cyclosis():
    """Return u_z(φ) of steady cyclosis at alpha = (1, 0.5), evenly spaced."""
    return cy.stability.cyclosis(cy.Parameters(alpha_p=1.0, alpha_u=0.5), n_theta=128).u


def cyclosis():
    """Steady cyclosis: speeds, shear and dissipation that an earlier program found."""
    grid = cy.CylinderGrid(128, 8)
    u = np.zeros((2, *grid.shape))
    u[1] = profile_of_cyclosis()[:, None]
    flow = cy.vacuole.flow(grid, u)
    modes = 2 * np.abs(flow.modes[1, [1, 3, 5, 7], 0])
    top = float(np.angle(flow.modes[1, 1, 0]))  # the first wave is cos(θ + top)
    middle = flow.at([[r, -top, 0.0] for r in (0.25, 0.5, 0.75, 0.9)])[:, 2]
    section = 0.5 * np.sum((2 * np.abs(flow.modes[1, 1:64, 0])) ** 2 / (2 * np.arange(1, 64) + 2))
    area = 2 * np.pi * grid.length
    known = (1.13899777, 0.201248972, 0.0364025416, 0.000387936)
    speeds = (0.2816404790, 0.5454734397, 0.7777304693, 0.8987191304)
    shear = flow.at([[1e-6, -top, 0.0]])[0, 2] / 1e-6
    law = "vacuole, cyclosis"
    return [
        Row(law, "error of four known amplitudes", float(np.abs(modes - known).max()), 6e-9),
        Row(law, "error of four known speeds", float(np.abs(middle - speeds).max()), 6e-11),
        Row(law, "error of the shear on the axis", abs(shear - 1.1389977745), 1e-10),
        Row(law, "error of <v_z²>", abs(2 * section - 0.3295056988), 6e-11),
        Row(law, "error of the dissipation", abs(flow.dissipation / area - 0.7131657052), 6e-11),
    ]


HELICES = {
    0.25: (0.0006218100, 0.0001781116, 0.4929346995),
    0.5: (0.0043761603, 0.0012564618, 0.4789277135),
    1.0: (0.0229552960, 0.0066542450, 0.4772459791),
    Q: (0.0347669399, 0.0101547295, 0.5007264599),
    2.0: (0.0567480470, 0.0171356163, 0.6551340728),
    3.0: (0.0483145539, 0.0157671262, 0.9992921254),
    4.0: (0.0274413912, 0.0102004665, 1.4212457020),
}
"""Of bands sin φ by Q: speed on the axis, max |ψ| on 401 x 256 points, dissipation per area."""
OF_CYCLOSIS = {
    0.5: (0.0049844368, 0.0013936239, 0.688491580),
    Q: (0.0395994672, 0.0114078823, 0.736243550),
    2.0: (0.0646358992, 0.0194023694, 0.970687940),
    3.0: (0.0550301694, 0.0179206240, 1.473164834),
}
"""The same of bands with the profile of steady cyclosis."""


def helices():
    """Bands that wind: known numbers, the law of the third power, and the fastest circulation."""
    rows = []
    for name, profile, table, n in (
        ("sin φ", np.sin, HELICES, 16),
        ("cyclosis", profile_of_cyclosis(), OF_CYCLOSIS, 128),
    ):
        worst = np.zeros(3)
        for q, known in table.items():
            worst = np.maximum(worst, _helix(profile, q, known, n))
        law = f"vacuole, helical bands of {name}"
        rows += [
            Row(law, "error of the speed on the axis", worst[0], 6e-11),
            Row(law, "error of max |ψ|", worst[1], 2e-10),
            Row(law, "error of the dissipation", worst[2], 2e-9 if n > 16 else 6e-11),
        ]
    r = np.linspace(0.1, 0.9, 9)
    for n in (1, 2, 3, 5):
        slow = radial_stream(n, 1e-5, r)[:, n - 1] * 1e-5
        ratio = slow / (-(n / (4 * (n + 1) * (n + 2))) * 1e-15 * r**n * (1 - r**2) ** 2)
        law, what = f"vacuole, slow twist, n = {n}", "ψ / (-K_n Q³ r^n (1 - r²)²) - 1"
        rows.append(Row(law, what, float(np.abs(ratio - 1).max()), 1e-8))
    best = brentq(_slope, 2, 4, xtol=1e-13)
    top = float(cy.vacuole.axis_speed(best))
    law = "vacuole, circulation by pitch"
    rows.append(Row(law, "pitch of the fastest - 2.82226299", abs(best - 2.82226299), 2e-8))
    q = 2 * np.pi / best
    v = wave(1, -q, q / np.hypot(1, q), 1 / np.hypot(1, q), 1e-12)[0]
    rows.append(Row(law, "its speed / that of fifty digits - 1", abs(top / abs(v[0]) - 1), 1e-12))
    rows.append(Row(law, "its speed - 0.0579497988", abs(top - 0.0579497988), 6e-11))
    return rows


def _slope(pitch):
    """Return the slope of the speed on the axis, by differences of fourth order, but for a factor."""
    far, near, after, beyond = cy.vacuole.axis_speed(pitch + 1e-3 * np.array([-2, -1, 1, 2]))
    return float(far - 8 * near + 8 * after - beyond)


def _helix(profile, q, known, n):
    grid = cy.CylinderGrid(n, 2 * n if n == 16 else n, 2 * np.pi / q)
    flow = cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, profile, pitch=2 * np.pi / q))
    axis = np.hypot(*flow.cartesian_at([[0.0, 0.0, 0.0]])[0, :2])
    psi = cy.vacuole.stream_function(flow).on(np.linspace(0, 1, 401), 2 * np.pi / 256 * np.arange(256))
    found = [axis, np.abs(psi).max(), flow.dissipation / (2 * np.pi * grid.length)]
    return np.abs(np.array(found) - known)


def budget():
    """A disordered wall: no net flux, no divergence, and the work of the wall is dissipated."""
    grid = cy.CylinderGrid(24, 20, 3.0)
    u = cy.flow(cy.Parameters(), grid, band_limited(4, grid.shape, (8, 6)))
    flow = cy.vacuole.flow(grid, u / np.hypot(*u).max())
    nodes, weights = legendre.leggauss(64)
    r, weights = 0.5 * (nodes + 1), 0.5 * weights
    v = flow.volume(r)
    flux = 2 * np.pi * np.einsum("r,rqz->z", weights * r, v[2]) / grid.n_theta
    e, divergence = strain(grid, nodes, r, v)
    heat = np.einsum("r,rqz->", weights * r, np.sum(2 * e**2, axis=(0, 1)))
    heat *= 2 * np.pi * grid.length / (grid.n_theta * grid.n_z)
    law = "vacuole, disordered wall"
    return [
        Row(law, "max net flux through a section", float(np.abs(flux).max()), 1e-14),
        Row(law, "max divergence", float(np.abs(divergence).max()), 1e-8),
        Row(law, "∫ 2 e:e dV / work of the wall - 1", abs(heat / flow.dissipation - 1), 1e-10),
    ]


def strain(grid, nodes, r, v):
    """Return the rate of strain (3, 3, ...) and the divergence of v (3, n_r, ...) on Gauss points of r."""
    vander = legendre.legvander(nodes, nodes.size - 1)
    slopes = np.stack([legendre.legval(nodes, legendre.legder(c)) for c in np.eye(nodes.size)], axis=1)
    along_r = 2 * slopes @ np.linalg.inv(vander)
    d_r = np.einsum("rs,csqz->crqz", along_r, v)
    waves = np.fft.fft2(v)
    d_theta = np.fft.ifft2(1j * grid.m[:, None] * waves).real
    d_z = np.fft.ifft2(1j * grid.q * waves).real
    r = r[:, None, None]
    gradient = np.empty((3, 3, *v.shape[1:]))
    gradient[:, 0] = d_r
    gradient[0, 1], gradient[1, 1] = (d_theta[0] - v[1]) / r, (d_theta[1] + v[0]) / r
    gradient[2, 1] = d_theta[2] / r
    gradient[:, 2] = d_z
    return 0.5 * (gradient + gradient.swapaxes(0, 1)), np.trace(gradient)


DRAG = (
    *((0, Q, 0.371128286681), (0, 2 * Q, 1.279182894550), (1, Q, 1.001452919847), (1, -Q, 1.001452919847)),
    *((2, Q, 2.055317380963), (5, 2 * np.pi, 7.176759777664), (0, 20.0, 18.519754971658)),
    *((20, 20.0, 27.551000103537), (1, 0.1, 0.997540226415), (1, 0.0, 1.0), (2, 0.0, 2.0), (40, 0.0, 40.0)),
)


def drag():
    """The drag of solenoidal waves: digits that an earlier program found, and its limits."""
    worst = 0.0
    for m, q, known in DRAG:
        worst = max(worst, abs(float(cy.vacuole.drag(m, q)) - known))
    small = max(abs(float(cy.vacuole.drag(0, q)) / (q**2 / 4) - 1) for q in (1e-3, 1e-6))
    return [
        Row("vacuole drag Z(m, q)", "error of twelve digits, and of Z(n, 0) = n", worst, 6e-13),
        Row("vacuole drag Z(0, q)", "Z / (q²/4) - 1 for q to 0", small, 1e-6),
    ]


def limits():
    """Waves that become long go over into those that do not vary along the cell."""
    rows = []
    for m in (1, 2, 7):
        long = cy.vacuole.wave(m, 1e-7, 0.3, 0.7, RADII)
        straight = cy.vacuole.wave(m, 0.0, 0.3, 0.7, RADII)
        change = max(np.abs(a - b).max() for a, b in zip(long[:2], straight[:2], strict=True))
        rows.append(Row(f"vacuole, m = {m}", "change from q = 1e-7 to q = 0", float(change), 1e-6))
    long, straight = (cy.vacuole.wave(0, q, 0.3, 0.7, RADII).velocity for q in (1e-7, 0.0))
    change = float(np.abs(long - straight).max())
    return [*rows, Row("vacuole, m = 0", "change from q = 1e-7 to q = 0", change, 1e-6)]


def rows():
    return [*reference(), *oracle(), *bands(), *cyclosis(), *helices(), *budget(), *drag(), *limits()]
