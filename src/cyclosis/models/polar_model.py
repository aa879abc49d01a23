"""The polar model with the settings of its [model] table."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from ..contract.model import Model
from ..model.closures import PAPER, checked
from ..model.definitions import definition
from ..model.errors import InputError
from .concentration.model import uneven
from .polar_cylinder import polar


def polar_model(closure: str = PAPER, concentration: bool = False, force_density: str = "linear") -> Model:
    """Return the polar model with a closure, and with a concentration of filaments or without.

    A closure is what stands for the higher moments of filament angles. With p = P_theta + i P_z,
    H = α_p p + α_u u, S = ε (E_tt + i E_tz) - (κ/2) e^{2ib}, strain E, vorticity w and angle b of d, the
    torques of all closures but "paper" change p by

        (1/2)[H - H* m_2 + S p* - S* m_3] + (i ε w/2) p.

    * "paper" (default): the paper's equation, <pp> = PP and <ppp> = PPP, which is not of this form. It
      doubles the torques of bundling and flow where order is weak.
    * "von_mises": m_2 = (I_2/I_0) e², m_3 = (I_3/I_0) e³, with I_1(x)/I_0(x) = |P| and e = p/|p|. Exact for
      uniform steady order without repulsion, and close in strongly ordered states.
    * "wrapped_normal": m_2 = |p|² p², m_3 = |p|⁶ p³. About as close.
    * "weak": m_2 = p², m_3 = p³, that is <pp> = (1 - |P|²) I/2 + PP. For teaching: it keeps the trace, but
      its distribution is far too wide between weak and full order.

    The last three have no nematic state: where κ > 4 d_r they polarise at α_p = 0, at the rate κ/4 - d_r
    about isotropy, which filaments do not. Use them for the values of ordered states (|P|, speeds), not for
    onset or persistence. The theory of `cyclosis.stability` is that of the paper's closure; no final regime
    is certified with another.

    With `concentration` a state is an array (3, n_theta, n_z) of P_theta, P_z and c, see
    `cyclosis.initial.with_concentration`, and

        dc/dt = -ε ∇·(u c) + d_s ∇²c,   dP/dt = ... + 2 d_s (∇ ln c·∇)P,

    in which the force is c |P|ⁿ P (`force_density` "linear") or |cP|ⁿ cP ("power"). The bundling torque stays
    α_p P. Steps of a protocol act on P and leave c. Everything is dimensionless. Raises `InputError` for
    values that do not exist, and for a `force_density` without concentration.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(alpha_p=0.25, kappa=0.0), cy.CylinderGrid(8, 8)
        >>> start = cy.initial.unidirectional(grid, 0.9)
        >>> for closure in ("paper", "von_mises"):  # a distribution of angles has |P| = 0.9455
        ...     model = cy.models.polar_model(closure=closure)
        ...     run = cy.simulate(params, grid, start, 200.0, 200.0, model=model)
        ...     print(closure, run.final_state[1, 0, 0].round(4))
        paper 0.9487
        von_mises 0.9455
    """
    concentration = definition("model", "concentration").check(concentration)
    force_density = definition("model", "force_density").check(force_density)
    if not concentration and force_density != "linear":
        rule = "used only where [model] concentration is true"
        raise InputError("force_density", force_density, rule, "remove it, or set that")
    closed = _closed(checked(closure))
    return _uneven(closed, force_density) if concentration else closed


@cache
def _closed(closure: str) -> Model:
    if closure == PAPER:
        return polar
    assert polar.lanes is not None
    # The theory that certifies final regimes is that of the paper's closure.
    return replace(polar, options={"closure": closure}, lanes=replace(polar.lanes, certain=None))


_uneven = cache(uneven)
