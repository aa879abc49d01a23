"""When disorder is certain: a bound below which a weakly ordered state can only decay.

For α_p <= d_r the disordered state gains nothing from bundling, and all other driving is of third order
in P. Let M = max |P|, e = <|P - <P>|²>^½, s = <P_theta²>^½, F = |P|²P with Lipschitz constant 3M², u the
flow, |u'| <= |F'|, k₁ the smallest wavenumber, a = d_r - α_p >= 0. Because bundling's cubic part is
monotone, advection conserves <|P|²> and repulsion damps, the equation gives

    de/dt <= -λ e,          λ = a + d_s k₁² - 3κM² - α_u (3M² + 5M⁴) - 3 ε c M³,
    ds/dt <= -ν s + β e,    ν = a + κ' - α_u (M² + M⁴),     β = 3α_u (M² + M⁴) + 3 ε c M³,
    dM/dt <= α_u (M² s + 3 C₀ M² e) + 3 ε C₁ M³ e,

c = max_k k/(1 + μk²), C₀² = Σ 1/(1 + μk²)², C₁² = Σ k²/(1 + μk²)² over the resolved modes, and κ' is the
effect of repulsion on P_theta: κ(1 - M²) for d = e_theta, -κM² for d = e_z. If, with M the largest value
that these bounds allow,

    M₀ + α_u M² [s₀/ν + β e₀/(νλ)] + 3M² (α_u C₀ + ε C₁ M) e₀/λ <= M,    λ, ν > 0,

then e and s decay exponentially, and the uniform P_z that remains obeys dP_z/dt = -a P_z - α_p P_z³: the
state can only become disordered, however long that takes (as t^-½ at α_p = d_r). Own derivation.
"""

from __future__ import annotations

import numpy as np

from ..model.grid import CylinderGrid
from ..model.parameters import Parameters

TRIALS = 1.05 ** np.arange(1, 29)
"""Trial ratios of the largest future |P| to the present one, up to 3.9."""


class Disorder:
    """The bound for one parameter point and grid; `decays` applies it to a state."""

    def __init__(self, params: Parameters, grid: CylinderGrid) -> None:
        self.params = params
        numbers = params.shape is None and params.force_exponent == 2 and params.alpha_p <= params.d_r
        tilt = abs(np.sin(params.repulsion_angle)) if numbers else 0.0
        self.axial = tilt > 0.5
        aligned = min(tilt, abs(np.cos(params.repulsion_angle))) < 1e-12 if numbers else False
        self.applies = bool(numbers and (aligned or params.kappa == 0))
        k2 = (grid.m[:, None] ** 2 + grid.q[None, :] ** 2).ravel()[1:]
        answer = 1.0 / (1.0 + params.mu * k2)
        self.k1_squared = float(k2.min())
        self.steepest = float(np.max(np.sqrt(k2) * answer))
        self.C0, self.C1 = float(np.sqrt(np.sum(answer**2))), float(np.sqrt(np.sum(k2 * answer**2)))

    def decays(self, largest: float, unevenness: float, around: float) -> bool:
        """Return whether a state with max |P|, <|P - <P>|²>^½ and <P_theta²>^½ can only become disordered.

        All dimensionless. False is inconclusive: the bound is sufficient, not necessary.
        """
        return self.applies and any(
            self._bounded(largest, largest * ratio, unevenness, around)
            for ratio in TRIALS
            if largest * ratio < 1
        )

    def _bounded(self, M0: float, M: float, e: float, s: float) -> bool:
        p, c = self.params, self.steepest
        alpha_u, kappa, epsilon, a = float(p.alpha_u), float(p.kappa), p.epsilon, p.d_r - float(p.alpha_p)
        held = -kappa * M**2 if self.axial else kappa * (1 - M**2)
        turned = 3 * kappa * M**2 + alpha_u * (3 * M**2 + 5 * M**4) + 3 * epsilon * c * M**3
        rate = a + p.d_s * self.k1_squared - turned
        around = a + held - alpha_u * (M**2 + M**4)
        if rate <= 0 or around <= 0:
            return False
        beta = 3 * alpha_u * (M**2 + M**4) + 3 * epsilon * c * M**3
        gain = alpha_u * M**2 * (s / around + beta * e / (around * rate))
        gain += 3 * M**2 * (alpha_u * self.C0 + epsilon * self.C1 * M) * e / rate
        return M0 + gain <= M
