import type { Grid } from './grid';

/** The linear map from force to flow, U_k = direct F_k + mirror conj(F_-k), as `model/hydrodynamics.py`. */
export interface FlowOperator {
  direct: Float64Array;
  mirror: Float64Array;
  mu: number;
  zeroThetaFlux: boolean;
}

/**
 * -μ ∇²u + u + Π₀ e_z + ∇Π' = F, ∇·u = 0, <u_z> = 0. Forces are given as n0 n1 times their spectrum, hence the
 * scale.
 */
export function flowOperator(grid: Grid, mu: number, zeroThetaFlux: boolean): FlowOperator {
  const direct = new Float64Array(grid.size);
  const mirror = new Float64Array(2 * grid.size);
  const scale = 1 / grid.size;
  for (let i = 0, at = 0; i < grid.nTheta; i += 1) {
    for (let j = 0; j < grid.nZ; j += 1, at += 1) {
      const k2 = grid.k2[at]!;
      if (k2 === 0) {
        // The two halves add up to Re F: only the mean of F_theta, if that is free.
        const mean = zeroThetaFlux ? 0 : 0.5 * scale;
        direct[at] = mean;
        mirror[2 * at] = mean;
        continue;
      }
      const green = (0.5 * grid.keep[at]! * scale) / (1 + mu * k2);
      const [m, q] = [grid.m[i]!, grid.q[j]!];
      direct[at] = green;
      mirror[2 * at] = (-green * (m * m - q * q)) / k2;
      mirror[2 * at + 1] = (-green * 2 * m * q) / k2;
    }
  }
  return { direct, mirror, mu, zeroThetaFlux };
}
