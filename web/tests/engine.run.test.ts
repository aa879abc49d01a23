import { describe, expect, it } from 'vitest';
import { measure, type Measured } from '../src/engine/diagnostics';
import { Grid, resolvedModes, spectrumOf, stateOf, unpacked } from '../src/engine/grid';
import { initialState } from '../src/engine/initial';
import { Live } from '../src/engine/live';
import { protocolOf, protocolOfTables } from '../src/engine/protocol';
import { judged } from '../src/engine/regimes';
import { System } from '../src/engine/system';
import type { Params } from '../src/engine/values';
import { CATALOGUE } from './catalogue';
import { apart, golden, stateOfText } from './golden';
import { FIGURE_4 } from './paper';

type Row = Omit<Measured, 'mean_P_theta' | 'mean_P_z'> & { t: number; mean_P: [number, number] };

interface Cell {
  name: string;
  initial: Record<string, unknown> & { seed: number };
  end: number;
  protocol: unknown[];
  texts: string[];
  tables: Record<string, unknown>[];
  parameters: (Record<keyof Params, number> & { t: number })[];
  states: { t: number; state: string }[];
}

describe('a run to t = 20 from disorder is that of the library', () => {
  const expected = golden<{ rows: Row[]; state: string; flow: string; accepted: number; rejected: number; evaluations: number }>('run.json');
  const grid = new Grid(32, 32, 5);
  const live = new Live(FIGURE_4, grid, initialState({ seed: 0 }, grid), 0.5, protocolOf([], 0));
  const rows: (Measured & { t: number })[] = [];
  while (live.t < 20) if (live.forward() && live.frame % 4 === 0) rows.push({ ...measure(live.system, live.reported, live.t), t: live.t });

  it('in its steps', () => {
    const { accepted, rejected, evaluations } = live.progress;
    expect({ accepted, rejected, evaluations }).toEqual({ accepted: expected.accepted, rejected: expected.rejected, evaluations: expected.evaluations });
  });

  it('in its state and its flow', () => {
    expect(apart(live.state, stateOfText(expected.state))).toBeLessThan(1e-9);
    live.system.at(live.reported, live.t);
    expect(apart(unpacked(live.system.u), stateOfText(expected.flow))).toBeLessThan(1e-9);
  });

  it('in every quantity on the way', () => {
    expect(rows.length).toBe(expected.rows.length);
    expected.rows.forEach(({ mean_P: [mean_P_theta, mean_P_z], ...row }, k) => {
      for (const [name, value] of Object.entries({ ...row, mean_P_theta, mean_P_z })) {
        expect(Math.abs(rows[k]![name as keyof Measured] - value), `${name} at t = ${row.t}`).toBeLessThan(1e-9);
      }
    });
  });
});

describe('cells under protocols are those of the library', () => {
  for (const cell of golden<Cell[]>('protocols.json')) {
    it(cell.name, () => {
      const grid = new Grid(24, 16, 5);
      const protocol = protocolOfTables(cell.protocol, cell.initial.seed, CATALOGUE);
      expect(protocol.steps.map((step) => step.text)).toEqual(cell.texts);
      expect(protocol.steps.map((step) => step.table)).toEqual(cell.tables);
      const live = new Live(FIGURE_4, grid, initialState(cell.initial, grid), 0.5, protocol);
      let [frame, state] = [0, 0];
      while (live.t < cell.end) {
        if (!live.forward()) continue;
        const { t, ...params } = cell.parameters[frame]!;
        for (const [name, value] of Object.entries(params)) {
          const found = live.paramsNow[name as keyof Params];
          const mean = typeof found === 'object' ? found.reduce((a, b) => a + b, 0) / found.length : Number(found);
          expect(Math.abs(mean - value), `${name} at t = ${t}`).toBeLessThan(1e-12);
        }
        frame += 1;
        if (cell.states[state]!.t !== live.t) continue;
        expect(apart(live.state, stateOfText(cell.states[state]!.state)), `t = ${live.t}`).toBeLessThan(1e-9);
        state += 1;
      }
      expect(state).toBe(cell.states.length);
    });
  }

  it('also when the steps are given while they run', () => {
    const [cell] = golden<[Cell]>('protocols.json');
    const grid = new Grid(24, 16, 5);
    const { steps, seed } = protocolOfTables(cell.tables, cell.initial.seed, CATALOGUE);
    const make = (known: typeof steps): Live => new Live(FIGURE_4, grid, initialState(cell.initial, grid), 0.05, protocolOf(known, seed));
    const [whole, written] = [make(steps), make([])];
    while (whole.t < 6) whole.forward(3);
    while (written.t < 6) {
      if (!written.forward(3)) continue;
      steps.filter((step) => step.at === written.t).forEach((step) => written.do(protocolOf([...written.protocol.steps, step], seed)));
    }
    expect(apart(written.state, whole.state)).toBe(0);
    expect(() => written.do(protocolOf([...written.protocol.steps, { ...steps[0]!, at: 5.5, table: {} }], seed))).toThrow('the time reached');
  });
});

describe('what a state is', () => {
  interface Known {
    of: string;
    state: string;
    found: { name: string; reason: string; boundaries: number[]; zones: number[]; widths: number[]; mean_P: number[]; drift: number[]; order: number; rate: number };
  }
  for (const { of, state, found } of golden<Known[]>('regimes.json')) {
    it(`${of}: ${found.name} (${found.reason})`, () => {
      const grid = new Grid(16, 12, 5);
      const params = { ...FIGURE_4, kappa: 0.1 };
      const system = new System(grid, { first: params, last: params, ramps: {} });
      const spectrum = resolvedModes(grid, spectrumOf(grid, stateOfText(state)));
      const change = stateOf(grid, system.rate(spectrum, 0, new Float64Array(spectrum.length)));
      const { name, reason, boundaries, ...numbers } = judged(grid, stateOf(grid, spectrum), spectrum, change);
      expect({ name, reason, boundaries }).toEqual({ name: found.name, reason: found.reason, boundaries: found.boundaries });
      const list = (value: number | number[]): number[] => [value].flat();
      for (const [key, value] of Object.entries({ ...found, mean: found.mean_P })) {
        if (!(key in numbers)) continue;
        const mine = list(numbers[key as keyof typeof numbers]);
        expect(mine.length, key).toBe(list(value as number[]).length);
        list(value as number[]).forEach((each, k) => expect(Math.abs(mine[k]! - each), key).toBeLessThan(1e-9));
      }
    });
  }
});
