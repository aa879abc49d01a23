"""The filament equation, as one tuple of named terms.

    dP/dt = - ε (u·∇)P + d⁽ˢ⁾ ∇²P - d⁽ʳ⁾ P
            + (I - PP)·[ε (P·∇)u + α_p P + α_u u - κ (P·d) d]

(Woodhouse & Goldstein 2013; (∇u)·P is read as (P·∇)u). This is the paper's closure of the equation for the
angles of filaments; with another one, see `closures`, the torques in brackets turn P differently. Packed
fields p = P_theta + i P_z are used throughout, see `spectral`. Dynamics, budget and linearisation all read
the tuple `TERMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp

from ..display.shown import shown
from .closures import PAPER, turned
from .equation import EQUATION, TermKind
from .errors import InputError
from .moment import Moment
from .spectral import dot, pack, unpack


@shown
@dataclass(frozen=True)
class Term:
    """One term of dP/dt.

    A `torque` acts through the projector (I - PP), or as another closure says, a `rate` directly, a `linear`
    term is a real multiplier in Fourier space; these take a `Moment`. A `custom` term is the user's
    `function(t, P, u, params, grid)` with P, u and its result of shape (2, n_theta, n_z), traceable by
    JAX; `params` holds the values of `Parameters` by name and `grid` the points on which P is given.

    Example:
        >>> import cyclosis as cy
        >>> [term.name for term in cy.TERMS if term.kind == "torque"]
        ['shear', 'bundling', 'flow_alignment', 'repulsion']
        >>> import jax.numpy as jnp
        >>> def field(t, P, u, params, grid):  # turns all filaments upwards: (I - PP)·0.1 e_z
        ...     return 0.1 * jnp.stack([-P[0] * P[1], 1 - P[1] ** 2])
        >>> grid = cy.CylinderGrid(16, 16)
        >>> state = cy.initial.unidirectional(grid, 0.5)
        >>> cy.rate_of_change(cy.Parameters(), grid, state, terms=[field])[:, 0, 0].round(6)
        array([0.   , 0.075])
    """

    name: str
    formula: str
    kind: TermKind
    function: Callable[..., Any]


def advection(now: Moment) -> jax.Array:
    """Return -ε (u·∇)P."""
    along_theta, along_z = now.p_gradient
    return -now.values.epsilon * (now.u.real * along_theta + now.u.imag * along_z)


def shear(now: Moment) -> jax.Array:
    """Return ε (P·∇)u."""
    along_theta, along_z = now.u_gradient
    return now.values.epsilon * (now.p.real * along_theta + now.p.imag * along_z)


def bundling(now: Moment) -> jax.Array:
    """Return α_p P."""
    return now.values.alpha_p * now.p


def flow_alignment(now: Moment) -> jax.Array:
    """Return α_u u."""
    return now.values.alpha_u * now.u


def repulsion(now: Moment) -> jax.Array:
    """Return -κ (P·d) d, which packed is -κ (p + e^{2iφ} p*) / 2."""
    return -0.5 * (now.values.kappa * now.p + now.values.kappa_mirror * jnp.conj(now.p))


def diffusion(now: Moment) -> jax.Array:
    """Return the symbol -d⁽ˢ⁾ k² of d⁽ˢ⁾ ∇²P."""
    return -now.values.d_s * now.space.k2


def rotational_diffusion(now: Moment) -> jax.Array:
    """Return the symbol -d⁽ʳ⁾ of -d⁽ʳ⁾ P."""
    return -now.values.d_r * jnp.ones_like(now.space.k2)


FUNCTIONS: dict[str, Callable[[Moment], jax.Array]] = {
    "advection": advection,
    "shear": shear,
    "bundling": bundling,
    "flow_alignment": flow_alignment,
    "repulsion": repulsion,
    "diffusion": diffusion,
    "rotational_diffusion": rotational_diffusion,
}
"""The function of each term of `EQUATION`."""

TERMS = tuple(Term(item.name, item.formula, item.kind, FUNCTIONS[item.name]) for item in EQUATION)

TermLike = str | Term | Callable[..., Any]


def select_terms(terms: Iterable[TermLike] | None = None) -> tuple[Term, ...]:
    """Return the terms that act: all by default, otherwise those named or given, or custom functions.

    Raises `InputError` for unknown names, repeats and anything that is not callable.
    """
    if terms is None:
        return TERMS
    known = {term.name: term for term in TERMS}
    rule = "a list of " + ", ".join(known) + ", or functions term(t, P, u, params, grid)"
    if isinstance(terms, str) or not isinstance(terms, Iterable):
        raise InputError("terms", terms, rule, "write them as a list")
    chosen = []
    for item in terms:
        if isinstance(item, Term):
            chosen.append(item)
        elif isinstance(item, str) and item in known:
            chosen.append(known[item])
        elif callable(item):
            name = getattr(item, "__name__", type(item).__name__)
            chosen.append(Term(name, f"{name}(t, P, u)", "custom", item))
        else:
            raise InputError("terms", item, rule, "check the spelling")
    if not chosen:
        raise InputError("terms", [], "a list of at least one term", "name one, or leave it out for all")
    names = [term.name for term in chosen]
    for term in chosen:
        if names.count(term.name) > 1:
            raise InputError("terms", term.name, "a list without repeats", "name each term once")
        if term != known.get(term.name, term):
            raise InputError(
                "terms", term.name, "named differently from the terms of the model", "rename your function"
            )
    return tuple(chosen)


def project(p: jax.Array, torque: jax.Array) -> jax.Array:
    """Return (I - PP)·torque."""
    return torque - p * dot(p, torque)


def rates(now: Moment, terms: tuple[Term, ...]) -> dict[str, jax.Array]:
    """Return the contribution of each term to dP/dt, packed and in physical space."""
    return {term.name: _rate(now, term) for term in terms}


def _rate(now: Moment, term: Term) -> jax.Array:
    if term.kind == "linear":
        return now.space.to_physical(term.function(now) * now.spectrum)
    if term.kind == "custom":
        P, u = unpack(now.p), unpack(now.u)
        return pack(term.function(now.time, P, u, now.values, now.grid)).astype(now.p.dtype)
    if term.kind == "torque":
        return turned_by(now, [term])
    return term.function(now)


def turned_by(now: Moment, torques: list[Term]) -> jax.Array:
    """Return what torques together add to dP/dt, packed.

    In other closures than the paper's shear and repulsion turn each filament by its own direction; all other
    torques turn the filaments of a place towards one vector.
    """
    if now.closure == PAPER:
        return project(now.p, sum((t.function(now) for t in torques), jnp.zeros_like(now.p)))
    polar, nematic, spin, values = jnp.zeros_like(now.p), jnp.zeros_like(now.p), 0.0, now.values
    for term in torques:
        if term.name == "shear":
            nematic, spin = nematic + values.epsilon * now.strain, 0.5 * values.epsilon * now.vorticity
        elif term.name == "repulsion":
            nematic = nematic - 0.5 * values.kappa_mirror
        else:
            polar = polar + term.function(now)
    return turned(now.closure, now.p, polar, nematic, spin)


def linear_symbol(now: Moment, terms: tuple[Term, ...]) -> jax.Array:
    """Return the real multiplier of the linear terms in Fourier space, shape (n_theta, n_z)."""
    symbols = [term.function(now) for term in terms if term.kind == "linear"]
    return sum(symbols, jnp.zeros_like(now.space.k2))


def nonlinear(now: Moment, terms: tuple[Term, ...]) -> jax.Array:
    """Return the spectrum of all terms that are not linear.

    With advection and shear both acting they are fused into one transport term. With
    s = u_theta P_z - u_z P_theta and E the strain of the divergence-free u,

        (P·∇)u - (u·∇)P = (d_z s, -d_theta s) - u (∇·P),      P·(P·∇)u = P·E·P,

    which needs three transforms; the two separate terms need eight. In closures other than the paper's the
    two stay separate, because the strain acts differently.
    """
    names = {term.name for term in terms}
    fused = now.fuses and {"advection", "shear"} <= names and now.closure == PAPER
    separate = [t for t in terms if t.kind != "linear" and not (fused and t.name in ("advection", "shear"))]
    rate = turned_by(now, [t for t in separate if t.kind == "torque"])
    for term in separate:
        if term.kind != "torque":
            rate = rate + _rate(now, term)
    if not fused:
        return now.space.keep * now.space.to_spectrum(rate)
    p, u, strain, epsilon = now.p, now.u, now.strain, now.values.epsilon
    stretching = strain.real * (p.real**2 - p.imag**2) + 2 * strain.imag * p.real * p.imag
    rate = rate - epsilon * (u * now.divergence + p * stretching)
    s = u.real * p.imag - u.imag * p.real
    # The curl (d_z s, -d_theta s) packs to the spectrum K s_k.
    curl = epsilon * (now.space.K * now.space.to_spectrum(s))
    # K alone leaves the Nyquist modes of one direction that have a wavenumber in the other.
    return now.space.keep * (now.space.to_spectrum(rate) + curl)
