import { Lines } from './fft';
import { isNyquist, type Grid, type State } from './grid';

// Where the axial polarity changes sign, as `analysis/zones.py`. States are without their Nyquist modes.

const DISORDER = 0.05;
const DOMINANT = 0.8;

/** Means of the two squares and of P: all that the words about a state need. */
export function meansOf(state: State): { around: number; along: number; order: number; mean: [number, number] } {
  const size = state[0].length;
  const mean = (values: Float64Array, power: number): number => values.reduce((sum, value) => sum + value ** power, 0) / size;
  const [around, along] = [mean(state[0], 2), mean(state[1], 2)];
  return { around, along, order: Math.sqrt(around + along), mean: [mean(state[0], 1), mean(state[1], 1)] };
}

/** How often P_z changes sign around each circle z = const. */
export function crossings(grid: Grid, state: State): Int32Array {
  const { nTheta, nZ } = grid;
  const up = state[1];
  return Int32Array.from({ length: nZ }, (_, j) => {
    let count = 0;
    for (let i = 0; i < nTheta; i += 1) {
      const before = (i || nTheta) - 1;
      if (up[i * nZ + j]! > 0 !== up[before * nZ + j]! > 0) count += 1;
    }
    return count;
  });
}

/** The mean of a field along the axis, over theta. */
export function axialMean(grid: Grid, field: Float64Array): Float64Array {
  return Float64Array.from({ length: grid.nTheta }, (_, i) => {
    const row = field.subarray(i * grid.nZ, (i + 1) * grid.nZ);
    return row.reduce((sum, value) => sum + value, 0) / grid.nZ;
  });
}

/** The angles at which the axial mean of P_z changes sign, sorted; none for a state without stripes. */
export function zonesOf(grid: Grid, state: State): number[] {
  const { around, along, order } = meansOf(state);
  const up = state[1].some((value) => value > 0);
  const down = state[1].some((value) => !(value > 0));
  if (order < DISORDER || around >= DOMINANT * (around + along) || !up || !down) return [];
  return zoneAngles(axialMean(grid, state[1]));
}

/** The angles in [0, 2π) at which a periodic profile, interpolated trigonometrically, changes sign. */
export function zoneAngles(profile: Float64Array): number[] {
  const n = profile.length;
  const packed = new Float64Array(2 * n);
  profile.forEach((value, k) => (packed[2 * k] = value / n));
  const blank = (): Float64Array => new Float64Array(2 * n);
  const spectrum = new Lines(n).run(packed, blank(), blank(), 1, 1, false);
  const waves = Math.floor(n / 2) + 1;
  const value = (angle: number): number => {
    let sum = spectrum[0]!;
    for (let m = 1; m < waves; m += 1) {
      if (isNyquist(m, n)) continue;
      sum += 2 * (spectrum[2 * m]! * Math.cos(m * angle) - spectrum[2 * m + 1]! * Math.sin(m * angle));
    }
    return sum;
  };
  const fine = 4 * n;
  const step = (2 * Math.PI) / fine;
  const sampled = Array.from({ length: fine }, (_, k) => value(k * step));
  const angles: number[] = [];
  sampled.forEach((here, k) => {
    const next = sampled[(k + 1) % fine]!;
    if (here > 0 !== next > 0) angles.push(root(value, k * step, (k + 1) * step) % (2 * Math.PI));
  });
  return angles.sort((a, b) => a - b);
}

/** The root between two points, by bisection down to neighbouring numbers. */
function root(value: (x: number) => number, low: number, high: number): number {
  let [a, b] = [low, high];
  const [first, last] = [value(a), value(b)];
  if (first * last >= 0) return Math.abs(first) <= Math.abs(last) ? a : b; // one end is a root to rounding
  for (;;) {
    const middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) return middle;
    const there = value(middle);
    if (there === 0) return middle;
    if (there > 0 === first > 0) a = middle;
    else b = middle;
  }
}

/** The widths of the stripes between sorted angles, as fractions of the circumference. */
export function stripeWidths(angles: number[]): number[] {
  return angles.map((angle, k) => ((angles[k + 1] ?? angles[0]! + 2 * Math.PI) - angle) / (2 * Math.PI));
}
