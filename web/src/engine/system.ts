import { flowOperator, type FlowOperator } from './flow';
import type { Grid } from './grid';
import { RealTransform } from './realtransform';
import { Couplings, paramsAt, type Params, type Ramps } from './values';

/** Parameters that change linearly in time: those at the beginnings and at the ends of the active ramps. */
export interface Stage {
  first: Params;
  last: Params;
  ramps: Ramps;
}

/**
 * The right-hand side of one cell, dP/dt = linear P + nonlinear(P) in packed Fourier space, as `model/system.py`:
 *
 *     dP/dt = - ε (u·∇)P + d⁽ˢ⁾ ∇²P - d⁽ʳ⁾ P + (I - PP)·[ε (P·∇)u + α_p P + α_u u - κ (P·d) d]
 *
 * Both components are one complex field p = P_theta + i P_z. Advection and shear together take three transforms: with
 * s = u_theta P_z - u_z P_theta, (P·∇)u - (u·∇)P = (d_z s, -d_theta s) - u (∇·P), and P·(P·∇)u = P·E·P.
 * `split` says that the linear terms are kept separate, for steppers that treat them exactly.
 */
export class System {
  /** The symbol of the linear part; during a ramp that of the stronger diffusion of the two ends. */
  readonly linear: Float64Array;
  /** Fields of the state evaluated last: P, u, and E_tt + i E_tz of the strain, packed. */
  readonly p: Float64Array;
  readonly u: Float64Array;
  readonly strain: Float64Array;
  readonly flow: Float64Array;
  readonly force: Float64Array;
  private readonly work: Float64Array;
  private readonly real: RealTransform;
  private readonly divergence: Float64Array;
  private readonly turn: Float64Array;
  private readonly values: Couplings;
  private readonly cubic: boolean;
  private readonly moving: boolean;
  private operator: FlowOperator;
  private now: Params;

  constructor(readonly grid: Grid, readonly stage: Stage, readonly split = true) {
    const { first, last, ramps } = stage;
    const blank = (): Float64Array => new Float64Array(2 * grid.size);
    [this.p, this.u, this.strain] = [blank(), blank(), blank()];
    this.real = new RealTransform(grid.nTheta, grid.nZ);
    this.divergence = new Float64Array(2 * grid.nTheta * this.real.half);
    this.turn = this.real.field();
    [this.flow, this.force, this.work] = [blank(), blank(), blank()];
    this.moving = Object.keys(ramps).length > 0;
    this.cubic = first.force_exponent === 2 && last.force_exponent === 2;
    this.now = first;
    this.values = new Couplings(grid);
    this.values.set(first);
    this.operator = flowOperator(grid, first.mu, first.zero_theta_flux);
    this.linear = new Float64Array(grid.size);
    if (split) {
      const [spatial, turning] = [Math.max(first.d_s, last.d_s), Math.max(first.d_r, last.d_r)];
      for (let at = 0; at < grid.size; at += 1) this.linear[at] = -spatial * grid.k2[at]! - turning;
    }
  }

  /** Set p, the force and the flow for a packed spectrum at a time. */
  at(spectrum: Float64Array, t: number): void {
    if (this.moving) this.move(t);
    const { grid, p, force, flow, work } = this;
    grid.transform.inverse(spectrum, p);
    this.push(p, force);
    grid.transform.forward(force, work);
    const { direct, mirror } = this.operator;
    const { nTheta, nZ } = grid;
    for (let i = 0, at = 0; i < nTheta; i += 1) {
      const row = (i ? nTheta - i : 0) * nZ;
      for (let j = 0; j < nZ; j += 1, at += 1) {
        const back = 2 * (row + (j ? nZ - j : 0));
        const here = 2 * at;
        const d = direct[at]!, mr = mirror[here]!, mi = mirror[here + 1]!;
        const fr = work[here]!, fi = work[here + 1]!, br = work[back]!, bi = work[back + 1]!;
        flow[here] = d * fr + mr * br + mi * bi;
        flow[here + 1] = d * fi + mi * br - mr * bi;
      }
    }
    grid.transform.inverse(flow, this.u);
  }

  /** Write the spectrum of the nonlinear part at a time into `out`. */
  nonlinear(spectrum: Float64Array, t: number, out: Float64Array): Float64Array {
    this.at(spectrum, t);
    const divergence = this.gradients(spectrum);
    const { grid, p, u, strain, force, turn, values } = this;
    const { alphaP, alphaU, half, mirrorReal, mirrorImaginary } = values;
    const { nTheta, nZ } = grid;
    const epsilon = this.now.epsilon;
    for (let i = 0, at = 0, re = 0; i < nTheta; i += 1) {
      let row = (i >> 1) * 2 * nZ + (i & 1);
      for (let j = 0; j < nZ; j += 1, at += 1, re += 2, row += 2) {
        const im = re + 1;
        const pt = p[re]!, pz = p[im]!, ut = u[re]!, uz = u[im]!;
        const mr = mirrorReal[at]!, mi = mirrorImaginary[at]!;
        const own = alphaP[at]! - half[at]!, aligned = alphaU[at]!;
        const tt = own * pt + aligned * ut - (mr * pt + mi * pz);
        const tz = own * pz + aligned * uz - (mi * pt - mr * pz);
        const stretching = strain[re]! * (pt * pt - pz * pz) + 2 * strain[im]! * pt * pz;
        const along = pt * tt + pz * tz + epsilon * stretching;
        const carried = epsilon * divergence[row]!;
        force[re] = tt - pt * along - carried * ut;
        force[im] = tz - pz * along - carried * uz;
        turn[row] = ut * pz - uz * pt;
      }
    }
    grid.transform.forward(force, out);
    this.gather(this.real.forward(turn), out);
    if (!this.split || this.moving) this.addLinear(spectrum, out);
    return out;
  }

  /** Write the spectrum of dP/dt into `out`. */
  rate(spectrum: Float64Array, t: number, out: Float64Array): Float64Array {
    this.nonlinear(spectrum, t, out);
    for (let at = 0; at < out.length; at += 1) out[at]! += this.linear[at >> 1]! * spectrum[at]!;
    return out;
  }

  /** The viscosity at the time evaluated last. */
  get mu(): number {
    return this.now.mu;
  }

  /** The largest |P|² of the state evaluated last; NaN if there is any. */
  peak(): number {
    const { p } = this;
    let most = 0;
    for (let at = 0; at < p.length; at += 2) {
      const square = p[at]! * p[at]! + p[at + 1]! * p[at + 1]!;
      if (!(square <= most)) most = square;
      if (square !== square) return NaN;
    }
    return most;
  }

  /** The force |P|ⁿ P of p. */
  private push(p: Float64Array, force: Float64Array): void {
    const exponent = 0.5 * this.now.force_exponent;
    for (let re = 0; re < p.length; re += 2) {
      const pt = p[re]!, pz = p[re + 1]!;
      const square = pt * pt + pz * pz;
      const size = this.cubic || square === 0 ? square : square ** exponent;
      force[re] = size * pt;
      force[re + 1] = size * pz;
    }
  }

  /** Set the strain of the flow, and return the divergence of P, placed as `RealTransform` does. */
  private gradients(spectrum: Float64Array): Float64Array {
    const { grid, flow, strain, work, divergence, real } = this;
    const { m, q, nTheta, nZ } = grid;
    for (let i = 0, re = 0; i < nTheta; i += 1) {
      const k = 0.5 * m[i]!;
      for (let j = 0; j < nZ; j += 1, re += 2) {
        const l = 0.5 * q[j]!, fr = flow[re]!, fi = flow[re + 1]!;
        work[re] = -(k * fi + l * fr); // i K U / 2, with K = m + i q
        work[re + 1] = k * fr - l * fi;
      }
    }
    grid.transform.inverse(work, strain);
    for (let i = 0, out = 0; i < nTheta; i += 1) {
      const k = 0.5 * m[i]!;
      const [row, back] = [2 * i * nZ, 2 * (i ? nTheta - i : 0) * nZ];
      for (let j = 0; j < real.half; j += 1, out += 2) {
        const l = 0.5 * q[j]!, a = row + 2 * j, b = back + 2 * (j ? nZ - j : 0);
        const zr = spectrum[a]!, zi = spectrum[a + 1]!, br = spectrum[b]!, bi = spectrum[b + 1]!;
        divergence[out] = l * (zr - br) - k * (zi - bi); // of D = i conj(K) Z the part (D_k + conj D_-k)/2
        divergence[out + 1] = l * (zi + bi) + k * (zr + br);
      }
    }
    return real.inverse(divergence);
  }

  /** Add the curl of s, given n0 n1 times the spectrum of s and of the other terms, and drop the Nyquist modes. */
  private gather(curl: Float64Array, out: Float64Array): void {
    const { m, q, nTheta, nZ, keep, size } = this.grid;
    const { half } = this.real;
    const scale = 1 / size;
    const epsilon = this.now.epsilon;
    for (let i = 0, at = 0; i < nTheta; i += 1) {
      const k = epsilon * m[i]!;
      const [row, back] = [2 * i * half, 2 * (i ? nTheta - i : 0) * half];
      for (let j = 0; j < nZ; j += 1, at += 1) {
        const there = j < half ? row + 2 * j : back + 2 * (nZ - j);
        const l = epsilon * q[j]!, re = 2 * at, factor = scale * keep[at]!;
        const sr = curl[there]!, si = j < half ? curl[there + 1]! : -curl[there + 1]!;
        out[re] = factor * (out[re]! + k * sr - l * si);
        out[re + 1] = factor * (out[re + 1]! + k * si + l * sr);
      }
    }
  }

  /** Add the part of the linear terms that is not in `linear`. */
  private addLinear(spectrum: Float64Array, out: Float64Array): void {
    const { d_s, d_r } = this.now;
    for (let at = 0; at < this.grid.size; at += 1) {
      const rest = -d_s * this.grid.k2[at]! - d_r - this.linear[at]!;
      out[2 * at]! += rest * spectrum[2 * at]!;
      out[2 * at + 1]! += rest * spectrum[2 * at + 1]!;
    }
  }

  private move(t: number): void {
    const { first, last, ramps } = this.stage;
    this.now = paramsAt(first, last, ramps, t);
    this.values.set(this.now);
    if (this.now.mu !== this.operator.mu) this.operator = flowOperator(this.grid, this.now.mu, this.now.zero_theta_flux);
  }
}

/** <|P|²>^½ of a packed spectrum, or the same of a rate. */
export function sizeOf(spectrum: Float64Array): number {
  let sum = 0;
  for (let at = 0; at < spectrum.length; at += 1) sum += spectrum[at]! * spectrum[at]!;
  return Math.sqrt(sum);
}
