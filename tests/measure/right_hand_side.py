"""One right-hand side of the package against the oracle."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

import cyclosis as cy
import oracle

from . import Row, band_limited, broadband, furthest

NUMBERS = {
    "alpha_p": 0.7, "alpha_u": 0.9, "epsilon": 0.6, "d_s": 0.03, "d_r": 0.05, "kappa": 0.4, "mu": 0.07,
    "repulsion_angle": 0.6,
}  # fmt: skip
"""All terms of comparable size, d tilted."""


def coefficient_fields(shape, length):
    """Return couplings that vary over the surface with modes up to (2, 1), also κ e^{2iφ}."""
    theta = 2 * np.pi * np.arange(shape[0])[:, None] / shape[0]
    zeta = 2 * np.pi * np.arange(shape[1])[None, :] / shape[1]
    return {
        "alpha_p": 0.7 + 0.2 * np.cos(2 * theta - zeta + 0.3),
        "alpha_u": 0.9 + 0.4 * np.sin(theta + zeta),
        "kappa": 0.4 + 0.1 * np.cos(theta) + 0.05 * np.sin(zeta),
        # The direction d turns by half a turn around the cell: as a line it is smooth.
        "repulsion_angle": 0.3 + 0.5 * theta + 0.0 * zeta,
    }


CASES = {
    "numbers, tilted d": ((56, 40), 5.0, (4, 3), False, {}),
    "zero mean u_theta": ((56, 40), 5.0, (4, 3), False, {"zero_theta_flux": True}),
    "paper parameters": ((56, 40), 5.0, (4, 3), False, dict(cy.Parameters().items())),
    "coefficient fields": ((40, 56), 3.2, (3, 4), True, {}),
    "odd sizes, fields, zero mean u_theta": ((45, 33), 8.0, (3, 2), True, {"zero_theta_flux": True}),
    "linear force": ((45, 33), 8.0, (3, 2), True, {"force_exponent": 0.0}),
    "quintic force": ((45, 33), 8.0, (2, 1), True, {"force_exponent": 4.0}),
}
"""Per case: grid, length, modes of the state, coefficient fields or numbers, other parameters.

The highest product is P P (P·E·P): six times the modes of the state for the cubic force, eight for the
quintic; fields come on top of P P P u. All stay below half the grid, so that nothing aliases.
"""


def case(name):
    """Return parameters, grid and alias-free state of a case."""
    shape, length, modes, fields, other = CASES[name]
    values = NUMBERS | (coefficient_fields(shape, length) if fields else {}) | other
    return cy.Parameters(**values), cy.CylinderGrid(*shape, length), band_limited(7, shape, modes)


def alias_free(name):
    """Flow and dP/dt, all terms on, where no product aliases."""
    p, grid, P = case(name)
    u = furthest(cy.flow(p, grid, P), oracle.flow(p, grid.length, P))
    dP = furthest(cy.rate_of_change(p, grid, P), oracle.rate(p, grid.length, P))
    law = f"oracle, alias-free, {name}, {grid.n_theta} x {grid.n_z}"
    return [Row(law, "flow, relative to max", u, 1e-12), Row(law, "dP/dt, relative to max", dP, 1e-12)]


def single_terms(state="alias-free"):
    """Each term alone: the same products are formed at each point, so that broadband states agree too."""
    p, grid, P = case("coefficient fields")
    if state == "broadband":
        P = broadband(3, grid.shape)
    rows, own = [], oracle.terms(p, grid.length, P)
    for name in oracle.TERMS:
        error = furthest(cy.rate_of_change(p, grid, P, terms=[name]), own[name])
        rows.append(Row(f"oracle, single term, {state}", name, error, 1e-12))
    return rows


def fused_transport():
    """Advection and shear together are computed by identities: equal up to aliasing."""
    p, grid, P = case("coefficient fields")
    rows = []
    for state, Q, bound in (("alias-free", P, 1e-12), ("broadband", broadband(3, grid.shape), None)):
        fused = cy.rate_of_change(p, grid, Q, terms=["advection", "shear"])
        apart = sum(cy.rate_of_change(p, grid, Q, terms=[name]) for name in ("advection", "shear"))
        rows.append(
            Row(f"fused transport, {state}", "against advection + shear", furthest(fused, apart), bound)
        )
    return rows


def all_terms_broadband():
    """All terms on independent random numbers, without padding.

    The oracle forms every product as written, the package fuses advection and shear: they alias differently.
    """
    p, grid, _ = case("coefficient fields")
    P = broadband(3, grid.shape)
    law = f"oracle, broadband, all terms, {grid.n_theta} x {grid.n_z}"
    error = furthest(cy.rate_of_change(p, grid, P), oracle.rate(p, grid.length, P))
    rows = [Row(law, "dP/dt with advection and shear fused", error)]
    apart = [name for name in oracle.TERMS if name != "advection"]
    sum_apart = cy.rate_of_change(p, grid, P, terms=apart) + cy.rate_of_change(
        p, grid, P, terms=["advection"]
    )
    return [
        *rows,
        Row(law, "dP/dt with both apart", furthest(sum_apart, oracle.rate(p, grid.length, P)), 1e-12),
    ]


def force_laws():
    """The flow of F = |P|ⁿ P for whole and broken n, broadband: one product per point, the same in both."""
    rows = []
    for n in (0.0, 0.5, 1.3, 2.0, 3.0):
        p, grid, _ = case("numbers, tilted d")
        p, P = p.replace(force_exponent=n), broadband(4, grid.shape)
        error = furthest(cy.flow(p, grid, P), oracle.flow(p, grid.length, P))
        rows.append(Row("oracle, force law, broadband", f"flow, n = {n:g}", error, 1e-12))
    return rows


def padded(shape, fields=True):
    """All terms on a broadband state, products fully padded, against the oracle on a grid three times finer.

    Three times is more than the 5/2 that quartic terms need: equality shows that 5/2 leaves no aliasing.
    """
    length, fine = 5.0, (3 * shape[0], 3 * shape[1])
    grid, P = cy.CylinderGrid(*shape, length), broadband(5, shape)
    on_fine = SimpleNamespace(
        **(dict(cy.Parameters(**NUMBERS).items()) | (coefficient_fields(fine, length) if fields else {}))
    )
    p = cy.Parameters(**(NUMBERS | (coefficient_fields(shape, length) if fields else {})))
    exact = oracle.rate(on_fine, length, P, fine=fine)
    law = f"oracle without aliasing, broadband, {shape[0]} x {shape[1]}"
    u = furthest(cy.flow(p, grid, P, dealias="full"), oracle.flow(on_fine, length, P, fine=fine))
    rows = [Row(law, "flow, dealias full", u, 1e-12)]
    for dealias, bound in (("full", 1e-12), ("cubic", None), ("quadratic", None), ("none", None)):
        error = furthest(cy.rate_of_change(p, grid, P, dealias=dealias), exact)
        rows.append(Row(law, f"dP/dt, dealias {dealias}", error, bound))
    return rows


def rows():
    """Return every row of this comparison."""
    out = [row for name in CASES for row in alias_free(name)]
    out += (
        single_terms() + single_terms("broadband") + fused_transport() + all_terms_broadband() + force_laws()
    )
    return out + padded((24, 16)) + padded((15, 21))
