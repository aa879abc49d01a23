import { describe, expect, it } from 'vitest';
import { Advance, start, type Control, type Method } from '../src/engine/advance';
import { numbersOf } from '../src/engine/base64';
import { Grid, resolvedModes, spectrumOf, stateOf } from '../src/engine/grid';
import { initialState } from '../src/engine/initial';
import { phi } from '../src/engine/steppers';
import { System } from '../src/engine/system';
import { apart, golden, stateOfText } from './golden';
import { FIGURE_4 } from './paper';

interface Run {
  method: Method;
  control: Omit<Control, 'steadyRate'> & { steady_rate: number };
  target: number;
  most: number;
  t: number;
  accepted: number;
  rejected: number;
  evaluations: number;
  rung: number;
  failed: boolean;
  rate: number;
  peak: number;
  state: string;
}

describe('initial states are those of the library bit for bit', () => {
  for (const { table, state } of golden<{ table: Record<string, unknown>; state: string }[]>('initial.json')) {
    it(JSON.stringify(table), () => {
      const [expected, found] = [numbersOf(state), initialState(table, new Grid(16, 12, 5))];
      // Interpolation is by another transform than NumPy's, with other rounding.
      if (table.noise_grid) expect(apart(found, stateOfText(state))).toBeLessThan(1e-14);
      else expect([...found[0], ...found[1]]).toEqual([...expected]);
    });
  }
});

describe('steps are those of the library', () => {
  const [{ grid: shape, state, runs }] = golden<[{ grid: [number, number, number]; state: string; runs: Run[] }]>('steps.json');
  for (const run of runs) {
    it(`${run.method} to t = ${run.target}, ${JSON.stringify(run.control)}`, () => {
      const grid = new Grid(...shape);
      const system = new System(grid, { first: FIGURE_4, last: FIGURE_4, ramps: {} }, run.method !== 'rk4');
      const control = { ...run.control, steadyRate: run.control.steady_rate };
      const begun = start(system, resolvedModes(grid, spectrumOf(grid, stateOfText(state))), 0);
      const end = new Advance(system, run.method).to(control, begun, run.target, run.most);
      const { accepted, rejected, evaluations, rung, failed } = end;
      const { accepted: a, rejected: r, evaluations: e, rung: g, failed: f } = run;
      expect({ accepted, rejected, evaluations, rung, failed }).toEqual({ accepted: a, rejected: r, evaluations: e, rung: g, failed: f });
      expect(Math.abs(end.t - run.t)).toBeLessThan(1e-9);
      expect(apart(stateOf(grid, end.spectrum), stateOfText(run.state))).toBeLessThan(run.t > 20 ? 1e-9 : 1e-11);
      expect(end.peak).toBeCloseTo(run.peak, 10);
      expect(Math.abs(end.rate - run.rate)).toBeLessThan(1e-9 * run.rate + 1e-12);
    });
  }
});

describe('the functions φ', () => {
  it('satisfy their recurrence on both sides of the change of method', () => {
    for (const z of [-1e-3, -0.5, -0.999, -1.001, -3, -40]) {
      const [one, two, three] = phi(z);
      expect(z * one + 1).toBeCloseTo(Math.exp(z), 14);
      expect(z * two + 1).toBeCloseTo(one, 14);
      expect(z * three + 0.5).toBeCloseTo(two, 14);
    }
    expect(phi(0)).toEqual([1, 0.5, 1 / 6]);
  });
});
