import type { System } from './system';

// One step in time: Krogstad's ETDRK4-B with a third-order solution for the error, as `dynamics/steppers.py`.

/** Coefficients of a step, each a real field over the modes. */
export interface Tableau {
  full: Float64Array;
  half: Float64Array;
  a21: Float64Array;
  a31: Float64Array;
  a32: Float64Array;
  a41: Float64Array;
  a43: Float64Array;
  w1: Float64Array;
  w23: Float64Array;
  w4: Float64Array;
}

/** φ₁, φ₂, φ₃ of z <= 0: a Taylor series within |z| < 1, else the recurrence. */
export function phi(z: number): [number, number, number] {
  const out: [number, number, number] = [0, 0, 0];
  let factorial = 1; // (k - 1)!
  let value = Math.exp(z);
  for (let k = 1; k <= 3; k += 1) {
    if (Math.abs(z) < 1) {
      let series = 0;
      for (let j = 17; j >= 0; j -= 1) series = series * z + 1 / FACTORIALS[j + k]!;
      out[k - 1] = series;
    } else {
      value = (value - 1 / factorial) / z;
      out[k - 1] = value;
    }
    factorial *= k;
  }
  return out;
}

const FACTORIALS = Array.from({ length: 21 }, (_, n) => Array.from({ length: n }, (_x, k) => k + 1).reduce((a, b) => a * b, 1));

/** The coefficients of a step of length h. */
export function tableau(linear: Float64Array, h: number): Tableau {
  const blank = (): Float64Array => new Float64Array(linear.length);
  const out: Tableau = {
    full: blank(), half: blank(), a21: blank(), a31: blank(), a32: blank(), a41: blank(), a43: blank(), w1: blank(), w23: blank(), w4: blank(),
  };
  for (let at = 0; at < linear.length; at += 1) {
    const z = h * linear[at]!;
    const [half1, half2] = phi(0.5 * z);
    const [full1, full2, full3] = phi(z);
    out.full[at] = Math.exp(z);
    out.half[at] = Math.exp(0.5 * z);
    out.a21[at] = 0.5 * h * half1;
    out.a31[at] = h * (0.5 * half1 - half2);
    out.a32[at] = h * half2;
    out.a41[at] = h * (full1 - 2 * full2);
    out.a43[at] = 2 * h * full2;
    out.w1[at] = h * (full1 - 3 * full2 + 4 * full3);
    out.w23[at] = 2 * h * (full2 - 2 * full3);
    out.w4[at] = h * (4 * full3 - full2);
  }
  return out;
}

/** The arrays that a step writes into: the new spectrum, its N, and the estimate of the error. */
export class Stepper {
  readonly spectrum: Float64Array;
  readonly nonlinear: Float64Array;
  readonly error: Float64Array;
  private readonly n2: Float64Array;
  private readonly n3: Float64Array;
  private readonly n4: Float64Array;

  constructor(size: number) {
    const blank = (): Float64Array => new Float64Array(2 * size);
    [this.spectrum, this.nonlinear, this.error] = [blank(), blank(), blank()];
    [this.n2, this.n3, this.n4] = [blank(), blank(), blank()];
  }

  /** Advance the spectrum Z by h; n1 is the nonlinear part at (t, Z). Return max |P|² of the new state. */
  step(system: System, c: Tableau, t: number, h: number, z: Float64Array, n1: Float64Array): number {
    const { n2, n3, n4, spectrum, nonlinear, error } = this;
    const { full, half, a21, a31, a32, a41, a43, w1, w23, w4 } = c;
    const length = z.length;
    for (let at = 0; at < length; at += 1) {
      const k = at >> 1;
      error[at] = half[k]! * z[at]! + a21[k]! * n1[at]!;
    }
    system.nonlinear(error, t + 0.5 * h, n2);
    for (let at = 0; at < length; at += 1) {
      const k = at >> 1;
      error[at] = half[k]! * z[at]! + a31[k]! * n1[at]! + a32[k]! * n2[at]!;
    }
    system.nonlinear(error, t + 0.5 * h, n3);
    for (let at = 0; at < length; at += 1) {
      const k = at >> 1;
      error[at] = full[k]! * z[at]! + a41[k]! * n1[at]! + a43[k]! * n3[at]!;
    }
    system.nonlinear(error, t + h, n4);
    for (let at = 0; at < length; at += 1) {
      const k = at >> 1;
      spectrum[at] = full[k]! * z[at]! + w1[k]! * n1[at]! + w23[k]! * (n2[at]! + n3[at]!) + w4[k]! * n4[at]!;
    }
    system.nonlinear(spectrum, t + h, nonlinear);
    for (let at = 0; at < length; at += 1) error[at] = w4[at >> 1]! * (n4[at]! - nonlinear[at]!);
    return system.peak();
  }
}
