"""Laws that hold for every state and every parameter, each measured as one number that must vanish."""

from __future__ import annotations

import numpy as np

import cyclosis as cy
import oracle

from . import Row, band_limited, broadband, furthest

GRID = cy.CylinderGrid(32, 28, 5.0)
MODES = (2, 2)
"""Modes of the smooth states: six times as many fit on the grid, so that no product aliases."""
RUN = {"t_end": 1.0, "save_at": (1.0,), "stepper": "etdrk4", "dt": 0.02}


def state(seed, kind="smooth", largest=0.95):
    """Return a random state: smooth enough that nothing aliases, or independent at every point."""
    make = {"smooth": lambda: band_limited(seed, GRID.shape, MODES, largest)}
    make["rough"] = lambda: broadband(seed, GRID.shape, largest)
    return make[kind]()


def budget_defect(p, P):
    """<F·u> - μ <|∇u|²> - <|u|²>, relative, from the flow alone."""
    u, F = cy.flow(p, GRID, P), oracle.force(p, oracle.both(P, GRID.shape))
    squares = sum(np.mean(part**2) for c in u for part in oracle.gradient(c, GRID.length))
    power = np.mean(np.sum(F * u, axis=0))
    return abs(power - p.mu * squares - np.mean(np.sum(u**2, axis=0))) / power


def reported_budget_defect(p, P):
    """The same balance from the diagnostics."""
    found = cy.diagnose(p, GRID, P)
    spent = found["viscous_dissipation"] + found["friction_dissipation"]
    return abs(found["power_input"] - spent) / found["power_input"]


def divergence(p, P):
    """Largest ∇·u over the largest velocity gradient."""
    u = cy.flow(p, GRID, P)
    slopes = [oracle.gradient(c, GRID.length) for c in u]
    return float(np.abs(slopes[0][0] + slopes[1][1]).max() / np.abs(slopes).max())


def axial_flux(p, P):
    """<u_z>, relative to the largest speed."""
    u = cy.flow(p, GRID, P)
    return abs(float(u[1].mean())) / np.abs(u).max()


def theta_flux_defect(p, P):
    """<u_theta> - <F_theta>, or <u_theta> where that is held at zero, relative to the largest speed."""
    u, F = cy.flow(p, GRID, P), oracle.force(p, oracle.both(P, GRID.shape))
    return abs(float(u[0].mean() - (0.0 if p.zero_theta_flux else F[0].mean()))) / np.abs(u).max()


def shifted(f, by):
    """Translate by whole grid points."""
    return np.roll(f, by, axis=(-2, -1))


def slid(P, by):
    """Translate by any distance (radians, radii), exactly for band-limited fields."""
    phase = np.exp(-1j * (GRID.m[:, None] * by[0] + GRID.q[None, :] * by[1]))
    return np.fft.ifft2(np.fft.fft2(P) * phase).real


def mirrored(P, axis):
    """Reflect theta -> -theta (axis 0) or z -> -z (axis 1): that component of the vector changes sign."""
    at = np.roll(np.flip(P, axis + 1), 1, axis + 1).copy()
    at[axis] *= -1
    return at


def turned(P):
    """Turn the unrolled surface by 180 degrees about the origin."""
    return mirrored(mirrored(P, 0), 1)


def flow_covariance(p, P, change, after=None):
    """Whether the flow of the changed state is the changed flow: largest relative difference."""
    return furthest(cy.flow(after or p, GRID, change(P)), change(cy.flow(p, GRID, P)))


def rate_covariance(p, P, change, after=None):
    """The same for dP/dt; `after` holds the parameters of the changed cell, where they change too."""
    return furthest(cy.rate_of_change(after or p, GRID, change(P)), change(cy.rate_of_change(p, GRID, P)))


def run_covariance(p, P, change, after=None):
    """The same for a run."""
    first, second = (
        cy.simulate(q, GRID, begin, **RUN).final_state for q, begin in ((p, P), (after or p, change(P)))
    )
    return furthest(second, change(first))


def term_budget_defect(p, P):
    """Sum of <P·term> against <P·dP/dt>, relative to the largest term."""
    found = cy.diagnose(p, GRID, P)["budget"]
    total = np.mean(np.sum(P * cy.rate_of_change(p, GRID, P), axis=0))
    return abs(sum(found.values()) - total) / max(map(abs, found.values()))


def growth_of_order_defect(p, P, h=2e-3):
    """Sum of the term budget against the centred difference of <|P|²>/2 along a run, relative."""
    run = cy.simulate(p, GRID, P, t_end=2 * h, save_at=(0.0, h, 2 * h), stepper="etdrk4", dt=h)
    before, _, after = run.records["order"] ** 2 / 2
    budget = run.records["budget"][1]
    return abs((after - before) / (2 * h) - budget.sum()) / np.abs(budget).max()


def overshoot(p, P):
    """Largest |P| - 1 over the frames of a run after its start, by the default stepper, small tolerance."""
    run = cy.simulate(p, GRID, P, t_end=20.0, save_at=[0.5 * k for k in range(1, 41)], rtol=1e-7)
    assert run.ok, run.message
    return max(float(np.hypot(*frame).max()) for frame in run.frames) - 1


def precision_defect(p, P):
    """A run in float32 against one in float64, largest difference."""
    runs = [cy.simulate(p, GRID, P, precision=name, **RUN).final_state for name in ("float32", "float64")]
    return float(np.abs(runs[0] - runs[1]).max())


def parameters(angle=0.0, **other):
    """Return parameters with every term of the equation at work."""
    values = {
        "alpha_p": 0.7,
        "alpha_u": 0.8,
        "epsilon": 0.5,
        "d_s": 0.06,
        "d_r": 0.05,
        "kappa": 0.4,
        "mu": 0.1,
    }
    return cy.Parameters(**(values | other), repulsion_angle=angle)


ROUNDING = 1e-12
STEPS = ((3, 5), (0, 1), (17, 0))


def mirror(axis):
    return lambda P: mirrored(P, axis)


def rows():
    """Measure each law on a few states; the property-based tests take many."""
    worst = {}

    def add(law, quantity, value, high=None, low=None):
        old = worst.get((law, quantity))
        if old is not None:
            value = max(value, old.value) if low is None else min(value, old.value)
        worst[law, quantity] = Row(law, quantity, value, high, low)

    tilted, straight, across = parameters(0.6), parameters(0.0), parameters(np.pi / 2)
    for seed in range(4):
        P = state(seed)
        for kind in ("smooth", "rough"):
            Q = state(seed, kind)
            for p in (tilted, tilted.replace(zero_theta_flux=True)):
                option = "<u_theta> = 0" if p.zero_theta_flux else "<u_theta> = <F_theta>"
                law = f"flow, {kind} states, {option}"
                add(law, "power budget, relative", budget_defect(p, Q), ROUNDING)
                add(law, "power budget by the diagnostics, relative", reported_budget_defect(p, Q), ROUNDING)
                add(law, "divergence, relative", divergence(p, Q), ROUNDING)
                add(law, "<u_z>, relative", axial_flux(p, Q), ROUNDING)
                add(law, "<u_theta>, relative", theta_flux_defect(p, Q), ROUNDING)
        for by in STEPS:
            add(
                "translations",
                "of dP/dt",
                rate_covariance(tilted, P, lambda f, by=by: shifted(f, by)),
                ROUNDING,
            )
        add("translations", "of a run", run_covariance(tilted, P, lambda f: shifted(f, (3, 5))), 1e-11)
        for axis, name in enumerate(("theta -> -theta", "z -> -z")):
            for p, where in ((straight, "d = e_theta"), (across, "d = e_z")):
                add(f"reflection {name}, {where}", "of dP/dt", rate_covariance(p, P, mirror(axis)), ROUNDING)
            law = f"reflection {name}, tilted d"
            add(law, "of dP/dt: must fail", rate_covariance(tilted, P, mirror(axis)), None, 1e-2)
            image = tilted.replace(repulsion_angle=-0.6)
            add(law, "of dP/dt and of d", rate_covariance(tilted, P, mirror(axis), image), ROUNDING)
        add("turn by 180 degrees", "of dP/dt, tilted d", rate_covariance(tilted, P, turned), ROUNDING)
        add("P -> -P", "of dP/dt: must fail", rate_covariance(tilted, P, np.negative), None, 1e-2)
        free = tilted.replace(epsilon=0.0)
        add(
            "P -> -P", "of dP/dt without advection and shear", rate_covariance(free, P, np.negative), ROUNDING
        )
        add("term budget", "sum against <P·dP/dt>, relative", term_budget_defect(tilted, P), ROUNDING)
        add("term budget", "sum against d/dt <|P|²>/2 of a run", growth_of_order_defect(tilted, P), 1e-5)
        # Without rotational diffusion |P| = 1 is where the dynamics leads.
        add(
            "|P| <= 1",
            "largest |P| - 1 in a run from max |P| = 1, d_r = 0",
            overshoot(tilted.replace(d_r=0.0), state(seed, largest=1.0)),
            1e-7,
        )
        add("float32 against float64", "max difference at t = 1", precision_defect(tilted, P), 1e-5)
    return list(worst.values())
