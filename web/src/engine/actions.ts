import type { Grid, State } from './grid';
import { standardNoise } from './initial';
import type { Step } from './protocol';

/** A state after a step of a protocol with a seed; outside its region every bit is as before: `model/actions.py`. */
export function act(step: Step, state: State, grid: Grid, seed: number, mask: Uint8Array | null): State {
  const made = everywhere(step, state, grid, seed);
  if (!mask) return made;
  return [0, 1].map((k) => made[k]!.map((value, at) => (mask[at] ? value : state[k]![at]!))) as State;
}

function everywhere(step: Step, state: State, grid: Grid, seed: number): State {
  const values = step.values as Record<string, number>;
  if (step.action === 'depolymerise') return state.map((part) => part.map((value) => values.keep! * value)) as State;
  if (step.action === 'align') {
    const [along, up] = [values.magnitude! * Math.cos(values.angle!), values.magnitude! * Math.sin(values.angle!)];
    return [new Float64Array(grid.size).fill(along), new Float64Array(grid.size).fill(up)];
  }
  const noiseGrid = (step.values.noise_grid ?? null) as [number, number] | null;
  const drawn = standardNoise(grid, noiseGrid, seed, [values.seed ?? 0]);
  if (step.action === 'fragment') {
    const scale = Math.sqrt(0.5 / values.filaments_per_square!);
    return bounded(drawn.map((part) => part.map((value) => value * scale)) as State);
  }
  return bounded(drawn.map((part, k) => part.map((value, at) => state[k]![at]! + values.size! * value)) as State);
}

/** A state with |P| scaled back to 1 where it is larger. */
function bounded(state: State): State {
  const size = state[0].map((value, at) => Math.max(Math.hypot(value, state[1][at]!), 1));
  return state.map((part) => part.map((value, at) => value / size[at]!)) as State;
}
