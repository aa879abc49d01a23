import { beside, general } from './errors';
import type { Grid, State } from './grid';
import { crossings, meansOf, stripeWidths, zonesOf } from './zones';

// From a state to its regime, as `analysis/regimes.py`.

const DISORDER = 0.05;
const DOMINANT = 0.8;
const SETTLED = 1e-3;
const TRANSLATION = 0.9;

export interface Found {
  name: string;
  reason: string;
  zones: number[];
  widths: number[];
  mean: [number, number];
  order: number;
  around: number;
  boundaries: [number, number];
  drift: [number, number];
  rate: number;
}

/** The regime of a state without Nyquist modes, with its spectrum, that changes at a rate. */
export function judged(grid: Grid, state: State, spectrum: Float64Array, change: State): Found {
  const { around, order, mean } = meansOf(state);
  const rate = meansOf(change).order / Math.max(order, 1e-300);
  const [drift, explained] = drifting(grid, state, spectrum, change);
  const crossed = crossings(grid, state);
  const boundaries: [number, number] = [Math.min(...crossed), Math.max(...crossed)];
  const share = around / Math.max(order ** 2, 1e-300);
  const [name, reason] = named(state, order, rate, drift, explained, share, boundaries);
  const zones = zonesOf(grid, state);
  return { name, reason, zones, widths: stripeWidths(zones), mean, order, around: share, boundaries, drift, rate };
}

function named(
  state: State, order: number, rate: number, drift: [number, number], explained: number, around: number, [low, high]: [number, number],
): [string, string] {
  if (order < DISORDER) return ['disordered', `order ${beside(order, DISORDER, 2)} is below ${DISORDER}`];
  if (rate >= SETTLED && explained >= TRANSLATION) {
    return ['travelling', `drifts at ${general(drift[0], 3)} around and ${general(drift[1], 3)} along the axis`];
  }
  const percent = (100 * around).toFixed(0);
  if (around >= DOMINANT) return ['circumferential', `${percent} % of the order runs around the axis`];
  if (low !== high) return ['undecided', `${low} to ${high} indifferent zones along the axis`];
  if (around > 0.5) return ['undecided', `${percent} % of the order runs around the axis`];
  const oneSign = state[1].every((value) => value > 0) || !state[1].some((value) => value > 0);
  if (high === 0 && !oneSign) return ['undecided', 'the polarity changes along the axis, not around it'];
  if (high === 0) return ['unidirectional', 'one polarity, no indifferent zone'];
  if (high === 2) return ['cyclosis', 'two stripes along the whole cell'];
  return ['multistripe', `${high} stripes along the whole cell`];
}

/** Fit dP/dt = -c·∇P by least squares; return c and the share of |dP/dt|² that it explains. */
function drifting(grid: Grid, state: State, spectrum: Float64Array, change: State): [[number, number], number] {
  const derivative = (along: 'm' | 'q'): Float64Array => {
    const out = new Float64Array(spectrum.length);
    for (let at = 0; at < grid.size; at += 1) {
      const k = along === 'm' ? grid.m[Math.floor(at / grid.nZ)]! : grid.q[at % grid.nZ]!;
      out[2 * at] = -k * spectrum[2 * at + 1]!;
      out[2 * at + 1] = k * spectrum[2 * at]!;
    }
    return grid.transform.inverse(out, new Float64Array(out.length));
  };
  const product = (a: Float64Array, b: Float64Array): number => a.reduce((sum, value, at) => sum + value * b[at]!, 0);
  const target = new Float64Array(spectrum.length);
  for (let at = 0; at < grid.size; at += 1) {
    target[2 * at] = change[0][at]!;
    target[2 * at + 1] = change[1][at]!;
  }
  const size = product(target, target);
  if (size === 0 || !Number.isFinite(size)) return [[0, 0], 0];
  const [a, b] = [derivative('m'), derivative('q')];
  const [aa, ab, bb, at, bt] = [product(a, a), product(a, b), product(b, b), product(a, target), product(b, target)];
  // A drift is not defined along a direction in which the state hardly varies: leave it at zero.
  const least = 1e-12 * (product(state[0], state[0]) + product(state[1], state[1]));
  const [around, along] = [aa > least, bb > least];
  const drift: [number, number] = [0, 0];
  const determinant = aa * bb - ab * ab;
  // Two gradients that are the same but for a factor: the smallest drift.
  if (around && along && determinant <= 1e-13 * aa * bb) {
    drift[0] = -at / (aa + bb);
    drift[1] = (drift[0] * ab) / aa;
  } else if (around && along) {
    drift[0] = -(at * bb - bt * ab) / determinant;
    drift[1] = -(bt * aa - at * ab) / determinant;
  } else if (around) drift[0] = -at / aa;
  else if (along) drift[1] = -bt / bb;
  let remainder = 0;
  for (let k = 0; k < target.length; k += 1) remainder += (target[k]! + drift[0] * a[k]! + drift[1] * b[k]!) ** 2;
  return [drift, 1 - remainder / size];
}
