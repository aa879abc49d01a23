import type { Catalogue, Table } from './definitions';
import { beside, InputError } from './errors';
import type { Grid, State } from './grid';
import { interpolate } from './interpolate';
import { normals } from './random';

// Initial states, as `model/initial.py` and `model/starts.py`.

const NOISE = ['seed', 'filaments_per_square', 'noise_grid'];

/** Standard normal numbers, independent on `noiseGrid`, interpolated onto the grid. */
export function standardNoise(grid: Grid, noiseGrid: [number, number] | null, seed: number, key: readonly number[] = []): State {
  const own: [number, number] = [grid.nTheta, grid.nZ];
  const drawnOn = noiseGrid ?? own;
  const points = drawnOn[0] * drawnOn[1];
  const drawn = normals(2 * points, seed, key);
  return [interpolate(drawn.slice(0, points), drawnOn, own), interpolate(drawn.slice(points), drawnOn, own)];
}

/** The order vector of N randomly oriented filaments in every grid square. */
export function noise(grid: Grid, filaments: number, seed: number, noiseGrid: [number, number] | null): State {
  const own: [number, number] = [grid.nTheta, grid.nZ];
  const drawnOn = noiseGrid ?? own;
  const points = drawnOn[0] * drawnOn[1];
  // Scaled before it is interpolated, so that every bit is that of NumPy.
  const drawn = normals(2 * points, seed).map((value) => value * Math.sqrt(0.5 / filaments));
  return [interpolate(drawn.slice(0, points), drawnOn, own), interpolate(drawn.slice(points), drawnOn, own)];
}

/** Throw `InputError` for keys that the kind of initial state does not use, or if one is missing. */
export function checkInitial(given: Table, uses: Catalogue['uses'], usual: string): void {
  const kind = (given.kind ?? usual) as string;
  for (const [key, value] of Object.entries(given)) {
    if (key === 'kind' || uses[kind]!.includes(key)) continue;
    const users = Object.keys(uses).filter((each) => uses[each]!.includes(key));
    const rule = users.length ? `used only where initial kind is ${users.join(', ')}` : 'used only where [model] concentration is true';
    throw new InputError(key, value, rule, `remove it, or change kind = ${kind}`);
  }
  const [first] = NOISE.filter((key) => given[key] !== undefined && given[key] !== null);
  if (kind !== 'disordered' && first && (given.filaments_per_square ?? null) === null) {
    throw new InputError(first, given[first], `given with filaments_per_square for kind = ${kind}`, 'add it, for noise');
  }
}

/** The state that a checked [initial] table describes. */
export function initialState(given: Table, grid: Grid): State {
  const kind = (given.kind ?? 'disordered') as string;
  const blank = (): Float64Array => new Float64Array(grid.size);
  const state: State = [blank(), blank()];
  const magnitude = (given.magnitude ?? 0.9) as number;
  if (kind === 'unidirectional') state[1].fill(magnitude);
  else if (kind === 'circumferential') state[0].fill(magnitude);
  else if (kind === 'stripes') {
    const count = (given.stripes ?? 2) as number;
    if (count % 2) throw new InputError('stripes', count, 'an even number, because stripes alternate', 'choose 2 or 4');
    if (count / 2 > Math.floor((grid.nTheta - 1) / 2)) {
      throw new InputError('stripes', count, `resolved by n_theta = ${grid.nTheta}`, 'raise n_theta');
    }
    for (let at = 0; at < grid.size; at += 1) {
      state[1][at] = magnitude * Math.sin((count / 2) * grid.theta[Math.floor(at / grid.nZ)]!);
    }
  }
  const filaments = (given.filaments_per_square ?? (kind === 'disordered' ? 1000 : null)) as number | null;
  if (filaments !== null) {
    const drawn = noise(grid, filaments, (given.seed ?? 0) as number, (given.noise_grid ?? null) as [number, number] | null);
    state.forEach((part, k) => part.forEach((value, at) => (part[at] = value + drawn[k]![at]!)));
  }
  return bounded(state);
}

/** The state, unless |P| > 1 somewhere. */
function bounded(state: State): State {
  let most = 0;
  state[0].forEach((value, at) => (most = Math.max(most, Math.hypot(value, state[1][at]!))));
  if (most > 1 + 1e-12) {
    const rule = 'at most 1, because P is a mean of unit vectors';
    const remedy = 'scale the state down, or raise filaments_per_square if it is noise';
    throw new InputError('max |P| of the initial state', Number(beside(most, 1)), rule, remedy);
  }
  return state;
}
