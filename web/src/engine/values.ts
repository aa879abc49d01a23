import type { Grid } from './grid';

/** The parameters of a cell, by the names of the package. The first four may differ from place to place. */
export interface Params {
  alpha_p: Coupling;
  alpha_u: Coupling;
  kappa: Coupling;
  repulsion_angle: Coupling;
  epsilon: number;
  d_s: number;
  d_r: number;
  mu: number;
  zero_theta_flux: boolean;
  force_exponent: number;
}

export type Coupling = number | Float64Array;
export type Name = keyof Params;

/** When each ramp begins and ends, by the name of what changes. */
export type Ramps = Partial<Record<Name, [number, number]>>;

/** A coupling at a share of the way between two. */
export function between(first: Coupling, last: Coupling, share: number): Coupling {
  if (typeof first === 'number' && typeof last === 'number') return first + share * (last - first);
  const size = typeof first === 'number' ? (last as Float64Array).length : first.length;
  const [a, b] = [valueAt(first), valueAt(last)];
  return Float64Array.from({ length: size }, (_, at) => a(at) + share * (b(at) - a(at)));
}

export function valueAt(coupling: Coupling): (at: number) => number {
  return typeof coupling === 'number' ? () => coupling : (at) => coupling[at]!;
}

/** The parameters at a time during ramps, linear in time. */
export function paramsAt(first: Params, last: Params, ramps: Ramps, t: number): Params {
  const now: Params = { ...first };
  for (const [name, [begin, end]] of Object.entries(ramps) as [Name, [number, number]][]) {
    if (name === 'zero_theta_flux') continue;
    const share = (t - begin) / (end - begin);
    Object.assign(now, { [name]: between(first[name] as Coupling, last[name] as Coupling, share) });
  }
  return now;
}

/** The couplings at every point, as the right-hand side needs them. */
export class Couplings {
  readonly alphaP: Float64Array;
  readonly alphaU: Float64Array;
  /** The repulsion -κ (P·d) d, packed, is -(half p + mirror conj p) with half = κ/2 and mirror = κ e^{2iφ}/2. */
  readonly half: Float64Array;
  readonly mirrorReal: Float64Array;
  readonly mirrorImaginary: Float64Array;

  constructor(grid: Grid) {
    const blank = (): Float64Array => new Float64Array(grid.size);
    [this.alphaP, this.alphaU, this.half, this.mirrorReal, this.mirrorImaginary] = [blank(), blank(), blank(), blank(), blank()];
  }

  set(params: Params): void {
    const { alpha_p, alpha_u, kappa, repulsion_angle } = params;
    put(this.alphaP, alpha_p);
    put(this.alphaU, alpha_u);
    if (typeof kappa === 'number' && typeof repulsion_angle === 'number') {
      this.half.fill(0.5 * kappa);
      this.mirrorReal.fill(0.5 * kappa * Math.cos(2 * repulsion_angle));
      this.mirrorImaginary.fill(0.5 * kappa * Math.sin(2 * repulsion_angle));
      return;
    }
    const [strength, angle] = [valueAt(kappa), valueAt(repulsion_angle)];
    for (let at = 0; at < this.half.length; at += 1) {
      const half = 0.5 * strength(at);
      this.half[at] = half;
      this.mirrorReal[at] = half * Math.cos(2 * angle(at));
      this.mirrorImaginary[at] = half * Math.sin(2 * angle(at));
    }
  }
}

function put(out: Float64Array, coupling: Coupling): void {
  if (typeof coupling === 'number') out.fill(coupling);
  else out.set(coupling);
}
