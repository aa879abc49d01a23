import { describe, expect, it } from 'vitest';
import { numbersOf } from '../src/engine/base64';
import { Grid, resolvedModes, spectrumOf, stateOf } from '../src/engine/grid';
import { System } from '../src/engine/system';
import type { Params, Ramps } from '../src/engine/values';
import { apart, golden, stateOfText } from './golden';

interface Case {
  name: string;
  grid: [number, number, number];
  parameters: Partial<Params>;
  fields: Record<string, string>;
  last?: Partial<Params>;
  ramps?: Ramps;
  t?: number;
  rate: string;
}

const REST = { zero_theta_flux: false, force_exponent: 2 };

describe('the right-hand side is that of the library', () => {
  const { states, cases } = golden<{ states: Record<string, string>; cases: Case[] }>('rates.json');
  for (const item of cases) {
    for (const split of [true, false]) {
      it(`${item.name}, linear terms ${split ? 'apart' : 'included'}`, () => {
        const grid = new Grid(...item.grid);
        const fields = Object.fromEntries(Object.entries(item.fields).map(([name, text]) => [name, numbersOf(text)]));
        const first = { ...REST, ...item.parameters, ...fields } as Params;
        const system = new System(grid, { first, last: { ...first, ...item.last }, ramps: item.ramps ?? {} }, split);
        const spectrum = resolvedModes(grid, spectrumOf(grid, stateOfText(states[`${item.grid[0]} x ${item.grid[1]}`]!)));
        const rate = system.rate(spectrum, item.t ?? 0, new Float64Array(spectrum.length));
        expect(apart(stateOf(grid, rate), stateOfText(item.rate))).toBeLessThan(1e-12);
      });
    }
  }
});
