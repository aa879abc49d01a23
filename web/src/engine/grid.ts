import { Transform } from './transform';

/** Points on the surface of a cylinder of radius 1, as `cyclosis.CylinderGrid`, and what transforms on it need. */
export class Grid {
  readonly size: number;
  readonly theta: Float64Array;
  readonly z: Float64Array;
  /** Wavenumbers in transform order, 0 for the Nyquist modes; the others, with them, are `fullM` and `fullQ`. */
  readonly m: Float64Array;
  readonly q: Float64Array;
  private readonly fullM: Float64Array;
  private readonly fullQ: Float64Array;
  /** |k|², with the Nyquist modes. */
  readonly k2: Float64Array;
  /** 0 on the Nyquist modes, 1 elsewhere. */
  readonly keep: Float64Array;
  readonly transform: Transform;

  constructor(readonly nTheta: number, readonly nZ: number, readonly length: number) {
    this.size = nTheta * nZ;
    this.theta = Float64Array.from({ length: nTheta }, (_, i) => ((2 * Math.PI) / nTheta) * i);
    this.z = Float64Array.from({ length: nZ }, (_, j) => (length / nZ) * j);
    this.fullM = modeNumbers(nTheta);
    this.fullQ = modeNumbers(nZ).map((j) => j * ((2 * Math.PI) / length));
    this.m = withoutNyquist(this.fullM);
    this.q = withoutNyquist(this.fullQ);
    this.k2 = new Float64Array(this.size);
    this.keep = new Float64Array(this.size);
    for (let i = 0, at = 0; i < nTheta; i += 1) {
      for (let j = 0; j < nZ; j += 1, at += 1) {
        this.k2[at] = this.fullM[i]! ** 2 + this.fullQ[j]! ** 2;
        this.keep[at] = isNyquist(i, nTheta) || isNyquist(j, nZ) ? 0 : 1;
      }
    }
    this.transform = new Transform(nTheta, nZ);
  }
}

export function isNyquist(k: number, n: number): boolean {
  return n % 2 === 0 && k === n / 2;
}

function modeNumbers(n: number): Float64Array {
  return Float64Array.from({ length: n }, (_, k) => (k < n / 2 ? k : k - n));
}

function withoutNyquist(waves: Float64Array): Float64Array {
  return waves.map((wave, k) => (isNyquist(k, waves.length) ? 0 : wave));
}

/** The packed spectrum of a state [P_theta, P_z], with all modes. */
export function spectrumOf(grid: Grid, state: State): Float64Array {
  const packed = new Float64Array(2 * grid.size);
  for (let at = 0; at < grid.size; at += 1) {
    packed[2 * at] = state[0][at]!;
    packed[2 * at + 1] = state[1][at]!;
  }
  const out = grid.transform.forward(packed, new Float64Array(2 * grid.size));
  const scale = 1 / grid.size;
  for (let at = 0; at < out.length; at += 1) out[at]! *= scale;
  return out;
}

/** The spectrum without its Nyquist modes: what is reported about a state. */
export function resolvedModes(grid: Grid, spectrum: Float64Array): Float64Array {
  return spectrum.map((value, at) => value * grid.keep[at >> 1]!);
}

/** The state of a packed spectrum. */
export function stateOf(grid: Grid, spectrum: Float64Array): State {
  const packed = grid.transform.inverse(spectrum, new Float64Array(2 * grid.size));
  return unpacked(packed);
}

export function unpacked(packed: Float64Array): State {
  const [first, second] = [new Float64Array(packed.length / 2), new Float64Array(packed.length / 2)];
  for (let at = 0; at < first.length; at += 1) {
    first[at] = packed[2 * at]!;
    second[at] = packed[2 * at + 1]!;
  }
  return [first, second];
}

/** A vector field (component theta, component z), each theta-major: value at i * n_z + j. */
export type State = [Float64Array, Float64Array];
