import type { Params } from '../src/engine/values';

/** The parameters of the paper's Figure 4. */
export const FIGURE_4: Params = {
  alpha_p: 1, alpha_u: 0.5, epsilon: 0.1, d_s: 0.025, d_r: 0.025, kappa: 0.5, mu: 0.05, repulsion_angle: 0, zero_theta_flux: false, force_exponent: 2,
};
