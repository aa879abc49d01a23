"""Two-stripe cyclosis at the paper's parameters: a one-dimensional profile with numbers known to ten digits.

They solve d_s P'' - d_r P + (1 - P²)(α_p P + α_u u) = 0, -μ u'' + u + Π₀ = P³, <u> = 0, P = P(theta) e_z.
"""

from __future__ import annotations

import numpy as np

import cyclosis as cy

from . import Row

KNOWN = {
    "max P_z": 0.9915720522,
    "max u_z": 0.9714276568,
    "rms u": 0.8182985977,
    "<F·u>": 0.7122318317,
}
RATE = -0.06406947
GRID = cy.CylinderGrid(128, 8, 5.0)


def largest(values):
    """Return the maximum of a periodic function from its samples, by trigonometric interpolation."""
    n = values.size
    spectrum = np.fft.fft(values, norm="forward")
    m = np.fft.fftfreq(n, 1 / n)
    x = 2 * np.pi * np.argmax(values) / n
    for _ in range(20):
        waves = spectrum * np.exp(1j * m * x)
        x -= float(np.sum(1j * m * waves).real / np.sum(-(m**2) * waves).real)
    return float(np.sum(spectrum * np.exp(1j * m * x)).real)


def relaxed(t_end=500.0, dt=0.1):
    """Run unequal stripes (a mean P_z of 0.05) to t_end; return the run."""
    state = cy.initial.stripes(GRID)
    state[1] += 0.05
    run = cy.simulate(
        cy.Parameters(),
        GRID,
        state,
        t_end=t_end,
        save_at=(t_end,),
        record_every=20.0,
        stepper="etdrk4",
        dt=dt,
    )
    assert run.ok, run.message
    return run


def profile():
    """The steady profile, and the rate at which the stripes become equal: that of the decay of <P_z>."""
    run = relaxed()
    P, p = run.final_state, run.params
    u, found = cy.flow(p, GRID, P), cy.diagnose(p, GRID, P)
    measured = {
        "max P_z": largest(P[1, :, 0]),
        "max u_z": largest(u[1, :, 0]),
        "rms u": found["rms_speed"],
        "<F·u>": found["power_input"],
    }
    law = "cyclosis at alpha_p = 1, alpha_u = 0.5, t = 500, 128 x 8"
    rows = [
        Row(law, f"{name} - {KNOWN[name]}", abs(value - KNOWN[name]), 1e-8)
        for name, value in measured.items()
    ]
    mean = run.records["mean_P"][:, 1]
    fitted = (run.record_times >= 120) & (run.record_times <= 240)
    rate = np.polyfit(run.record_times[fitted], np.log(np.abs(mean[fitted])), 1)[0]
    rows += [
        Row(law, f"decay rate of <P_z> / ({RATE}) - 1", abs(rate / RATE - 1), 1e-5),
        Row(law, "largest |dP/dt| left", float(np.abs(cy.rate_of_change(p, GRID, P)).max()), 1e-12),
        Row(law, "largest |P_theta|", float(np.abs(P[0]).max()), 1e-12),
        Row(law, "variation along z", float(np.ptp(P, axis=2).max()), 1e-12),
    ]
    return rows


def rows():
    """Return every row of this comparison."""
    return profile()
